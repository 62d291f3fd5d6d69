//! Functions that several tests of I-frames share.

use kn_bitstream::{BitReader, BitWriter, IntraPayload, Level};
use kn_codec::intra::{IntraDecoder, IntraEncoding, IntraError, IntraLimits, decode_intra};
use kn_mesh::GridMesh;

/// The bytes of a coded mesh.
pub(crate) fn bytes_of(encoding: &IntraEncoding) -> Vec<u8> {
    let mut bits = BitWriter::new();
    encoding.payload().write(&mut bits);
    bits.into_bytes()
}

/// Reads and decodes the bytes of a payload in a stream of the highest level.
pub(crate) fn decode_bytes(bytes: &[u8], limits: &IntraLimits) -> Result<GridMesh, IntraError> {
    let level = Level::all().last().expect("there are levels").1;
    let payload = IntraPayload::read(&mut BitReader::new(bytes), bytes.len() as u32, &level)
        .map_err(|error| IntraError::Malformed { rule: error.rule().expect("no limits"), at: 0 })?;
    let mut mesh = GridMesh::default();
    decode_intra(&payload, limits, &mut IntraDecoder::default(), &mut mesh).map(|()| mesh)
}

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
