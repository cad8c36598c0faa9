//! Do the links and pictures of our papers lead anywhere?

use crate::process::{self, Done, failed};
use std::path::{Component, Path, PathBuf};

/// Folders that hold no papers of ours.
const NOT_OURS: [&str; 4] = ["target", "shared", "node_modules", "third_party"];

/// Every relative link of every Markdown file leads to something in the checkout, and its anchor to a heading there.
pub fn check() -> Done {
    let root = process::root();
    let mut papers = Vec::new();
    find_papers(&root, &mut papers)
        .map_err(|e| failed(format!("{} cannot be searched: {e}", root.display())))?;
    if !papers.iter().any(|paper| paper.ends_with("README.md")) {
        return Err(failed("there is no README.md"));
    }
    let mut count = 0;
    for paper in &papers {
        let text = std::fs::read_to_string(paper).map_err(|e| failed(format!("{}: {e}", paper.display())))?;
        let folder = paper.parent().unwrap_or(&root);
        for (line, link) in links(&text) {
            count += 1;
            lead(&root, folder, paper, &link).map_err(|why| {
                let paper = paper.strip_prefix(&root).unwrap_or(paper).display();
                failed(format!("{paper}:{line}: `{link}` {why}"))
            })?;
        }
    }
    println!("{count} relative links in {} papers lead somewhere", papers.len());
    Ok(())
}

/// Does a link of a paper lead to a file, and its anchor to a place in it? If not, why.
fn lead(root: &Path, folder: &Path, paper: &Path, link: &str) -> Result<(), String> {
    let (file, anchor) = link.split_once('#').map_or((link, None), |(file, anchor)| (file, Some(anchor)));
    let path = if file.is_empty() { Some(paper.to_path_buf()) } else { resolve(root, folder, file) };
    let path = path.filter(|path| path.exists()).ok_or("leads to nothing in the checkout")?;
    let Some(anchor) = anchor else { return Ok(()) };
    let read = || std::fs::read_to_string(&path).map_err(|e| format!("cannot be followed: {e}"));
    let is_there = match path.extension().and_then(|ending| ending.to_str()) {
        Some("md") => anchors(&read()?).iter().any(|known| known == anchor),
        Some("html") => read()?.contains(&format!("id=\"{anchor}\"")),
        // Lines of source, which only the web's view of it has.
        _ => true,
    };
    if is_there {
        Ok(())
    } else {
        Err(format!("leads to no heading: nothing there has the anchor `{anchor}`"))
    }
}

/// The anchors of a paper's headings, as GitHub makes them: small letters, blanks to hyphens, no other signs, and a number
/// after a name that was there before.
fn anchors(text: &str) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    let mut in_code = false;
    for line in text.lines() {
        if line.trim_start().starts_with("```") {
            in_code = !in_code;
        }
        let title = line.trim_start_matches('#');
        let depth = line.len() - title.len();
        if in_code || !(1..=6).contains(&depth) || !title.starts_with(' ') {
            continue;
        }
        let kept = without_targets(title.trim()).to_lowercase();
        let kept = kept.chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
        let name: String = kept.map(|c| if c == ' ' { '-' } else { c }).collect();
        let again = (1..).map(|i| format!("{name}-{i}"));
        let free = std::iter::once(name.clone()).chain(again).find(|name| !found.contains(name));
        found.extend(free);
    }
    found
}

/// The title without what its links lead to: `[a](b.md)` is a.
fn without_targets(title: &str) -> String {
    let mut parts = title.split("](");
    let first = parts.next().unwrap_or("").to_owned();
    parts.fold(first, |text, part| text + part.split_once(')').map_or("", |(_, rest)| rest))
}

fn find_papers(folder: &Path, papers: &mut Vec<PathBuf>) -> std::io::Result<()> {
    for entry in std::fs::read_dir(folder)? {
        let (path, kind) = entry.and_then(|e| Ok((e.path(), e.file_type()?)))?;
        let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        if kind.is_dir() {
            if !name.starts_with('.') && !NOT_OURS.contains(&name.as_str()) {
                find_papers(&path, papers)?;
            }
        } else if name.ends_with(".md") {
            papers.push(path);
        }
    }
    Ok(())
}

/// Where a link leads; `None` when that is outside of the checkout, where a reader on the web has nothing.
fn resolve(root: &Path, folder: &Path, link: &str) -> Option<PathBuf> {
    let link = link.replace("%20", " ");
    let start = if link.starts_with('/') { root } else { folder };
    let mut path = start.to_path_buf();
    for component in Path::new(link.trim_start_matches('/')).components() {
        match component {
            Component::ParentDir => {
                path.pop();
            }
            Component::Normal(part) => path.push(part),
            _ => {}
        }
    }
    path.starts_with(root).then_some(path)
}

/// Line number and target of every relative link and picture, without code.
fn links(text: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    let mut in_code = false;
    for (i, line) in text.lines().enumerate() {
        if line.trim_start().starts_with("```") {
            in_code = !in_code;
        }
        if in_code {
            continue;
        }
        let line = without_code(line);
        for (start, end) in [("](", ')'), ("src=\"", '"'), ("href=\"", '"')] {
            let targets = line.split(start).skip(1).filter_map(|rest| rest.split(end).next());
            found.extend(targets.filter_map(relative).map(|target| (i + 1, target)));
        }
        // Reference definitions: `[name]: target`.
        if let Some((_, target)) = line.strip_prefix('[').and_then(|rest| rest.split_once("]: ")) {
            found.extend(relative(target).map(|target| (i + 1, target)));
        }
    }
    found
}

/// The file that a target names, with its anchor; nothing for other places of the net.
fn relative(target: &str) -> Option<String> {
    let target = target.split_whitespace().next()?.trim_matches(['<', '>']);
    let elsewhere = target.contains("://") || target.starts_with("mailto:");
    (!elsewhere && !target.is_empty() && target != "#").then(|| target.to_owned())
}

/// The line without what stands between back ticks.
fn without_code(line: &str) -> String {
    line.split('`').step_by(2).collect::<Vec<_>>().join("`")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_are_found_and_code_is_not() {
        let text = "[a](docs/a.md#part) and ![b](b.png \"title\") `[c](c.md)`\n\
                    ```\n[d](d.md)\n```\n<img src=\"e.png\">, [web](https://x.org/f.md), [here](#g)\n[ref]: h.md";
        let found: Vec<_> = links(text);
        let expected = [(1, "docs/a.md#part"), (1, "b.png"), (5, "#g"), (5, "e.png"), (6, "h.md")];
        assert_eq!(found, expected.map(|(line, link)| (line, link.to_owned())));
    }

    #[test]
    fn anchors_are_those_of_github() {
        let text = "# `pcf`: all comparisons\n## I8, B4 Maps that follow\n```sh\n# no heading\n```\n#tag\n\
                    ## Scale and bias, depth\n## Scale and bias, depth\n### [A link](b.md) to z_n + 1.5\n";
        let expected = [
            "pcf-all-comparisons",
            "i8-b4-maps-that-follow",
            "scale-and-bias-depth",
            "scale-and-bias-depth-1",
            "a-link-to-z_n--15",
        ];
        assert_eq!(anchors(text), expected);
    }

    #[test]
    fn a_broken_link_picture_or_anchor_is_seen() {
        let root = std::env::temp_dir().join(format!("xtask-links-{}", std::process::id()));
        let guide = root.join("docs/guide");
        std::fs::create_dir_all(guide.join("pictures")).unwrap();
        std::fs::write(guide.join("a.md"), "# A\n\n## Where it fails\n").unwrap();
        std::fs::write(guide.join("page.html"), "<p id=\"said\">").unwrap();
        std::fs::write(guide.join("pictures/a.png"), "").unwrap();
        std::fs::write(root.join("README.md"), "# Read\n").unwrap();
        let lead = |link: &str| lead(&root, &guide, &guide.join("a.md"), link);
        let good =
            ["a.md", "a.md#where-it-fails", "#a", "../../README.md#read", "page.html#said", "pictures/a.png"];
        let bad = [
            "b.md",
            "a.md#where",
            "#b",
            "../../README.md#a",
            "page.html#text",
            "pictures/b.png",
            "../../../x.md",
        ];
        let (good, bad) = (good.map(lead), bad.map(lead));
        std::fs::remove_dir_all(&root).unwrap();
        assert!(good.iter().all(Result::is_ok), "{good:?}");
        assert!(bad.iter().all(Result::is_err), "{bad:?}");
    }

    #[test]
    fn a_link_out_of_the_checkout_leads_nowhere() {
        let (root, docs) = (Path::new("/repo"), Path::new("/repo/docs"));
        assert_eq!(resolve(root, docs, "../a%20b.png"), Some(PathBuf::from("/repo/a b.png")));
        assert_eq!(resolve(root, docs, "/LICENSE-MIT"), Some(PathBuf::from("/repo/LICENSE-MIT")));
        assert_eq!(resolve(root, docs, "../../shared/x.md"), None);
    }
}
