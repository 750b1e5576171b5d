//! Durations on the command line.

/// Parses a duration with a unit, s.
pub(crate) fn seconds(text: &str) -> Result<f64, String> {
    let end = text.rfind(|c: char| !c.is_ascii_alphabetic()).map_or(0, |last| last + 1);
    let (number, unit) = text.split_at(end);
    let factor = match unit {
        "" | "s" => 1.0,
        "ms" => 1e-3,
        "min" => 60.0,
        "h" => 3600.0,
        _ => return Err(format!("`{unit}` is no unit of time; expected s, ms, min or h")),
    };
    match number.trim().parse::<f64>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value * factor),
        Ok(value) => Err(format!("{value} is no duration; it must be greater than 0")),
        Err(_) => Err("expected a time, as in 10s, 1.5min or 500ms".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_read() {
        for (text, expected) in
            [("10s", 10.0), ("10", 10.0), ("1.5min", 90.0), ("500ms", 0.5), ("1e-1s", 0.1), ("1e1", 10.0)]
        {
            assert!((seconds(text).unwrap() - expected).abs() < 1e-12, "{text}");
        }
        for text in ["-1s", "0s", "ten", "5 years", "", "nan", "inf"] {
            assert!(seconds(text).is_err(), "{text}");
        }
    }
}
