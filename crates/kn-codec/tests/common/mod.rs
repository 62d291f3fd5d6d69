//! What several tests of I-frames need.

/// A payload whose header announces so many vertices and faces, then zeros.
pub(crate) fn announcing(vertices: u32, faces: u32, len: usize) -> Vec<u8> {
    let mut bytes = vec![0, 0];
    for mut count in [vertices, vertices, faces, faces, 0, 0, 0, 0, 0] {
        while count >= 0x80 {
            bytes.push(count as u8 | 0x80);
            count >>= 7;
        }
        bytes.push(count as u8);
    }
    bytes.resize(len, 0);
    bytes
}
