//! Digests of decoded frames: short ones for streams, long ones for conformance.

use sha2::{Digest, Sha256};

/// Short digest of positions in reference units (`#V × 3`; `frame.digest.positions`).
pub fn positions_digest(positions: &[[i32; 3]]) -> u64 {
    let mut hash = counted(positions.len());
    update_positions(&mut hash, positions);
    truncate(hash)
}

/// Short digest of faces (`#F × 3`; `intra.digest.faces`).
pub fn faces_digest(faces: &[[u32; 3]]) -> u64 {
    let mut hash = counted(faces.len());
    update_faces(&mut hash, faces);
    truncate(hash)
}

/// SHA-256 of a whole frame in lower-case hexadecimal digits: #V, #F, positions and faces as 32-bit
/// little-endian integers (`conformance.frame.sha256`).
pub fn frame_sha256(positions: &[[i32; 3]], faces: &[[u32; 3]]) -> String {
    let mut hash = counted(positions.len());
    hash.update((faces.len() as u32).to_le_bytes());
    update_positions(&mut hash, positions);
    update_faces(&mut hash, faces);
    hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Begins a hash with a number of elements.
fn counted(elements: usize) -> Sha256 {
    Sha256::new().chain_update((elements as u32).to_le_bytes())
}

fn update_positions(hash: &mut Sha256, positions: &[[i32; 3]]) {
    for value in positions.as_flattened() {
        hash.update(value.to_le_bytes());
    }
}

fn update_faces(hash: &mut Sha256, faces: &[[u32; 3]]) {
    for value in faces.as_flattened() {
        hash.update(value.to_le_bytes());
    }
}

/// The first 8 bytes as a big-endian number.
fn truncate(hash: Sha256) -> u64 {
    let bytes = hash.finalize();
    bytes.iter().take(8).fold(0, |value, &byte| value << 8 | u64::from(byte))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digests_are_frozen() {
        // Values of an independent SHA-256 over the little-endian bytes.
        assert_eq!(positions_digest(&[[1, -1, 2]]), 0xcbb1_2c2e_fda2_ed27);
        assert_eq!(faces_digest(&[[0, 1, 2]]), 0xe918_28e2_1b5a_9eef);
        let empty = "af5570f5a1810b7af78caf4bc70a660f0df51e42baf91d4de5b2328de0e83dfc";
        assert_eq!(frame_sha256(&[], &[]), empty);
    }
}
