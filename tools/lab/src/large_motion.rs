//! Number of limbs that the fit loses when they swing far between two frames.
//!
//! `cargo run --release -p kn-lab -- large-motion [SEEDS [FIRST]]`
//!
//! Each seed gives two poses of the performer, meshed independently, whose limbs are up to 30 % of
//! the height apart; the first is registered to the second with 200 rigid nodes and no labels. A
//! part is lost when its RMS distance to the true positions exceeds 5 % of the height.

use anyhow::Result;
use kn_fit::{RegisterOptions, Registration, register};
use kn_mesh::Mesh;
use kn_mesh::vec3::distance_squared;
use kn_performer::{Action, Performer, PerformerConfig};

const VERTICES: usize = 10_000;
/// Of a lost part, metres: 5 % of a figure of 1.7 m.
const LOST: f64 = 0.05 * 1.7;

pub(crate) fn run(arguments: &[String]) -> Result<()> {
    let mut arguments = arguments.iter();
    let seeds: u64 = arguments.next().map_or(Ok(50), |text| text.parse())?;
    let first: u64 = arguments.next().map_or(Ok(0), |text| text.parse())?;
    let (mut lost, mut sum) = (0, 0.0);
    for seed in first..first + seeds {
        let config = PerformerConfig {
            seed,
            vertices: VERTICES,
            action: Action::Poses,
            ..PerformerConfig::default()
        };
        let performer = Performer::new(config)?;
        let (source, target) = (performer.frame(0), performer.frame(1));
        let truth = performer.transport(&source, 0, 1);
        let found = registered(&source, &target)?;
        let squared: Vec<f64> =
            found.positions.iter().zip(&truth).map(|(a, b)| distance_squared(*a, *b)).collect();
        let worst = worst_part(&squared, &source.labels);
        sum += root_mean(squared.iter().copied());
        if worst.1 > LOST {
            lost += 1;
            println!("seed {seed}: part {} is {:.0} mm off", worst.0, 1e3 * worst.1);
        }
    }
    let mean = 1e3 * sum / seeds as f64;
    println!("{lost} of {seeds} pairs lost a part; RMS to the truth {mean:.1} mm in the mean");
    Ok(())
}

fn registered(source: &Mesh, target: &Mesh) -> Result<Registration> {
    let (from, to) = (&source.positions, &target.positions);
    Ok(register(from, &source.faces, to, &target.faces, &RegisterOptions::default())?)
}

fn root_mean(values: impl Iterator<Item = f64>) -> f64 {
    let (count, sum) = values.fold((0, 0.0), |(count, sum), value| (count + 1, sum + value));
    (sum / f64::from(count.max(1))).sqrt()
}

/// The label with the largest RMS distance, and that distance.
fn worst_part(squared: &[f64], labels: &[u8]) -> (u8, f64) {
    let of = |part: u8| labels.iter().zip(squared).filter(move |(label, _)| **label == part);
    let parts = (0..=14).map(|part| (part, root_mean(of(part).map(|(_, &value)| value))));
    parts.fold((0, 0.0), |worst, part| if part.1 > worst.1 { part } else { worst })
}
