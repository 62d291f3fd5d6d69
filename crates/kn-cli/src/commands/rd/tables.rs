//! Points of other codecs from a CSV table.

use super::curves::{Curve, Point};
use anyhow::{Context, Result, bail};
use csv::StringRecord;
use serde::Deserialize;
use std::path::Path;

/// The names of the columns; a metric whose column keeps its usual name may be absent.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Columns {
    sequence: Option<String>,
    codec: Option<String>,
    point: Option<String>,
    bytes: Option<String>,
    msdm2: Option<String>,
    p2s_psnr: Option<String>,
    d1_psnr: Option<String>,
    d2_psnr: Option<String>,
}

/// The places of the columns.
struct Places {
    sequence: usize,
    codec: usize,
    point: Option<usize>,
    bytes: usize,
    /// In the order of `Quality::ALL`.
    values: [Option<usize>; 4],
}

impl Columns {
    fn find(&self, header: &StringRecord) -> Result<Places> {
        let place = |name: &str| header.iter().position(|title| title.trim() == name);
        let needed = |given: &Option<String>, usual: &str| {
            let name = given.as_deref().unwrap_or(usual);
            place(name).with_context(|| {
                let titles = header.iter().collect::<Vec<_>>().join(", ");
                format!("there is no column '{name}' (there are {titles})")
            })
        };
        let wanted = |given: &Option<String>, usual: &str| match given {
            Some(_) => needed(given, usual).map(Some),
            None => Ok(place(usual)),
        };
        let places = Places {
            sequence: needed(&self.sequence, "sequence")?,
            codec: needed(&self.codec, "codec")?,
            point: wanted(&self.point, "point")?,
            bytes: needed(&self.bytes, "bytes_per_frame")?,
            values: [
                wanted(&self.msdm2, "msdm2")?,
                wanted(&self.p2s_psnr, "p2s_psnr")?,
                wanted(&self.d1_psnr, "d1_psnr")?,
                wanted(&self.d2_psnr, "d2_psnr")?,
            ],
        };
        if places.values == [None; 4] {
            bail!("there is no column 'msdm2', 'p2s_psnr', 'd1_psnr' or 'd2_psnr'");
        }
        Ok(places)
    }
}

/// The curves that a table holds, rows of the same sequence and codec together. Rows without a
/// number of bytes are no points of a curve and are left out.
///
/// # Errors
/// A column is missing, a number is none: file, line and column are named.
pub(super) fn read(
    path: &Path,
    columns: &Columns,
    codecs: Option<&[String]>,
) -> Result<Vec<Curve>> {
    let name = || path.display().to_string();
    let mut reader = csv::Reader::from_path(path).with_context(name)?;
    let places = columns.find(reader.headers().with_context(name)?).with_context(name)?;
    let titles = reader.headers().with_context(name)?.clone();
    let mut curves: Vec<Curve> = Vec::new();
    for record in reader.into_records() {
        let record = record.with_context(name)?;
        let codec = &record[places.codec];
        if codecs.is_some_and(|codecs| !codecs.iter().any(|wanted| wanted == codec)) {
            continue;
        }
        let line = record.position().map_or(0, csv::Position::line);
        let point = places.point_of(&record, &titles);
        let Some(point) = point.with_context(|| format!("{}: line {line}", name()))? else {
            continue;
        };
        let sequence = &record[places.sequence];
        match curves.iter_mut().find(|curve| curve.sequence == sequence && curve.codec == codec) {
            Some(curve) => curve.points.push(point),
            None => curves.push(Curve {
                sequence: sequence.into(),
                codec: codec.into(),
                foreign: true,
                points: vec![point],
            }),
        }
    }
    if let Some(missing) = codecs.and_then(|codecs| {
        codecs.iter().find(|codec| curves.iter().all(|curve| curve.codec != **codec))
    }) {
        bail!("{}: there is no row of the codec '{missing}'", name());
    }
    Ok(curves)
}

impl Places {
    fn point_of(&self, record: &StringRecord, titles: &StringRecord) -> Result<Option<Point>> {
        let number = |at: usize| -> Result<Option<f64>> {
            let text = record[at].trim();
            if text.is_empty() {
                return Ok(None);
            }
            match text.parse::<f64>() {
                Ok(value) if value.is_finite() => Ok(Some(value)),
                _ => bail!("'{text}' in the column {} is not a number", &titles[at]),
            }
        };
        let Some(bytes) = number(self.bytes)? else { return Ok(None) };
        if bytes <= 0.0 {
            bail!("{bytes} in the column {} is not positive", &titles[self.bytes]);
        }
        let mut values = [None; 4];
        for (value, place) in values.iter_mut().zip(self.values) {
            *value = place.map(number).transpose()?.flatten();
        }
        let name = self.point.map_or("", |at| &record[at]);
        Ok(Some(Point::foreign(name.into(), bytes, values)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::commands::rd::curves::Quality;
    use crate::commands::rd::results::Share;
    use std::fs;

    fn curves(text: &str, columns: &str, codecs: Option<&[String]>) -> Result<Vec<Curve>> {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.csv");
        fs::write(&path, text).expect("written");
        read(&path, &toml::from_str(columns).expect("columns"), codecs)
    }

    const TEXT: &str = "sequence,codec,rate,msdm2_sym,p2s_psnr\n\
        a,x,100,0.5,60\na,x,200,,61\nb,x,100,0.4,60\na,y,50,0.9,40\na,still,,0.3,50\n";
    const COLUMNS: &str = "bytes = 'rate'\nmsdm2 = 'msdm2_sym'";

    #[test]
    fn rows_become_curves() {
        let found = curves(TEXT, COLUMNS, None).expect("sound");
        let names: Vec<_> = found.iter().map(|c| (c.sequence.as_str(), c.codec.as_str())).collect();
        assert_eq!(names, [("a", "x"), ("b", "x"), ("a", "y")]);
        assert_eq!(found[0].line(Quality::P2s, Share::All).len(), 2);
        assert_eq!(found[0].line(Quality::Msdm2, Share::All), [(100.0, 0.5, "")]);
        let only = curves(TEXT, COLUMNS, Some(&["y".into()])).expect("sound");
        assert_eq!(only.len(), 1);
    }

    #[test]
    fn faults_name_file_line_and_column() {
        let message = |text: &str, columns: &str| {
            let error = curves(text, columns, None).expect_err("a fault");
            format!("{error:#}")
        };
        let missing = message(TEXT, "");
        assert!(missing.contains("a.csv: there is no column 'bytes_per_frame' (there are"));
        let bad = message(&TEXT.replace("200", "2oo"), COLUMNS);
        assert!(bad.ends_with("a.csv: line 3: '2oo' in the column rate is not a number"), "{bad}");
        let ragged = message(&TEXT.replace("a,y,50,0.9,40", "a,y"), COLUMNS);
        assert!(ragged.contains("line: 5"), "{ragged}");
        let none = message("sequence,codec,bytes_per_frame\n", "");
        assert!(none.contains("there is no column 'msdm2'"), "{none}");
        let codec = curves(TEXT, COLUMNS, Some(&["z".into()])).expect_err("no such codec");
        assert!(codec.to_string().ends_with("there is no row of the codec 'z'"));
    }
}
