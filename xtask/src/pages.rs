//! `cargo xtask pages`: keeps of the pages in `docs/guide/` what follows from the one table true to it.
//!
//! A page is written by hand but for its parts between `<!-- made: KIND -->` and `<!-- /made -->`. Those are made here, from what
//! `umbrage techniques --json` and `umbrage passes` print, from the measured tables of `docs/guide.md`, and from the list of
//! pictures.

mod parts;
mod pictures;

use crate::gallery;
use crate::process::{self, Done, Fault, failed};
use crate::setup::{self, Need};

use parts::Facts;
use pictures::{PICTURES, Picture};
use std::path::Path;

/// The pages' folder, from the top of the checkout.
const FOLDER: &str = "docs/guide";
/// The page that has the links to all others.
const INDEX: &str = "README.md";
/// What every page of a technique has.
const OF_EACH: [&str; 4] = ["facts", "passes", "parameters", "measured"];

/// A page: its file's name and its text.
type Page = (String, String);

/// `cargo xtask pages [--pictures [NAME]]`
pub fn run(arguments: &[String]) -> Done {
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let drawn: Option<&str> = match words[..] {
        [] => None,
        ["--pictures"] => Some(""),
        ["--pictures", name] if PICTURES.iter().any(|p| p.file.starts_with(name)) => Some(name),
        ["--pictures", name] => {
            return Err(Fault::WrongUse(format!("no picture's name begins with `{name}`")));
        }
        _ => return Err(Fault::WrongUse("pages takes --pictures, and the beginning of a name".into())),
    };
    setup::before_build(Need::Draw)?;
    process::build_umbrage("debug")?;
    setup::after_build()?;
    let root = process::root();
    if let Some(name) = drawn {
        process::make_folder(&root.join(FOLDER).join("pictures"))?;
        PICTURES.iter().filter(|picture| picture.file.starts_with(name)).try_for_each(draw)?;
    }
    let facts = Facts::ask()?;
    let before = read(&root)?;
    let mut changed = 0;
    for (name, text) in &before {
        let made = facts.page(name, text).map_err(failed)?;
        if made != *text {
            process::write(&root.join(FOLDER).join(name), made)?;
            println!("{FOLDER}/{name} is written anew");
            changed += 1;
        }
    }
    println!("{changed} of {} pages changed.", before.len());
    judge(&facts, &read(&root)?, &files_of_pictures(&root)?).map_err(failed)
}

/// Are all pages there, and none of them stale?
pub fn check() -> Done {
    // Whoever ran the tests before has built it; then this takes no time.
    process::build_umbrage("debug")?;
    let root = process::root();
    let facts = Facts::ask()?;
    let pages = read(&root)?;
    judge(&facts, &pages, &files_of_pictures(&root)?).map_err(failed)?;
    println!("{} pages of the guide say what the table says; {} pictures", pages.len(), PICTURES.len());
    Ok(())
}

fn judge(facts: &Facts, pages: &[Page], pictures: &[String]) -> Result<(), String> {
    let text_of =
        |name: &str| pages.iter().find(|(own, _)| own == name).map(|(_, text)| text.as_str()).unwrap_or("");
    for id in facts.ids() {
        let name = format!("{id}.md");
        let text = text_of(&name);
        if text.is_empty() {
            return Err(format!("the technique `{id}` has no page {FOLDER}/{name}"));
        }
        if let Some(kind) = OF_EACH.iter().find(|kind| !text.contains(&parts::opening(kind))) {
            return Err(format!("{FOLDER}/{name} has no part `{}`", parts::opening(kind)));
        }
    }
    for (name, text) in pages {
        if facts.page(name, text)? != *text {
            return Err(format!("{FOLDER}/{name} is stale: a part of it is no longer what the table says"));
        }
        if name != INDEX && !text_of(INDEX).contains(&format!("({name})")) {
            return Err(format!("{FOLDER}/{INDEX} has no link to {name}"));
        }
    }
    for picture in PICTURES {
        if !pictures.contains(&format!("{}.png", picture.file)) {
            return Err(format!("{FOLDER}/pictures/{}.png is not there; add --pictures", picture.file));
        }
        let opening = parts::opening(&format!("picture {}", picture.file));
        if !pages.iter().any(|(_, text)| text.contains(&opening)) {
            return Err(format!("no page shows the picture `{}`", picture.file));
        }
    }
    let is_listed = |file: &&String| PICTURES.iter().any(|p| **file == format!("{}.png", p.file));
    match pictures.iter().find(|file| !is_listed(file)) {
        Some(file) => Err(format!("{FOLDER}/pictures/{file} is in no list (xtask/src/pages/pictures.rs)")),
        None => Ok(()),
    }
}

/// All pages, by name.
fn read(root: &Path) -> Result<Vec<Page>, Fault> {
    let mut pages = Vec::new();
    for name in names_in(&root.join(FOLDER))?.into_iter().filter(|name| name.ends_with(".md")) {
        let path = root.join(FOLDER).join(&name);
        let text = std::fs::read_to_string(&path).map_err(|e| failed(format!("{}: {e}", path.display())))?;
        pages.push((name, text));
    }
    Ok(pages)
}

/// The names of all drawn pictures: none where nobody has drawn yet.
fn files_of_pictures(root: &Path) -> Result<Vec<String>, Fault> {
    let folder = root.join(FOLDER).join("pictures");
    if folder.is_dir() { names_in(&folder) } else { Ok(Vec::new()) }
}

fn names_in(folder: &Path) -> Result<Vec<String>, Fault> {
    let why = |e: std::io::Error| failed(format!("{}: {e}", folder.display()));
    let entries = std::fs::read_dir(folder).map_err(why)?;
    let mut names = entries
        .map(|entry| Ok(entry?.file_name().to_string_lossy().into_owned()))
        .collect::<Result<Vec<_>, _>>()
        .map_err(why)?;
    names.sort();
    Ok(names)
}

fn draw(picture: &Picture) -> Done {
    process::run(process::umbrage("debug", picture.words()).arg("--quiet"))?;
    gallery::pack(&process::root().join(picture.path()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pages that lack nothing.
    fn whole(facts: &Facts) -> Vec<Page> {
        let parts = |kinds: &[String]| {
            let parts = kinds.iter().map(|kind| format!("{}\n{}\n", parts::opening(kind), parts::CLOSING));
            parts.collect::<Vec<_>>().join("\n")
        };
        let pictures: Vec<_> = PICTURES.iter().map(|p| format!("picture {}", p.file)).collect();
        let mut pages: Vec<Page> = facts
            .ids()
            .map(|id| (format!("{id}.md"), format!("# {id}\n\n{}", parts(&OF_EACH.map(str::to_owned)))))
            .collect();
        pages.push((INDEX.to_owned(), parts(&["index".into(), "measured-all".into()]) + &parts(&pictures)));
        for (name, text) in &mut pages {
            *text = facts.page(name, text).expect("it can be made");
        }
        pages
    }

    fn files() -> Vec<String> {
        PICTURES.iter().map(|picture| format!("{}.png", picture.file)).collect()
    }

    fn said(pages: &[Page], files: &[String]) -> String {
        judge(&parts::tests::facts(), pages, files).expect_err("something is wrong")
    }

    #[test]
    fn what_is_missing_or_stale_is_seen() {
        let facts = parts::tests::facts();
        let pages = whole(&facts);
        assert_eq!(judge(&facts, &pages, &files()), Ok(()));
        let without = |name: &str| pages.iter().filter(|(own, _)| own != name).cloned().collect::<Vec<_>>();
        assert!(said(&without("pcf.md"), &files()).contains("`pcf` has no page"));
        let edited = |name: &str, from: &str, to: &str| {
            let edit = |(own, text): &Page| {
                let text = if own == name { text.replace(from, to) } else { text.clone() };
                (own.clone(), text)
            };
            pages.iter().map(edit).collect::<Vec<_>>()
        };
        assert!(said(&edited("pcf.md", "1 to 17", "1 to 16"), &files()).contains("pcf.md is stale"));
        assert!(said(&edited("pcf.md", "made: passes", "mode: passes"), &files()).contains("passes"));
        let mut more = pages.clone();
        more.push(("porting.md".into(), "# Porting\n".into()));
        assert!(said(&more, &files()).contains("no link to porting.md"));
    }

    #[test]
    fn a_picture_that_nobody_shows_or_draws_is_seen() {
        let facts = parts::tests::facts();
        let pages = whole(&facts);
        assert!(said(&pages, &files()[1..]).contains("is not there"));
        let mut more = files();
        more.push("stray.png".into());
        assert!(said(&pages, &more).contains("stray.png"));
        let hidden: Vec<_> = pages
            .iter()
            .map(|(name, text)| (name.clone(), text.replace("made: picture hard ", "mode: picture hard ")))
            .collect();
        assert!(said(&hidden, &files()).contains("no page shows"));
    }

    #[test]
    fn wrong_use_is_named() {
        for words in [&["--pictures", "nonsense"][..], &["pcf"], &["--pictures", "hard", "linear"]] {
            let words: Vec<_> = words.iter().map(|word| (*word).to_owned()).collect();
            assert!(matches!(run(&words), Err(Fault::WrongUse(_))), "{words:?}");
        }
    }
}
