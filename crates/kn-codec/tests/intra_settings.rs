//! Settings of the encoder for I-frames: no loss, fewer faces, maps of vertices.

use kn_codec::{DROPPED, GridChoice};
use kn_codec::{Decimation, Decoder, EncodeError, Encoder, EncoderConfig, FrameReport};
use kn_mesh::{ExactGrid, Mesh};
use kn_performer::{Performer, PerformerConfig};

fn frames(count: u32, scale: f64) -> Vec<Mesh> {
    let config = PerformerConfig { vertices: 2000, ..PerformerConfig::default() };
    let performer = Performer::new(config).expect("sound settings");
    let mut frames: Vec<_> = (0..count).map(|index| performer.frame(index)).collect();
    for position in frames.iter_mut().flat_map(|mesh| &mut mesh.positions) {
        *position = position.map(|x| if scale > 0.0 { (x * scale).round() } else { x });
    }
    frames
}

fn encode(
    config: EncoderConfig,
    frames: &[Mesh],
) -> Result<(Vec<u8>, Vec<FrameReport>), EncodeError> {
    let mut encoder = Encoder::new(Vec::new(), config)?;
    let mut reports = Vec::new();
    for mesh in frames {
        encoder.push(mesh)?;
        reports.extend(encoder.drain_reports());
    }
    let finished = encoder.finish()?;
    reports.extend(finished.reports);
    Ok((finished.writer, reports))
}

fn decode(file: &[u8]) -> Vec<Mesh> {
    let mut decoder = Decoder::new(std::io::Cursor::new(file)).expect("a stream");
    let mut mesh = Mesh::default();
    let mut frames = Vec::new();
    while decoder.next_frame(&mut mesh).expect("a frame").is_some() {
        frames.push(mesh.clone());
    }
    frames
}

#[test]
fn integers_come_back_to_the_last_bit() {
    let frames = frames(2, 1000.0);
    let mut search = ExactGrid::default();
    frames.iter().for_each(|mesh| search.include(&mesh.positions));
    let grid = search.grid().expect("integers");
    assert_eq!(grid.step, 1.0);
    let config = EncoderConfig::default()
        .with_grid(GridChoice::Lossless(grid))
        .with_group_length(1)
        .with_vertex_maps(true);
    let (file, reports) = encode(config.clone(), &frames).expect("encoded");
    for ((mesh, decoded), report) in frames.iter().zip(decode(&file)).zip(reports) {
        let map = report.intra().and_then(|intra| intra.vertex_map.clone()).expect("asked for");
        assert_eq!(map.len(), mesh.positions.len());
        for (position, &target) in mesh.positions.iter().zip(&map) {
            let bits = |p: [f64; 3]| p.map(|x| (x + 0.0).to_bits());
            assert_eq!(bits(decoded.positions[target as usize]), bits(*position));
        }
    }
    let mut moved = frames;
    moved[1].positions[7][0] += 0.25;
    let error = encode(config.clone(), &moved).expect_err("off the grid").to_string();
    assert_eq!(error, "frame 1: vertex 7 does not lie on the lossless grid");
    for wrong in
        [config.clone().with_group_length(2), config.with_decimation(Some(Decimation::Share(0.5)))]
    {
        assert!(matches!(encode(wrong, &moved), Err(EncodeError::Settings(_))));
    }
}

#[test]
fn p_frames_deform_a_decimated_i_frame() {
    let frames = frames(3, 0.0);
    let config = EncoderConfig::default()
        .with_decimation(Some(Decimation::Share(0.25)))
        .with_vertex_maps(true)
        .with_group_length(3)
        .with_nodes(60);
    let (file, reports) = encode(config, &frames).expect("encoded");
    let decoded = decode(&file);
    assert_eq!(decoded.len(), 3);
    let [FrameReport::Intra(intra), predicted @ ..] = &reports[..] else { panic!("no I-frame") };
    let (faces, input_faces) = (intra.frame.faces, intra.frame.input_faces);
    assert_eq!(input_faces as usize, frames[0].faces.len());
    assert!(4 * faces <= input_faces && 5 * faces > input_faces);
    let diagonal = frames[0].bounding_box().expect("a box").diagonal();
    assert!(intra.decimation_error > 0.0 && intra.decimation_error < 0.03 * diagonal);
    let rms = |report: &FrameReport| report.predicted().expect("a P-frame").fit_rms;
    assert!(predicted.iter().all(|report| rms(report) < 0.01 * diagonal));
    let map = intra.vertex_map.as_ref().expect("asked for");
    // Rounded to the grid, and smoothed within it.
    let step = 1.5 * diagonal / 2047.0;
    for (position, &target) in frames[0].positions.iter().zip(map).filter(|(_, t)| **t != DROPPED) {
        let found = decoded[0].positions[target as usize];
        assert!((0..3).all(|k| (found[k] - position[k]).abs() < step));
    }
    assert_eq!(map.iter().filter(|&&t| t != DROPPED).count(), intra.frame.vertices as usize);
}
