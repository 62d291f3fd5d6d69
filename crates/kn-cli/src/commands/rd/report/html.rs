//! Pieces of HTML and SVG: everything that is text goes through [`esc`].

use std::fmt;

/// A text in which no character means anything to HTML or XML.
pub(super) fn esc(text: &str) -> Escaped<'_> {
    Escaped(text)
}

/// See [`esc`].
pub(super) struct Escaped<'t>(&'t str);

impl fmt::Display for Escaped<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for character in self.0.chars() {
            match character {
                '&' => f.write_str("&amp;")?,
                '<' => f.write_str("&lt;")?,
                '>' => f.write_str("&gt;")?,
                '"' => f.write_str("&quot;")?,
                '\'' => f.write_str("&#39;")?,
                // Control characters are forbidden in XML, and invisible.
                c if c.is_control() && c != '\n' => f.write_str("\u{fffd}")?,
                c => write!(f, "{c}")?,
            }
        }
        Ok(())
    }
}

/// A number with so many decimals and a true minus sign; a dash where there is none. Only decibels
/// of equal meshes are infinite.
pub(super) fn number(value: Option<f64>, digits: usize) -> String {
    match value {
        Some(value) if value.is_finite() => format!("{value:.digits$}").replace('-', "\u{2212}"),
        Some(_) => "\u{221e}".into(),
        None => "\u{2013}".into(),
    }
}

/// A table of cells that are HTML already; the first column is a heading of its row.
pub(super) fn table(titles: &[String], rows: &[Vec<String>]) -> String {
    let mut html = String::from("<div class=\"scroll\"><table><thead><tr>");
    html.extend(titles.iter().map(|title| format!("<th scope=\"col\">{title}</th>")));
    html.push_str("</tr></thead><tbody>\n");
    for row in rows {
        html.push_str("<tr>");
        for (column, cell) in row.iter().enumerate() {
            if column == 0 {
                html.push_str(&format!("<th scope=\"row\">{cell}</th>"));
            } else {
                html.push_str(&format!("<td>{cell}</td>"));
            }
        }
        html.push_str("</tr>\n");
    }
    html.push_str("</tbody></table></div>\n");
    html
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_gets_through_as_markup() {
        let text = esc("<script>alert('\"&\u{1b}')</script>").to_string();
        assert_eq!(text, "&lt;script&gt;alert(&#39;&quot;&amp;\u{fffd}&#39;)&lt;/script&gt;");
    }

    #[test]
    fn numbers_have_a_minus_or_a_dash() {
        assert_eq!(number(Some(-1.25), 1), "\u{2212}1.2");
        assert_eq!(number(None, 1), "\u{2013}");
    }
}
