//! The page, as Markdown.

use super::rows::ROWS;
use super::{Picture, Row};
use std::fmt::Write;

const HEAD: &str = "# Gallery

Every picture here was drawn by the command beneath it; `cargo xtask gallery` draws them all anew and writes this page.
The ids are those of the capabilities that Umbrage is built by: H hardware shadow maps, F effects, B beyond them.
";

/// The page with those pictures that `is_there`.
pub fn page(is_there: impl Fn(&Picture) -> bool) -> String {
    let mut page = HEAD.to_owned();
    for row in ROWS {
        let pictures: Vec<&Picture> = row.pictures.iter().filter(|picture| is_there(picture)).collect();
        if !pictures.is_empty() {
            section(&mut page, row, &pictures);
        }
    }
    page
}

/// A heading, words, and pictures side by side.
fn section(page: &mut String, row: &Row, pictures: &[&Picture]) {
    // Writing to a string cannot fail.
    let _ = writeln!(page, "\n## {} {}\n\n{}\n", row.id, row.title, row.text);
    if let [one] = pictures {
        let _ = writeln!(page, "{}\n\n{}", shown(one), one.caption);
    } else {
        let columns = if pictures.len().is_multiple_of(3) { 3 } else { 2 };
        for (i, line) in pictures.chunks(columns).enumerate() {
            let cells = |of: &dyn Fn(&Picture) -> String| {
                let cells: Vec<_> = line.iter().map(|picture| of(picture)).collect();
                format!("| {} |", cells.join(" | "))
            };
            let _ = writeln!(page, "{}{}", if i > 0 { "\n" } else { "" }, cells(&shown));
            let _ = writeln!(page, "|{}", "---|".repeat(line.len()));
            let _ = writeln!(page, "{}", cells(&|picture| picture.caption.to_owned()));
        }
    }
    let commands: Vec<_> = pictures.iter().map(|p| format!("umbrage {}", p.words().join(" "))).collect();
    let _ = writeln!(page, "\n```sh\n{}\n```", commands.join("\n"));
}

fn shown(picture: &Picture) -> String {
    format!("![{}](gallery/{}.png)", picture.caption, picture.file)
}
