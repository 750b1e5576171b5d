//! Cells of a line, and the numbers in them.

/// A cell's content.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Cell {
    Number(f64),
    /// Nanoseconds since 1970.
    Date(i64),
    /// Empty, or a word for "no value".
    Missing,
    Text,
}

/// Words that programs write where there is no value, in small letters.
const MISSING: [&str; 14] =
    ["", "nan", "-nan", "nan(ind)", "1.#qnan", "na", "n/a", "#n/a", "null", "none", "-", "--", "inf", "-inf"];

/// What a cell holds.
pub(crate) fn cell(text: &str, decimal_comma: bool, date: Option<&str>) -> Cell {
    let text = text.trim().trim_matches('"').trim();
    if let Some(number) = number(text, decimal_comma) {
        return Cell::Number(number);
    }
    if let Some(date) = crate::dates::nanoseconds(text, date) {
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

fn number(text: &str, decimal_comma: bool) -> Option<f64> {
    if !text.starts_with(|c: char| c.is_ascii_digit() || "+-.,".contains(c)) {
        return None;
    }
    let plain =
        text.parse::<f64>().ok().filter(|_| !(decimal_comma && text.contains('.') && text.contains(',')));
    let parsed = match (plain, decimal_comma) {
        (Some(number), _) => Some(number),
        // Points and blanks between thousands.
        (None, true) => {
            text.replace(['.', '\u{a0}', '\u{202f}', ' ', '\''], "").replace(',', ".").parse().ok()
        }
        (None, false) => None,
    };
    parsed.filter(|number| number.is_finite())
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
            ("+2e-3", false, 2e-3),
            ("\"3.25\"", false, 3.25),
            (" .5 ", false, 0.5),
        ] {
            assert_eq!(cell(text, comma, None), Cell::Number(value), "{text}");
        }
        assert_eq!(cell("1,5", false, None), Cell::Text);
        assert_eq!((cell("NaN", false, None), cell("", true, None)), (Cell::Missing, Cell::Missing));
        assert_eq!(cell("1e999", false, None), Cell::Text);
    }

    #[test]
    fn a_separator_within_quotes_separates_nothing() {
        assert_eq!(split("a,\"b,c\",d", b','), ["a", "\"b,c\"", "d"]);
        assert_eq!(split("  1   2 ", b' '), ["1", "2"]);
    }
}
