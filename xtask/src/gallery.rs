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
    /// What commands say that draw nothing.
    listings: &'static [Listing],
}

impl Row {
    /// A row of which only the words are known.
    const BARE: Self = Self { id: "", title: "", text: "", pictures: &[], measures: &[], listings: &[] };
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
    /// What of the command's JSON the page quotes; the arguments then hold `--json`.
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

    /// The scene's file, when it is none of ours.
    fn scene_file(&self) -> Option<&'static str> {
        self.arguments.split_whitespace().find(|word| word.starts_with("../"))
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

/// A command that draws nothing, whose words the page quotes.
struct Listing {
    arguments: &'static str,
    /// The paragraph that begins with this line; empty for all.
    paragraph: &'static str,
}

/// `cargo xtask gallery [NAME]`: all of it, or only the pictures whose names begin with `NAME`.
pub fn run(arguments: &[String]) -> Done {
    let name = match arguments {
        [] => "",
        [name] if rows::all().flat_map(|row| row.pictures).any(|picture| picture.file.starts_with(name)) => {
            name
        }
        [name] => return Err(Fault::WrongUse(format!("no picture's name begins with `{name}`"))),
        _ => return Err(Fault::WrongUse("gallery takes one name at most".into())),
    };
    setup::before_build(Need::Draw)?;
    process::build_umbrage("debug")?;
    setup::after_build()?;
    let root = process::root();
    process::make_folder(&root.join(FOLDER))?;
    slide::write(&root.join(FOLDER).join("slide.png"))?;
    let mut found = Found::default();
    let mut skipped = Vec::new();
    for picture in rows::all().flat_map(|row| row.pictures).filter(|picture| picture.file.starts_with(name)) {
        match lacking(&root, picture) {
            Some(scene) => skipped.push((picture, scene)),
            None => draw(&root, picture, &mut found)?,
        }
    }
    if name.is_empty() {
        // The picture at the head of README.md.
        let head = ["render", "--size", "960x540", "--msaa", "4", "--quiet", "-o", "docs/umbrage.png"];
        process::run(&mut process::umbrage("debug", head))?;
        pack(&root.join("docs/umbrage.png"))?;
        for row in rows::all() {
            row.measures.iter().try_for_each(|measure| found.measure(measure))?;
            row.listings.iter().try_for_each(|listing| found.list(listing))?;
        }
        let page = page::page(&found, |picture| root.join(picture.path()).is_file());
        process::write(&root.join("docs/gallery.md"), page)?;
        println!("The gallery is drawn: docs/gallery.md. Look at what changed before you commit it.");
    } else {
        println!("Only pictures {name}* are drawn; docs/gallery.md stays as it was.");
    }
    warn_of(&skipped);
    Ok(())
}

/// The file of a picture's scene when it is not there.
fn lacking(root: &Path, picture: &Picture) -> Option<&'static str> {
    picture.scene_file().filter(|scene| !root.join(scene).is_file())
}

/// Says loudly what could not be drawn.
fn warn_of(skipped: &[(&Picture, &str)]) {
    if skipped.is_empty() {
        return;
    }
    eprintln!("\nSKIPPED: {} pictures stay as they were, because their scenes are not there:", skipped.len());
    for (picture, scene) in skipped {
        eprintln!("SKIPPED: {} needs {scene}", picture.file);
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

fn pack(path: &Path) -> Done {
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
        let all = page::page(&found, |_| true);
        for row in rows::all() {
            assert!(all.contains(row.title), "{}", row.title);
            assert!(
                row.pictures.iter().all(|p| all.contains(&format!("gallery/{}.png", p.file))),
                "{}",
                row.id
            );
        }
        assert!(!page::page(&found, |_| false).contains(".png)"));
    }

    #[test]
    fn what_the_page_quotes_or_measures_needs_no_file() {
        for row in rows::all() {
            for picture in row.pictures {
                assert_eq!(
                    !picture.quoted.is_empty(),
                    picture.arguments.contains("--json"),
                    "{}",
                    picture.file
                );
                assert!(picture.quoted.is_empty() || picture.scene_file().is_none(), "{}", picture.file);
            }
            for measure in row.measures {
                assert!(!measure.arguments.contains("../"), "{}: {}", row.id, measure.label);
                assert_eq!(measure.arguments.matches("--techniques ").count(), 1, "{}", measure.arguments);
            }
        }
    }

    #[test]
    fn only_pictures_of_files_lack_them() {
        let nowhere = Path::new("/nowhere/at/all");
        for picture in rows::all().flat_map(|row| row.pictures) {
            assert_eq!(
                lacking(nowhere, picture).is_some(),
                picture.arguments.contains("../"),
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
            "F4", "F5", "F6", "B4", "B5", "B6",
        ] {
            assert!(ids.contains(id), "{id}");
        }
    }
}
