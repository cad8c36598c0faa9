//! Roles of a node's mesh, from its extras: `"extras": {"umbrage": {"blocker": false, "receiver": false}}`.
//!
//! They are the node's own: children do not inherit them, as they inherit none of the mesh that they belong to. All places of
//! `EXT_mesh_gpu_instancing` have the roles of their node.

use super::document::Document;
use crate::Roles;
use serde_json::Value;

/// The roles of a node. What is not said, or is not understood, is as usual; the latter with a warning.
pub(super) fn read(document: &Document<'_>, node: usize, warnings: &mut Vec<String>) -> Roles {
    let mut roles = Roles::default();
    let Some(extras) = document.root.nodes[node].extras.as_ref() else { return roles };
    // Extras are anybody's. Only what is meant for Umbrage is looked at.
    let Ok(Value::Object(extras)) = serde_json::from_str(extras.get()) else { return roles };
    let Some(own) = extras.get("umbrage") else { return roles };
    let mut warn = |what: String| {
        warnings.push(format!("{}, extras.umbrage: {what}", document.node_label(node)));
    };
    let Value::Object(own) = own else {
        warn("it is no object of `blocker` and `receiver`, and is passed over".into());
        return roles;
    };
    for (name, value) in own {
        let role = match name.as_str() {
            "blocker" => &mut roles.blocker,
            "receiver" => &mut roles.receiver,
            _ => {
                let name: String = name.chars().take(40).flat_map(char::escape_debug).collect();
                warn(format!("`{name}` is passed over; `blocker` and `receiver` are known"));
                continue;
            }
        };
        match value {
            Value::Bool(value) => *role = *value,
            _ => warn(format!("`{name}` is neither true nor false, and is taken for true")),
        }
    }
    roles
}
