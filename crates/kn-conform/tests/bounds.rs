//! The reader of kn-bitstream and the ranges of the syntax tables have the same bounds: values at and
//! beyond each bound are tried on both.

use std::collections::BTreeSet;
use std::path::Path;

use kn_bitstream::rule::{self, Rule};
use kn_conform::{Probe, Spec, example_trace};

/// No example begins with the signature; a faulty stream does, with another one.
const NOT_TRIED: (&str, Rule) = ("file_signature", rule::FILE_SIGNATURE_VALUE);

#[test]
fn the_reader_has_the_bounds_of_the_tables() {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../spec"));
    let spec = Spec::load(folder).unwrap_or_else(|error| panic!("{error}"));
    let ranges = spec.syntax.ranges();
    let mut refused = BTreeSet::from([(NOT_TRIED.0, NOT_TRIED.1.id())]);
    for probe in spec.examples.iter().flat_map(|example| spec.probes(example)) {
        let of_element =
            ranges.iter().filter(|(name, _)| probe.what.starts_with(&format!("{name} =")));
        let of_element: Vec<_> = of_element.copied().collect();
        check(&probe, &of_element);
        let broken = of_element.iter().filter(|(_, rule)| Some(*rule) == probe.rule);
        refused.extend(broken.map(|(name, rule)| (*name, rule.id())));
    }
    let all: BTreeSet<_> = ranges.iter().map(|(name, rule)| (*name, rule.id())).collect();
    let untried: Vec<_> = all.difference(&refused).collect();
    assert!(
        untried.is_empty(),
        "no example is sound there, so that no value was tried: {untried:?}"
    );
}

/// The reader refuses what the tables refuse, by the same rule and as soon as it is read.
fn check(probe: &Probe, of_element: &[(&str, Rule)]) {
    let found = example_trace(&probe.example);
    let place = format!("{}: {}", probe.example.place, probe.what);
    match (probe.rule, found) {
        (Some(rule), Err(error)) => {
            assert_eq!(error.rule(), Some(rule), "{place}: {error}");
            assert_eq!(error.bit, probe.end, "{place}: {error}");
        }
        (Some(rule), Ok(_)) => panic!("{place}: the reader does not refuse it by {rule}"),
        (None, Err(error)) => {
            let of_range = of_element.iter().any(|(_, rule)| error.rule() == Some(*rule));
            let of_element = of_range && error.bit <= probe.end;
            assert!(!of_element, "{place}: the tables allow it, the reader says: {error}");
        }
        (None, Ok(_)) => {}
    }
}
