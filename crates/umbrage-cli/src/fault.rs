//! How the command ends when it does not succeed, and how it speaks.

use std::io::Write;
use umbrage_render::RenderError;
use umbrage_render::umbrage::core::technique::SettingError;

/// Why the command ended early. The text is one line.
#[derive(Debug)]
pub enum Fault {
    /// The command line cannot be meant: status 2.
    WrongUse(String),
    /// The command line is fine, the work was not possible: status 1.
    Failed(String),
    /// The reader of standard output has gone: status 0.
    NobodyReads,
    /// Ctrl-C: status 130, as shells have it.
    Stopped,
}

impl Fault {
    /// What a failed write to standard output means.
    pub fn from_stdout(error: std::io::Error) -> Self {
        if error.kind() == std::io::ErrorKind::BrokenPipe {
            Self::NobodyReads
        } else {
            Self::Failed(format!("cannot write to standard output: {error}"))
        }
    }
}

impl From<SettingError> for Fault {
    fn from(error: SettingError) -> Self {
        Self::WrongUse(error.to_string())
    }
}

impl From<umbrage_scene::SceneError> for Fault {
    fn from(error: umbrage_scene::SceneError) -> Self {
        match error {
            // No such built-in scene or parameter: a name that was typed, not a file.
            umbrage_scene::SceneError::Builtin(message) => Self::WrongUse(message),
            // Likewise an animation that is not in the file.
            error @ umbrage_scene::SceneError::Pose { .. } => Self::WrongUse(error.to_string()),
            other => Self::Failed(other.to_string()),
        }
    }
}

impl From<RenderError> for Fault {
    fn from(error: RenderError) -> Self {
        match error {
            RenderError::View(message) => Self::WrongUse(message),
            other => Self::Failed(other.to_string()),
        }
    }
}

impl From<umbrage_truth::TruthError> for Fault {
    fn from(error: umbrage_truth::TruthError) -> Self {
        umbrage_measure::MeasureError::from(error).into()
    }
}

impl From<umbrage_measure::MeasureError> for Fault {
    fn from(error: umbrage_measure::MeasureError) -> Self {
        match error {
            umbrage_measure::MeasureError::Stopped => Self::Stopped,
            umbrage_measure::MeasureError::Render(error) => error.into(),
            other => Self::Failed(other.to_string()),
        }
    }
}

/// Text without line breaks and control characters, words one space apart.
pub fn one_line(text: &str) -> String {
    let clean: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    clean.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// One line on standard error. A closed standard error is nobody's failure.
pub fn tell(prefix: &str, message: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{prefix}: {}", one_line(message));
}

/// Text on standard output, with a line break at its end.
///
/// # Errors
/// [`Fault::NobodyReads`] on a broken pipe, [`Fault::Failed`] on a full disk and the like.
pub fn say(text: &str) -> Result<(), Fault> {
    let mut out = std::io::stdout().lock();
    let end = if text.ends_with('\n') { "" } else { "\n" };
    out.write_all(text.as_bytes())
        .and_then(|()| out.write_all(end.as_bytes()))
        .and_then(|()| out.flush())
        .map_err(Fault::from_stdout)
}

/// `; did you mean ...?` when a known name is near enough, otherwise nothing.
pub fn suggest<'a>(asked: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    // The comparison's cost grows with the square of the word's length.
    let asked: String = asked.chars().take(40).flat_map(char::to_lowercase).collect();
    known
        .into_iter()
        .map(|name| (strsim::jaro_winkler(&asked, &name.to_lowercase()), name))
        .filter(|(likeness, _)| *likeness > 0.7)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, name)| format!("; did you mean `{name}`?"))
        .unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_are_one_line() {
        assert_eq!(one_line("a\n  b\r\n\tc\u{1b}[0m "), "a b c [0m");
    }

    #[test]
    fn only_near_names_are_suggested() {
        assert_eq!(suggest("Postion", ["position", "target"]), "; did you mean `position`?");
        assert_eq!(suggest("zzz", ["position", "target"]), "");
        assert_eq!(suggest(&"p".repeat(1 << 20), ["position"]), "");
    }
}
