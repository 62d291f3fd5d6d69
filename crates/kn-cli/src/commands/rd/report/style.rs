//! Style of the report: colours and markers of the codecs.

/// The style sheet of the page.
pub(super) const CSS: &str = include_str!("style.css");

/// Colours that stay apart for most eyes (after Okabe and Ito), then darker ones.
const COLOURS: [&str; 10] = [
    "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#6a3d9a", "#8c564b",
    "#444444", "#a6761d",
];

/// The colour of codec number `look`.
pub(super) fn colour(look: usize) -> &'static str {
    COLOURS[look % COLOURS.len()]
}

/// The marker of codec number `look` at a place: a shape per codec, so that colour is not needed.
pub(super) fn marker(look: usize, x: f64, y: f64) -> String {
    let colour = colour(look);
    let polygon = |offsets: &[(f64, f64)]| {
        let at = |&(dx, dy): &(f64, f64)| format!("{:.1},{:.1}", x + dx, y + dy);
        let points: Vec<String> = offsets.iter().map(at).collect();
        format!("<polygon fill=\"{colour}\" points=\"{}\"/>", points.join(" "))
    };
    match look % 5 {
        0 => format!("<circle fill=\"{colour}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\"/>"),
        1 => polygon(&[(-3.7, -3.7), (3.7, -3.7), (3.7, 3.7), (-3.7, 3.7)]),
        2 => polygon(&[(0.0, -4.8), (4.6, 3.4), (-4.6, 3.4)]),
        3 => polygon(&[(0.0, -5.2), (5.2, 0.0), (0.0, 5.2), (-5.2, 0.0)]),
        _ => polygon(&[(0.0, 4.8), (4.6, -3.4), (-4.6, -3.4)]),
    }
}

/// Style of a line whose numbers come from a table.
pub(super) fn dashes(foreign: bool) -> &'static str {
    if foreign { " stroke-dasharray=\"5 3\"" } else { "" }
}
