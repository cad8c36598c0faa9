//! `umbrage wgsl`: the shader library as text.

use crate::args::WgslArgs;
use crate::fault::{Fault, say, suggest};
use crate::text;
use umbrage_render::umbrage::core::wgsl::{MODULES, assemble};

/// Prints the named modules with all that they need, or the list.
///
/// # Errors
/// [`Fault::WrongUse`] for a name that is no module.
pub fn run(args: &WgslArgs) -> Result<(), Fault> {
    if args.modules.is_empty() {
        let width = text::width();
        let indent = 2 + MODULES.iter().map(|m| m.name.len()).max().unwrap_or(0);
        let lines = MODULES.iter().map(|module| {
            let needs = if module.needs.is_empty() {
                String::new()
            } else {
                format!(" (needs {})", module.needs.join(", "))
            };
            text::hang(module.name, indent, &format!("{}{needs}", module.summary), width)
        });
        return say(&lines.collect::<String>());
    }
    let names: Vec<&str> = args.modules.iter().map(String::as_str).collect();
    let wgsl = assemble(&names).map_err(|unknown| {
        let near = suggest(&unknown.asked, MODULES.iter().map(|m| m.name));
        Fault::WrongUse(format!(
            "there is no WGSL module `{}`{near}; there are {}",
            unknown.asked, unknown.known
        ))
    })?;
    say(&wgsl)
}
