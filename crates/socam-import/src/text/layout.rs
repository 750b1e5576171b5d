//! Layout of a text file, found from its beginning.

use socam_units::{conversion, is_counts, seconds};

use super::cells::{Cell, Style, cell, split, style};

/// Layout of the lines of a text file. Lines count from 1.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TextLayout {
    /// Name of the encoding, as in the WHATWG standard (`utf-8`, `utf-16le`, `windows-1252`).
    pub encoding: String,
    /// Byte between cells; a blank means any number of blanks and tabulators.
    pub separator: u8,
    /// Whether numbers have a decimal comma.
    pub decimal_comma: bool,
    /// Line of the names of the columns; 0 where there is none.
    pub header_line: usize,
    /// Line of the units of the columns; 0 where there is none.
    pub units_line: usize,
    /// First line of numbers.
    pub first_line: usize,
    /// Whether lines end in a separator with nothing behind it.
    pub ends_in_separator: bool,
    /// Words that mark a missing value, in addition to the usual ones.
    pub missing: Vec<String>,
}

impl TextLayout {
    /// Cells of a line, without an empty one behind a last separator.
    #[must_use]
    pub fn cells<'l>(&self, line: &'l str) -> Vec<&'l str> {
        let mut cells = split(line, self.separator);
        if cells.len() > 1
            && cells.last().is_some_and(|cell| cell.trim().is_empty())
            && self.ends_in_separator
        {
            cells.pop();
        }
        cells
    }
}

/// Lines from which the layout is found.
const LINES: usize = 400;
const SEPARATORS: [u8; 5] = [b';', b'\t', b',', b'|', b' '];

/// Finds the layout from the first lines of a file; `None` where nothing looks like a table of numbers.
pub(crate) fn sniff(encoding: &str, text: &str, is_cut: bool) -> Option<TextLayout> {
    let mut lines: Vec<&str> = text.lines().take(LINES).collect();
    if is_cut && lines.len() < LINES {
        lines.pop();
    }
    let mut best: Option<(Score, usize, u8, bool)> = None;
    for separator in SEPARATORS {
        for comma in [false, true] {
            if comma && separator == b',' {
                continue;
            }
            let Some((score, first)) = rate(&lines, separator, comma) else { continue };
            if best.is_none_or(|(other, ..)| score > other) {
                best = Some((score, first, separator, comma));
            }
        }
    }
    let (_, first, separator, decimal_comma) = best?;
    let ends = |line: &str| {
        separator != b' ' && line.trim_end_matches(['\r', '\n']).ends_with(char::from(separator))
    };
    let mut layout = TextLayout {
        encoding: encoding.to_owned(),
        separator,
        decimal_comma,
        header_line: 0,
        units_line: 0,
        first_line: first + 1,
        ends_in_separator: ends(lines[first]),
        missing: Vec::new(),
    };
    layout.find_header(&lines);
    Some(layout)
}

/// Score of a reading of lines; scores are compared field by field, and the first field that differs decides.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
struct Score {
    /// Share and number of the cells that hold numbers.
    numbers: f64,
    /// Minus the cells with the other decimal sign.
    pointed: isize,
    /// Minus the cells with the other sign between groups of digits.
    grouped: isize,
}

impl Score {
    fn of(numbers: &[&&str], cells: usize, comma: bool) -> Self {
        let count = |of: Style| numbers.iter().filter(|text| style(text, comma) == of).count() as isize;
        Self {
            numbers: (numbers.len() * numbers.len()) as f64 / cells as f64,
            pointed: -count(Style::Pointed),
            grouped: -count(Style::Grouped),
        }
    }

    fn plus(self, other: Self) -> Self {
        Self {
            numbers: self.numbers + other.numbers,
            pointed: self.pointed + other.pointed,
            grouped: self.grouped + other.grouped,
        }
    }
}

/// Score of a reading with this separator and decimal sign, and the first line of numbers. The lines scored are the longest run of
/// lines with equally many cells, most of which hold numbers.
fn rate(lines: &[&str], separator: u8, comma: bool) -> Option<(Score, usize)> {
    let mut best: Option<(Score, usize)> = None;
    // First line, cells and score of the run.
    let mut run: Option<(usize, usize, Score)> = None;
    for (index, line) in lines.iter().enumerate() {
        if line.trim().is_empty() {
            continue;
        }
        let cells = split(line, separator);
        let held = |text: &&str| matches!(cell(text, comma, None), Cell::Number(_) | Cell::Date(_));
        let numbers: Vec<&&str> = cells.iter().filter(|text| held(text)).collect();
        if numbers.is_empty() || 2 * numbers.len() < cells.len() {
            run = None;
            continue;
        }
        let gain = Score::of(&numbers, cells.len(), comma);
        run = match run {
            Some((first, count, score)) if count == cells.len() => Some((first, count, score.plus(gain))),
            _ => Some((index, cells.len(), gain)),
        };
        if let Some((first, _, score)) = run
            && best.is_none_or(|(other, _)| score > other)
        {
            best = Some((score, first));
        }
    }
    best
}

impl TextLayout {
    /// The names are in the last line before the numbers that has as many cells; a line of units may stand between.
    fn find_header(&mut self, lines: &[&str]) {
        let width = self.cells(lines[self.first_line - 1]).len();
        let before = |from: usize| {
            let is_header = |at: &usize| {
                let cells = self.cells(header(lines[*at]));
                let filled =
                    cells.iter().rposition(|text| !text.trim().is_empty()).map_or(0, |last| last + 1);
                cells.len() == width || filled == width || is_sequence(&cells)
            };
            (0..from).rev().find(|at| !lines[*at].trim().is_empty()).filter(is_header)
        };
        let Some(last) = before(self.first_line - 1) else { return };
        let above = before(last);
        let cells = self.cells(header(lines[last]));
        let of_units = cells.iter().filter(|text| is_unit(text)).count();
        let filled = cells.iter().filter(|text| !text.trim().is_empty()).count();
        match above {
            Some(above) if filled > 0 && 2 * of_units > filled => {
                (self.header_line, self.units_line) = (above + 1, last + 1);
            }
            _ => self.header_line = last + 1,
        }
    }
}

/// Whether these are the names or units of a table whose first column numbers the samples: oscilloscopes of Rigol write the time of the first
/// and their distance behind the units.
pub(super) fn is_sequence(cells: &[&str]) -> bool {
    cells.first().is_some_and(|first| first.trim() == "Sequence")
        || cells.first().is_some_and(|first| first.trim() == "X")
            && cells.iter().any(|text| text.trim() == "Increment")
}

/// A line without the mark of a comment, which some programs put before names.
pub(super) fn header(line: &str) -> &str {
    line.trim_start_matches(['#', '%', '\u{feff}']).trim_end_matches(['\r', '\n'])
}

fn is_unit(text: &str) -> bool {
    let text = text.trim().trim_matches('"');
    text == "date"
        || text == "Sequence"
        || conversion(text).is_some()
        || seconds(text).is_some()
        || is_counts(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(text: &str) -> (char, bool, usize, usize, usize) {
        let layout = sniff("utf-8", text, false).expect("a table");
        let separator = char::from(layout.separator);
        (separator, layout.decimal_comma, layout.header_line, layout.units_line, layout.first_line)
    }

    #[test]
    fn layouts_of_the_world_are_found() {
        assert_eq!(found("t,x\n0,1\n1,2\n"), (',', false, 1, 0, 2));
        assert_eq!(found("Zeit;n\ns;1/min\n0,001;1,5\n0,002;1,6\n"), (';', true, 1, 2, 3));
        assert_eq!(found("sep=;\nZeit;n\n0;1\n1;2\n"), (';', false, 2, 0, 3));
        assert_eq!(found("# run 7\n# by hand\nt\tx\n0.1\t2\n0.2\t3\n"), ('\t', false, 3, 0, 4));
        assert_eq!(found("  0.0   1.5\n  0.1   1.6\n"), (' ', false, 0, 0, 1));
        assert_eq!(
            found("time,x\n2024-05-01 12:00:00.0,1\n2024-05-01 12:00:00.1,2\n"),
            (',', false, 1, 0, 2)
        );
        assert_eq!(found("%t x y\n1 2 3\n2 3 4\n"), (' ', false, 1, 0, 2));
        assert_eq!(found("a;b;\n1,5;2,5;\n2,5;3,5;\n"), (';', true, 1, 0, 2));
        // Signs between thousands are no decimal signs.
        assert_eq!(found("t;x\n0,000;1.000\n0,001;1.001\n"), (';', true, 1, 0, 2));
        assert_eq!(found("t;x;y\n0.000;1,000;2,000\n0.001;1,001;2,001\n"), (';', false, 1, 0, 2));
        assert_eq!(found("t;x\n0.000;\"1,000.5\"\n0.001;\"1,001.5\"\n"), (';', false, 1, 0, 2));
        assert_eq!(found("t\tx\n0.000\t-993.00\n0.001\t1,093.00\n"), ('\t', false, 1, 0, 2));
        assert_eq!(found("t;x\n1,001;20,500\n1,002;20,501\n"), (';', true, 1, 0, 2));
        assert_eq!(sniff("utf-8", "Dear colleague,\nthe bench is broken.\n", false), None);
    }
}
