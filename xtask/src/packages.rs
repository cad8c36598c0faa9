//! Could the crates that a user adds be published?

use crate::process::{self, Done, failed};

/// Those crates. What they need of ours is among them.
pub const CRATES: [&str; 3] = ["umbrage-core", "umbrage-scene", "umbrage"];

/// No address of ours is public yet, so none of the three would be true. Whoever has one writes it into `[workspace.package]`
/// and takes this line away.
const ALLOWED: [&str; 1] = ["manifest has no documentation, homepage or repository"];

/// Packs them as `cargo publish` would, without a network, and takes warnings for faults.
///
/// `cargo publish --dry-run` does the same after it has asked the registry; `--no-verify` because the tests have built all of it.
pub fn check() -> Done {
    let mut words = vec!["package", "--offline", "--allow-dirty", "--no-verify"];
    words.extend(CRATES.iter().flat_map(|name| ["--package", name]));
    let mut command = process::cargo(words);
    eprintln!("$ {}", process::typed(&command));
    // Colours would stand before the words that are looked for.
    let output = process::output(command.env("CARGO_TERM_COLOR", "never"))?;
    let said = String::from_utf8_lossy(&output.stderr);
    if !output.status.success() {
        return Err(failed(format!("`cargo package` failed: {}", process::last_words(&output))));
    }
    judge(&said).map_err(failed)?;
    println!("{} could be published, but for an address: there is none yet", CRATES.join(", "));
    Ok(())
}

fn judge(said: &str) -> Result<(), String> {
    for name in CRATES {
        if !said.lines().any(|line| line.trim_start().starts_with(&format!("Packaging {name} v"))) {
            return Err(format!("`cargo package` did not pack {name}"));
        }
    }
    let warnings = said.lines().filter_map(|line| line.trim_start().strip_prefix("warning: "));
    match warnings.into_iter().find(|warning| !ALLOWED.contains(warning)) {
        Some(warning) => Err(format!("`cargo package` warns: {warning}")),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_warning_is_seen_but_for_the_one_that_is_allowed() {
        let packing: String =
            CRATES.iter().map(|name| format!("   Packaging {name} v0.1.0 (/x)\n")).collect();
        let allowed = format!("warning: {}\n  |\n  = note: see\n{packing}", ALLOWED[0]);
        assert_eq!(judge(&allowed), Ok(()));
        let more = allowed.replace("no documentation", "no description, license, documentation");
        assert!(judge(&more).expect_err("a warning").contains("no description"));
        assert!(judge(&format!("{packing}warning: readme is missing\n")).is_err());
        assert!(judge(&packing.replace("umbrage-scene", "other")).expect_err("one lacks").contains("scene"));
    }
}
