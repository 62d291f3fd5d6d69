//! The known name that an unknown one was meant to be.

/// The share of letters that must agree for a suggestion to help.
const ALIKE: f64 = 0.7;

/// `; did you mean 'NAME'?` with the most similar of `known`, or nothing where none is similar.
pub(crate) fn nearest<'a>(unknown: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    let similarity = |name: &str| strsim::jaro_winkler(unknown, name);
    let best = known.into_iter().max_by(|a, b| similarity(a).total_cmp(&similarity(b)));
    match best.filter(|name| similarity(name) >= ALIKE) {
        Some(name) => format!("; did you mean '{name}'?"),
        None => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_similar_names_are_suggested() {
        assert_eq!(nearest("bimodl", ["baseline", "bimodal"]), "; did you mean 'bimodal'?");
        assert_eq!(nearest("draco", ["baseline", "bimodal"]), "");
        assert_eq!(nearest("x", []), "");
    }
}
