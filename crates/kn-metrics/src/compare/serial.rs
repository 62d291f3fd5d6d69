//! Comparisons as maps from the names of the metrics to their values.

use std::collections::BTreeMap;

use serde::de::IgnoredAny;
use serde::ser::SerializeMap;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::{Comparison, Metric};

/// The entry of a comparison of two empty frames.
const OF_NOTHING: &str = "both_empty";

impl Serialize for Comparison {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        for (metric, value) in self.iter() {
            map.serialize_entry(metric.name(), &value)?;
        }
        if self.of_nothing {
            map.serialize_entry(OF_NOTHING, &true)?;
        }
        map.end()
    }
}

/// A value of the map; entries of other names may have any.
#[derive(Deserialize)]
#[serde(untagged)]
enum Entry {
    Number(f64),
    /// JSON has no infinity: decibels of equal meshes become null.
    Null(()),
    Flag(bool),
    Other(IgnoredAny),
}

impl<'de> Deserialize<'de> for Comparison {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let entries = BTreeMap::<String, Entry>::deserialize(deserializer)?;
        let value = |metric: Metric| match entries.get(metric.name())? {
            Entry::Number(value) => Some((metric, *value)),
            Entry::Null(()) => Some((metric, f64::INFINITY)),
            Entry::Flag(_) | Entry::Other(IgnoredAny) => None,
        };
        let mut comparison: Self = Metric::ALL.into_iter().filter_map(value).collect();
        comparison.of_nothing = matches!(entries.get(OF_NOTHING), Some(Entry::Flag(true)));
        Ok(comparison)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_comparison_is_a_map_by_name() {
        let one: Comparison = [(Metric::P2sRms, 2.0)].into_iter().collect();
        assert_eq!(serde_json::to_string(&one).expect("JSON"), r#"{"p2s_rms":2.0}"#);
        let read = |text: &str| serde_json::from_str::<Comparison>(text).expect("a comparison");
        assert_eq!(read(r#"{"p2s_rms":2.0,"x":"y"}"#), one);
        let mut nothing = one.clone();
        nothing.of_nothing = true;
        let text = serde_json::to_string(&nothing).expect("JSON");
        assert_eq!((read(&text), &text[..]), (nothing, r#"{"p2s_rms":2.0,"both_empty":true}"#));
        assert_eq!(read(r#"{"d1_psnr":null}"#).get(Metric::D1Psnr), Some(f64::INFINITY));
    }
}
