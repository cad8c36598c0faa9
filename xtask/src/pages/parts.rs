//! The parts of a page that are made.

use super::{FOLDER, PICTURES};
use crate::process::{self, Fault, failed};
use serde_json::Value;
use std::fmt::Write;

/// The line that ends a made part.
pub const CLOSING: &str = "<!-- /made -->";
/// How the heading of a measured table of `docs/guide.md` begins; the scene follows.
const MEASURED: &str = "## Every technique on ";
/// The scene whose table the index quotes.
const INDEX_SCENE: &str = "`builtin:torus`";

/// The line that begins a made part.
pub fn opening(kind: &str) -> String {
    format!("<!-- made: {kind} -->")
}

/// What the pages are made from.
pub struct Facts {
    /// What `umbrage techniques --json` prints.
    table: Value,
    /// What `umbrage passes` prints of each technique, by its id.
    passes: Vec<(String, String)>,
    /// The text of `docs/guide.md`.
    measured: String,
}

impl Facts {
    /// Asks the command, which must be built.
    pub fn ask() -> Result<Self, Fault> {
        let said = |words: &[&str]| process::stdout(&mut process::umbrage("debug", words));
        let text = said(&["techniques", "--json"])?;
        let table = serde_json::from_str(&text)
            .map_err(|e| failed(format!("`umbrage techniques --json` printed no JSON: {e}")))?;
        let path = process::root().join("docs/guide.md");
        let measured =
            std::fs::read_to_string(&path).map_err(|e| failed(format!("{}: {e}", path.display())))?;
        let mut facts = Self { table, passes: Vec::new(), measured };
        for id in facts.ids().map(str::to_owned).collect::<Vec<_>>() {
            let passes = said(&["passes", &id])?;
            facts.passes.push((id, passes));
        }
        Ok(facts)
    }

    /// All techniques, in the order of the table.
    pub fn ids(&self) -> impl Iterator<Item = &str> {
        self.techniques().filter_map(|technique| technique["id"].as_str())
    }

    fn techniques(&self) -> impl Iterator<Item = &Value> {
        self.table["techniques"].as_array().into_iter().flatten()
    }

    /// A page with all its made parts made anew.
    pub fn page(&self, name: &str, text: &str) -> Result<String, String> {
        let id = name.strip_suffix(".md").unwrap_or(name);
        let mut page = String::new();
        let mut lines = text.lines().enumerate();
        while let Some((i, line)) = lines.next() {
            page += line;
            page.push('\n');
            let Some(kind) = line.strip_prefix("<!-- made: ").and_then(|rest| rest.strip_suffix(" -->"))
            else {
                continue;
            };
            let at = || format!("{FOLDER}/{name}:{}", i + 1);
            let made = self.part(id, kind).map_err(|why| format!("{}: {why}", at()))?;
            let _ = write!(page, "\n{}\n\n{CLOSING}\n", made.trim_end());
            let mut old =
                lines.by_ref().map(|(_, line)| line).take_while(|line| !line.starts_with("<!-- made:"));
            if !old.any(|line| line == CLOSING) {
                return Err(format!("{}: `{}` has no `{CLOSING}`", at(), opening(kind)));
            }
        }
        Ok(page)
    }

    fn part(&self, id: &str, kind: &str) -> Result<String, String> {
        if let Some(file) = kind.strip_prefix("picture ") {
            let picture = PICTURES.iter().find(|picture| picture.file == file);
            return Ok(picture.ok_or_else(|| format!("there is no picture `{file}` in the list"))?.shown());
        }
        match kind {
            "index" => return Ok(self.index()),
            "measured-all" => return self.measured_all(),
            _ => {}
        }
        let technique = self.techniques().find(|technique| technique["id"] == id);
        let technique = technique.ok_or_else(|| format!("there is no technique `{id}`"))?;
        match kind {
            "facts" => Ok(self.facts(technique)),
            "parameters" => Ok(parameters(technique)),
            "passes" => {
                let passes = self.passes.iter().find(|(own, _)| own == id).map_or("", |(_, text)| text);
                Ok(format!("```text\n$ umbrage passes {id}\n{}\n```", passes.trim_end()))
            }
            "measured" => self.measured(id),
            _ => Err(format!("nobody knows how `{kind}` is made")),
        }
    }

    /// What it is, where it was published, and what it is made of.
    fn facts(&self, technique: &Value) -> String {
        let word = |value: &Value| value.as_str().unwrap_or("").to_owned();
        let mut text = format!("`--technique {}`: {}.", word(&technique["id"]), word(&technique["summary"]));
        if !technique["source"].is_null() {
            let _ = write!(text, "\n\nPublished: {}.", published(technique));
        }
        let Some(choices) = technique["choices"].as_object() else {
            return text + " It has no choices.";
        };
        text += "\n\n| choice | here | what that is |\n|---|---|---|\n";
        // In the order of the tables of its family, which JSON objects do not keep.
        let family = &self.table["families"][word(&technique["family"])];
        let ordered = family.as_array().into_iter().flatten().filter_map(Value::as_str);
        let mut keys: Vec<&str> = ordered.filter(|key| choices.contains_key(*key)).collect();
        keys.extend(choices.keys().map(String::as_str).filter(|key| !keys.contains(key)).collect::<Vec<_>>());
        for key in keys {
            let rows = self.table["choices"][key].as_array().into_iter().flatten();
            let summary =
                rows.filter(|row| row["id"] == choices[key]).map(|row| word(&row["summary"])).next();
            let _ = writeln!(
                text,
                "| `{key}` | `{}` | {} |",
                word(&choices[key]),
                escaped(&summary.unwrap_or_default())
            );
        }
        text
    }

    /// One line for each technique, with a link to its page.
    fn index(&self) -> String {
        let mut text = "| page | what it is | published |\n|---|---|---|\n".to_owned();
        for technique in self.techniques() {
            let id = technique["id"].as_str().unwrap_or("");
            let summary = technique["summary"].as_str().unwrap_or("");
            let _ = writeln!(
                text,
                "| [`{id}`]({id}.md) | {} | {} |",
                escaped(summary),
                escaped(&published(technique))
            );
        }
        text
    }

    /// The tables of `docs/guide.md` that have every technique: the scene, and the lines of its table.
    fn tables(&self) -> impl Iterator<Item = (&str, impl Iterator<Item = &str>)> {
        self.measured.split("\n## ").filter_map(|section| {
            let (scene, rest) = section.strip_prefix(&MEASURED[3..])?.split_once('\n')?;
            Some((scene, rest.lines().filter(|line| line.starts_with('|'))))
        })
    }

    /// What was measured of one technique, a line for each scene.
    fn measured(&self, id: &str) -> Result<String, String> {
        let mut text = String::new();
        for (scene, lines) in self.tables() {
            let lines: Vec<&str> = lines.collect();
            if text.is_empty() {
                let head = lines.iter().take(2).map(|line| line.replacen("technique", "scene", 1) + "\n");
                text.extend(head);
            }
            let own = format!("| `{id}` |");
            let row = lines.iter().find_map(|line| line.strip_prefix(&own));
            let row = row.ok_or_else(|| {
                format!("docs/guide.md has no row of `{id}` on {scene}; `cargo xtask guide` measures it")
            })?;
            let _ = writeln!(text, "| {scene} |{row}");
        }
        Ok(text)
    }

    /// What was measured of every technique on one scene, with links to their pages.
    fn measured_all(&self) -> Result<String, String> {
        let (_, lines) = self
            .tables()
            .find(|(scene, _)| *scene == INDEX_SCENE)
            .ok_or_else(|| format!("docs/guide.md has no table of {INDEX_SCENE}"))?;
        let linked = |line: &str| match line.strip_prefix("| `").and_then(|rest| rest.split_once('`')) {
            Some((id, rest)) => format!("| [`{id}`]({id}.md){rest}\n"),
            None => format!("{line}\n"),
        };
        Ok(lines.map(linked).collect())
    }
}

fn published(technique: &Value) -> String {
    let source = &technique["source"];
    match (source["paper"].as_str(), source["year"].as_u64()) {
        (Some(paper), Some(year)) => format!("{paper}, {year}"),
        _ => String::new(),
    }
}

fn parameters(technique: &Value) -> String {
    let params: Vec<&Value> = technique["params"].as_array().into_iter().flatten().collect();
    if params.is_empty() {
        return "None.".to_owned();
    }
    let mut text =
        "| `--set` | unit | range | default | what it does | what it costs |\n|---|---|---|---|---|---|\n"
            .to_owned();
    let number = |value: &Value| value.as_f64().map_or_else(String::new, |x| format!("{x}"));
    for param in params {
        let word = |key: &str| escaped(param[key].as_str().unwrap_or(""));
        let default =
            if param["default"].is_null() { word("default_rule") } else { number(&param["default"]) };
        let _ = writeln!(
            text,
            "| `{}` | {} | {} to {} | {default} | {} | {} |",
            word("name"),
            word("unit"),
            number(&param["min"]),
            number(&param["max"]),
            word("help"),
            word("cost")
        );
    }
    text
}

/// As the cell of a table.
fn escaped(text: &str) -> String {
    text.replace('|', "\\|")
}

impl super::Picture {
    /// The picture, its caption, and the command that draws it.
    pub fn shown(&self) -> String {
        let mut words = self.words();
        words.insert(0, "umbrage".to_owned());
        format!(
            "![{0}](pictures/{1}.png)\n\n*{0}*\n\n```sh\n{2}\n```",
            self.caption,
            self.file,
            words.join(" ")
        )
    }
}

#[cfg(test)]
pub mod tests {
    use super::*;
    use serde_json::json;

    /// A small table.
    pub fn facts() -> Facts {
        let source = json!({"paper": "Reeves | Cook", "year": 1987});
        let width = json!({"name": "width", "unit": "texel", "min": 1.0, "max": 17.0, "default": 5.0,
                           "default_rule": null, "help": "how wide", "cost": "lookups"});
        let table = json!({
            "families": {"map": ["storage", "filter"]},
            "choices": {"filter": [{"id": "pcf", "summary": "a box"}], "storage": [{"id": "auto", "summary": "best"}]},
            "techniques": [
                {"id": "unshadowed", "family": "none", "choices": null, "params": [], "source": null, "summary": "light"},
                {"id": "pcf", "family": "map", "choices": {"filter": "pcf", "storage": "auto"}, "params": [width],
                 "source": source, "summary": "soft"},
            ],
        });
        let passes = ["unshadowed", "pcf"].map(|id| (id.to_owned(), format!("lighting of {id}\n")));
        let measured = "# Guide\n\n## Every technique on `builtin:torus`\n\n| technique | rmse |\n|---|--:|\n\
                        | `unshadowed` | 0.3 |\n| `pcf` | 0.02 |\n\n## Every technique on `builtin:contact`\n\n\
                        | technique | rmse |\n|---|--:|\n| `unshadowed` | 0.4 |\n| `pcf` | 0.03 |\n";
        Facts { table, passes: passes.to_vec(), measured: measured.to_owned() }
    }

    #[test]
    fn made_parts_are_replaced_and_the_rest_stays() {
        let page = "# A\n<!-- made: passes -->\nold\n<!-- /made -->\nafter\n<!-- made: measured -->\n<!-- /made -->\n";
        let once = facts().page("pcf.md", page).expect("a page");
        assert!(
            once.starts_with(
                "# A\n<!-- made: passes -->\n\n```text\n$ umbrage passes pcf\nlighting of pcf\n"
            )
        );
        assert!(!once.contains("old") && once.contains("<!-- /made -->\nafter\n"), "{once}");
        assert!(once.contains(
            "| scene | rmse |\n|---|--:|\n| `builtin:torus` | 0.02 |\n| `builtin:contact` | 0.03 |"
        ));
        assert_eq!(facts().page("pcf.md", &once), Ok(once));
    }

    #[test]
    fn tables_keep_their_columns() {
        let page = |kind: &str| {
            let text = format!("{}\n{CLOSING}\n", opening(kind));
            facts().page("pcf.md", &text).expect("a page")
        };
        assert!(page("facts").contains("Published: Reeves | Cook, 1987."));
        assert!(page("facts").contains("| `storage` | `auto` | best |\n| `filter` | `pcf` | a box |"));
        assert!(page("parameters").contains("| `width` | texel | 1 to 17 | 5 | how wide | lookups |"));
        assert!(page("index").contains("| [`pcf`](pcf.md) | soft | Reeves \\| Cook, 1987 |"));
        assert!(page("measured-all").contains("| [`pcf`](pcf.md) | 0.02 |"));
    }

    #[test]
    fn what_cannot_be_made_is_named() {
        let said = |name: &str, text: &str| facts().page(name, text).expect_err("it cannot be made");
        assert!(
            said("pcf.md", "<!-- made: colours -->\n<!-- /made -->\n").contains("pcf.md:1: nobody knows")
        );
        assert!(
            said("pfc.md", "\n<!-- made: facts -->\n<!-- /made -->\n")
                .contains("pfc.md:2: there is no technique")
        );
        assert!(said("pcf.md", "<!-- made: facts -->\n").contains("has no `<!-- /made -->`"));
        let two = "<!-- made: facts -->\n<!-- made: passes -->\n<!-- /made -->\n";
        assert!(said("pcf.md", two).contains("has no `<!-- /made -->`"));
        assert!(
            said("pcf.md", "<!-- made: picture none -->\n<!-- /made -->\n").contains("no picture `none`")
        );
        let mut lacking = facts();
        lacking.measured = lacking.measured.replace("| `pcf` |", "| `pfc` |");
        let text = "<!-- made: measured -->\n<!-- /made -->\n";
        assert!(lacking.page("pcf.md", text).expect_err("no row").contains("cargo xtask guide"));
    }

    #[test]
    fn the_index_links_every_page_by_name() {
        let page = facts().page("README.md", "<!-- made: index -->\n<!-- /made -->\n").expect("a page");
        assert!(facts().ids().all(|id| page.contains(&format!("({id}.md)"))));
    }
}
