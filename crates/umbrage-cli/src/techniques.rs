//! `umbrage techniques`: the table, for people and programs.

use crate::args::TechniquesArgs;
use crate::fault::{Fault, say};
use crate::json::{self, ParamJson, SourceJson};
use crate::text;
use serde_json::{Value, json};
use umbrage_render::umbrage::core::technique::{
    Bias, Choice, Combination, DEFAULT, Filter, Param, ParamDefault, Projection, Settings, Source, Storage,
    TECHNIQUES, Technique, Translucent,
};

/// Prints the table.
///
/// # Errors
/// When standard output cannot be written.
pub fn run(args: &TechniquesArgs) -> Result<(), Fault> {
    match (args.json, args.matrix) {
        (true, true) => json::print(&json!({ "combinations": matrix_json() })),
        (true, false) => json::print(&json!({
            "default": DEFAULT,
            "techniques": TECHNIQUES.iter().map(technique_json).collect::<Vec<_>>(),
            "choices": tables().map(|(key, rows)| (key.to_owned(), rows.iter().map(|row| choice_json(row)).collect()))
                .collect::<serde_json::Map<String, Value>>(),
        })),
        (false, true) => say(&matrix()),
        (false, false) => say(&listing(text::width())),
    }
}

fn tables() -> impl Iterator<Item = (&'static str, Vec<&'static Choice>)> {
    let rows = [
        Storage::ALL.iter().map(|c| c.row()).collect::<Vec<_>>(),
        Projection::ALL.iter().map(|c| c.row()).collect(),
        Bias::ALL.iter().map(|c| c.row()).collect(),
        Filter::ALL.iter().map(|c| c.row()).collect(),
        Translucent::ALL.iter().map(|c| c.row()).collect(),
    ];
    Settings::CHOICES.into_iter().zip(rows)
}

/// Every parameter once, in the order of the tables.
fn all_params() -> Vec<&'static Param> {
    let mut params: Vec<&'static Param> = Vec::new();
    for param in tables().flat_map(|(_, rows)| rows).flat_map(|row| row.params) {
        if params.iter().all(|known| known.name != param.name) {
            params.push(param);
        }
    }
    params
}

fn choices_of(combination: &Combination) -> String {
    let pairs = Settings::CHOICES.iter().zip(combination.rows());
    pairs.map(|(key, row)| format!("{key}={}", row.id)).collect::<Vec<_>>().join(" ")
}

fn cite(source: Option<Source>) -> String {
    source.map(|s| format!(" [{}, {}]", s.paper, s.year)).unwrap_or_default()
}

fn listing(width: usize) -> String {
    const INDENT: usize = 16;
    let mut out = String::from("Techniques (--technique ID)\n");
    for technique in TECHNIQUES {
        let default = if technique.id == DEFAULT { " (the default)" } else { "" };
        let about = format!("{}{default}: {}{}", technique.label, technique.summary, cite(technique.source));
        out += &text::hang(&format!("  {}", technique.id), INDENT, &about, width);
        if let Some(combination) = &technique.combination {
            out += &text::hang("", INDENT, &choices_of(combination), width);
            let params: Vec<&str> = combination.params().map(|p| p.name).collect();
            out += &text::hang("", INDENT, &format!("parameters: {}", params.join(", ")), width);
        }
    }
    out += "\nChoices of a map (--set KEY=ID)\n";
    for (key, rows) in tables() {
        out += &format!("  {key}\n");
        for row in rows {
            let params: Vec<&str> = row.params.iter().map(|p| p.name).collect();
            let params =
                if params.is_empty() { String::new() } else { format!(" (has {})", params.join(", ")) };
            let about = format!("{}{}{params}", row.summary, cite(row.source));
            out += &text::hang(&format!("    {}", row.id), INDENT, &about, width);
        }
    }
    out += "\nParameters (--set NAME=NUMBER)\n";
    for param in all_params() {
        let default = match param.default {
            ParamDefault::Fixed(value) => value.to_string(),
            ParamDefault::Derived { rule, .. } => rule.to_owned(),
        };
        let unit = if param.unit.is_empty() { String::new() } else { format!(" {}", param.unit) };
        out += &text::hang(&format!("  {}", param.name), INDENT, param.help, width);
        let numbers = format!("{} to {}{unit}, step {}; default {default}", param.min, param.max, param.step);
        out += &text::hang("", INDENT, &numbers, width);
        out += &text::hang("", INDENT, &format!("cost: {}", param.cost), width);
    }
    out
}

fn matrix() -> String {
    let head = Settings::CHOICES.iter().map(|key| (*key).to_owned()).chain(["valid".to_owned()]).collect();
    let mut rows: Vec<Vec<String>> = vec![head];
    let mut valid = 0;
    for combination in Combination::all() {
        let mut row: Vec<String> = combination.rows().iter().map(|row| row.id.to_owned()).collect();
        let objection = combination.objection();
        valid += usize::from(objection.is_none());
        row.push(objection.map_or_else(|| "yes".to_owned(), |why| format!("no: {why}")));
        rows.push(row);
    }
    let count = rows.len() - 1;
    let mut out = String::new();
    for row in &rows {
        let (choices, verdict) = row.split_at(Settings::CHOICES.len());
        let head: String = choices.iter().map(|cell| format!("{cell:<12}")).collect();
        out += &text::hang(&head, 12 * Settings::CHOICES.len(), &verdict.join(" "), text::width());
    }
    out + &format!("{valid} of {count} combinations are valid\n")
}

fn matrix_json() -> Vec<Value> {
    Combination::all()
        .map(|combination| {
            let mut entry = serde_json::Map::new();
            for (key, row) in Settings::CHOICES.iter().zip(combination.rows()) {
                entry.insert((*key).to_owned(), row.id.into());
            }
            entry.insert("valid".to_owned(), combination.objection().is_none().into());
            entry.insert("why_not".to_owned(), combination.objection().into());
            Value::Object(entry)
        })
        .collect()
}

fn technique_json(technique: &Technique) -> Value {
    let choices = technique.combination.map(|combination| {
        let pairs = Settings::CHOICES.iter().zip(combination.rows());
        pairs.map(|(key, row)| ((*key).to_owned(), row.id.into())).collect::<serde_json::Map<String, Value>>()
    });
    let settings = Settings::new(technique.id, []).ok();
    let params: Vec<Value> = settings
        .iter()
        .flat_map(|settings| {
            settings.params().map(|param| {
                let mut entry = json!(ParamJson::from(param));
                if let ParamDefault::Derived { .. } = param.default {
                    entry["default"] = settings.value(param.name).map(json::decimal).into();
                }
                entry
            })
        })
        .collect();
    json!({
        "id": technique.id,
        "label": technique.label,
        "summary": technique.summary,
        "family": technique.family.id(),
        "source": technique.source.map(SourceJson::from),
        "choices": choices,
        "params": params,
    })
}

fn choice_json(row: &Choice) -> Value {
    json!({
        "id": row.id,
        "label": row.label,
        "summary": row.summary,
        "source": row.source.map(SourceJson::from),
        "modules": row.modules,
        "params": row.params.iter().map(ParamJson::from).collect::<Vec<_>>(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_listing_fits_80_columns_and_leaves_nothing_out() {
        let text = listing(80);
        assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
        for technique in TECHNIQUES {
            assert!(text.contains(technique.id) && text.contains(technique.label), "{}", technique.id);
        }
        for param in all_params() {
            assert!(text.contains(&format!("\n  {}", param.name)), "{}", param.name);
        }
    }

    #[test]
    fn the_choices_are_named_as_settings_are() {
        use umbrage_render::umbrage::core::technique::Settings;
        for (key, rows) in tables() {
            for row in rows {
                assert!(Settings::new("linear", [(key, row.id)]).is_ok(), "{key}={}", row.id);
            }
        }
    }
}
