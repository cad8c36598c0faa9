//! `umbrage techniques`: the table, for people and programs.

use crate::args::TechniquesArgs;
use crate::fault::{Fault, say};
use crate::json::{self, ParamJson, SourceJson};
use crate::text;
use serde_json::{Value, json};
use umbrage_render::umbrage::core::technique::{
    Choice, Combination, DEFAULT, Family, Method, Param, ParamDefault, Settings, Source, TECHNIQUES, Table,
    Technique,
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
            "choices": tables().map(|(_, table)| (table.key.to_owned(), table.rows.iter().map(|row| choice_json(row)).collect()))
                .collect::<serde_json::Map<String, Value>>(),
            "families": Family::WITH_CHOICES.iter().map(|family| {
                (family.id().to_owned(), family.tables().iter().map(|table| Value::from(table.key)).collect())
            }).collect::<serde_json::Map<String, Value>>(),
        })),
        (false, true) => say(&matrix()),
        (false, false) => say(&listing(text::width())),
    }
}

fn tables() -> impl Iterator<Item = (Family, Table)> {
    Family::WITH_CHOICES
        .into_iter()
        .flat_map(|family| family.tables().into_iter().map(move |table| (family, table)))
}

/// Every parameter once, in the order of the tables.
fn all_params() -> Vec<&'static Param> {
    let mut params: Vec<&'static Param> = Vec::new();
    for param in tables().flat_map(|(_, table)| table.rows).flat_map(|row| row.params) {
        if params.iter().all(|known| known.name != param.name) {
            params.push(param);
        }
    }
    params
}

fn choices_of(method: &Method) -> String {
    method.rows().iter().map(|(key, row)| format!("{key}={}", row.id)).collect::<Vec<_>>().join(" ")
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
        if technique.method != Method::None {
            out += &text::hang("", INDENT, &choices_of(&technique.method), width);
            let params: Vec<&str> = technique.method.params().iter().map(|p| p.name).collect();
            out += &text::hang("", INDENT, &format!("parameters: {}", params.join(", ")), width);
        }
    }
    let mut last = None;
    for (family, table) in tables() {
        if last.replace(family) != Some(family) {
            out += &format!("\nChoices of a {} (--set KEY=ID)\n", family.id());
        }
        out += &format!("  {}\n", table.key);
        for row in table.rows {
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
    let keys: Vec<&str> = Family::Map.tables().iter().map(|table| table.key).collect();
    let head = keys.iter().map(|key| (*key).to_owned()).chain(["valid".to_owned()]).collect();
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
        let (choices, verdict) = row.split_at(keys.len());
        let head: String = choices.iter().map(|cell| format!("{cell:<12}")).collect();
        out += &text::hang(&head, 12 * keys.len(), &verdict.join(" "), text::width());
    }
    out + &format!("{valid} of {count} combinations are valid\n")
}

fn matrix_json() -> Vec<Value> {
    Combination::all()
        .map(|combination| {
            let mut entry = serde_json::Map::new();
            for (key, row) in Method::Map(combination).rows() {
                entry.insert(key.to_owned(), row.id.into());
            }
            entry.insert("valid".to_owned(), combination.objection().is_none().into());
            entry.insert("why_not".to_owned(), combination.objection().into());
            Value::Object(entry)
        })
        .collect()
}

fn technique_json(technique: &Technique) -> Value {
    let pairs = technique.method.rows().into_iter().map(|(key, row)| (key.to_owned(), row.id.into()));
    let choices =
        (technique.method != Method::None).then(|| pairs.collect::<serde_json::Map<String, Value>>());
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
        "family": technique.method.family().id(),
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
        for (family, table) in tables() {
            let technique = TECHNIQUES.iter().find(|technique| technique.method.family() == family);
            let Some(technique) = technique else { panic!("no technique is a {}", family.id()) };
            for row in table.rows {
                assert!(
                    Settings::new(technique.id, [(table.key, row.id)]).is_ok(),
                    "{}={}",
                    table.key,
                    row.id
                );
            }
        }
    }
}
