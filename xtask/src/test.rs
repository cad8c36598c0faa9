//! `cargo xtask test`: everything that must hold before a change goes in.

use crate::process::{self, Done, Fault, failed};
use crate::setup::{self, Need};
use crate::{checks, links, oldest, packages, pages};
use std::time::{Duration, Instant};

/// One step, cheap ones first.
struct Step {
    name: &'static str,
    run: fn() -> Done,
    /// What to do when it fails.
    advice: &'static str,
}

/// Golden images exist for lavapipe alone, and lavapipe is at home on Linux. A browser is easily had there, too.
const HAS_GOLDENS: bool = cfg!(target_os = "linux");

const STEPS: &[Step] = &[
    Step {
        name: "set up",
        run: || setup::before_build(if HAS_GOLDENS { Need::Tests } else { Need::Draw }),
        advice: "install what is named above",
    },
    Step {
        name: "format",
        run: || process::run(&mut process::cargo(["fmt", "--all", "--check"])),
        advice: "type `cargo fmt --all` (`rustup component add rustfmt` if there is none)",
    },
    Step { name: "papers", run: links::check, advice: "mend the link, or make the file that it names" },
    Step {
        name: "one version of each",
        run: checks::one_version_each,
        advice: "`cargo tree --duplicates` says who asks for the other version",
    },
    Step {
        name: "core without a GPU API",
        run: checks::core_without_gpu,
        advice: "what needs a GPU belongs into the crate `umbrage` or above it",
    },
    Step {
        name: "packages",
        run: packages::check,
        advice: "mend what is named above in crates/*/Cargo.toml",
    },
    Step {
        name: "lints",
        run: || {
            process::run(&mut process::cargo([
                "clippy",
                "--workspace",
                "--all-targets",
                "--",
                "-D",
                "warnings",
            ]))
        },
        advice: "mend what clippy names (`rustup component add clippy` if there is none)",
    },
    Step {
        name: "tests",
        run: tests,
        advice: "a golden that changed on purpose: `cargo xtask bless`, then look at the pictures",
    },
    Step {
        name: "guide pages",
        run: pages::check,
        advice: "`cargo xtask pages` makes what follows from the table anew; docs/guide/adding.md says what a page has",
    },
    Step {
        name: "oldest Rust",
        run: oldest::check,
        advice: "write it so that the oldest Rust understands it, or raise rust-version where README and CHANGELOG say it",
    },
    Step {
        name: "documentation",
        run: || {
            let mut doc = process::cargo(["doc", "--workspace", "--no-deps"]);
            process::run(doc.env("RUSTDOCFLAGS", "-D warnings"))
        },
        advice: "mend what rustdoc names",
    },
];

/// `cargo xtask test`
pub fn run(_: &[String]) -> Done {
    let mut times = Vec::new();
    for (i, step) in STEPS.iter().enumerate() {
        eprintln!("\n== {}/{} {}", i + 1, STEPS.len(), step.name);
        let start = Instant::now();
        let done = (step.run)();
        times.push((step.name, start.elapsed()));
        if let Err(fault) = done {
            print_times(&times, "FAILED");
            let (Fault::Failed(message) | Fault::WrongUse(message)) = fault;
            return Err(failed(format!("{}: {message}; {}", step.name, step.advice)));
        }
    }
    print_times(&times, "passed");
    for what in process::skipped() {
        println!("SKIPPED: {what}");
    }
    if HAS_GOLDENS {
        println!("All {} steps passed.", STEPS.len());
    } else {
        println!("All {} steps passed, but golden images were NOT compared: that needs Linux.", STEPS.len());
    }
    Ok(())
}

fn tests() -> Done {
    let mut test = process::cargo(["test", "--workspace"]);
    if HAS_GOLDENS {
        // A golden test that finds no lavapipe skips, and a page's test that finds no browser; here that is a failure.
        test.env("UMBRAGE_GOLDEN_REQUIRED", "1").env("UMBRAGE_BROWSER_REQUIRED", "1");
        // Property tests draw the same cases every time: what is tested does not depend on the day. `cargo test` alone,
        // without the variable, draws new ones.
        if std::env::var_os("PROPTEST_RNG_SEED").is_none() {
            test.env("PROPTEST_RNG_SEED", "4");
        }
    }
    process::run(&mut test)
}

fn print_times(times: &[(&str, Duration)], last: &str) {
    println!();
    for (i, (name, time)) in times.iter().enumerate() {
        let end = if i + 1 == times.len() { last } else { "passed" };
        println!("{name:<24} {:>7.1} s  {end}", time.as_secs_f64());
    }
}
