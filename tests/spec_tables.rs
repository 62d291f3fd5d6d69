//! The generated tables are the CSV's, the CSV is sound, and syntax tables and trace use one set of
//! names.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use kn_conform::tables::Table;
use kn_conform::{Spec, load_corpus, stream_trace};
use kn_corpus::rust_tables::{cauchy_source, levels_source};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn read(path: impl AsRef<Path>) -> String {
    let path: PathBuf = root().join(path);
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

#[test]
fn rust_tables_are_generated_from_the_csv() {
    let generated = cauchy_source(&read("spec/tables/cauchy_huffman.csv")).expect("a table");
    assert!(generated == read("crates/kn-bitstream/src/tables/cauchy.rs"), "run kn-corpus tables");
    let generated = levels_source(&read("spec/tables/levels.csv")).expect("a table");
    assert!(generated == read("crates/kn-bitstream/src/tables/levels.rs"), "run kn-corpus tables");
}

#[test]
fn every_huffman_table_is_a_complete_code_for_its_symbols() {
    let table = Table::parse(&read("spec/tables/cauchy_huffman.csv")).expect("a table");
    assert_eq!(table.rows.len(), 48);
    for (index, row) in table.rows.iter().enumerate() {
        let [number, max_magnitude, escape_order, escape_length] = row[..4] else {
            panic!("short")
        };
        let counts = &row[4..];
        assert_eq!(number, index as u64);
        assert_eq!(max_magnitude + 1, 1 << escape_order, "table {index}");
        assert_eq!(counts.iter().sum::<u64>(), 2 * max_magnitude + 1, "table {index}");
        let symbols = (1..).zip(counts).map(|(length, &count)| count << (24 - length));
        assert_eq!(symbols.sum::<u64>() + (1 << (24 - escape_length)), 1 << 24, "table {index}");
    }
}

#[test]
fn levels_rise() {
    let table = Table::parse(&read("spec/tables/levels.csv")).expect("a table");
    for pair in table.rows.windows(2) {
        assert!(pair[0].iter().zip(&pair[1]).all(|(low, high)| low <= high), "{pair:?}");
    }
}

#[test]
fn every_syntax_element_is_a_trace_name_and_the_reverse() {
    let spec = Spec::load(&root().join("spec")).expect("the specification");
    let mut traced = BTreeSet::new();
    for example in &spec.examples {
        let trace = kn_conform::example_trace(example).unwrap_or_default();
        traced.extend(trace.into_iter().map(|line| line.name));
    }
    for stream in load_corpus(&root().join("spec/conformance")).expect("the corpus") {
        let (trace, _) = stream_trace(&std::fs::read(&stream.path).expect("a stream"));
        traced.extend(trace.into_iter().map(|line| line.name));
    }
    // The element of lone descriptors.
    traced.remove("value");
    let listed: BTreeSet<String> =
        spec.syntax.element_names().into_iter().map(str::to_owned).collect();
    assert_eq!(traced, listed);
}
