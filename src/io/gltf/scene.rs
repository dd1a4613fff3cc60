//! Nodes: where a document places its meshes.

use crate::error::ParseError;
use crate::soup::{Node, Note, Scene, Transform};
use gltf_json::Index;
use serde::Deserialize;

/// The nodes of a scene; the specification allows a scene without.
#[derive(Deserialize)]
pub(super) struct SceneRoots {
    #[serde(default)]
    nodes: Vec<usize>,
}

/// The nodes and where the default scene begins.
///
/// `bodies` has the body of each mesh, where it has one.
pub(super) fn read_scene(
    given: &[gltf_json::Node],
    scenes: &[SceneRoots],
    default: Option<usize>,
    bodies: &[Option<usize>],
    notes: &mut Vec<Note>,
) -> Result<Scene, ParseError> {
    let count = given.len();
    let mut nodes = Vec::with_capacity(count);
    let mut parents: Vec<Option<usize>> = vec![None; count];
    for (i, node) in given.iter().enumerate() {
        let body = match node.mesh {
            None => None,
            Some(mesh) => *bodies.get(mesh.value()).ok_or_else(|| {
                let what = format!("there is no mesh {mesh} among {}", bodies.len());
                ParseError::json(format!("nodes[{i}].mesh"), what)
            })?,
        };
        let children: Vec<usize> = node.children.iter().flatten().map(Index::value).collect();
        for (c, &child) in children.iter().enumerate() {
            let path = || format!("nodes[{i}].children[{c}]");
            match parents.get_mut(child) {
                None => return Err(ParseError::json(path(), format!("there is no node {child} among {count}"))),
                Some(Some(other)) => {
                    return Err(ParseError::json(path(), format!("node {child} is already a child of node {other}")));
                }
                Some(parent) => *parent = Some(i),
            }
        }
        let transform = match node.matrix {
            Some(matrix) => Transform::Matrix(matrix),
            None => Transform::Parts {
                translation: node.translation,
                rotation: node.rotation.map(|rotation| rotation.0),
                scale: node.scale,
            },
        };
        nodes.push(Node { name: node.name.clone().unwrap_or_default(), transform, body, children });
    }
    let tops: Vec<usize> = (0..count).filter(|&node| parents[node].is_none()).collect();
    let listed = listed_roots(scenes, default, count)?;

    // From the top down, with a stack of our own: every node is met once, or it hangs on a cycle.
    let mut met = vec![false; count];
    let mut placed_by_parent = vec![false; count];
    let mut stack = tops.clone();
    while let Some(node) = stack.pop() {
        met[node] = true;
        for &child in &nodes[node].children {
            placed_by_parent[child] = placed_by_parent[node] || listed.as_ref().is_some_and(|l| l.is_root[node]);
            stack.push(child);
        }
    }
    if let Some(node) = met.iter().position(|met| !met) {
        // One with a parent always has one that is not met either: going up ends in the cycle.
        let inside = (0..count).fold(node, |node, _| parents[node].unwrap_or(node));
        return Err(ParseError::json(format!("nodes[{inside}].children"), "the node is a descendant of itself"));
    }
    let roots = match listed {
        None => tops,
        Some(listed) => {
            let (dropped, roots): (Vec<_>, Vec<_>) = listed.order.into_iter().partition(|&node| placed_by_parent[node]);
            if let Some(first) = dropped.first() {
                let message = format!(
                    "the scene lists children of its nodes as roots, node {first} first; they were placed once"
                );
                notes.push(Note::repaired(message));
            }
            roots
        }
    };
    Ok(Scene { nodes, roots, ..Scene::default() })
}

/// The nodes that the default scene lists, each once.
struct Listed {
    order: Vec<usize>,
    is_root: Vec<bool>,
}

fn listed_roots(scenes: &[SceneRoots], default: Option<usize>, count: usize) -> Result<Option<Listed>, ParseError> {
    let index = default.unwrap_or(0);
    let Some(scene) = scenes.get(index) else {
        if default.is_some() {
            let what = format!("there is no scene {index} among {}", scenes.len());
            return Err(ParseError::json("scene", what));
        }
        return Ok(None);
    };
    let mut listed = Listed { order: Vec::with_capacity(scene.nodes.len()), is_root: vec![false; count] };
    for (r, &root) in scene.nodes.iter().enumerate() {
        let Some(is_root) = listed.is_root.get_mut(root) else {
            let what = format!("there is no node {root} among {count}");
            return Err(ParseError::json(format!("scenes[{index}].nodes[{r}]"), what));
        };
        if !std::mem::replace(is_root, true) {
            listed.order.push(root);
        }
    }
    Ok(Some(listed))
}

#[cfg(test)]
mod tests {
    use super::super::read::tests::{error_of, read_glb};
    use serde_json::{Value, json};

    #[test]
    fn a_node_has_one_parent_and_no_cycle() {
        for (nodes, path) in [
            (json!([{ "children": [0] }]), "nodes[0].children: "),
            (json!([{}, { "children": [3] }, { "children": [1] }, { "children": [2, 4] }, {}]), "nodes["),
            (json!([{ "children": [2] }, { "children": [2] }, {}]), "nodes[1].children[0]: "),
            (json!([{ "children": [1, 1] }, {}]), "nodes[0].children[1]: "),
        ] {
            let error = error_of(&[0, 1, 2], &json!({ "nodes": nodes }));
            assert!(error.starts_with(path), "{error}");
        }
    }

    #[test]
    fn the_default_scene_gives_the_roots() {
        let roots = |parts: &Value| {
            let soup = read_glb(&[0, 1, 2], parts).expect("readable");
            (soup.scene.expect("always").roots, soup.notes.len())
        };
        let nodes = json!([{ "children": [1] }, {}, {}]);
        assert_eq!(roots(&json!({ "nodes": nodes })), (vec![0, 2], 0));
        assert_eq!(roots(&json!({ "nodes": nodes, "scenes": [{ "nodes": [2] }, { "nodes": [0] }] })), (vec![2], 0));
        assert_eq!(
            roots(&json!({ "nodes": nodes, "scene": 1, "scenes": [{ "nodes": [2] }, { "nodes": [0] }] })),
            (vec![0], 0)
        );
        assert_eq!(roots(&json!({ "nodes": nodes, "scenes": [{ "name": "empty" }] })), (vec![], 0));
        assert_eq!(roots(&json!({ "nodes": nodes, "scenes": [{ "nodes": [1] }] })), (vec![1], 0));
        assert_eq!(roots(&json!({ "nodes": nodes, "scenes": [{ "nodes": [1, 2, 0] }] })), (vec![2, 0], 1));
    }

    #[test]
    fn a_chain_of_many_nodes_does_not_exhaust_the_stack() {
        let count = 100_000;
        let nodes: Vec<Value> = (1..=count)
            .map(|next| if next < count { json!({ "children": [next] }) } else { json!({ "mesh": 0 }) })
            .collect();
        let soup = read_glb(&[0, 1, 2], &json!({ "nodes": nodes })).expect("readable");
        assert_eq!(soup.scene.expect("always").roots, [0]);
        let mut nodes = nodes;
        nodes[count - 1] = json!({ "children": [0] });
        assert!(error_of(&[0, 1, 2], &json!({ "nodes": nodes })).contains("descendant of itself"));
    }
}
