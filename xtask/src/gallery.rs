//! `cargo xtask gallery`: draws the pictures of `docs/gallery/`, measures, and writes the page that shows all of it.

mod found;
mod page;
mod rows;

use crate::process::{self, Done, Fault, failed};
use crate::setup::{self, Need};
use crate::{picture, slide};
use found::Found;
use std::path::Path;

/// The pictures' folder, from the top of the checkout.
const FOLDER: &str = "docs/gallery";
/// Where listings write files, from the top of the checkout.
const MADE: &str = "target/gallery/";
/// The page.
const PAGE: &str = "docs/gallery.md";
/// What each picture may weigh: pictures stay in git for ever.
const LIMIT_BYTES: u64 = 150_000;

/// What one row of the gallery shows.
struct Row {
    /// The capability's id, or a name.
    id: &'static str,
    title: &'static str,
    /// What to look at, in a sentence or two.
    text: &'static str,
    pictures: &'static [Picture],
    /// Lines of a table of measures.
    measures: &'static [Measure],
    /// What commands say that draw nothing. They run before the pictures are drawn, which may show what they wrote.
    listings: &'static [Listing],
    /// Files of pictures of which the page says in how many pixels they differ.
    pairs: &'static [[&'static str; 2]],
}

impl Row {
    /// A row of which only the words are known.
    const BARE: Self =
        Self { id: "", title: "", text: "", pictures: &[], measures: &[], listings: &[], pairs: &[] };
}

/// One picture and the command that makes it.
struct Picture {
    /// Below [`FOLDER`], without its ending.
    file: &'static str,
    caption: &'static str,
    /// `render` or `truth`.
    command: &'static str,
    /// What stands between the command and `--size`.
    arguments: &'static str,
    /// What of the command's JSON the page quotes (`a.b` is b of a); the arguments then hold `--json`.
    quoted: &'static [&'static str],
}

impl Picture {
    fn path(&self) -> String {
        format!("{FOLDER}/{}.png", self.file)
    }

    /// As words; no argument of ours holds a space.
    fn words(&self) -> Vec<String> {
        let tail = ["--size", "640x360", "--msaa", "4", "-o"].map(str::to_owned);
        let words = self.arguments.split_whitespace().map(str::to_owned).chain(tail);
        std::iter::once(self.command.to_owned()).chain(words).chain([self.path()]).collect()
    }

    /// The scene's file, when it is none of ours, or one that a listing writes.
    fn scene_file(&self) -> Option<&'static str> {
        self.arguments.split_whitespace().find(|word| word.starts_with("../") || word.starts_with(MADE))
    }
}

/// A technique and how it is set, measured against rays on a small picture.
struct Measure {
    label: &'static str,
    /// What follows `compare`: a scene of our own and one technique.
    arguments: &'static str,
}

impl Measure {
    fn words(&self) -> Vec<&'static str> {
        let tail = ["--size", "320x180", "--frames", "5", "--json"];
        std::iter::once("compare").chain(self.arguments.split_whitespace()).chain(tail).collect()
    }
}

/// A command that draws nothing, whose words the page quotes. A file that it writes lies in [`MADE`].
struct Listing {
    arguments: &'static str,
    /// The paragraph that begins with this line; empty for all.
    paragraph: &'static str,
}

impl Listing {
    /// The file that it reads, when it is none of ours.
    fn file(&self) -> Option<&'static str> {
        self.arguments.split_whitespace().find(|word| word.starts_with("../"))
    }
}

/// What of the gallery is made anew.
#[derive(Debug, PartialEq, Eq)]
enum Wanted {
    All,
    /// Only the pictures whose names begin so.
    Pictures(String),
    /// Only the rows with one of these ids, and their part of the page.
    Rows(Vec<String>),
}

impl Wanted {
    fn of(arguments: &[String]) -> Result<Self, Fault> {
        let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
        match words[..] {
            [] => Ok(Self::All),
            ["--rows", ids] => {
                let ids: Vec<_> = ids.split(',').map(str::to_owned).collect();
                match ids.iter().find(|id| rows::all().all(|row| !row.has(id))) {
                    None => Ok(Self::Rows(ids)),
                    Some(id) => Err(Fault::WrongUse(format!("no row has the id `{id}`"))),
                }
            }
            [name] if rows::all().flat_map(|row| row.pictures).any(|p| p.file.starts_with(name)) => {
                Ok(Self::Pictures(name.to_owned()))
            }
            [name] => Err(Fault::WrongUse(format!("no picture's name begins with `{name}`"))),
            _ => Err(Fault::WrongUse("gallery takes one name, or --rows and ids, at most".into())),
        }
    }

    fn row(&self, row: &Row) -> bool {
        match self {
            Self::All => true,
            Self::Pictures(_) => false,
            Self::Rows(ids) => ids.iter().any(|id| row.has(id)),
        }
    }

    fn picture(&self, row: &Row, picture: &Picture) -> bool {
        match self {
            Self::Pictures(name) => picture.file.starts_with(name.as_str()),
            _ => self.row(row),
        }
    }
}

impl Row {
    fn has(&self, id: &str) -> bool {
        self.id.split(", ").any(|own| own == id)
    }
}

/// `cargo xtask gallery [NAME | --rows ID,...] [--no-costs]`: all of it, or only the pictures whose names begin
/// with `NAME`, or only these rows and their part of the page. Costs are left out for a machine that is busy.
pub fn run(arguments: &[String]) -> Done {
    let (flags, rest): (Vec<_>, Vec<_>) = arguments.iter().cloned().partition(|word| word == "--no-costs");
    let wanted = Wanted::of(&rest)?;
    setup::before_build(Need::Draw)?;
    process::build_umbrage("debug")?;
    setup::after_build()?;
    let root = process::root();
    process::make_folder(&root.join(FOLDER))?;
    process::make_folder(&root.join(MADE))?;
    slide::write(&root.join(FOLDER).join("slide.png"))?;
    let mut found = Found::default();
    found.no_costs = !flags.is_empty();
    let mut skipped = Vec::new();
    for row in rows::all() {
        make(&root, row, &wanted, &mut found, &mut skipped)?;
    }
    if wanted == Wanted::All {
        // The picture at the head of README.md.
        let head = ["render", "--size", "960x540", "--msaa", "4", "--quiet", "-o", "docs/umbrage.png"];
        process::run(&mut process::umbrage("debug", head))?;
        pack(&root.join("docs/umbrage.png"))?;
    }
    if let Wanted::Pictures(name) = &wanted {
        println!("Only pictures {name}* are drawn; {PAGE} stays as it was.");
    } else {
        // Without a page all of it is new.
        let before = std::fs::read_to_string(root.join(PAGE)).unwrap_or_default();
        let is_new = |row: &Row| wanted.row(row) && !skipped.iter().any(|skip| skip.silences == Some(row.id));
        let page = page::page(&found, &before, is_new, |picture| root.join(picture.path()).is_file());
        process::write(&root.join(PAGE), page)?;
        println!("The gallery is drawn: {PAGE}. Look at what changed before you commit it.");
    }
    warn_of(&skipped);
    Ok(())
}

/// What could not be made.
struct Skip {
    what: &'static str,
    file: &'static str,
    /// The row that would lose words of the page, and so keeps its part.
    silences: Option<&'static str>,
}

/// Makes what is wanted of a row.
fn make(root: &Path, row: &'static Row, wanted: &Wanted, found: &mut Found, skipped: &mut Vec<Skip>) -> Done {
    // A picture may show what its row's listing writes.
    let writes = |listing: &Listing| listing.arguments.contains(MADE);
    let is_drawn = row.pictures.iter().any(|picture| wanted.picture(row, picture));
    for listing in row.listings.iter().filter(|listing| wanted.row(row) || is_drawn && writes(listing)) {
        match listing.file().filter(|file| !root.join(file).is_file()) {
            Some(file) => skipped.push(Skip { what: listing.arguments, file, silences: Some(row.id) }),
            None => found.list(listing)?,
        }
    }
    for picture in row.pictures.iter().filter(|picture| wanted.picture(row, picture)) {
        match lacking(root, picture) {
            Some(file) => {
                let is_told = !picture.quoted.is_empty() || row.pairs.as_flattened().contains(&picture.file);
                skipped.push(Skip { what: picture.file, file, silences: is_told.then_some(row.id) });
            }
            None => draw(root, picture, found)?,
        }
    }
    if wanted.row(row) {
        row.measures.iter().try_for_each(|measure| found.measure(measure))?;
        let path = |file: &str| root.join(FOLDER).join(format!("{file}.png"));
        for pair in row.pairs.iter().filter(|pair| pair.iter().all(|file| path(file).is_file())) {
            found.compare(*pair, picture::difference(&path(pair[0]), &path(pair[1]))?);
        }
    }
    Ok(())
}

/// The file of a picture's scene when it is not there.
fn lacking(root: &Path, picture: &Picture) -> Option<&'static str> {
    picture.scene_file().filter(|scene| !root.join(scene).is_file())
}

/// Says loudly what could not be drawn.
fn warn_of(skipped: &[Skip]) {
    if skipped.is_empty() {
        return;
    }
    eprintln!("\nSKIPPED: {} things stay as they were, because their files are not there:", skipped.len());
    for Skip { what, file, .. } in skipped {
        eprintln!("SKIPPED: {what} needs {file}");
    }
}

fn draw(root: &Path, picture: &Picture, found: &mut Found) -> Done {
    let mut command = process::umbrage("debug", picture.words());
    if picture.quoted.is_empty() {
        process::run(command.arg("--quiet"))?;
    } else {
        found.quote(picture, &mut command)?;
    }
    pack(&root.join(picture.path()))
}

/// Packs a picture that stays in git, and weighs it.
pub fn pack(path: &Path) -> Done {
    picture::repack(path)?;
    let bytes = std::fs::metadata(path).map_err(|e| failed(format!("{}: {e}", path.display())))?.len();
    if bytes > LIMIT_BYTES {
        let path = path.display();
        return Err(failed(format!(
            "{path} weighs {bytes} bytes, more than {LIMIT_BYTES}; choose a calmer one"
        )));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn every_picture_has_a_name_of_its_own_and_can_be_typed() {
        let pictures: Vec<_> = rows::all().flat_map(|row| row.pictures).collect();
        let names: HashSet<_> = pictures.iter().map(|picture| picture.file).collect();
        assert_eq!(names.len(), pictures.len());
        for picture in pictures {
            assert!(!picture.arguments.contains(['"', '\'']), "{}: no shell quotes", picture.file);
        }
    }

    #[test]
    fn the_page_shows_what_is_there_and_only_that() {
        let found = Found::default();
        let all = page::page(&found, "", |_| true, |_| true);
        for row in rows::all() {
            assert!(all.contains(row.title), "{}", row.title);
            assert!(
                row.pictures.iter().all(|p| all.contains(&format!("gallery/{}.png", p.file))),
                "{}",
                row.id
            );
        }
        assert!(!page::page(&found, "", |_| true, |_| false).contains(".png)"));
    }

    #[test]
    fn rows_that_are_not_made_anew_keep_their_part_of_the_page() {
        let found = Found::default();
        let all = page::page(&found, "", |_| true, |_| true);
        assert!(page::page(&found, &all, |_| false, |_| true) == all);
        let edited =
            all.replace("fades from clear to opaque", "EDITED").replace("of a shining ball", "EDITED");
        let mended = page::page(&found, &edited, |row| row.has("F4"), |_| true);
        assert!(mended == all.replace("of a shining ball", "EDITED"));
        // A row that the page lacks comes in its place.
        let lacking = page::page(&found, "", |row| !row.has("F4"), |_| true);
        assert!(!lacking.contains("## F4 "));
        assert!(page::page(&found, &lacking, |row| row.has("F4"), |_| true) == all);
    }

    #[test]
    fn one_name_or_rows_can_be_asked_for() {
        let of =
            |words: &[&str]| Wanted::of(&words.iter().map(|word| (*word).to_owned()).collect::<Vec<_>>());
        assert_eq!(of(&[]).ok(), Some(Wanted::All));
        assert_eq!(of(&["f4"]).ok(), Some(Wanted::Pictures("f4".into())));
        let rows = of(&["--rows", "F4,H3"]).expect("both are there");
        let of_rows: Vec<_> = rows::all().filter(|row| rows.row(row)).map(|row| row.id).collect();
        assert_eq!(of_rows, ["H3, H4", "F4"]);
        for wrong in [&["zz"][..], &["--rows"], &["--rows", "F4,Z9"], &["f4", "f5"]] {
            assert!(matches!(of(wrong), Err(Fault::WrongUse(_))), "{wrong:?}");
        }
    }

    #[test]
    fn what_is_quoted_is_printed_and_measures_need_no_file() {
        for row in rows::all() {
            for picture in row.pictures {
                assert_eq!(
                    !picture.quoted.is_empty(),
                    picture.arguments.contains("--json"),
                    "{}",
                    picture.file
                );
            }
            for measure in row.measures {
                assert!(!measure.arguments.contains("../"), "{}: {}", row.id, measure.label);
                assert_eq!(measure.arguments.matches("--techniques ").count(), 1, "{}", measure.arguments);
            }
            for file in row.pairs.as_flattened() {
                assert!(row.pictures.iter().any(|picture| picture.file == *file), "{file}");
            }
        }
    }

    #[test]
    fn only_pictures_of_files_lack_them() {
        let nowhere = Path::new("/nowhere/at/all");
        for picture in rows::all().flat_map(|row| row.pictures) {
            assert_eq!(
                lacking(nowhere, picture).is_some(),
                picture.arguments.contains("../") || picture.arguments.contains(MADE),
                "{}",
                picture.file
            );
        }
    }

    #[test]
    fn every_capability_built_so_far_has_a_row() {
        let ids: HashSet<_> = rows::all().flat_map(|row| row.id.split(", ")).collect();
        for id in [
            "H1", "H2", "H3", "H4", "H5", "H6", "H7", "H8", "H9", "H10", "H11", "H12", "H13", "H14", "H15",
            "H16", "I1", "I2", "I3", "I4", "I5", "I6", "I7", "I8", "I9", "I10", "I11", "F1", "F2", "F3",
            "F4", "F5", "F6", "F7", "F8", "F9", "F10", "F11", "N1", "N2", "N3", "N4", "N5", "N6", "N7", "N8",
            "N9", "N10", "N11", "N12", "B4", "B5", "B6",
        ] {
            assert!(ids.contains(id), "{id}");
        }
    }
}
