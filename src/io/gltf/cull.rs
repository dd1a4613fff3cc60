//! Primitives of an original that lose all their faces, and what goes with them.
//!
//! A primitive must have a triangle and a mesh a primitive; nodes stay, so that the scene's placement and
//! animations do. What only they used goes too.

use super::draft::Draft;
use super::references::{Kind, Object, counts, index};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// Takes out primitives, given by mesh and place in it.
pub(super) fn cull(draft: &mut Draft<'_>, primitives: &[(usize, usize)]) {
    if primitives.is_empty() {
        return;
    }
    // From what refers to what is referred to.
    let kinds = [Kind::Material, Kind::Texture, Kind::Image, Kind::Sampler, Kind::Accessor];
    let before = kinds.map(|kind| counts(&mut draft.root, kind));
    let mut gone: BTreeMap<usize, BTreeSet<usize>> = BTreeMap::new();
    for &(mesh, primitive) in primitives {
        gone.entry(mesh).or_default().insert(primitive);
    }
    let mut empty = BTreeSet::new();
    for (mesh, gone) in gone {
        let Some(Value::Array(list)) = draft.list("meshes").get_mut(mesh).and_then(|m| m.get_mut("primitives")) else {
            continue;
        };
        let mut place = 0..;
        list.retain(|_| place.next().is_some_and(|place| !gone.contains(&place)));
        if list.is_empty() {
            empty.insert(mesh);
        }
    }
    clear_nodes(&mut draft.root, &empty);
    drop_members(&mut draft.root, "meshes", "mesh", &empty);
    drop_unused_skins(&mut draft.root);
    for (kind, before) in kinds.into_iter().zip(before) {
        let after = counts(&mut draft.root, kind);
        draft.free(kind, (0..before.len()).filter(|&i| before[i] > 0 && after[i] == 0));
    }
}

/// Takes the meshes off their nodes, and what may only stand beside a mesh.
fn clear_nodes(root: &mut Object, meshes: &BTreeSet<usize>) {
    let mut cleared = BTreeSet::new();
    for (n, node) in members(root, "nodes").enumerate() {
        let Some(node) = node.as_object_mut() else { continue };
        if node.get("mesh").and_then(index).is_some_and(|mesh| meshes.contains(&mesh)) {
            ["mesh", "skin", "weights"].iter().for_each(|key| _ = node.remove(*key));
            cleared.insert(n);
        }
    }
    let moves_cleared = |channel: &Value| {
        let target = channel.get("target");
        let node = target.and_then(|target| index(target.get("node")?));
        node.is_some_and(|node| cleared.contains(&node))
            && target.and_then(|target| target.get("path")).is_some_and(|path| path == "weights")
    };
    for animation in members(root, "animations") {
        let Some(Value::Array(channels)) = animation.get_mut("channels") else { continue };
        channels.retain(|channel| !moves_cleared(channel));
    }
    if let Some(Value::Array(animations)) = root.get_mut("animations") {
        animations
            .retain(|animation| animation.get("channels").and_then(Value::as_array).is_none_or(|c| !c.is_empty()));
        if animations.is_empty() {
            root.remove("animations");
        }
    }
}

fn drop_unused_skins(root: &mut Object) {
    let used: BTreeSet<usize> = members(root, "nodes").filter_map(|node| index(node.get("skin")?)).collect();
    let unused = (0..members(root, "skins").count()).filter(|skin| !used.contains(skin)).collect();
    drop_members(root, "skins", "skin", &unused);
}

/// Takes members out of a list that only nodes refer to.
fn drop_members(root: &mut Object, list: &str, key: &str, gone: &BTreeSet<usize>) {
    if gone.is_empty() {
        return;
    }
    for node in members(root, "nodes") {
        if let Some(reference) = node.get_mut(key)
            && let Some(old) = index(reference)
        {
            *reference = (old - gone.range(..old).count()).into();
        }
    }
    let Some(Value::Array(all)) = root.get_mut(list) else { return };
    let mut place = 0..;
    all.retain(|_| place.next().is_some_and(|place| !gone.contains(&place)));
    if all.is_empty() {
        root.remove(list);
    }
}

fn members<'r>(root: &'r mut Object, list: &str) -> impl Iterator<Item = &'r mut Value> {
    root.get_mut(list).and_then(Value::as_array_mut).into_iter().flatten()
}
