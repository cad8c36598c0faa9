//! `cargo xtask gallery`: draws the pictures of `docs/gallery/` and writes the page that shows them.

mod page;
mod rows;

use crate::process::{self, Done, failed};
use crate::setup::{self, Need};
use crate::{picture, slide};
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

/// `cargo xtask gallery`
pub fn run(_: &[String]) -> Done {
    setup::before_build(Need::Draw)?;
    process::build_umbrage("debug")?;
    setup::after_build()?;
    let root = process::root();
    process::make_folder(&root.join(FOLDER))?;
    slide::write(&root.join(FOLDER).join("slide.png"))?;
    for picture in rows::ROWS.iter().flat_map(|row| row.pictures) {
        draw(&root, picture)?;
    }
    // The picture at the head of README.md.
    let head = ["render", "--size", "960x540", "--msaa", "4", "--quiet", "-o", "docs/umbrage.png"];
    process::run(&mut process::umbrage("debug", head))?;
    pack(&root.join("docs/umbrage.png"))?;
    let page = page::page(|picture| root.join(picture.path()).is_file());
    process::write(&root.join("docs/gallery.md"), page)?;
    println!("The gallery is drawn: docs/gallery.md. Look at what changed before you commit it.");
    Ok(())
}

fn draw(root: &Path, picture: &Picture) -> Done {
    if let Some(scene) = picture.scene_file()
        && !root.join(scene).is_file()
    {
        eprintln!("SKIPPED: {}, because {scene} is not there; the picture stays as it was", picture.file);
        return Ok(());
    }
    process::run(process::umbrage("debug", picture.words()).arg("--quiet"))?;
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
        let pictures: Vec<_> = rows::ROWS.iter().flat_map(|row| row.pictures).collect();
        let names: HashSet<_> = pictures.iter().map(|picture| picture.file).collect();
        assert_eq!(names.len(), pictures.len());
        for picture in pictures {
            assert!(!picture.arguments.contains(['"', '\'']), "{}: no shell quotes", picture.file);
        }
    }

    #[test]
    fn the_page_shows_what_is_there_and_only_that() {
        let all = page::page(|_| true);
        for row in rows::ROWS {
            assert!(all.contains(row.title), "{}", row.title);
            assert!(
                row.pictures.iter().all(|p| all.contains(&format!("gallery/{}.png", p.file))),
                "{}",
                row.id
            );
        }
        assert!(!page::page(|_| false).contains(".png)"));
    }
}
