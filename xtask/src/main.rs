//! `cargo xtask`: sets the machine up, then builds, draws, tests and measures Umbrage.
//!
//! Exit status: 0 done, 1 failed, 2 wrong use.

mod bench;
mod bias;
mod bless;
mod checks;
mod demo;
mod gallery;
mod guide;
mod links;
mod machine;
mod oldest;
mod packages;
mod pages;
mod picture;
mod process;
mod setup;
mod slide;
mod test;

use process::{Done, Fault};
use std::process::ExitCode;

/// One command of `cargo xtask`.
struct Task {
    name: &'static str,
    /// What may follow the name.
    takes: &'static str,
    summary: &'static str,
    run: fn(&[String]) -> Done,
}

const TASKS: &[Task] = &[
    Task {
        name: "demo",
        takes: "",
        summary: "set the machine up, build, draw the built-in scene to target/demo/umbrage.png",
        run: demo::run,
    },
    Task {
        name: "test",
        takes: "",
        summary: "set the machine up, then format, lints, tests with goldens, guide pages, oldest Rust, packages, papers",
        run: test::run,
    },
    Task {
        name: "bless",
        takes: "[FILTER]",
        summary: "write golden images anew (those of tests whose name holds FILTER)",
        run: bless::run,
    },
    Task {
        name: "bench",
        takes: "[--json]",
        summary: "measure whole commands and frames against their bounds (--json: also to target/bench.json)",
        run: bench::run,
    },
    Task {
        name: "gallery",
        takes: "[NAME | --rows ID,...] [--no-costs]",
        summary: "draw the pictures of docs/gallery and write docs/gallery.md (NAME: only those named so; --rows: only \
                  these; --no-costs: the machine is busy)",
        run: gallery::run,
    },
    Task {
        name: "guide",
        takes: "",
        summary: "measure the techniques on the built-in scenes and write docs/guide.md",
        run: guide::run,
    },
    Task {
        name: "bias",
        takes: "",
        summary: "measure the biases, and those of engines, and write docs/bias.md",
        run: bias::run,
    },
    Task {
        name: "pages",
        takes: "[--pictures [NAME]]",
        summary: "write the made parts of docs/guide/ anew (--pictures: draw its pictures, too, or those named so)",
        run: pages::run,
    },
    Task {
        name: "setup",
        takes: "",
        summary: "only set the machine up: what the others do first",
        run: setup::run,
    },
];

fn main() -> ExitCode {
    let arguments: Vec<String> =
        std::env::args_os().skip(1).map(|a| a.to_string_lossy().into_owned()).collect();
    match dispatch(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(Fault::Failed(message)) => {
            eprintln!("xtask: {message}");
            ExitCode::from(1)
        }
        Err(Fault::WrongUse(message)) => {
            eprintln!("xtask: {message}");
            ExitCode::from(2)
        }
    }
}

fn dispatch(arguments: &[String]) -> Done {
    let Some((name, rest)) = arguments.split_first() else {
        list();
        return Ok(());
    };
    if matches!(name.as_str(), "help" | "-h" | "--help") {
        list();
        return Ok(());
    }
    let task = TASKS.iter().find(|task| task.name == name).ok_or_else(|| {
        let names: Vec<_> = TASKS.iter().map(|task| task.name).collect();
        Fault::WrongUse(format!("there is no command `{name}`; there are {}", names.join(", ")))
    })?;
    if rest.iter().any(|a| matches!(a.as_str(), "-h" | "--help")) {
        println!("cargo xtask {} {}\n    {}", task.name, task.takes, task.summary);
        return Ok(());
    }
    if task.takes.is_empty()
        && let Some(extra) = rest.first()
    {
        return Err(Fault::WrongUse(format!("`{name}` takes no arguments, but `{extra}` was given")));
    }
    (task.run)(rest)
}

fn list() {
    println!("cargo xtask COMMAND\n");
    for task in TASKS {
        println!("  {:<17} {}", format!("{} {}", task.name, task.takes), task.summary);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(arguments: &[&str]) -> String {
        let arguments: Vec<String> = arguments.iter().map(|a| (*a).to_owned()).collect();
        match dispatch(&arguments) {
            Err(Fault::WrongUse(message)) => message,
            other => panic!("{arguments:?} must be wrong use, not {other:?}"),
        }
    }

    #[test]
    fn wrong_use_names_what_there_is() {
        assert!(refused(&["dmeo"]).contains("demo, test, bless"));
        assert!(refused(&["demo", "now"]).contains("`now`"));
        assert!(refused(&["bench", "--jsno"]).contains("--json"));
        assert!(refused(&["bless", "a", "b"]).contains("one"));
        assert!(refused(&["gallery", "h99"]).contains("`h99`"));
        assert!(refused(&["pages", "h99"]).contains("--pictures"));
    }
}
