//! `cargo xtask bless`: writes golden images anew.

use crate::process::{self, Done, Fault, failed};
use crate::setup::{self, Need};

/// The test targets that hold golden images, by name.
const GOLDEN_TARGETS: [&str; 2] = ["*golden*", "examples"];

/// `cargo xtask bless [FILTER]`
pub fn run(arguments: &[String]) -> Done {
    let filter = match arguments {
        [] => None,
        [filter] => Some(filter.as_str()),
        _ => return Err(Fault::WrongUse("`bless` takes one filter, a part of the tests' names".into())),
    };
    setup::before_build(Need::Goldens)?;
    let [golden, examples] = GOLDEN_TARGETS;
    let tests = ["test", "--workspace", "--test", golden, "--test", examples, "--no-fail-fast"];
    // Apart, because a failure to build must not look like what comes next.
    process::run(process::cargo(tests).arg("--no-run"))?;
    eprintln!(
        "\nEach golden test now writes its image and FAILS: so a run that blesses never looks green.\n"
    );
    let mut bless = process::cargo(tests);
    bless.env("UPDATE_GOLDEN", "1").env("UMBRAGE_GOLDEN_REQUIRED", "1");
    if let Some(filter) = filter {
        bless.args(["--", filter]);
    }
    let status = bless.status().map_err(|e| failed(format!("cargo does not start: {e}")))?;
    if status.success() {
        return Err(failed("no golden test ran, so nothing was written; is the filter right?"));
    }
    report()
}

/// Which pictures differ from those in git.
fn report() -> Done {
    let mut git = std::process::Command::new("git");
    git.args(["status", "--short", "--untracked-files=all", "--", "*.png"]).current_dir(process::root());
    let changed = process::stdout(&mut git)?;
    if changed.is_empty() {
        println!("\nEvery golden image is what it was.");
    } else {
        println!("\nThese pictures changed. Look at each before you commit it:\n{}", changed.trim_end());
    }
    println!("Then `cargo xtask test` must pass.");
    Ok(())
}
