//! Mesh files that differ from tidy ones: the ways that real files do, and damage on top.
//!
//! A number gives the same file every time. The file may be sound, odd or broken; a reader has to
//! return a mesh or an error for each.

mod damage;
mod gltf;
mod obj;
mod off;
mod ply;
mod random;
mod shape;
mod stl;

use random::Random;
use shape::Shape;

/// The extensions that [`files`] knows.
pub const FORMATS: [&str; 6] = ["obj", "ply", "off", "stl", "glb", "gltf"];

/// A file by its name.
pub type File = (String, Vec<u8>);

/// The files of mutation `seed` in a format of [`FORMATS`]: the mesh, called `mesh` with the
/// format's extension, and what lies beside it.
///
/// # Panics
/// If the format is not one of [`FORMATS`].
pub fn files(format: &str, seed: u64) -> Vec<File> {
    let mut random = Random::new(format, seed);
    let mut shape = Shape::any(&mut random);
    if random.chance(3) {
        shape.spoil(&mut random);
    }
    let (mut bytes, beside) = match format {
        "obj" => obj::write(&shape, &mut random),
        "ply" => (ply::write(&shape, &mut random), vec![]),
        "off" => (off::write(&shape, &mut random), vec![]),
        "stl" => (stl::write(&shape, &mut random), vec![]),
        "glb" => (gltf::write_binary(&shape, &mut random), vec![]),
        "gltf" => (gltf::write_text(&shape, &mut random), vec![]),
        _ => panic!("no format is called {format}"),
    };
    if random.chance(4) {
        damage::apply(&mut bytes, &mut random);
    }
    let mut files = vec![(format!("mesh.{format}"), bytes)];
    files.extend(beside);
    files
}

#[cfg(test)]
mod tests {
    use super::{FORMATS, files};

    #[test]
    fn a_number_gives_the_same_files_and_another_number_others() {
        for format in FORMATS {
            assert_eq!(files(format, 7), files(format, 7));
            let different = (0..20).filter(|&seed| files(format, seed) != files(format, seed + 1));
            assert!(different.count() > 15, "{format}");
        }
    }
}
