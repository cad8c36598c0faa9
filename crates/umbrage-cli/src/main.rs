//! The `umbrage` command. Exit status: 0 done, 1 failed, 2 wrong use, 130 stopped by Ctrl-C.

mod again;
mod args;
mod bench;
mod cases;
mod compare;
mod doctor;
mod fault;
mod generate;
mod json;
mod passes;
mod progress;
mod render;
mod roles;
mod setup;
mod specs;
mod split_edges;
mod techniques;
mod text;
mod threaded;
mod truth;
mod wgsl;

use args::{Cli, Command};
use clap::Parser;
use fault::{Fault, one_line};
use std::process::ExitCode;

/// Mesa's device-select layer asks Wayland which adapter the desktop uses, and libwayland writes to standard error when
/// there is no desktop session. Umbrage sorts adapters itself, so the layer is switched off there.
#[cfg(target_os = "linux")]
fn silence_device_select() {
    if std::env::var_os("XDG_RUNTIME_DIR").is_none() {
        // SAFETY: the first thing that the process does; no other thread exists that could read the environment.
        #[allow(unsafe_code)]
        unsafe {
            std::env::set_var("NODEVICE_SELECT", "1");
        }
    }
}

/// Software rasterisers take and give back tens of megabytes in each frame; glibc would return them to the system and
/// fault every page in again. On two cores that was a fifth of a frame's time.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
fn keep_heap() {
    // SAFETY: only changes when glibc's own allocator returns memory; the values are in the range that it documents.
    #[allow(unsafe_code)]
    unsafe {
        libc::mallopt(libc::M_MMAP_THRESHOLD, 32 << 20);
        libc::mallopt(libc::M_TRIM_THRESHOLD, 1 << 30);
        libc::mallopt(libc::M_TOP_PAD, 64 << 20);
    }
}

fn main() -> ExitCode {
    #[cfg(target_os = "linux")]
    silence_device_select();
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    keep_heap();
    let done = match Cli::try_parse() {
        Ok(cli) => run(cli.command),
        Err(error) => wrong_use(&error),
    };
    match done {
        // Nobody reads on: `umbrage techniques | head -1` is no failure.
        Ok(()) | Err(Fault::NobodyReads) => ExitCode::SUCCESS,
        Err(Fault::Failed(message)) => {
            fault::tell("umbrage", &message);
            ExitCode::from(1)
        }
        Err(Fault::Stopped) => {
            fault::tell("umbrage", "stopped before it was done; nothing was written");
            ExitCode::from(130)
        }
        Err(Fault::WrongUse(message)) => {
            fault::tell("umbrage", &message);
            ExitCode::from(2)
        }
    }
}

fn run(command: Command) -> Result<(), Fault> {
    match command {
        Command::Render(args) => render::run(&args),
        Command::Truth(args) => truth::run(&args),
        Command::Compare(args) => compare::run(&args),
        Command::Bench(args) => bench::run(&args),
        Command::Techniques(args) => techniques::run(&args),
        Command::Passes(args) => passes::run(&args),
        Command::Wgsl(args) => wgsl::run(&args),
        Command::SplitEdges(args) => split_edges::run(&args),
        Command::Doctor(args) => doctor::run(&args),
        Command::Completions { shell } => generate::completions(shell),
        Command::Man { command } => generate::man(command.as_deref()),
    }
}

/// Help and version are what was asked for; all else becomes one line.
fn wrong_use(error: &clap::Error) -> Result<(), Fault> {
    use clap::error::ErrorKind;
    match error.kind() {
        ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => {
            // On a terminal with its colours, elsewhere without.
            error.print().map_err(Fault::from_stdout)
        }
        ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand | ErrorKind::MissingSubcommand => {
            Err(Fault::WrongUse(
                "name a command, for example `umbrage render`; `umbrage --help` lists them".into(),
            ))
        }
        _ => {
            let text = error.render().to_string();
            let useful: Vec<String> = text
                .lines()
                .map(one_line)
                .filter(|line| !line.is_empty())
                .take_while(|line| !line.starts_with("Usage:") && !line.starts_with("For more information"))
                .collect();
            let message = useful.join("; ").replace(":; ", ": ");
            Err(Fault::WrongUse(message.trim_start_matches("error: ").to_owned()))
        }
    }
}
