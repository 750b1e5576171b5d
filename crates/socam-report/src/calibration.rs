//! A picture of a line through its pairs and, beside it, of the residuals.

use socam_calibrate::Line;
use socam_plot::{Axis, COLUMNS, Mark, Panel, Plot, Row, Series};

/// A line with its labels.
#[derive(Debug, Clone, PartialEq)]
pub struct Titled<'a> {
    /// Title of its row.
    pub title: String,
    /// Quantity and unit of x.
    pub over: String,
    /// Quantity and unit of y.
    pub of: String,
    /// The line.
    pub line: &'a Line,
}

/// Abscissas and ordinates.
type Points = (Vec<f64>, Vec<f64>);

/// The numbers of one row.
struct Drawn {
    line: Points,
    inside: Points,
    outliers: Points,
    /// Residuals, % of the span.
    rest: Points,
    /// Residuals of outliers; they are drawn at the edge, so that the scale suits the other residuals.
    edge: Points,
    edge_label: String,
}

/// Lines, one row each, as a file.
#[must_use]
pub fn svg(lines: &[Titled<'_>]) -> String {
    let drawn: Vec<Drawn> = lines.iter().map(|titled| Drawn::of(titled.line)).collect();
    let rows: Vec<Row<'_>> = lines.iter().zip(&drawn).map(|(titled, drawn)| drawn.row(titled)).collect();
    socam_plot::sheet("Lines through calibration pairs, and what they leave", &rows)
}

impl Drawn {
    fn of(line: &Line) -> Self {
        let (outliers, inside): (Vec<usize>, Vec<usize>) =
            (0..line.pairs.len()).partition(|row| line.outliers.contains(row));
        let pairs =
            |rows: &[usize]| rows.iter().map(|row| (line.pairs[*row][0], line.pairs[*row][1])).unzip();
        let span = (line.gain.value * (line.range[1] - line.range[0])).abs().max(f64::MIN_POSITIVE);
        let left = |row: &usize| {
            let [x, y] = line.pairs[*row];
            (x, 100.0 * (y - line.at(x)) / span)
        };
        let rest: Points = inside.iter().map(left).unzip();
        let most = 1.1 * rest.1.iter().fold(1e-6_f64, |most, rest| most.max(rest.abs()));
        let ends = line.pairs.iter().map(|pair| pair[0]);
        let ends = [ends.clone().fold(f64::INFINITY, f64::min), ends.fold(f64::NEG_INFINITY, f64::max)];
        Self {
            line: ends.into_iter().map(|x| (x, line.at(x))).unzip(),
            inside: pairs(&inside),
            rest,
            edge: outliers.iter().map(left).map(|(x, rest)| (x, rest.clamp(-most, most))).unzip(),
            edge_label: format!("does not belong to the others ({}), at the edge", outliers.len()),
            outliers: pairs(&outliers),
        }
    }

    fn row<'a>(&'a self, titled: &Titled<'_>) -> Row<'a> {
        fn series<'a>(label: &'a str, class: &'a str, mark: Mark, (x, y): &'a Points) -> Series<'a> {
            Series { label, class, mark, x, y, spread: &[] }
        }
        // The labels contain the units.
        let axis = |words: &str| Axis::new(words, "1");
        let plot = |title: &str, y: Axis, series: Vec<Series<'a>>| Plot {
            title: format!("{}: {title}", titled.title),
            x: axis(&titled.over),
            y,
            series: series.into_iter().filter(|series| !series.x.is_empty()).collect(),
            columns: COLUMNS,
        };
        let line = vec![
            series("line", "after", Mark::Line, &self.line),
            series("pairs", "noise", Mark::Points, &self.inside),
            series("does not belong to the others", "before", Mark::Crosses, &self.outliers),
        ];
        let rest = vec![
            series("", "noise", Mark::Points, &self.rest),
            series(&self.edge_label, "before", Mark::Crosses, &self.edge),
        ];
        Row {
            title: titled.title.clone(),
            panels: vec![
                Panel::Plot(plot("line", axis(&titled.of), line)),
                Panel::Plot(plot("what is left", Axis::new("What is left", "% of span"), rest)),
            ],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_whatever_people_wrote() {
        let pairs: Vec<[f64; 2]> = (0..12)
            .map(|i| [f64::from(i), 2.0 * f64::from(i) + if i == 7 { 5.0 } else { 0.01 * f64::from(i % 3) }])
            .collect();
        let line = Line::through("x", "y", &pairs, 0.0).unwrap();
        assert_eq!(line.outliers, [7]);
        let name = "a < b & \"c\"".to_owned();
        let text = svg(&[Titled { title: name.clone(), over: name.clone(), of: name, line: &line }]);
        assert!(text.contains("a &lt; b &amp;") && !text.contains("a < b"), "{text}");
        assert!(text.contains("does not belong to the others (1), at the edge"));
    }
}
