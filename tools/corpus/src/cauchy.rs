//! Makes `spec/tables/cauchy_huffman.csv` from the Cauchy density.
//!
//! `cargo run -p kn-corpus -- cauchy --check` compares with the file,
//! `--write` replaces it, `--loss` prints the mean length of each code beside the entropy of the
//! density, also for smaller and larger M. Without any of them, the table is printed.
//!
//! Table i is for γ/Δ = 2^((i − 8)/4). A cell's mass is the integral of the density over it, in
//! units of 2^-48; from there on all arithmetic is in integers, so the table has one right answer.

use std::fmt::Write as _;
use std::path::Path;

use anyhow::{Result, bail, ensure};

const TABLES: i32 = 48;
const MAX_LENGTH: usize = 24;

/// Checks, writes or prints the table of the checkout at `root`.
pub(crate) fn run(root: &Path, option: Option<&str>) -> Result<()> {
    let path = root.join("spec/tables/cauchy_huffman.csv");
    let text = csv();
    match option {
        None => print!("{text}"),
        Some("--check") => {
            let same = std::fs::read_to_string(&path)? == text;
            ensure!(same, "{} differs from what the density gives", path.display());
            println!("{} is what the density gives", path.display());
        }
        Some("--write") => std::fs::write(&path, text)?,
        Some("--loss") => print_loss(),
        Some(other) => bail!("cauchy takes --check, --write or --loss, not {other}"),
    }
    Ok(())
}

fn csv() -> String {
    let mut text = String::from("table,max_magnitude,escape_order,escape_length");
    for length in 1..=MAX_LENGTH {
        let _ = write!(text, ",symbols_{length}");
    }
    text.push('\n');
    for table in 0..TABLES {
        let scale = scale(table);
        let order = escape_order(scale);
        let max_magnitude = (1_u32 << order) - 1;
        let (symbols, escape) =
            code_lengths(&masses(scale, max_magnitude), escape_mass(scale, max_magnitude));
        let _ = write!(text, "{table},{max_magnitude},{order},{escape}");
        for length in 1..=MAX_LENGTH {
            let _ = write!(text, ",{}", symbols.iter().filter(|&&l| l == length).count());
        }
        text.push('\n');
    }
    text
}

/// γ/Δ of a table.
fn scale(table: i32) -> f64 {
    // 2^(1/4) and 2^(3/4), correctly rounded.
    const QUARTERS: [f64; 4] =
        [1.0, 1.189_207_115_002_721, std::f64::consts::SQRT_2, 1.681_792_830_507_429];
    let exponent = (table - 8).div_euclid(4);
    QUARTERS[(table - 8).rem_euclid(4) as usize] * 2_f64.powi(exponent)
}

/// k, with M = 2^k − 1 at least about 16γ/Δ, so that the escape takes 4 % of the mass: a tail
/// lighter than Cauchy's then loses little. Beyond M an Exp-Golomb code of order k, whose groups
/// double, has the lengths that the tail of the density asks for.
fn escape_order(scale: f64) -> u32 {
    (4..14).find(|&k| f64::from(1 << k) >= 16.0 * scale).unwrap_or(14)
}

/// Masses of 0, +1, −1, +2, … in units of 2^-48.
fn masses(scale: f64, max_magnitude: u32) -> Vec<u64> {
    let zero = 2.0 * libm::atan(0.5 / scale);
    let one_side = |m: u32| {
        // atan(a) − atan(b) as one arc tangent: nothing cancels.
        let m = f64::from(m);
        libm::atan(scale / (scale * scale + (m * m - 0.25)))
    };
    let sides = (1..=max_magnitude).flat_map(|m| [one_side(m); 2]);
    std::iter::once(zero).chain(sides).map(in_units).collect()
}

fn escape_mass(scale: f64, max_magnitude: u32) -> u64 {
    in_units(2.0 * libm::atan(scale / (f64::from(max_magnitude) + 0.5)))
}

fn in_units(angle: f64) -> u64 {
    (angle / std::f64::consts::PI * 2_f64.powi(48)).round() as u64
}

/// Mean bits a value: the entropy, and codes whose M is 2^(k + 1) − 1 by choices of k.
fn print_loss() {
    println!("table  entropy     k - 2     k - 1         k     k + 1");
    for table in (0..TABLES).step_by(4) {
        let scale = scale(table);
        let order = escape_order(scale);
        print!("{table:5}{:9.3}", entropy(scale));
        for order in [order - 2, order - 1, order, order + 1] {
            print!("{:10.3}", mean_length(scale, order));
        }
        println!();
    }
}

/// Probability of one sign's magnitudes from m on.
fn tail(scale: f64, m: f64) -> f64 {
    libm::atan(scale / (m - 0.5)) / std::f64::consts::PI
}

fn entropy(scale: f64) -> f64 {
    let bits = |p: f64| -p * libm::log2(p);
    let zero = 1.0 - 2.0 * tail(scale, 1.0);
    let mut sum = bits(zero);
    for m in 1..1 << 20 {
        let m = f64::from(m);
        sum += 2.0 * bits(tail(scale, m) - tail(scale, m + 1.0));
    }
    sum
}

fn mean_length(scale: f64, order: u32) -> f64 {
    let max_magnitude = (1_u32 << order) - 1;
    let masses = masses(scale, max_magnitude);
    let (lengths, escape) = code_lengths(&masses, escape_mass(scale, max_magnitude));
    let weigh = |(&mass, &length): (&u64, &usize)| mass as f64 / 2_f64.powi(48) * length as f64;
    let mut sum: f64 = masses.iter().zip(&lengths).map(weigh).sum();
    // Escaped: the group of an Exp-Golomb code that begins at 2^order · 2^ones.
    for ones in 0..20 - order {
        let from = f64::from(1_u32 << (order + ones));
        let mass = 2.0 * (tail(scale, from) - tail(scale, 2.0 * from));
        sum += mass * (escape as f64 + f64::from(2 * ones + 1 + order + 1));
    }
    sum
}

/// Huffman code lengths of the symbols and of the escape.
fn code_lengths(symbols: &[u64], escape: u64) -> (Vec<usize>, usize) {
    let mut leaves: Vec<u64> = symbols.to_vec();
    // The escape goes after the symbols that are at least as likely.
    let place = leaves.partition_point(|&mass| mass >= escape);
    leaves.insert(place, escape);
    leaves.reverse();
    let mut lengths = huffman(&leaves);
    lengths.reverse();
    let escape = lengths.remove(place);
    assert!(
        lengths.is_sorted() && lengths.iter().all(|&l| l <= MAX_LENGTH) && escape <= MAX_LENGTH
    );
    (lengths, escape)
}

/// Huffman code lengths for masses in rising order; of equal masses leaves are merged before pairs.
fn huffman(rising: &[u64]) -> Vec<usize> {
    let leaves = rising.len();
    let mut parent = vec![0; 2 * leaves - 1];
    let mut mass = rising.to_vec();
    let (mut leaf, mut pair) = (0, leaves);
    for node in leaves..2 * leaves - 1 {
        let mut merged = 0;
        for _ in 0..2 {
            let next_is_leaf = leaf < leaves && (pair == node || mass[leaf] <= mass[pair]);
            let next = if next_is_leaf { &mut leaf } else { &mut pair };
            merged += mass[*next];
            parent[*next] = node;
            *next += 1;
        }
        mass.push(merged);
    }
    let mut depth = vec![0; 2 * leaves - 1];
    for node in (0..2 * leaves - 2).rev() {
        depth[node] = depth[parent[node]] + 1;
    }
    depth.truncate(leaves);
    // Equal masses may have got lengths in any order: the likelier, earlier symbol gets the shorter.
    depth.sort_unstable_by(|a, b| b.cmp(a));
    depth
}
