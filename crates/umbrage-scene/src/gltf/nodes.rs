//! The node tree: which nodes are drawn, and where in the world each node is.

use super::document::label;
use glam::{DMat4, DQuat, DVec3, Mat4};
use gltf::json;

/// Nodes in the world.
pub(super) struct Tree {
    /// World from node, for every node of the file: joints may lie outside the scene.
    pub(super) world: Vec<Mat4>,
    /// The scene's nodes, parents before children, each once.
    pub(super) drawn: Vec<usize>,
}

/// Walks the tree. References have been checked.
pub(super) fn walk(root: &json::Root, warnings: &mut Vec<String>) -> Result<Tree, String> {
    let parents = parents(root)?;
    let world = world(root, &parents, warnings)?;
    let tops: Vec<usize> =
        match root.scene.map(|scene| scene.value()).or((!root.scenes.is_empty()).then_some(0)) {
            Some(scene) => root.scenes[scene].nodes.iter().map(|node| node.value()).collect(),
            // A file without scenes is a library; all of it is shown.
            None => (0..root.nodes.len()).filter(|node| parents[*node].is_none()).collect(),
        };
    let mut seen = vec![false; root.nodes.len()];
    let mut drawn = Vec::new();
    let mut open: Vec<usize> = tops.into_iter().rev().collect();
    while let Some(node) = open.pop() {
        if std::mem::replace(&mut seen[node], true) || hidden(&root.nodes[node]) {
            continue;
        }
        drawn.push(node);
        open.extend(root.nodes[node].children.iter().flatten().rev().map(|child| child.value()));
    }
    Ok(Tree { world, drawn })
}

fn name(root: &json::Root, node: usize) -> String {
    label("node", node, root.nodes[node].name.as_ref())
}

/// KHR_node_visibility: such a node is not drawn, nor is what hangs on it.
fn hidden(node: &json::Node) -> bool {
    let visibility = node.extensions.as_ref().and_then(|e| e.others.get("KHR_node_visibility"));
    visibility.and_then(|v| v.get("visible")).and_then(serde_json::Value::as_bool) == Some(false)
}

/// Each node's parent. A node with two is no tree, and a tree is what makes the walk end.
fn parents(root: &json::Root) -> Result<Vec<Option<usize>>, String> {
    let mut parents = vec![None; root.nodes.len()];
    for (parent, node) in root.nodes.iter().enumerate() {
        for child in node.children.iter().flatten().map(|child| child.value()) {
            if let Some(other) = parents[child].replace(parent) {
                let (child, parent, other) = (name(root, child), name(root, parent), name(root, other));
                return Err(format!(
                    "{child} is a child of {parent} and again of {other}; export the file again"
                ));
            }
        }
    }
    Ok(parents)
}

fn world(
    root: &json::Root,
    parents: &[Option<usize>],
    warnings: &mut Vec<String>,
) -> Result<Vec<Mat4>, String> {
    // In 64 bits, so that deep trees with large offsets lose nothing before the end.
    let mut world: Vec<Option<DMat4>> = vec![None; root.nodes.len()];
    let mut open: Vec<usize> = (0..root.nodes.len()).filter(|node| parents[*node].is_none()).collect();
    while let Some(node) = open.pop() {
        let local = local(root, node, warnings)?;
        let parent = parents[node].and_then(|parent| world[parent]).unwrap_or(DMat4::IDENTITY);
        world[node] = Some(parent * local);
        open.extend(root.nodes[node].children.iter().flatten().map(|child| child.value()));
    }
    let mut narrow = Vec::with_capacity(world.len());
    for (node, matrix) in world.into_iter().enumerate() {
        // What hangs on no top node hangs on itself.
        let Some(matrix) = matrix else {
            return Err(format!("{} is its own ancestor; export the file again", name(root, node)));
        };
        let matrix = matrix.as_mat4();
        if !matrix.is_finite() {
            return Err(format!("the place of {} is not finite; correct its transform", name(root, node)));
        }
        narrow.push(matrix);
    }
    Ok(narrow)
}

fn local(root: &json::Root, node: usize, warnings: &mut Vec<String>) -> Result<DMat4, String> {
    let json = &root.nodes[node];
    let scale = json.scale.unwrap_or([1.0; 3]).map(f64::from);
    let rotation = json.rotation.map_or([0.0, 0.0, 0.0, 1.0], |r| r.0.map(f64::from));
    let translation = json.translation.unwrap_or_default().map(f64::from);
    let parts = json.scale.is_some() || json.rotation.is_some() || json.translation.is_some();
    let matrix = match json.matrix {
        Some(matrix) => {
            if parts {
                warnings
                    .push(format!("{} has a matrix and parts beside it; the matrix holds", name(root, node)));
            }
            let mut matrix = DMat4::from_cols_array(&matrix.map(f64::from));
            let last = matrix.row(3);
            if (last - DVec3::ZERO.extend(1.0)).abs().max_element() > 1e-4 {
                return Err(format!(
                    "the matrix of {} is not affine: its last row is {last}",
                    name(root, node)
                ));
            }
            for (column, value) in [(0, 0.0), (1, 0.0), (2, 0.0), (3, 1.0)] {
                matrix.col_mut(column).w = value;
            }
            matrix
        }
        None => {
            let rotation = DQuat::from_array(rotation);
            // Exporters round; a quaternion without length turns nothing.
            let rotation =
                if rotation.length_squared() > 0.0 { rotation.normalize() } else { DQuat::IDENTITY };
            DMat4::from_scale_rotation_translation(DVec3::from(scale), rotation, DVec3::from(translation))
        }
    };
    if matrix.is_finite() {
        return Ok(matrix);
    }
    Err(format!("the transform of {} is not finite; correct it", name(root, node)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(nodes: &str, rest: &str) -> Result<Tree, String> {
        let text = format!(r#"{{"asset":{{"version":"2.0"}},"nodes":{nodes}{rest}}}"#);
        walk(&serde_json::from_str(&text).unwrap(), &mut vec![])
    }

    #[test]
    fn transforms_multiply_down_the_tree() {
        let tree = parse(r#"[{"children":[1],"scale":[2,2,2]},{"translation":[1,0,0]}]"#, "").unwrap();
        assert_eq!(tree.world[1].transform_point3(glam::Vec3::X), glam::Vec3::X * 4.0);
        assert_eq!(tree.drawn, [0, 1]);
    }

    #[test]
    fn loops_and_second_parents_are_named() {
        for (nodes, word) in [
            (r#"[{"children":[0]}]"#, "ancestor"),
            (r#"[{"children":[1]},{"children":[0]}]"#, "ancestor"),
            (r#"[{"children":[2]},{"children":[2]},{}]"#, "again of"),
            (r#"[{"children":[1,1]},{}]"#, "again of"),
            (r#"[{"scale":[1e39,1,1]}]"#, "not finite"),
            (r#"[{"matrix":[1,0,0,9,0,1,0,0,0,0,1,0,0,0,0,1]}]"#, "not affine"),
        ] {
            let message = parse(nodes, "").err().expect(word);
            assert!(message.contains(word), "{word}: {message}");
        }
    }

    #[test]
    fn the_default_scene_is_drawn_and_hidden_nodes_are_not() {
        let nodes = r#"[{},{"children":[2]},{"extensions":{"KHR_node_visibility":{"visible":false}}}]"#;
        let scenes = r#","scenes":[{"nodes":[0]},{"nodes":[1]}]"#;
        assert_eq!(parse(nodes, scenes).unwrap().drawn, [0]);
        assert_eq!(parse(nodes, &format!("{scenes},\"scene\":1")).unwrap().drawn, [1]);
        assert_eq!(parse(nodes, "").unwrap().drawn, [0, 1]);
    }

    #[test]
    fn a_chain_of_a_hundred_thousand_nodes_needs_no_stack() {
        let count = 100_000;
        let nodes: Vec<String> = (1..count).map(|i| format!(r#"{{"children":[{i}]}}"#)).collect();
        let tree = parse(&format!("[{},{{}}]", nodes.join(",")), "").unwrap();
        assert_eq!(tree.drawn.len(), count);
    }
}
