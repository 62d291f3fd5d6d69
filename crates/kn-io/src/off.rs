//! Geomview OFF: positions and polygons, in file order.

use super::read::Parsed;
use super::text::{Lines, parse, shown, words};
use super::{Fault, MeshErrorKind, Place};

/// Reads an OFF file's bytes.
pub(super) fn read_off(bytes: &[u8]) -> Result<Parsed, Fault> {
    let mut lines = Lines::new(bytes)
        .map(|(number, line)| (Place::Line(number), words(line).collect::<Vec<_>>()))
        .filter(|(_, words)| !words.is_empty());
    let mut next =
        |what: String| lines.next().ok_or_else(|| Fault::from(MeshErrorKind::Truncated(what)));

    let (place, mut header) = next("in the OFF header".into())?;
    if header[0] != b"OFF" {
        return Err(place.malformed(format!("{} is not OFF", shown(header[0]))));
    }
    header.remove(0);
    let (place, counts) =
        if header.is_empty() { next("no OFF counts".into())? } else { (place, header) };
    let (vertices, faces) = match counts[..] {
        [vertices, faces] | [vertices, faces, _] => (count(vertices, place)?, count(faces, place)?),
        _ => return Err(place.malformed("OFF counts are vertices, faces and edges")),
    };

    let mut parsed = Parsed::default();
    for vertex in 0..vertices {
        let (place, words) = next(format!("vertex {vertex} of {vertices} is not there"))?;
        read_vertex(&words, place, &mut parsed)?;
    }
    for face in 0..faces {
        let (place, words) = next(format!("face {face} of {faces} is not there"))?;
        read_face(&words, vertices, place, &mut parsed)?;
    }
    parsed.notes.ignore("lines after the last face", lines.count() as u64);
    Ok(parsed)
}

fn count(word: &[u8], place: Place) -> Result<usize, Fault> {
    parse(word).ok_or_else(|| place.malformed(format!("{} is not a count", shown(word))))
}

fn read_vertex(words: &[&[u8]], place: Place, parsed: &mut Parsed) -> Result<(), Fault> {
    let [x, y, z, rest @ ..] = words else {
        return Err(place.malformed(format!("a vertex has 3 coordinates, not {}", words.len())));
    };
    let mut position = [0f32; 3];
    for (coordinate, word) in position.iter_mut().zip([x, y, z]) {
        *coordinate = parse(word)
            .ok_or_else(|| place.malformed(format!("{} is not a number", shown(word))))?;
    }
    if !position.iter().all(|coordinate| coordinate.is_finite()) {
        return Err(place.fault(MeshErrorKind::NotFinite));
    }
    parsed.mesh.positions.push(position);
    parsed.notes.ignore("further numbers of vertices", rest.len() as u64);
    Ok(())
}

/// `n` and `n` indices; a colour may follow.
fn read_face(
    words: &[&[u8]],
    vertices: usize,
    place: Place,
    parsed: &mut Parsed,
) -> Result<(), Fault> {
    let corners = count(words[0], place)?;
    if corners >= words.len() {
        return Err(place.malformed(format!("a face of {corners} corners lists fewer")));
    }
    let (indices, rest) = words[1..].split_at(corners);
    let mut face = Vec::with_capacity(corners);
    for word in indices {
        let index: i64 = parse(word)
            .ok_or_else(|| place.malformed(format!("{} is not an index", shown(word))))?;
        match u32::try_from(index) {
            Ok(vertex) if (vertex as usize) < vertices => face.push(vertex),
            _ => return Err(place.fault(MeshErrorKind::FaceIndex { index, vertices })),
        }
    }
    parsed.notes.ignore("colours of faces", u64::from(!rest.is_empty()));
    parsed.push_polygon(&face, place)
}
