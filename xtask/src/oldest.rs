//! Does the oldest Rust that we promise still understand what a user adds?

use crate::packages::CRATES;
use crate::process::{self, Done, Fault, failed};
use std::process::Command;

/// Checks those crates with the `rust-version` of the workspace, in a target folder of its own: two compilers in one would build
/// everything anew each time. Says loudly when there is no such compiler and none can be had.
pub fn check() -> Done {
    let version = version()?;
    if !process::is_installed("rustup") {
        process::skip(format!("Rust {version} was NOT tried, because there is no rustup to have it from"));
        return Ok(());
    }
    if !has(&version) {
        let mut install = Command::new("rustup");
        install.args(["toolchain", "install", &version, "--profile", "minimal", "--no-self-update"]);
        if process::run(&mut install).is_err() || !has(&version) {
            process::skip(format!("Rust {version} was NOT tried, because rustup cannot install it"));
            return Ok(());
        }
    }
    let folder = process::programs("debug").with_file_name("msrv");
    let mut check = Command::new("rustup");
    check.args(["run", &version, "cargo", "check", "--locked", "--target-dir"]).arg(folder);
    // What the cargo above us set for its own compiler.
    for own in ["RUSTC", "RUSTDOC", "RUSTUP_TOOLCHAIN", "CARGO"] {
        check.env_remove(own);
    }
    process::run(check.current_dir(process::root()).args(CRATES.iter().flat_map(|name| ["--package", name])))
}

/// Is that toolchain there?
fn has(version: &str) -> bool {
    // Not `rustup run`, which may install what it lacks.
    let list = process::stdout(Command::new("rustup").args(["toolchain", "list"]));
    list.is_ok_and(|list| lists(&list, version))
}

fn lists(list: &str, version: &str) -> bool {
    list.lines().any(|line| line.strip_prefix(version).is_some_and(|rest| rest.starts_with('-')))
}

/// `rust-version` of the workspace.
fn version() -> Result<String, Fault> {
    let path = process::root().join("Cargo.toml");
    let text = std::fs::read_to_string(&path).map_err(|e| failed(format!("{}: {e}", path.display())))?;
    version_in(&text).ok_or_else(|| failed("Cargo.toml says no rust-version"))
}

fn version_in(manifest: &str) -> Option<String> {
    let line = manifest.lines().find_map(|line| line.strip_prefix("rust-version = \""))?;
    line.strip_suffix('"').map(str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_version_is_that_of_the_workspace() {
        assert_eq!(version_in("[workspace.package]\nrust-version = \"1.88\"\n"), Some("1.88".to_owned()));
        assert_eq!(version_in("edition = \"2024\"\n"), None);
        assert!(version().is_ok_and(|version| version.starts_with("1.")));
    }

    #[test]
    fn a_toolchain_is_known_by_its_whole_number() {
        let list = "stable-x86_64-unknown-linux-gnu (active, default)\n1.88-x86_64-unknown-linux-gnu\n";
        assert!(lists(list, "1.88") && !lists(list, "1.8") && !lists(list, "1.89"));
        assert!(!lists("1.88.0-x86_64-unknown-linux-gnu\n", "1.88"));
    }
}
