//! Several fillings of the slots in one shader: what depends on a slot is there once for each, under names of its own.

use super::{MODULES, Module, SLOTS, UnknownModule, text, wanted};
use std::collections::BTreeSet;

/// One filling of the slots.
#[derive(Clone, Copy, Debug)]
pub struct Variant<'a> {
    /// Modules, as [`super::assemble`] takes them.
    pub modules: &'a [&'a str],
    /// Slots filled by text of one's own, as [`super::assemble_with`] takes them.
    pub own: &'a [(&'a str, &'a str)],
    /// What is hung on every name that depends on a slot: `umbrage_filter_linear` becomes `umbrage_filter_linear_1` where
    /// this is `_1`. Different for each variant, and such that no name results that is there already.
    pub suffix: &'a str,
}

impl Variant<'_> {
    /// What a function of a module is called in this variant: its name hung with the suffix, unless the module depends on no slot.
    pub fn name(&self, module: &str, function: &str) -> String {
        let varies = MODULES.iter().find(|other| other.name == module).is_some_and(is_varied);
        if varies { format!("{function}{}", self.suffix) } else { function.to_owned() }
    }
}

/// Does a module, or anything that it needs, depend on how a slot is filled?
fn is_varied(module: &Module) -> bool {
    let needs_varied = |need: &&str| {
        SLOTS.iter().any(|(slot, _)| slot == need)
            || MODULES.iter().find(|other| other.name == *need).is_some_and(is_varied)
    };
    module.slot().is_some() || module.needs.iter().any(needs_varied)
}

/// Words of a text, each with where it begins: identifiers, keywords, numbers.
fn words(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let mut rest = 0;
    std::iter::from_fn(move || {
        let start = rest + text[rest..].find(is_word)?;
        let length = text[start..].find(|c| !is_word(c)).unwrap_or(text.len() - start);
        rest = start + length;
        Some((start, &text[start..rest]))
    })
}

/// The names that a text defines: functions, structures, aliases and constants.
fn defined(text: &str) -> BTreeSet<&str> {
    let mut defined = BTreeSet::new();
    let mut before = "";
    for (_, word) in words(text) {
        if matches!(before, "fn" | "struct" | "alias" | "const") {
            defined.insert(word);
        }
        before = word;
    }
    defined
}

/// A text with `suffix` hung on `names`, but for what stands behind a dot.
fn renamed(text: &str, names: &BTreeSet<&str>, suffix: &str) -> String {
    let mut made = String::with_capacity(text.len() + 16 * names.len());
    let mut done = 0;
    for (start, word) in words(text).filter(|(_, word)| names.contains(word)) {
        let end = start + word.len();
        made.push_str(&text[done..end]);
        if !text[..start].ends_with('.') {
            made.push_str(suffix);
        }
        done = end;
    }
    made.push_str(&text[done..]);
    made
}

/// One text with all that `shared` and every variant need: what depends on no slot once, what does once for each variant.
///
/// # Errors
/// [`UnknownModule`] lists the names that exist.
pub fn assemble_variants(shared: &[&str], variants: &[Variant<'_>]) -> Result<String, UnknownModule> {
    let mut once = wanted(shared)?;
    let mut varied = Vec::new();
    for variant in variants {
        let of_variant = wanted(variant.modules)?;
        let mut own = Vec::new();
        for (index, module) in MODULES.iter().enumerate().filter(|(index, _)| of_variant[*index]) {
            if is_varied(module) {
                own.push(text(module, variant.own));
            } else {
                once[index] = true;
            }
        }
        let own = own.join("\n");
        varied.push(renamed(&own, &defined(&own), variant.suffix));
    }
    let once = MODULES.iter().zip(once).filter(|(_, wanted)| *wanted).map(|(module, _)| module.source);
    Ok(once.map(str::to_owned).chain(varied).collect::<Vec<_>>().join("\n"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_fillings_go_into_one_shader() {
        let all: Vec<_> = crate::technique::Combination::all().filter(|c| c.objection().is_none()).collect();
        let mut seen = BTreeSet::new();
        let modules: Vec<Vec<&str>> =
            all.iter().map(|c| c.modules()).filter(|modules| seen.insert(modules.clone())).collect();
        assert!(modules.len() > 20, "{}", modules.len());
        let suffixes: Vec<String> = (0..modules.len()).map(|i| format!("_{i}")).collect();
        let variants: Vec<Variant<'_>> = modules
            .iter()
            .zip(&suffixes)
            .map(|(modules, suffix)| Variant { modules, own: &[], suffix })
            .collect();
        let text = assemble_variants(&["face", "light"], &variants).expect("known");
        assert_eq!(text.matches("fn umbrage_locate(").count(), 1);
        let module =
            naga::front::wgsl::parse_str(&text).unwrap_or_else(|e| panic!("{}", e.emit_to_string(&text)));
        naga::valid::Validator::new(naga::valid::ValidationFlags::all(), naga::valid::Capabilities::empty())
            .validate(&module)
            .unwrap_or_else(|e| panic!("{}", e.emit_to_string(&text)));
        let names: Vec<_> = module.functions.iter().filter_map(|(_, f)| f.name.clone()).collect();
        let mut varied = 0;
        for variant in &variants {
            let filter = variant.modules.iter().find(|name| name.starts_with("filter/")).expect("a filter");
            let wanted = variant.name(filter, &filter.replacen("filter/", "umbrage_filter_", 1));
            varied += usize::from(wanted.ends_with(variant.suffix));
            assert!(names.contains(&wanted), "{wanted} is missing");
        }
        assert!(varied > 20 && varied < variants.len(), "hardware's own comparison depends on no slot");
    }

    #[test]
    fn text_of_ones_own_is_renamed_whole_and_members_are_left_alone() {
        let own = "fn weight(layer: f32) -> f32 { return layer; }
fn layer_of(view: UmbrageView) -> f32 { return weight(f32(view.layer)); }
fn umbrage_kernel(view: UmbrageView, right: vec4f, down: vec4f) -> vec4f { return right * down * layer_of(view); }";
        let variant = Variant { modules: &["filter/kernel"], own: &[("kernel", own)], suffix: "_7" };
        let text = assemble_variants(&[], &[variant]).expect("known");
        assert!(text.contains("fn weight_7(layer") && text.contains("view.layer)"));
        assert!(naga::front::wgsl::parse_str(&text).is_ok());
        assert!(assemble_variants(&["no/such"], &[]).is_err());
    }
}
