//! The copies of a mesh that one node draws (EXT_mesh_gpu_instancing).

use super::super::Fault;
use super::accessor::{Accessor, Budget, Document};
use super::json::{self, Node};
use super::{bad, nodes};
use glam::{DMat4, DQuat, DVec3};
use serde::Deserialize;
use std::collections::BTreeMap;

/// The extension's object.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct Instancing {
    attributes: BTreeMap<String, usize>,
}

/// The places of the copies relative to the node: one, the node's own, where it has no copies.
///
/// # Errors
/// An attribute has not one element for each copy.
pub(super) fn load(
    document: &Document,
    node: &Node,
    budget: &mut Budget,
) -> Result<Vec<DMat4>, Fault> {
    let Some(object) = node.extensions.get("EXT_mesh_gpu_instancing") else {
        return Ok(vec![DMat4::IDENTITY]);
    };
    let Instancing { attributes } = json::structure(object.clone())?;
    let mut read = |name: &str, width: usize| -> Result<Option<Vec<f64>>, Fault> {
        let Some(&at) = attributes.get(name) else { return Ok(None) };
        Ok(Some(Accessor::open_wide(document, at, width, budget)?.read(document)))
    };
    let translations = read("TRANSLATION", 3)?;
    let rotations = read("ROTATION", 4)?;
    let scales = read("SCALE", 3)?;
    let lengths = [(&translations, 3), (&rotations, 4), (&scales, 3)];
    let mut counts = lengths.iter().filter_map(|(list, width)| Some(list.as_ref()?.len() / width));
    let Some(count) = counts.next() else { return Ok(vec![DMat4::IDENTITY]) };
    if counts.any(|other| other != count) {
        return Err(bad("an instanced node has not one place for each instance"));
    }
    let row = |list: &Option<Vec<f64>>, at: usize, width: usize| {
        list.as_ref().map(|list| list[at * width..][..width].to_vec())
    };
    let place = |at: usize| {
        let translation = row(&translations, at, 3).map_or(DVec3::ZERO, |v| DVec3::from_slice(&v));
        let scale = row(&scales, at, 3).map_or(DVec3::ONE, |v| DVec3::from_slice(&v));
        let rotation = row(&rotations, at, 4).map_or(DQuat::IDENTITY, |v| DQuat::from_slice(&v));
        DMat4::from_scale_rotation_translation(scale, nodes::unit(rotation), translation)
    };
    Ok((0..count).map(place).collect())
}
