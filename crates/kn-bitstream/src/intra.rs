//! The coded mesh of an I-frame: its header and its sections (chapter 3.5). The content of the
//! sections is described in chapter 5.

use crate::error::Error;
use crate::level::Level;
use crate::reader::BitReader;
use crate::rule;
use crate::writer::BitWriter;

/// Largest number of vertices and faces that a byte of payload can hold.
const DENSITY: u64 = 2048;

/// Counts and flags of a coded mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct IntraHeader {
    /// Whether positions are coded as ranks in a lattice.
    pub has_lattice: bool,
    /// Whether every vertex has a label.
    pub has_labels: bool,
    /// Number of all vertices.
    pub vertex_count: u32,
    /// Number of vertices that no coded face uses.
    pub isolated_count: u32,
    /// Number of all faces.
    pub face_count: u32,
    /// Number of faces that are listed as they are, such as those that repeat a vertex.
    pub raw_face_count: u32,
    /// Number of connected components of the conquest.
    pub component_count: u32,
    /// Number of vertices of the conquest that repeat another.
    pub join_count: u32,
}

/// A coded mesh: its header and the three sections that follow it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct IntraPayload<'a> {
    /// Counts and flags.
    pub header: IntraHeader,
    /// The conquest, its joins and the raw faces.
    pub connectivity: &'a [u8],
    /// The positions.
    pub geometry: &'a [u8],
    /// The labels; empty where there are none.
    pub labels: &'a [u8],
}

impl IntraHeader {
    /// Number of faces that the conquest codes.
    pub fn conquered_faces(&self) -> u32 {
        self.face_count - self.raw_face_count
    }

    /// Reads flags and counts of a payload of `size` bytes.
    fn read(bits: &mut BitReader<'_, '_>, size: u32, level: &Level) -> Result<Self, Error> {
        let reserved = bits.u8("reserved_zero", 6)?;
        bits.require_supported(reserved == 0, rule::INTRA_RESERVED_ZERO)?;
        let has_lattice = bits.flag("lattice_present")?;
        let has_labels = bits.flag("labels_present")?;
        let attribute_count = bits.u8("attribute_count", 8)?;
        bits.require_supported(attribute_count == 0, rule::INTRA_HEADER_ATTRIBUTES)?;
        let vertex_count = bits.uleb("vertex_count")?;
        bits.require(vertex_count <= level.max_vertices, rule::INTRA_SIZE_LEVEL)?;
        let isolated_count = bits.uleb("isolated_count")?;
        bits.require(isolated_count <= vertex_count, rule::INTRA_VERTICES_COUNT)?;
        let face_count = bits.uleb("face_count")?;
        bits.require(face_count <= level.max_faces, rule::INTRA_SIZE_LEVEL)?;
        let dense = u64::from(vertex_count) + u64::from(face_count) > DENSITY * u64::from(size);
        bits.require(!dense, rule::INTRA_COUNTS_DENSITY)?;
        let raw_face_count = bits.uleb("raw_face_count")?;
        bits.require(raw_face_count <= face_count, rule::INTRA_FACES_COUNT)?;
        let conquered = face_count - raw_face_count;
        let component_count = bits.uleb("component_count")?;
        bits.require(component_count <= conquered, rule::INTRA_FACES_COUNT)?;
        let join_count = bits.uleb("join_count")?;
        let corners = 3 * u64::from(conquered);
        bits.require(u64::from(join_count) <= corners, rule::INTRA_JOIN_ORDER)?;
        Ok(Self {
            has_lattice,
            has_labels,
            vertex_count,
            isolated_count,
            face_count,
            raw_face_count,
            component_count,
            join_count,
        })
    }

    /// Writes flags and counts; the mirror of [`Self::read`].
    fn write(&self, bits: &mut BitWriter) {
        bits.u(0, 6);
        bits.flag(self.has_lattice);
        bits.flag(self.has_labels);
        // attribute_count.
        bits.u(0, 8);
        bits.uleb(self.vertex_count);
        bits.uleb(self.isolated_count);
        bits.uleb(self.face_count);
        bits.uleb(self.raw_face_count);
        bits.uleb(self.component_count);
        bits.uleb(self.join_count);
    }
}

impl<'a> IntraPayload<'a> {
    /// Reads a payload of `size` bytes of a stream of this level. The sections are borrowed.
    ///
    /// # Errors
    /// The counts contradict each other or the level, or the sections do not fill the payload.
    pub fn read(bits: &mut BitReader<'a, '_>, size: u32, level: &Level) -> Result<Self, Error> {
        let start = bits.position();
        let header = IntraHeader::read(bits, size, level)?;
        let connectivity_size = bits.uleb("connectivity_size")?;
        let geometry_size = bits.uleb("geometry_size")?;
        let label_size = bits.uleb("label_size")?;
        bits.require(header.has_labels || label_size == 0, rule::INTRA_SECTIONS_SIZE)?;
        let sections = [connectivity_size, geometry_size, label_size].map(u64::from);
        let whole = (bits.position() - start) / 8 + sections.iter().sum::<u64>();
        bits.require(whole == u64::from(size), rule::INTRA_SECTIONS_SIZE)?;
        Ok(Self {
            header,
            connectivity: bits.bytes("connectivity_section", connectivity_size)?,
            geometry: bits.bytes("geometry_section", geometry_size)?,
            labels: bits.bytes("label_section", label_size)?,
        })
    }

    /// Writes the payload; the mirror of [`Self::read`].
    pub fn write(&self, bits: &mut BitWriter) {
        self.header.write(bits);
        let sections = [self.connectivity, self.geometry, self.labels];
        sections.iter().for_each(|section| bits.uleb(section.len() as u32));
        sections.iter().for_each(|section| bits.bytes(section));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rule::Rule;

    const LEVEL: Level = Level {
        max_vertices: 1 << 20,
        max_faces: 1 << 21,
        max_nodes: 1,
        max_group_frames: 1,
        max_unit_bytes: 1,
    };

    fn example() -> IntraPayload<'static> {
        let header = IntraHeader {
            has_labels: true,
            vertex_count: 300,
            face_count: 500,
            component_count: 2,
            ..IntraHeader::default()
        };
        IntraPayload { header, connectivity: &[7; 200], geometry: b"geometry", labels: b"labels" }
    }

    fn written(payload: &IntraPayload<'_>) -> Vec<u8> {
        let mut bits = BitWriter::new();
        payload.write(&mut bits);
        bits.into_bytes()
    }

    fn read(bytes: &[u8]) -> Result<IntraPayload<'_>, Error> {
        IntraPayload::read(&mut BitReader::new(bytes), bytes.len() as u32, &LEVEL)
    }

    fn broken(payload: &IntraPayload<'_>) -> Option<Rule> {
        read(&written(payload)).expect_err("it is broken").rule()
    }

    #[test]
    fn reads_what_it_writes() {
        let bare = IntraPayload { header: IntraHeader::default(), labels: &[], ..example() };
        for payload in [example(), bare] {
            assert_eq!(read(&written(&payload)), Ok(payload));
        }
    }

    #[test]
    fn counts_that_contradict_each_other_are_refused() {
        let with = |change: fn(&mut IntraHeader)| {
            let mut payload = example();
            change(&mut payload.header);
            broken(&payload)
        };
        assert_eq!(with(|h| h.vertex_count = 1 << 20), Some(rule::INTRA_COUNTS_DENSITY));
        assert_eq!(with(|h| h.vertex_count = (1 << 20) + 1), Some(rule::INTRA_SIZE_LEVEL));
        assert_eq!(with(|h| h.isolated_count = 301), Some(rule::INTRA_VERTICES_COUNT));
        assert_eq!(with(|h| h.raw_face_count = 501), Some(rule::INTRA_FACES_COUNT));
        assert_eq!(with(|h| h.component_count = 501), Some(rule::INTRA_FACES_COUNT));
        assert_eq!(with(|h| h.join_count = 1501), Some(rule::INTRA_JOIN_ORDER));
        assert_eq!(with(|h| h.has_labels = false), Some(rule::INTRA_SECTIONS_SIZE));
    }

    #[test]
    fn sections_fill_the_payload() {
        let mut bytes = written(&example());
        bytes.push(0);
        assert_eq!(read(&bytes).map_err(|e| e.rule()), Err(Some(rule::INTRA_SECTIONS_SIZE)));
        bytes.truncate(5);
        assert_eq!(read(&bytes).map_err(|e| e.rule()), Err(Some(rule::UNIT_SIZE_EXACT)));
    }
}
