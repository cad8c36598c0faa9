//! Running other programs, and what can go wrong.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::Mutex;

/// How a command ends.
pub type Done = Result<(), Fault>;

/// Why a command ended early. One line each.
#[derive(Debug)]
pub enum Fault {
    /// Exit status 1.
    Failed(String),
    /// Exit status 2.
    WrongUse(String),
}

/// [`Fault::Failed`] with these words.
pub fn failed(message: impl Into<String>) -> Fault {
    Fault::Failed(message.into())
}

/// What was left out so far.
static SKIPPED: Mutex<Vec<String>> = Mutex::new(Vec::new());

/// Says loudly that something is left out, now and at the end.
pub fn skip(what: impl Into<String>) {
    let what = what.into();
    eprintln!("SKIPPED: {what}");
    SKIPPED.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).push(what);
}

/// All that was left out.
pub fn skipped() -> Vec<String> {
    SKIPPED.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).clone()
}

/// The top folder of the checkout.
pub fn root() -> PathBuf {
    // Cargo says where the package lies now; what was compiled in may be older than a move of the checkout.
    let package = std::env::var_os("CARGO_MANIFEST_DIR").unwrap_or_else(|| env!("CARGO_MANIFEST_DIR").into());
    Path::new(&package).parent().map_or_else(|| PathBuf::from("."), Path::to_path_buf)
}

/// The cargo that runs us, in the top folder.
pub fn cargo<S: AsRef<OsStr>>(arguments: impl IntoIterator<Item = S>) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.args(arguments).current_dir(root());
    command
}

/// The folder of finished programs of a profile, `debug` or `release`.
///
/// We lie in one ourselves, so this holds wherever the user keeps the target folder.
pub fn programs(profile: &str) -> PathBuf {
    let own = std::env::current_exe().ok();
    let target = own.as_deref().and_then(Path::parent).and_then(Path::parent);
    target.map_or_else(|| root().join("target"), Path::to_path_buf).join(profile)
}

/// The command `umbrage` of a profile, in the top folder.
pub fn umbrage<S: AsRef<OsStr>>(profile: &str, arguments: impl IntoIterator<Item = S>) -> Command {
    let name = format!("umbrage{}", std::env::consts::EXE_SUFFIX);
    let mut command = Command::new(programs(profile).join(name));
    command.args(arguments).current_dir(root());
    command
}

/// Builds the command `umbrage`.
pub fn build_umbrage(profile: &str) -> Done {
    let mut arguments = vec!["build", "-p", "umbrage-cli"];
    if profile == "release" {
        arguments.push("--release");
    }
    run(&mut cargo(arguments))
}

/// A command as somebody would type it.
pub fn typed(command: &Command) -> String {
    let word = |text: &OsStr| {
        let text = text.to_string_lossy();
        if text.contains([' ', '"', '\'', '&', '?', '*']) { format!("\"{text}\"") } else { text.into_owned() }
    };
    let program = Path::new(command.get_program());
    let name = program.file_stem().unwrap_or(command.get_program());
    let words: Vec<_> = std::iter::once(name).chain(command.get_args()).map(word).collect();
    words.join(" ")
}

/// Says what runs, runs it with our own input and output, and fails when it does.
pub fn run(command: &mut Command) -> Done {
    eprintln!("$ {}", typed(command));
    let status = command.status().map_err(|e| failed(format!("`{}` does not start: {e}", typed(command))))?;
    if status.success() { Ok(()) } else { Err(failed(format!("`{}` failed ({status})", typed(command)))) }
}

/// Runs quietly and keeps what it says.
pub fn output(command: &mut Command) -> Result<Output, Fault> {
    command.output().map_err(|e| failed(format!("`{}` does not start: {e}", typed(command))))
}

/// Runs quietly; what it printed on standard output, or its last words when it fails.
pub fn stdout(command: &mut Command) -> Result<String, Fault> {
    let output = output(command)?;
    if !output.status.success() {
        return Err(failed(format!("`{}` failed: {}", typed(command), last_words(&output))));
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// The last line that a program wrote, in which most programs say what went wrong.
pub fn last_words(output: &Output) -> String {
    let said = if output.stderr.is_empty() { &output.stdout } else { &output.stderr };
    let said = String::from_utf8_lossy(said);
    said.lines().rev().find(|line| !line.trim().is_empty()).unwrap_or("it said nothing").trim().to_owned()
}

/// Is there a program of that name? `name` may be a path.
pub fn is_installed(name: &str) -> bool {
    if Path::new(name).components().count() > 1 {
        return Path::new(name).is_file();
    }
    let file = format!("{name}{}", std::env::consts::EXE_SUFFIX);
    std::env::var_os("PATH").is_some_and(|path| std::env::split_paths(&path).any(|p| p.join(&file).is_file()))
}

/// Makes a folder and all above it.
pub fn make_folder(path: &Path) -> Done {
    std::fs::create_dir_all(path).map_err(|e| failed(format!("{} cannot be made: {e}", path.display())))
}

/// Writes a file.
pub fn write(path: &Path, contents: impl AsRef<[u8]>) -> Done {
    std::fs::write(path, contents).map_err(|e| failed(format!("{} cannot be written: {e}", path.display())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_read_as_typed() {
        let mut command = Command::new("/a/b/umbrage");
        command.args(["render", "builtin:torus?seed=1", "-o", "a b.png"]);
        assert_eq!(typed(&command), "umbrage render \"builtin:torus?seed=1\" -o \"a b.png\"");
    }

    #[test]
    fn the_root_holds_the_workspace() {
        assert!(root().join("Cargo.lock").is_file());
    }
}
