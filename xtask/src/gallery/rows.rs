//! What the gallery shows.

mod beyond;
mod effects;
mod hardware;
mod mainstream;
mod masks;
mod volumes;

use super::{Measure, Picture, Row};

/// All rows, in the order of the page.
pub fn all() -> impl Iterator<Item = &'static Row> {
    let rows = [hardware::ROWS, mainstream::ROWS, effects::ROWS, volumes::ROWS, masks::ROWS, beyond::ROWS];
    rows.into_iter().flatten()
}

const fn picture(file: &'static str, caption: &'static str, arguments: &'static str) -> Picture {
    Picture { file, caption, command: "render", arguments, quoted: &[] }
}

const fn traced(file: &'static str, caption: &'static str, arguments: &'static str) -> Picture {
    Picture { file, caption, command: "truth", arguments, quoted: &[] }
}

const fn measure(label: &'static str, arguments: &'static str) -> Measure {
    Measure { label, arguments }
}

impl Picture {
    /// The page quotes these keys of the JSON that the command prints.
    const fn quoting(self, quoted: &'static [&'static str]) -> Self {
        Self { quoted, ..self }
    }
}
