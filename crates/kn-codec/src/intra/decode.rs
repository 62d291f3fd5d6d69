//! Decoding of a payload into a mesh.

use super::IntraError;
use super::conquest::{Conquest, HalfEdge, NONE, Symbol};
use super::geometry::{GeometryModels, code_positions};
use super::joins::{code_joins, code_raw_faces, number_vertices};
use super::labels::{LabelModels, LabelTraversal, code_labels};
use super::lattice::Lattice;
use super::predict::{Point, Prediction};
use super::surface::Surface;
use super::symbols::SymbolModels;
use super::traversal::Traversal;
use kn_bitstream::range::RangeDecoder;
use kn_bitstream::rule::{self, Rule};
use kn_bitstream::{IntraHeader, IntraPayload};
use kn_mesh::GridMesh;

/// Limits of the mesh that a payload may announce.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IntraLimits {
    /// Vertices of the decoded mesh.
    pub max_vertices: u32,
    /// Faces of the decoded mesh.
    pub max_faces: u32,
}

/// Buffers of the decoder of I-frame meshes. They are reused from mesh to mesh.
#[derive(Clone, Debug, Default)]
pub struct IntraDecoder {
    conquest: Conquest,
    traversal: Traversal,
    label_traversal: LabelTraversal,
    joins: Vec<(u32, u32)>,
    surface: Surface,
    /// Per vertex of the conquest: the decoded number, position and error, label.
    number: Vec<u32>,
    points: Vec<Point>,
    labels: Vec<u8>,
}

/// Decodes one payload, which [`IntraPayload::read`] has read, into `mesh`, whose buffers are
/// reused. Vertices come in the order in which the connectivity first met them, then those that no
/// coded face uses; labels are empty where the payload has none.
///
/// Safe on untrusted input: returns an error or a mesh with indices in range, never panics, and
/// allocates at most about 1.5 kB for each face and 60 bytes for each vertex that the header
/// announces; it announces no more than `limits` allow, and no more than 2048 of both together for
/// a byte of payload. (Triangles that touch no other take 600 bytes each, scans 150.) On an error
/// the mesh is empty.
///
/// # Errors
/// [`IntraError::Malformed`] with the rule that the payload breaks, [`IntraError::Limit`].
pub fn decode_intra(
    payload: &IntraPayload<'_>,
    limits: &IntraLimits,
    decoder: &mut IntraDecoder,
    mesh: &mut GridMesh,
) -> Result<(), IntraError> {
    mesh.clear();
    let decoded = decoder.decode(payload, limits, mesh);
    if decoded.is_err() {
        mesh.clear();
    }
    decoded
}

impl IntraDecoder {
    fn decode(
        &mut self,
        payload: &IntraPayload<'_>,
        limits: &IntraLimits,
        mesh: &mut GridMesh,
    ) -> Result<(), IntraError> {
        let header = &payload.header;
        limits.check(header)?;
        let [connectivity, geometry, labels] = Section::of(payload);
        connectivity.read(|coder| self.decode_connectivity(coder, header, mesh))?;
        geometry.read(|coder| self.decode_geometry(coder, header, mesh))?;
        labels.read(|coder| self.decode_labels(coder, header, mesh))
    }

    fn decode_connectivity(
        &mut self,
        coder: &mut RangeDecoder,
        header: &IntraHeader,
        mesh: &mut GridMesh,
    ) -> Result<(), Rule> {
        self.decode_conquest(coder, header)?;
        let vertices = self.conquest.vertices.len();
        self.surface.restart(&self.conquest);
        self.number.clear();
        self.number.resize(vertices, NONE);
        self.joins.clear();
        self.joins.resize(header.join_count as usize, (0, 0));
        code_joins(
            coder,
            &self.conquest,
            &mut self.joins,
            &mut self.surface.twin,
            &mut self.number,
        )?;
        let numbered = number_vertices(&self.conquest, &mut self.number);
        if numbered.checked_add(header.isolated_count) != Some(header.vertex_count) {
            return Err(rule::INTRA_VERTICES_COUNT);
        }
        mesh.faces.reserve(header.face_count as usize);
        let corner = |edge: HalfEdge| self.number[edge.origin as usize];
        let triangles = self.conquest.edges.chunks_exact(3).map(|t| [t[0], t[1], t[2]].map(corner));
        mesh.faces.extend(triangles.filter(|face| !face.contains(&NONE)));
        mesh.faces.resize(header.face_count as usize, [0; 3]);
        let raw = header.conquered_faces() as usize;
        code_raw_faces(coder, &mut mesh.faces[raw..], header.vertex_count)
    }

    fn decode_conquest(
        &mut self,
        coder: &mut RangeDecoder,
        header: &IntraHeader,
    ) -> Result<(), Rule> {
        let mut models = SymbolModels::default();
        let faces = header.conquered_faces() as usize;
        self.conquest.clear();
        for _ in 0..header.component_count {
            let valences = [(); 3].map(|()| models.code_seed(coder, 0));
            self.conquest.seed(valences);
            while let Some(gate) = self.conquest.gate() {
                let any = Symbol::Left;
                let symbol = models.code(coder, &self.conquest, gate, any);
                self.conquest.apply(gate, symbol)?;
                // Every triangle of a dummy lies behind a side of a real one.
                let real = self.conquest.real_triangles();
                if real > faces || self.conquest.triangles() > 4 * faces {
                    return Err(rule::INTRA_FACES_COUNT);
                }
                if coder.is_exhausted() {
                    return Err(rule::RANGE_END);
                }
            }
        }
        if self.conquest.real_triangles() != faces {
            return Err(rule::INTRA_FACES_COUNT);
        }
        if self.conquest.is_complete() { Ok(()) } else { Err(rule::INTRA_CONNECTIVITY_VALENCE) }
    }

    fn decode_geometry(
        &mut self,
        coder: &mut RangeDecoder,
        header: &IntraHeader,
        mesh: &mut GridMesh,
    ) -> Result<(), Rule> {
        self.points.clear();
        self.points.resize(self.surface.vertices(), Point::default());
        let mut lattice = Lattice::default();
        if header.has_lattice {
            lattice.code(coder, header.vertex_count)?;
        }
        let mut models = GeometryModels::default();
        let (traversal, points) = (&mut self.traversal, &mut self.points);
        let mut last = code_positions(coder, &mut models, &self.surface, traversal, points)?;
        mesh.positions.resize(header.vertex_count as usize, [0; 3]);
        for (&number, point) in self.number.iter().zip(&self.points) {
            if number != NONE {
                mesh.positions[number as usize] = point.position;
            }
        }
        let isolated = (header.vertex_count - header.isolated_count) as usize;
        for position in &mut mesh.positions[isolated..] {
            last = models.code_unsupported(coder, &Prediction::default(), last, *position)?;
            *position = last;
        }
        if header.has_lattice {
            for position in &mut mesh.positions {
                *position = lattice.point(*position)?;
            }
        }
        Ok(())
    }

    fn decode_labels(
        &mut self,
        coder: &mut RangeDecoder,
        header: &IntraHeader,
        mesh: &mut GridMesh,
    ) -> Result<(), Rule> {
        if !header.has_labels {
            return Ok(());
        }
        self.labels.clear();
        self.labels.resize(self.surface.vertices(), 0);
        let mut models = LabelModels::default();
        let (traversal, labels) = (&mut self.label_traversal, &mut self.labels);
        let mut last =
            code_labels(coder, &mut models, &self.surface, traversal, labels, &self.points);
        mesh.labels.resize(header.vertex_count as usize, 0);
        for (&number, &label) in self.number.iter().zip(&self.labels) {
            if number != NONE {
                mesh.labels[number as usize] = label;
            }
        }
        let isolated = (header.vertex_count - header.isolated_count) as usize;
        for label in &mut mesh.labels[isolated..] {
            last = models.code_isolated(coder, last, *label);
            *label = last;
        }
        Ok(())
    }
}

impl IntraLimits {
    fn check(&self, header: &IntraHeader) -> Result<(), IntraError> {
        let within = |what, asked, allowed| {
            if asked > allowed { Err(IntraError::Limit { what, asked, allowed }) } else { Ok(()) }
        };
        within("vertices", header.vertex_count, self.max_vertices.min(super::MOST))?;
        within("faces", header.face_count, self.max_faces.min(super::MOST))
    }
}

/// A section of the payload: one stream of decisions, and its first byte among the sections.
struct Section<'a> {
    bytes: &'a [u8],
    start: usize,
}

impl<'a> Section<'a> {
    fn of(payload: &IntraPayload<'a>) -> [Self; 3] {
        let mut next = 0;
        [payload.connectivity, payload.geometry, payload.labels].map(|bytes| {
            let start = next;
            next += bytes.len();
            Self { bytes, start }
        })
    }

    /// Reads it with `decode` and requires that it holds nothing else.
    fn read(
        &self,
        decode: impl FnOnce(&mut RangeDecoder) -> Result<(), Rule>,
    ) -> Result<(), IntraError> {
        let mut coder = RangeDecoder::new(self.bytes);
        let mut decoded = decode(&mut coder);
        if decoded.is_ok() && !coder.is_finished() {
            decoded = Err(rule::RANGE_END);
        }
        decoded.map_err(|rule| IntraError::Malformed { rule, at: self.start + coder.position() })
    }
}
