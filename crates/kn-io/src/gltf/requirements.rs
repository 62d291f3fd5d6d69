//! What a file asks of its reader: the version of glTF, and extensions.

use super::super::{Fault, MeshErrorKind};
use super::json::{Extensions, Primitive, Root};
use serde_json::Value;

/// Compression that is not read.
const DRACO: &str = "KHR_draco_mesh_compression";

/// Extensions of the objects that hold geometry which are read.
const READ: [&str; 6] = [
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
    "KHR_animation_pointer",
    "KHR_mesh_quantization",
    "KHR_node_visibility",
];

/// Extensions that leave the shape as it is, by the start of their names: materials, textures,
/// lights, sound, physics, notes about a thing and the avatars of VRM.
const HARMLESS: [&str; 31] = [
    "ADOBE_materials_",
    "AGI_",
    "CESIUM_primitive_outline",
    "EXT_feature_metadata",
    "EXT_instance_features",
    "EXT_lights_",
    "EXT_materials_",
    "EXT_mesh_features",
    "EXT_mesh_manifold",
    "EXT_mesh_primitive_edge_visibility",
    "EXT_structural_metadata",
    "EXT_texture_",
    "FB_geometry_metadata",
    "KHR_audio",
    "KHR_collision_shapes",
    "KHR_implicit_shapes",
    "KHR_interactivity",
    "KHR_lights_",
    "KHR_materials_",
    "KHR_node_hoverability",
    "KHR_node_selectability",
    "KHR_physics_",
    "KHR_techniques_webgl",
    "KHR_texture_",
    "KHR_xmp",
    "MSFT_audio_",
    "MSFT_lod",
    "MSFT_packing_",
    "MSFT_texture_",
    "OMI_",
    "VRM",
];

/// Checks that glTF 2.0 is enough to read the file.
///
/// # Errors
/// The file is glTF 1.0, or needs a later version than 2.0.
pub(super) fn check_version(tree: &Value) -> Result<(), Fault> {
    let number = |name: &str| match &tree["asset"][name] {
        Value::String(text) => Some(text.clone()),
        Value::Number(number) => Some(number.to_string()),
        _ => None,
    };
    let parts = |text: &String| {
        let (major, minor) = text.split_once('.').unwrap_or((text, "0"));
        Some((major.trim().parse::<u32>().ok()?, minor.trim().parse::<u32>().ok()?))
    };
    let version = number("version").as_ref().and_then(parts);
    // Version 1 has named objects where version 2 has lists.
    let old = version.map_or(tree["meshes"].is_object(), |(major, _)| major < 2);
    if old {
        return Err(MeshErrorKind::Unsupported(GLTF_1.into()).into());
    }
    let least = number("minVersion").as_ref().and_then(parts);
    let needed = least.or(version.filter(|(major, _)| *major > 2));
    if let Some((major, minor)) = needed.filter(|needed| *needed > (2, 0)) {
        let what = format!("the file needs glTF version {major}.{minor}, and 2.0 is read");
        return Err(MeshErrorKind::Unsupported(what).into());
    }
    Ok(())
}

/// What is said about files of version 1.
pub(super) const GLTF_1: &str = "the file is glTF 1.0, and 2.0 is read: convert it, for instance with gltf-pipeline -i IN -o OUT";

/// Checks that the required extensions are read, or have nothing to do with the shape.
///
/// An extension of another name is harmless where it is used, but by no object that holds geometry:
/// nodes, meshes, skins, animations, accessors and buffers.
///
/// # Errors
/// One is neither.
pub(super) fn check_extensions(tree: &Value) -> Result<(), Fault> {
    let required = tree["extensionsRequired"].as_array().into_iter().flatten();
    for name in required.filter_map(Value::as_str) {
        if name == DRACO {
            return Err(draco());
        }
        let known = READ.contains(&name) || HARMLESS.iter().any(|start| name.starts_with(start));
        let harmless = || uses(tree, name) && GEOMETRY.iter().all(|list| !uses(&tree[list], name));
        if !known && !harmless() {
            let what = format!("the file requires the glTF extension {}", name.escape_debug());
            return Err(MeshErrorKind::Unsupported(what).into());
        }
    }
    Ok(())
}

/// The lists of the objects that hold geometry.
const GEOMETRY: [&str; 7] =
    ["accessors", "animations", "bufferViews", "buffers", "meshes", "nodes", "skins"];

/// Whether an object in the tree has this extension.
fn uses(tree: &Value, name: &str) -> bool {
    match tree {
        Value::Object(members) => members.iter().any(|(key, value)| match key.as_str() {
            "extras" => false,
            "extensions" if value.get(name).is_some() => true,
            _ => uses(value, name),
        }),
        Value::Array(items) => items.iter().any(|item| uses(item, name)),
        _ => false,
    }
}

/// Checks that a primitive has its data, and not only in a compressed form that is not read.
///
/// # Errors
/// It has not.
pub(super) fn check_primitive(root: &Root, primitive: &Primitive) -> Result<(), Fault> {
    let accessors = primitive.attributes.get("POSITION").into_iter().chain(&primitive.indices);
    let bare = |index: &usize| {
        root.accessors.get(*index).is_some_and(|accessor| accessor.buffer_view.is_none())
    };
    if has(&primitive.extensions, DRACO) && accessors.into_iter().any(bare) {
        return Err(draco());
    }
    Ok(())
}

/// Whether an object has an extension.
pub(super) fn has(extensions: &Extensions, name: &str) -> bool {
    extensions.contains_key(name)
}

fn draco() -> Fault {
    let what = format!(
        "the file is compressed with the glTF extension {DRACO}, which is not read: decompress it, \
         for instance with gltf-transform copy IN OUT"
    );
    MeshErrorKind::Unsupported(what).into()
}

/// Whether a node is drawn, as far as it says so itself.
pub(super) fn visible(extensions: &Extensions) -> bool {
    let visible = extensions.get("KHR_node_visibility").and_then(|object| object.get("visible"));
    visible != Some(&Value::Bool(false))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;
    use std::path::Path;

    #[test]
    fn versions_beyond_2_0_are_named() {
        let said = |asset: Value| {
            let fault = check_version(&json!({ "asset": asset })).err();
            fault.map_or(String::new(), |fault| fault.at(Path::new("a.glb")).to_string())
        };
        for taken in [
            json!({}),
            json!({ "version": "2.0" }),
            json!({ "version": 2 }),
            json!({ "version": "2.3", "minVersion": "2.0" }),
            json!({ "version": "2.1" }),
            json!({ "version": "2.0", "minVersion": "1.0" }),
        ] {
            assert_eq!(said(taken), "");
        }
        assert!(said(json!({ "version": "1.0" })).contains("glTF 1.0"));
        assert!(said(json!({ "version": "2.1", "minVersion": "2.1" })).contains("version 2.1"));
        assert!(said(json!({ "version": "3.0" })).contains("version 3.0"));
        let named = json!({ "meshes": { "it": {} } });
        assert!(check_version(&named).is_err());
    }

    #[test]
    fn extensions_matter_where_they_are_used_by_geometry() {
        let taken = |name: &str, mut tree: Value| {
            tree["extensionsRequired"] = json!([name]);
            check_extensions(&tree).is_ok()
        };
        let used = json!({ "extensions": { "X_y": {} } });
        for list in ["materials", "textures", "images", "cameras", "scenes"] {
            assert!(taken("X_y", json!({ list: [used] })), "{list}");
        }
        for list in GEOMETRY {
            assert!(!taken("X_y", json!({ list: [used] })), "{list}");
        }
        assert!(!taken("X_y", json!({ "meshes": [{ "primitives": [used] }] })));
        assert!(taken("X_y", used.clone()));
        assert!(!taken("X_y", json!({ "extras": used })), "it is used nowhere");
        assert!(taken("KHR_materials_unlit", json!({})) && taken("VRMC_vrm", json!({})));
        assert!(!taken(DRACO, json!({})));
    }
}
