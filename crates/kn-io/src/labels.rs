//! Reading of labels from a file beside the mesh, from a vertex property, or from colours.

use super::parsed::Parsed;
use super::read::read_file;
use super::text::{Lines, parse, shown, words};
use super::{Fault, LabelSource, MeshError, MeshErrorKind, Place, ReadOptions};
use kn_bitstream::params::BodyPart;
use std::fs;
use std::io::{self, Write};
use std::path::Path;

/// The labels that `options` ask for, checked; what is used up is taken out of `parsed`.
pub(super) fn take_labels(
    parsed: &mut Parsed,
    path: &Path,
    options: &ReadOptions,
) -> Result<Vec<u8>, MeshError> {
    let vertices = parsed.mesh.positions.len();
    match &options.labels {
        LabelSource::None => Ok(Vec::new()),
        // An empty frame has no colours to be wrong.
        LabelSource::Colours if vertices == 0 => Ok(Vec::new()),
        LabelSource::Property => {
            let labels = std::mem::take(&mut parsed.labels);
            checked(labels.into_iter(), options.max_label, Place::Vertex)
                .map_err(|fault| fault.at(path))
        }
        LabelSource::Colours => {
            let colours = std::mem::take(&mut parsed.colours);
            labels_of_colours(&colours, vertices, options.max_label).map_err(|f| f.at(path))
        }
        LabelSource::File(file) => read_labels(file, vertices, options.max_label),
    }
}

/// Reads a label file: one integer per line and vertex, in the order of the vertices. That of an
/// empty frame has no line.
///
/// # Errors
/// A line is not an integer, a label is above `max_label`, or there are not `vertices` labels.
pub fn read_labels(path: &Path, vertices: usize, max_label: u8) -> Result<Vec<u8>, MeshError> {
    if vertices == 0 && fs::metadata(path).is_ok_and(|file| file.len() == 0) {
        return Ok(Vec::new());
    }
    let bytes = read_file(path)?;
    parse_labels(&bytes, vertices, max_label).map_err(|fault| fault.at(path))
}

/// Writes labels as [`read_labels`] reads them: one integer a line.
///
/// # Errors
/// The writer fails.
pub fn write_labels(mut out: impl Write, labels: &[u8]) -> io::Result<()> {
    labels.iter().try_for_each(|label| writeln!(out, "{label}"))
}

fn parse_labels(bytes: &[u8], vertices: usize, max_label: u8) -> Result<Vec<u8>, Fault> {
    let mut labels = Vec::new();
    for (number, line) in Lines::new(bytes) {
        let mut words = words(line);
        let Some(word) = words.next() else { continue };
        let place = Place::Line(number);
        let Some(label) = parse::<i64>(word) else {
            return Err(place.malformed(format!("{} is not an integer", shown(word))));
        };
        if words.next().is_some() {
            return Err(place.malformed("more than one label in a line"));
        }
        labels.push(in_range(label, max_label).map_err(|kind| place.fault(kind))?);
    }
    if labels.len() == vertices {
        Ok(labels)
    } else {
        Err(MeshErrorKind::LabelCount { labels: labels.len(), vertices }.into())
    }
}

/// The labels of colours that are exactly those of the parts, to the last of 8 bits.
fn labels_of_colours(
    colours: &[[f32; 3]],
    vertices: usize,
    max_label: u8,
) -> Result<Vec<u8>, Fault> {
    if colours.is_empty() {
        return Err(MeshErrorKind::NoColours.into());
    }
    if colours.len() != vertices {
        return Err(MeshErrorKind::LabelCount { labels: colours.len(), vertices }.into());
    }
    let mut labels = Vec::with_capacity(vertices);
    for (vertex, colour) in colours.iter().enumerate() {
        // Colours between 0 and 1 are often written with three decimals: 0.0005 · 255 off.
        let on_8_bits = colour.iter().all(|c| (c - c.round()).abs() < 0.13);
        let rounded = colour.map(|channel| channel.round() as u8);
        let label = BodyPart::of_colour(rounded).filter(|_| on_8_bits).map(BodyPart::label);
        let unknown = || Place::Vertex(vertex).fault(MeshErrorKind::UnknownColour(rounded));
        labels.push(i64::from(label.ok_or_else(unknown)?));
    }
    checked(labels.into_iter(), max_label, Place::Vertex)
}

/// Labels within `0..=max_label`; the fault is at `place` of the first that is not.
fn checked(
    labels: impl Iterator<Item = i64>,
    max_label: u8,
    place: fn(usize) -> Place,
) -> Result<Vec<u8>, Fault> {
    labels
        .enumerate()
        .map(|(at, label)| in_range(label, max_label).map_err(|kind| place(at).fault(kind)))
        .collect()
}

fn in_range(label: i64, max_label: u8) -> Result<u8, MeshErrorKind> {
    match u8::try_from(label) {
        Ok(value) if value <= max_label => Ok(value),
        _ => Err(MeshErrorKind::LabelRange { label, max: max_label }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kn_bitstream::params::Named;

    fn message(result: Result<Vec<u8>, Fault>) -> String {
        result.expect_err("must fail").at(Path::new("f.labels")).to_string()
    }

    #[test]
    fn a_label_file_is_one_integer_a_line() {
        let mut written = Vec::new();
        write_labels(&mut written, &[0, 13, 7]).expect("memory");
        assert_eq!(written, b"0\n13\n7\n");
        assert_eq!(parse_labels(&written, 3, 14).expect("good"), [0, 13, 7]);
        assert_eq!(parse_labels(b"0\r\n13\n# done\n\n7", 3, 14).expect("good"), [0, 13, 7]);
        assert_eq!(message(parse_labels(b"0\n1\n", 3, 14)), "f.labels: 2 labels for 3 vertices");
        assert_eq!(
            message(parse_labels(b"0\n15\n", 2, 14)),
            "f.labels, line 2: label 15 is out of range: labels are 0 to 14"
        );
        assert!(message(parse_labels(b"-1\n", 1, 14)).contains("label -1 is out of range"));
        assert!(
            message(parse_labels(b"head\n", 1, 14)).contains("line 1: \"head\" is not an integer")
        );
        assert!(message(parse_labels(b"1 2\n", 2, 14)).contains("more than one label"));
    }

    #[test]
    fn colours_must_be_the_palettes_own() {
        let colours: Vec<[f32; 3]> =
            BodyPart::all().iter().map(|part| part.colour().map(f32::from)).collect();
        let labels = labels_of_colours(&colours, 15, 14).expect("the palette");
        assert_eq!(labels, (0..15).collect::<Vec<u8>>());
        assert_eq!(
            message(labels_of_colours(&[[128.0, 128.0, 129.0]], 1, 14)),
            "f.labels, vertex 0: colour [128, 128, 129] is the colour of no body part"
        );
        assert!(message(labels_of_colours(&[[128.0, 128.3, 128.0]], 1, 14)).contains("no body"));
        assert!(message(labels_of_colours(&[], 1, 14)).contains("the file has none"));
        assert!(message(labels_of_colours(&colours[14..], 1, 13)).contains("label 14"));
    }
}
