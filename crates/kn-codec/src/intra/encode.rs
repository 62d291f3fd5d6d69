//! Encoding of a mesh into a payload.

use super::IntraError;
use super::conquest::{Conquest, NONE};
use super::geometry::{GeometryModels, code_positions};
use super::joins::{code_joins, code_raw_faces, number_vertices};
use super::labels::{LabelModels, LabelTraversal, code_labels};
use super::lattice::Lattice;
use super::predict::{Point, Prediction};
use super::surface::Surface;
use super::survey::Survey;
use super::symbols::SymbolModels;
use super::topology::ClosedMesh;
use super::traversal::Traversal;
use kn_bitstream::range::RangeEncoder;
use kn_bitstream::{IntraHeader, IntraPayload, Rule};
use kn_mesh::{Grid, GridMesh};

/// A coded mesh, and what was cut in order to code it. Cuts are undone in the decoded mesh; only
/// the order of vertices and faces differs.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct IntraEncoding {
    /// Counts and flags of the payload.
    pub header: IntraHeader,
    /// The connectivity section.
    pub connectivity: Vec<u8>,
    /// The geometry section.
    pub geometry: Vec<u8>,
    /// The label section.
    pub labels: Vec<u8>,
    /// `#V` decoded vertex of each input vertex.
    pub vertex_map: Vec<u32>,
    /// Boundary loops after cutting.
    pub holes: usize,
    /// Number of edges that were cut: they have more than two faces, or faces of opposite
    /// orientation.
    pub cut_edges: usize,
}

impl IntraEncoding {
    /// The payload, to be written or decoded.
    pub fn payload(&self) -> IntraPayload<'_> {
        IntraPayload {
            header: self.header,
            connectivity: &self.connectivity,
            geometry: &self.geometry,
            labels: &self.labels,
        }
    }
}

/// Codes `mesh`. The decoded mesh has the same vertices (reordered, see
/// [`IntraEncoding::vertex_map`]) and the same faces (reordered, and each perhaps begun at another
/// of its corners).
///
/// # Errors
/// The mesh is not valid: a face index or the number of labels does not fit, a coordinate lies
/// outside the grid, or there are 2^28 vertices or faces or more.
pub fn encode_intra(mesh: &GridMesh) -> Result<IntraEncoding, IntraError> {
    check(mesh)?;
    let (faces, raw_faces): (Vec<_>, Vec<_>) = mesh.faces.iter().copied().partition(is_simple);
    let closed = ClosedMesh::new(&faces, mesh.positions.len());
    let mut encoder = IntraEncoder::new(mesh, &closed, raw_faces);
    let mut sections = [Vec::new(), Vec::new(), Vec::new()];
    encoder.encode_sections(&mut sections).map_err(|rule| IntraError::Malformed { rule, at: 0 })?;
    let [connectivity, geometry, labels] = sections;
    Ok(IntraEncoding {
        header: encoder.header,
        connectivity,
        geometry,
        labels,
        holes: closed.source.iter().filter(|&&source| source == NONE).count(),
        cut_edges: closed.cut_edges,
        vertex_map: encoder.vertex_map,
    })
}

fn check(mesh: &GridMesh) -> Result<(), IntraError> {
    for (what, count) in [("vertices", mesh.positions.len()), ("faces", mesh.faces.len())] {
        if count > super::MOST as usize {
            return Err(IntraError::TooLarge { what, count });
        }
    }
    let vertices = mesh.positions.len();
    if !mesh.labels.is_empty() && mesh.labels.len() != vertices {
        return Err(IntraError::LabelCount { labels: mesh.labels.len(), vertices });
    }
    let inside = |x: &i32| x.unsigned_abs() < Grid::LIMIT.unsigned_abs();
    if let Some(vertex) = mesh.positions.iter().position(|p| !p.iter().all(inside)) {
        return Err(IntraError::Outside { vertex });
    }
    let exists = |index: &u32| (*index as usize) < vertices;
    match mesh.faces.iter().position(|face| !face.iter().all(exists)) {
        Some(face) => Err(IntraError::FaceIndex { face }),
        None => Ok(()),
    }
}

fn is_simple(&[a, b, c]: &[u32; 3]) -> bool {
    a != b && b != c && c != a
}

struct IntraEncoder<'a> {
    mesh: &'a GridMesh,
    closed: &'a ClosedMesh,
    raw_faces: Vec<[u32; 3]>,
    header: IntraHeader,
    conquest: Conquest,
    /// `#M` input vertex of each vertex of the conquest; [`NONE`] for a dummy.
    source: Vec<u32>,
    surface: Surface,
    points: Vec<Point>,
    vertex_map: Vec<u32>,
    isolated: Vec<u32>,
}

impl<'a> IntraEncoder<'a> {
    fn new(mesh: &'a GridMesh, closed: &'a ClosedMesh, raw_faces: Vec<[u32; 3]>) -> Self {
        let header = IntraHeader {
            has_labels: !mesh.labels.is_empty(),
            vertex_count: mesh.positions.len() as u32,
            face_count: mesh.faces.len() as u32,
            raw_face_count: raw_faces.len() as u32,
            ..IntraHeader::default()
        };
        Self {
            mesh,
            closed,
            raw_faces,
            header,
            conquest: Conquest::default(),
            source: Vec::new(),
            surface: Surface::default(),
            points: Vec::new(),
            vertex_map: vec![NONE; mesh.positions.len()],
            isolated: Vec::new(),
        }
    }

    fn encode_sections(&mut self, sections: &mut [Vec<u8>; 3]) -> Result<(), Rule> {
        let [connectivity, geometry, labels] = sections;
        let mut coder = RangeEncoder::new(connectivity);
        self.encode_conquest(&mut coder)?;
        self.encode_joins(&mut coder)?;
        coder.finish();
        let mut coder = RangeEncoder::new(geometry);
        self.encode_geometry(&mut coder)?;
        coder.finish();
        if self.header.has_labels {
            let mut coder = RangeEncoder::new(labels);
            self.encode_labels(&mut coder);
            coder.finish();
        }
        Ok(())
    }

    fn encode_conquest(&mut self, coder: &mut RangeEncoder) -> Result<(), Rule> {
        let mut models = SymbolModels::default();
        let mut survey = Survey::new(self.closed);
        self.conquest.clear();
        for first in (0..3 * self.closed.real_faces as u32).step_by(3) {
            if survey.is_conquered(first) {
                continue;
            }
            self.header.component_count += 1;
            let valences = survey.valences(first);
            self.conquest.seed(valences.map(|valence| models.code_seed(coder, valence)));
            survey.record(first);
            while let Some(gate) = self.conquest.gate() {
                let symbol = survey.symbol(&self.conquest, gate);
                let triangle = survey.behind(gate);
                models.code(coder, &self.conquest, gate, symbol);
                self.conquest.apply(gate, symbol)?;
                survey.record(triangle);
            }
        }
        let source = |&own: &u32| self.closed.source[own as usize];
        self.source = survey.vertices.iter().map(source).collect();
        Ok(())
    }

    fn encode_joins(&mut self, coder: &mut RangeEncoder) -> Result<(), Rule> {
        let mut joins = Vec::new();
        let mut first_of = vec![NONE; self.mesh.positions.len()];
        for (vertex, &source) in (0..).zip(&self.source) {
            if source == NONE {
                continue;
            }
            match &mut first_of[source as usize] {
                free @ &mut NONE => *free = vertex,
                &mut first => joins.push((vertex, first)),
            }
        }
        self.surface.restart(&self.conquest);
        let mut number = vec![NONE; self.source.len()];
        code_joins(coder, &self.conquest, &mut joins, &mut self.surface.twin, &mut number)?;
        let mut vertices = number_vertices(&self.conquest, &mut number);
        for (&number, &source) in number.iter().zip(&self.source) {
            if source != NONE {
                self.vertex_map[source as usize] = number;
            }
        }
        for (vertex, number) in (0..).zip(&mut self.vertex_map) {
            if *number == NONE {
                self.isolated.push(vertex);
                *number = vertices;
                vertices += 1;
            }
        }
        self.header.join_count = joins.len() as u32;
        self.header.isolated_count = self.isolated.len() as u32;
        for corner in self.raw_faces.iter_mut().flatten() {
            *corner = self.vertex_map[*corner as usize];
        }
        code_raw_faces(coder, &mut self.raw_faces, vertices)
    }

    fn encode_geometry(&mut self, coder: &mut RangeEncoder) -> Result<(), Rule> {
        let mut lattice = Lattice::detect(&self.mesh.positions);
        self.header.has_lattice = lattice.is_some();
        if let Some(lattice) = &mut lattice {
            lattice.code(coder, self.header.vertex_count)?;
        }
        let coded = |vertex: u32| {
            let position = self.mesh.positions[vertex as usize];
            lattice.as_ref().map_or(position, |lattice| lattice.ranks(position))
        };
        let point = |&source: &u32| match source {
            NONE => Point::default(),
            vertex => Point { position: coded(vertex), error: 0 },
        };
        self.points = self.source.iter().map(point).collect();
        let mut models = GeometryModels::default();
        let mut traversal = Traversal::default();
        let mut last =
            code_positions(coder, &mut models, &self.surface, &mut traversal, &mut self.points)?;
        for &vertex in &self.isolated {
            let own = coded(vertex);
            last = models.code_unsupported(coder, &Prediction::default(), last, own)?;
        }
        Ok(())
    }

    fn encode_labels(&mut self, coder: &mut RangeEncoder) {
        let label = |&source: &u32| match source {
            NONE => 0,
            vertex => self.mesh.labels[vertex as usize],
        };
        let mut labels: Vec<_> = self.source.iter().map(label).collect();
        let mut models = LabelModels::default();
        let mut traversal = LabelTraversal::default();
        let mut last = code_labels(
            coder,
            &mut models,
            &self.surface,
            &mut traversal,
            &mut labels,
            &self.points,
        );
        for &vertex in &self.isolated {
            last = models.code_isolated(coder, last, self.mesh.labels[vertex as usize]);
        }
    }
}
