//! STAND-IN, not to be committed.
use crate::error::{DecodeError, DecodeErrorKind};
use kn_mesh::GridMesh;
#[derive(Debug, Default)]
pub struct IntraDecoder;
pub struct IntraLimits {
    pub max_vertices: u32,
    pub max_faces: u32,
}
#[derive(Debug)]
pub struct IntraError;
impl IntraError {
    pub(crate) fn to_decode_error(&self, at: u64, frame: u64) -> DecodeError {
        DecodeErrorKind::Malformed { rule: "intra", at, frame: Some(frame) }.into()
    }
}
pub struct IntraEncoding {
    pub vertex_map: Vec<u32>,
}
pub fn encode_intra(mesh: &GridMesh, out: &mut Vec<u8>) -> Result<IntraEncoding, IntraError> {
    out.extend((mesh.positions.len() as u32).to_le_bytes());
    out.extend((mesh.faces.len() as u32).to_le_bytes());
    out.extend((mesh.labels.len() as u32).to_le_bytes());
    for v in mesh.positions.as_flattened() {
        out.extend(v.to_le_bytes());
    }
    for v in mesh.faces.as_flattened() {
        out.extend(v.to_le_bytes());
    }
    out.extend(&mesh.labels);
    Ok(IntraEncoding { vertex_map: (0..mesh.positions.len() as u32).collect() })
}
pub fn decode_intra(
    b: &[u8],
    _l: &IntraLimits,
    _d: &mut IntraDecoder,
    m: &mut GridMesh,
) -> Result<(), IntraError> {
    m.clear();
    let w = |i: usize| -> Result<u32, IntraError> {
        Ok(u32::from_le_bytes(b.get(4 * i..4 * i + 4).ok_or(IntraError)?.try_into().unwrap()))
    };
    let (v, f, l) = (w(0)? as usize, w(1)? as usize, w(2)? as usize);
    for i in 0..v {
        m.positions.push([w(3 + 3 * i)? as i32, w(4 + 3 * i)? as i32, w(5 + 3 * i)? as i32]);
    }
    for i in 0..f {
        let k = 3 + 3 * v + 3 * i;
        m.faces.push([w(k)?, w(k + 1)?, w(k + 2)?]);
    }
    m.labels.extend_from_slice(b.get(4 * (3 + 3 * v + 3 * f)..).ok_or(IntraError)?);
    let _ = l;
    Ok(())
}
impl std::fmt::Display for IntraError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("x")
    }
}
