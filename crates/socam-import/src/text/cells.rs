//! Cells of a line, and the numbers in them.

use crate::dates::{Moment, moment};

/// A cell's content.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Cell {
    Number(f64),
    Date(Moment),
    /// Empty, or a word for "no value".
    Missing,
    Text,
}

/// Words that programs write where there is no value, in small letters.
const MISSING: [&str; 14] =
    ["", "nan", "-nan", "nan(ind)", "1.#qnan", "na", "n/a", "#n/a", "null", "none", "-", "--", "inf", "-inf"];

/// Interprets the content of a cell.
pub(crate) fn cell(text: &str, decimal_comma: bool, date: Option<&str>) -> Cell {
    let text = text.trim().trim_matches('"').trim();
    if let Some(number) = number(text, decimal_comma) {
        return Cell::Number(number);
    }
    if let Some(date) = moment(text, date) {
        return Cell::Date(date);
    }
    let small = text.to_ascii_lowercase();
    match small.as_str() {
        "true" | "on" => Cell::Number(1.0),
        "false" | "off" => Cell::Number(0.0),
        word if MISSING.contains(&word) => Cell::Missing,
        _ => Cell::Text,
    }
}

/// Notation of a number, where it is ambiguous.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Style {
    /// The notation follows the file's decimal sign.
    Plain,
    /// `0.5` in a file with decimal commas.
    Pointed,
    /// Groups of three digits and no decimals: `1.001` with decimal commas, `1,001` with decimal points.
    Grouped,
}

/// The style of a cell that holds a number.
pub(crate) fn style(text: &str, decimal_comma: bool) -> Style {
    let text = text.trim().trim_matches('"').trim();
    let (decimal, other) = if decimal_comma { (',', '.') } else { ('.', ',') };
    match text.contains(decimal) || !text.contains(other) {
        true => Style::Plain,
        false if grouped(text, decimal).is_some() => Style::Grouped,
        false => Style::Pointed,
    }
}

fn number(text: &str, decimal_comma: bool) -> Option<f64> {
    if !text.starts_with(|c: char| c.is_ascii_digit() || "+-.,".contains(c)) {
        return None;
    }
    let parsed = if decimal_comma {
        let decimal =
            || text.replace(',', ".").parse().ok().filter(|_| !(text.contains(',') && text.contains('.')));
        grouped(text, ',').or_else(decimal)
    } else {
        text.parse::<f64>().ok().or_else(|| grouped(text, '.'))
    };
    parsed.filter(|number| number.is_finite())
}

/// A number whose digits before the decimal sign form groups of three, with the same sign between all groups.
fn grouped(text: &str, decimal: char) -> Option<f64> {
    const MARKS: [char; 7] = ['.', ',', '\'', '\u{2019}', '\u{a0}', '\u{202f}', ' '];
    let digits = text.strip_prefix(['-', '+']).unwrap_or(text);
    let (whole, decimals) = digits.split_once(decimal).unwrap_or((digits, ""));
    let mark = whole.chars().find(|c| MARKS.contains(c) && *c != decimal)?;
    let is_digits = |part: &str| part.bytes().all(|byte| byte.is_ascii_digit());
    let mut groups = whole.split(mark);
    let first = groups.next().filter(|first| (1..=3).contains(&first.len()) && !first.starts_with('0'))?;
    let is_grouped = groups.all(|group| group.len() == 3 && is_digits(group));
    if !(is_grouped && is_digits(first) && is_digits(decimals)) {
        return None;
    }
    let size: f64 = format!("{}.{decimals}", whole.replace(mark, "")).parse().ok()?;
    Some(if text.starts_with('-') { -size } else { size })
}

/// Cells of a line of text, quotes respected.
pub(crate) fn split(line: &str, separator: u8) -> Vec<&str> {
    if separator == b' ' {
        return line.split_whitespace().collect();
    }
    let mut cells = Vec::new();
    let (mut start, mut is_quoted) = (0, false);
    for (at, byte) in line.bytes().enumerate() {
        match byte {
            b'"' => is_quoted = !is_quoted,
            _ if byte == separator && !is_quoted => {
                cells.push(&line[start..at]);
                start = at + 1;
            }
            _ => {}
        }
    }
    cells.push(&line[start..]);
    cells
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_all_countries_are_read() {
        for (text, comma, value) in [
            ("1.5", false, 1.5),
            ("-1,5", true, -1.5),
            ("1.234,5", true, 1234.5),
            ("1 234,5", true, 1234.5),
            ("1.5", true, 1.5),
            ("1.001", true, 1001.0),
            ("-1.234.567,5", true, -1_234_567.5),
            ("1'001,5", true, 1001.5),
            ("1'001.5", false, 1001.5),
            ("-1,000.00", false, -1000.0),
            ("2,001", false, 2001.0),
            ("+2e-3", false, 2e-3),
            ("\"3.25\"", false, 3.25),
            (" .5 ", false, 0.5),
        ] {
            assert_eq!(cell(text, comma, None), Cell::Number(value), "{text}");
        }
        for (text, comma) in
            [("1,5", false), ("0,001", false), ("1,000.5", true), ("1.00,5", true), ("1,0000", false)]
        {
            assert_eq!(cell(text, comma, None), Cell::Text, "{text}");
        }
        assert_eq!((cell("NaN", false, None), cell("", true, None)), (Cell::Missing, Cell::Missing));
        assert_eq!(cell("1e999", false, None), Cell::Text);
    }

    #[test]
    fn a_separator_within_quotes_separates_nothing() {
        assert_eq!(split("a,\"b,c\",d", b','), ["a", "\"b,c\"", "d"]);
        assert_eq!(split("  1   2 ", b' '), ["1", "2"]);
    }
}
