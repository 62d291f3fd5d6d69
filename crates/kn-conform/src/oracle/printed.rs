//! The numbers that the text prints are those that the literal decoder uses.

use std::path::Path;

use super::BODY_REGIONS;
use super::deform::{COSINE, EXP_CONSTANTS, SINCOS_CONSTANTS, SINE, exponential};
use super::smooth::STRENGTHS;
use super::spread::WEIGHTS;

fn chapter(name: &str) -> String {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../spec"));
    std::fs::read_to_string(folder.join(name)).expect("a chapter")
}

/// Cells of the rows of a Markdown table that begins after `heading`.
fn rows<'t>(text: &'t str, heading: &str) -> Vec<Vec<&'t str>> {
    let lines = text.split(heading).nth(1).expect("the heading").lines();
    let table = lines.skip_while(|line| !line.starts_with('|')).take_while(|l| l.starts_with('|'));
    let cells = |line: &'t str| line.trim_matches('|').split('|').map(str::trim).collect();
    table.skip(2).map(cells).collect()
}

#[test]
fn the_weights_of_table_5_1() {
    let text = chapter("05-intra.md");
    let printed = rows(&text, "Table 5-1: o, m, e");
    assert_eq!(printed.len(), WEIGHTS.len());
    for (row, weights) in printed.iter().zip(WEIGHTS) {
        for (cell, weights) in row[1..].iter().zip(weights) {
            let cell = cell.replace('−', "-");
            let numbers = cell.split(", ").map(|number| number.parse().expect("a number"));
            assert_eq!(numbers.collect::<Vec<i64>>(), weights);
        }
    }
}

#[test]
fn the_regions_of_a_body() {
    let text = chapter("06-semantics.md");
    let mut seen = 0;
    for row in rows(&text, "with the labels and regions of the table below") {
        for triple in row.chunks_exact(3).filter(|triple| !triple[0].is_empty()) {
            let label: usize = triple[0].parse().expect("a label");
            let region = triple[2].split(' ').next().unwrap_or("");
            assert_eq!(region.parse(), Ok(BODY_REGIONS[label]), "label {label}");
            seen += 1;
        }
    }
    assert_eq!(seen, BODY_REGIONS.len());
}

#[test]
fn the_constants_of_the_elementary_functions() {
    let text = chapter("08-deformation.md");
    let digits = |word: &str| word.trim_end_matches(|c: char| !c.is_ascii_hexdigit()).to_owned();
    let words =
        text.split("0x").skip(1).map(|rest| digits(rest.split([' ', '\n']).next().unwrap_or("")));
    let printed: Vec<u64> =
        words.map(|word| u64::from_str_radix(&word, 16).expect("a word")).collect();
    assert_eq!(printed, [SINCOS_CONSTANTS, EXP_CONSTANTS].concat());
}

/// Fractions such as `−1/6`, between two pieces of the text.
fn fractions(text: &str, from: &str, to: &str) -> Vec<f64> {
    let list = text.split(from).nth(1).and_then(|rest| rest.split(to).next()).expect("a list");
    let number = |n: &str| n.parse::<f64>().expect("a number");
    let fraction = |fraction: &str| {
        let fraction = fraction.trim().replace('−', "-");
        fraction.split_once('/').map_or_else(|| number(&fraction), |(a, b)| number(a) / number(b))
    };
    list.split(',').map(fraction).collect()
}

#[test]
fn the_coefficients_of_the_elementary_functions() {
    let text = chapter("08-deformation.md");
    assert_eq!(fractions(&text, "    P: ", "\n"), SINE);
    assert_eq!(fractions(&text, "    C: ", "\n"), COSINE);
    assert_eq!(fractions(&text, "and the coefficients ", ".\n"), exponential());
}

#[test]
fn the_strengths_of_smoothing() {
    let text = chapter("08-deformation.md");
    let printed = rows(&text, "r[smooth.strength]");
    let numbers = |row: &[&str]| -> Vec<f64> {
        row[1..].iter().map(|cell| cell.parse().expect("a number")).collect()
    };
    assert_eq!(printed.len(), 2);
    assert_eq!(numbers(&printed[0]), STRENGTHS.map(|(mu, _)| mu));
    assert_eq!(numbers(&printed[1]), STRENGTHS.map(|(_, omega)| omega));
}

#[test]
fn the_table_of_steps() {
    let text = chapter("07-motion.md");
    let row = text.lines().find(|line| line.starts_with("| T(s) |")).expect("the row");
    let head = text.lines().find(|line| line.starts_with("| s |")).expect("the head");
    let cells = |line: &str| {
        line.trim_matches('|').split('|').skip(1).map(|c| c.trim().to_owned()).collect::<Vec<_>>()
    };
    for (s, t) in cells(head).iter().zip(cells(row)) {
        // The first column is a range, `0 … 3`.
        for s in s.split(" … ").map(|s| s.parse::<u32>().expect("a number")) {
            assert_eq!(t, (((4 + u64::from(s % 4)) << (s / 4)) / 4).to_string(), "T({s})");
        }
    }
}
