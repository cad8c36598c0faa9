//! `umbrage completions` and `umbrage man`: made from the definitions that the parser uses.

use crate::args::Cli;
use crate::fault::{Fault, say, suggest};
use clap::CommandFactory;

/// Prints the completions of a shell.
///
/// # Errors
/// When standard output cannot be written.
pub fn completions(shell: clap_complete::Shell) -> Result<(), Fault> {
    let mut text = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), "umbrage", &mut text);
    say(&String::from_utf8_lossy(&text))
}

/// Prints the man page of the command, or of one of its commands.
///
/// # Errors
/// [`Fault::WrongUse`] for a command that there is not.
pub fn man(name: Option<&str>) -> Result<(), Fault> {
    let mut command = Cli::command();
    command.build();
    if let Some(name) = name {
        let names: Vec<String> = command.get_subcommands().map(|c| c.get_name().to_owned()).collect();
        let near = suggest(name, names.iter().map(String::as_str));
        command = command.find_subcommand(name).cloned().ok_or_else(|| {
            Fault::WrongUse(format!("there is no command `{name}`{near}; there are {}", names.join(", ")))
        })?;
    }
    let mut text = Vec::new();
    clap_mangen::Man::new(command).render(&mut text).map_err(|e| Fault::Failed(e.to_string()))?;
    say(&String::from_utf8_lossy(&text))
}
