//! The page, as Markdown.

use super::found::Found;
use super::{Picture, Row, rows};
use std::fmt::Write;

const HEAD: &str = "# Gallery

Every picture here was drawn by the command beneath it; `cargo xtask gallery` draws them all anew, measures, and
writes this page. The ids are those of the capabilities that Umbrage is built by: H hardware shadow maps, I the same
on mainstream hardware, F effects and shadow volumes, N projective masks, B beyond them.

Tables are measured against rays on pictures of 320x180 pixels, as the [guide](guide.md) explains: acne and leak are
shares of the receivers that are surely lit or surely in shadow, gap is how late a shadow begins at a contact, cost
is what shadows add to a frame. A cost of `-` was not measured, because the machine was busy.
";

/// What stands before and after the adapter's name.
const ADAPTER: [&str; 2] =
    ["Costs are of the adapter `", "` and a debug build: compare them with one another only.\n"];

/// The page with those pictures that `is_there`; rows that are not new are as they were `before`.
pub fn page(
    found: &Found,
    before: &str,
    is_new: impl Fn(&Row) -> bool,
    is_there: impl Fn(&Picture) -> bool,
) -> String {
    let mut page = HEAD.to_owned();
    let adapter_before = || Some(before.split_once(ADAPTER[0])?.1.split_once(ADAPTER[1])?.0);
    let adapter = if found.adapter.is_empty() { adapter_before() } else { Some(found.adapter.as_str()) };
    if let Some(adapter) = adapter {
        page = page + ADAPTER[0] + adapter + ADAPTER[1];
    }
    for row in rows::all() {
        let pictures: Vec<&Picture> = row.pictures.iter().filter(|picture| is_there(picture)).collect();
        if !is_new(row) {
            page.push_str(&section_before(before, row));
        } else if !pictures.is_empty() || row.pictures.is_empty() {
            section(&mut page, row, &pictures, found);
        }
    }
    page
}

/// A row's part of the page that is there; nothing where it has none.
fn section_before(page: &str, row: &Row) -> String {
    let heading = format!("\n## {} {}\n", row.id, row.title);
    let Some(from) = page.find(&heading) else { return String::new() };
    let length = page[from + heading.len()..].find("\n## ").map(|at| at + heading.len());
    page[from..][..length.unwrap_or(page.len() - from)].to_owned()
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
    for difference in row.pairs.iter().filter_map(|pair| found.difference_of(*pair)) {
        let _ = writeln!(page, "\n{difference}");
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
