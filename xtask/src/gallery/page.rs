//! The page, as Markdown.

use super::found::Found;
use super::{Picture, Row, rows};
use std::fmt::Write;

const HEAD: &str = "# Gallery

Every picture here was drawn by the command beneath it; `cargo xtask gallery` draws them all anew, measures, and
writes this page. The ids are those of the capabilities that Umbrage is built by: H hardware shadow maps, I the same
on mainstream hardware, F effects, B beyond them.

Tables are measured against rays on pictures of 320x180 pixels, as the [guide](guide.md) explains: acne and leak are
shares of the receivers that are surely lit or surely in shadow, gap is how late a shadow begins at a contact, cost
is what shadows add to a frame.
";

/// The page with those pictures that `is_there`.
pub fn page(found: &Found, is_there: impl Fn(&Picture) -> bool) -> String {
    let mut page = HEAD.to_owned();
    if !found.adapter.is_empty() {
        // Writing to a string cannot fail.
        let _ = writeln!(
            page,
            "Costs are of the adapter `{}` and a debug build: compare them with one another only.",
            found.adapter
        );
    }
    for row in rows::all() {
        let pictures: Vec<&Picture> = row.pictures.iter().filter(|picture| is_there(picture)).collect();
        if !pictures.is_empty() || row.pictures.is_empty() {
            section(&mut page, row, &pictures, found);
        }
    }
    page
}

/// A heading, words, pictures side by side, measures, and all commands.
fn section(page: &mut String, row: &Row, pictures: &[&Picture], found: &Found) {
    let _ = writeln!(page, "\n## {} {}\n\n{}", row.id, row.title, row.text);
    if let [one] = pictures {
        let _ = writeln!(page, "\n{}\n\n{}", shown(one), one.caption);
    } else {
        let columns = if pictures.len().is_multiple_of(3) { 3 } else { 2 };
        for line in pictures.chunks(columns) {
            let cells = |of: &dyn Fn(&Picture) -> String| {
                let cells: Vec<_> = line.iter().map(|picture| of(picture)).collect();
                format!("| {} |", cells.join(" | "))
            };
            let _ = writeln!(page, "\n{}", cells(&shown));
            let _ = writeln!(page, "|{}", "---|".repeat(line.len()));
            let _ = writeln!(page, "{}", cells(&|picture| picture.caption.to_owned()));
        }
    }
    table(page, row, found);
    let drawn = pictures.iter().map(|picture| picture.words().join(" "));
    let measured = row.measures.iter().map(|measure| measure.words().join(" "));
    let commands: Vec<_> = drawn.chain(measured).map(|words| format!("umbrage {words}")).collect();
    if !commands.is_empty() {
        let _ = writeln!(page, "\n```sh\n{}\n```", commands.join("\n"));
    }
    for picture in pictures {
        let quotes = found.quotes_of(picture);
        if !quotes.is_empty() {
            let _ = writeln!(page, "\n{} says:\n\n```text\n{}\n```", picture.file, quotes.join("\n"));
        }
    }
    for listing in row.listings {
        if let Some(said) = found.listing_of(listing) {
            let _ = writeln!(page, "\n```text\n$ umbrage {}\n{said}\n```", listing.arguments);
        }
    }
}

fn table(page: &mut String, row: &Row, found: &Found) {
    let lines: Vec<_> = row.measures.iter().filter_map(|measure| found.line_of(measure)).collect();
    if !lines.is_empty() {
        let _ = writeln!(page, "\n| | acne % | leak % | gap mm | rmse | cost ms | memory MiB |");
        let _ = writeln!(page, "|---|--:|--:|--:|--:|--:|--:|");
        let _ = writeln!(page, "{}", lines.join("\n"));
    }
}

fn shown(picture: &Picture) -> String {
    format!("![{}](gallery/{}.png)", picture.caption, picture.file)
}
