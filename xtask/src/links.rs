//! Do the links and pictures of our papers lead anywhere?

use crate::process::{self, Done, failed};
use std::path::{Component, Path, PathBuf};

/// Folders that hold no papers of ours.
const NOT_OURS: [&str; 4] = ["target", "shared", "node_modules", "third_party"];

/// Every relative link of every Markdown file leads to something in the checkout.
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
            let leads_to = resolve(&root, folder, &link);
            if !leads_to.is_some_and(|path| path.exists()) {
                let paper = paper.strip_prefix(&root).unwrap_or(paper).display();
                return Err(failed(format!("{paper}:{line}: `{link}` leads to nothing in the checkout")));
            }
        }
    }
    println!("{count} relative links in {} papers lead somewhere", papers.len());
    Ok(())
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

/// Line number and target of every relative link and picture, without code and without anchors.
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

/// The file that a target names; nothing for other places of the net and of the same page.
fn relative(target: &str) -> Option<String> {
    let target = target.split_whitespace().next()?.trim_matches(['<', '>']);
    let elsewhere = target.contains("://") || target.starts_with("mailto:");
    let file = target.split('#').next().unwrap_or("");
    (!elsewhere && !file.is_empty()).then(|| file.to_owned())
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
        let expected = [(1, "docs/a.md"), (1, "b.png"), (5, "e.png"), (6, "h.md")];
        assert_eq!(found, expected.map(|(line, link)| (line, link.to_owned())));
    }

    #[test]
    fn a_link_out_of_the_checkout_leads_nowhere() {
        let (root, docs) = (Path::new("/repo"), Path::new("/repo/docs"));
        assert_eq!(resolve(root, docs, "../a%20b.png"), Some(PathBuf::from("/repo/a b.png")));
        assert_eq!(resolve(root, docs, "/LICENSE-MIT"), Some(PathBuf::from("/repo/LICENSE-MIT")));
        assert_eq!(resolve(root, docs, "../../shared/x.md"), None);
    }
}
