//! The page: one folder that opens from disk, without a network.

use crate::{Comparison, MeasureError};
use serde::Serialize;
use serde_json::{Map, Value};
use std::path::{Path, PathBuf};

const PAGE: &str = include_str!("../report/page.html");
const STYLE: &str = include_str!("../report/page.css");
const SCRIPT: &str = include_str!("../report/page.js");

/// What the page says about the whole.
#[derive(Clone, Debug, Serialize)]
pub struct Head {
    /// What the scene is called.
    pub title: String,
    /// What was typed.
    pub command: String,
    /// Who drew it.
    pub adapter: String,
    /// Its driver.
    pub driver: String,
    /// Vulkan, Metal, ...
    pub backend: String,
    /// Of Umbrage.
    pub version: &'static str,
    /// Name and counts.
    pub scene: Map<String, Value>,
    /// Pixels.
    pub size: [u32; 2],
    /// Frames of each technique that were timed.
    pub frames: u32,
    /// What did not go as a user may expect.
    pub warnings: Vec<String>,
}

#[derive(Serialize)]
struct Page<'a> {
    #[serde(flatten)]
    head: &'a Head,
    truth: crate::TruthSummary,
    views: &'a [crate::ViewSummary],
    results: &'a [crate::Row],
}

/// Can the report be written there? Asked before any work.
///
/// # Errors
/// One line: the path, the reason, what to do.
pub fn check(folder: &Path) -> Result<(), String> {
    let refused = |reason: &str| Err(format!("cannot write the report {}: {reason}", folder.display()));
    if folder.file_name().is_none() {
        return refused("it names no folder");
    }
    if folder.is_file() {
        return refused("there is a file of that name; name a folder");
    }
    if folder.is_dir()
        && !is_report(folder)
        && std::fs::read_dir(folder).is_ok_and(|mut d| d.next().is_some())
    {
        return refused("the folder holds something else than a report; name a new one");
    }
    let parent = folder.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if !parent.is_dir() {
        return refused("its parent folder does not exist; make it or name another");
    }
    let probe = beside(folder, "probe");
    let made = std::fs::create_dir(&probe);
    let _ = std::fs::remove_dir(&probe);
    made.or_else(|e| refused(&format!("{e}; choose a place that you may write to")))
}

/// A folder that an earlier report left: nothing but its page and pictures.
fn is_report(folder: &Path) -> bool {
    let names = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.file_name());
    folder.join("index.html").is_file() && names.into_iter().all(|name| name == "index.html" || name == "img")
}

fn beside(folder: &Path, what: &str) -> PathBuf {
    let name = folder.file_name().unwrap_or_default().to_string_lossy();
    folder.with_file_name(format!(".{name}.{}.{what}", std::process::id()))
}

/// Writes page and pictures: first beside their place, then moved there, so that a failure leaves nothing behind. A report
/// that is there already is replaced.
///
/// # Errors
/// [`MeasureError::Write`]
pub fn write(folder: &Path, head: &Head, measured: &Comparison) -> Result<(), MeasureError> {
    check(folder).map_err(MeasureError::Write)?;
    let refused =
        |e: std::io::Error| MeasureError::Write(format!("cannot write the report {}: {e}", folder.display()));
    let (new, old) = (beside(folder, "part"), beside(folder, "old"));
    let written = write_into(&new, head, measured).and_then(|()| {
        let is_there = folder.is_dir();
        if is_there {
            std::fs::rename(folder, &old)?;
        }
        std::fs::rename(&new, folder).inspect_err(|_| {
            let _ = std::fs::rename(&old, folder);
        })?;
        if is_there { std::fs::remove_dir_all(&old) } else { Ok(()) }
    });
    written.map_err(|e| {
        let _ = std::fs::remove_dir_all(&new);
        refused(e)
    })
}

fn write_into(folder: &Path, head: &Head, measured: &Comparison) -> std::io::Result<()> {
    std::fs::create_dir_all(folder.join("img"))?;
    for view in &measured.views {
        std::fs::write(folder.join(&view.r#final), &view.pictures[0])?;
        std::fs::write(folder.join(&view.visibility), &view.pictures[1])?;
    }
    for row in &measured.rows {
        for (file, picture) in [&row.r#final, &row.visibility, &row.heat].into_iter().zip(&row.pictures) {
            std::fs::write(folder.join(file), picture)?;
        }
    }
    std::fs::write(folder.join("index.html"), page(head, measured))
}

/// The page as text.
fn page(head: &Head, measured: &Comparison) -> String {
    let data = Page { head, truth: measured.truth, views: &measured.views, results: &measured.rows };
    // A scene may be called `</script>`.
    let data = serde_json::to_string(&data).unwrap_or_default().replace('<', "\\u003c");
    let mut page = PAGE.to_owned();
    // Data last: what is put in is not searched for markers again.
    for (marker, text) in [("/*CSS*/", STYLE), ("/*JS*/", SCRIPT), ("/*DATA*/", &data)] {
        page = page.replacen(marker, text, 1);
    }
    page
}

#[cfg(test)]
mod tests {
    use super::*;

    fn head() -> Head {
        Head {
            title: "</script><b>".into(),
            command: "umbrage compare".into(),
            adapter: "a".into(),
            driver: "d".into(),
            backend: "b".into(),
            version: "0",
            scene: Map::new(),
            size: [4, 2],
            frames: 1,
            warnings: Vec::new(),
        }
    }

    fn nothing() -> Comparison {
        Comparison { truth: Default::default(), views: Vec::new(), rows: Vec::new(), warnings: Vec::new() }
    }

    #[test]
    fn the_page_holds_everything_and_no_marker() {
        let text = page(&head(), &nothing());
        for marker in ["/*CSS*/", "/*JS*/", "/*DATA*/"] {
            assert!(PAGE.matches(marker).count() == 1 && !text.contains(marker), "{marker}");
        }
        assert!(text.contains("\\u003c/script>\\u003cb>"));
        for from_elsewhere in ["src=\"http", "href=\"http", "url(http", "@import", "fetch("] {
            assert!(!text.contains(from_elsewhere), "{from_elsewhere}: the page must open without a network");
        }
    }

    #[test]
    fn a_report_replaces_a_report_and_nothing_else() {
        let home = std::env::temp_dir().join(format!("umbrage-report-{}", std::process::id()));
        std::fs::create_dir_all(&home).expect("a temporary folder");
        let folder = home.join("report");
        write(&folder, &head(), &nothing()).expect("new");
        write(&folder, &head(), &nothing()).expect("again");
        assert!(folder.join("index.html").is_file());
        std::fs::write(folder.join("mine.txt"), "x").expect("a file");
        let message = write(&folder, &head(), &nothing()).expect_err("not ours alone").to_string();
        assert!(message.contains("something else"), "{message}");
        assert!(check(&home.join("none/report")).expect_err("no parent").contains("does not exist"));
        assert!(check(&folder.join("mine.txt")).expect_err("a file").contains("name a folder"));
        let left: Vec<_> = std::fs::read_dir(&home).expect("home").flatten().map(|e| e.file_name()).collect();
        assert_eq!(left, ["report"]);
        std::fs::remove_dir_all(&home).expect("clean-up");
    }
}
