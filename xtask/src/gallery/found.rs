//! What the commands said: quoted words, measures, listings.

use super::{Listing, Measure, Picture};
use crate::picture::Difference;
use crate::process::{self, Done, Fault, failed};
use serde_json::Value;
use std::collections::HashMap;
use std::process::Command;

/// What the page tells beside its pictures.
#[derive(Default)]
pub struct Found {
    /// By picture's file.
    quotes: HashMap<&'static str, Vec<String>>,
    /// By a measure's arguments: a line of the table.
    lines: HashMap<&'static str, String>,
    /// By a listing's arguments.
    listings: HashMap<&'static str, String>,
    /// By two pictures' files.
    differences: HashMap<[&'static str; 2], String>,
    /// What measured.
    pub adapter: String,
    /// Are costs left out?
    pub no_costs: bool,
}

impl Found {
    pub fn quotes_of(&self, picture: &Picture) -> &[String] {
        self.quotes.get(picture.file).map_or(&[], Vec::as_slice)
    }

    pub fn line_of(&self, measure: &Measure) -> Option<&str> {
        self.lines.get(measure.arguments).map(String::as_str)
    }

    pub fn listing_of(&self, listing: &Listing) -> Option<&str> {
        self.listings.get(listing.arguments).map(String::as_str)
    }

    pub fn difference_of(&self, pair: [&'static str; 2]) -> Option<&str> {
        self.differences.get(&pair).map(String::as_str)
    }

    /// Keeps how much two pictures differ.
    pub fn compare(&mut self, pair: [&'static str; 2], difference: Difference) {
        let [a, b] = pair;
        let Difference { pixels, of, most } = difference;
        let said = match pixels {
            0 => format!("`{a}` and `{b}` are the same picture: none of {of} pixels differs."),
            _ => format!("`{a}` and `{b}` differ in {pixels} of {of} pixels, by {most} of 255 at most."),
        };
        self.differences.insert(pair, said);
    }

    /// Draws a picture and keeps what is quoted of its JSON.
    pub fn quote(&mut self, picture: &Picture, command: &mut Command) -> Done {
        eprintln!("$ {}", process::typed(command));
        let said = json(command)?;
        let quotes: Vec<_> = picture.quoted.iter().flat_map(|key| quotes(key, within(&said, key))).collect();
        if quotes.is_empty() {
            return Err(failed(format!(
                "{}: the command says nothing of {:?}",
                picture.file, picture.quoted
            )));
        }
        self.quotes.insert(picture.file, quotes);
        Ok(())
    }

    /// Measures one technique.
    pub fn measure(&mut self, measure: &Measure) -> Done {
        let mut command = process::umbrage("debug", measure.words());
        eprintln!("$ {}", process::typed(&command));
        let said = json(&mut command)?;
        self.adapter = said["adapter"].as_str().unwrap_or_default().to_owned();
        let of = &said["results"][0];
        let number = |key: &str| {
            let lacking = || failed(format!("`{}` has no {key}", process::typed(&command)));
            of[key].as_f64().ok_or_else(lacking)
        };
        let percent = |key| number(key).map(|share| 100.0 * share);
        // No contact in the picture: no gap.
        let gap = of["gap_m"].as_f64().map_or("-".to_owned(), |metres| format!("{:.1}", 1000.0 * metres));
        let cost = if self.no_costs { "-".to_owned() } else { format!("{:.1}", number("cost_ms")?) };
        let line = format!(
            "| {} | {:.3} | {:.3} | {gap} | {:.4} | {cost} | {:.2} |",
            measure.label,
            percent("acne")?,
            percent("leak")?,
            number("rmse")?,
            number("memory_bytes")? / f64::from(1 << 20),
        );
        self.lines.insert(measure.arguments, line);
        Ok(())
    }

    /// Keeps what a command prints.
    pub fn list(&mut self, listing: &Listing) -> Done {
        let mut command = process::umbrage("debug", listing.arguments.split_whitespace());
        let all = process::stdout(&mut command)?;
        let kept = paragraph(&all, listing.paragraph);
        if kept.is_empty() {
            return Err(failed(format!("`{}` says no {:?}", process::typed(&command), listing.paragraph)));
        }
        self.listings.insert(listing.arguments, kept);
        Ok(())
    }
}

fn json(command: &mut Command) -> Result<Value, Fault> {
    let said = process::stdout(command)?;
    serde_json::from_str(&said)
        .map_err(|e| failed(format!("`{}` prints no JSON: {e}", process::typed(command))))
}

/// What `a.b` names of a command's JSON.
fn within<'a>(said: &'a Value, key: &str) -> &'a Value {
    key.split('.').fold(said, |of, key| &of[key])
}

/// As the page shows it: words as they are, passes that draw with their triangles, anything else with its name.
fn quotes(key: &str, value: &Value) -> Vec<String> {
    match value {
        Value::Null => Vec::new(),
        Value::Array(passes) if key == "passes" => {
            let told = |pass: &Value| Some((pass["name"].as_str()?.to_owned(), pass["triangles"].as_u64()?));
            let drawn = passes.iter().filter_map(told).filter(|(_, triangles)| *triangles > 0);
            drawn.map(|(name, triangles)| format!("{name}: {triangles} triangles")).collect()
        }
        Value::Array(words) if words.iter().all(Value::is_string) => {
            words.iter().filter_map(Value::as_str).map(|text| format!("{key}: {text}")).collect()
        }
        other => vec![format!("{key}: {other}")],
    }
}

/// The lines from the one that begins with `first` to the next empty one; all without `first`.
fn paragraph(text: &str, first: &str) -> String {
    if first.is_empty() {
        return text.trim_end().to_owned();
    }
    let lines = text.lines().skip_while(|line| !line.starts_with(first));
    let kept: Vec<_> = lines.take_while(|line| !line.is_empty()).collect();
    kept.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_paragraph_ends_at_an_empty_line() {
        let text = "one\n\ntwo\n  three\n\nfour\n";
        assert_eq!(paragraph(text, "two"), "two\n  three");
        assert_eq!(paragraph(text, ""), text.trim_end());
        assert_eq!(paragraph(text, "five"), "");
    }

    #[test]
    fn words_are_quoted_one_by_one_and_numbers_as_they_are() {
        assert_eq!(quotes("warnings", &json!(["a", "b"])), ["warnings: a", "warnings: b"]);
        assert_eq!(quotes("maps_drawn", &json!(3)), ["maps_drawn: 3"]);
        assert_eq!(quotes("a.b", within(&json!({"a": {"b": 7}}), "a.b")), ["a.b: 7"]);
        let passes = json!([{"name": "mask 0.2", "triangles": 12}, {"name": "found", "triangles": 0}]);
        assert_eq!(quotes("passes", &passes), ["mask 0.2: 12 triangles"]);
        assert!(quotes("none", &Value::Null).is_empty() && quotes("none", &json!([])).is_empty());
    }
}
