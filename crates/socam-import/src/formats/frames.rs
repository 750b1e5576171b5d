//! Logs of a CAN bus in text, recognised by their first lines.

/// Whether a text begins like a log of candump: `(1.5) can0 123#DEADBEEF`, or `can0  123   [4]  DE AD BE EF`.
pub(super) fn is_candump(head: &str) -> bool {
    let first = head.lines().map(str::trim).find(|line| !line.is_empty()).unwrap_or_default();
    let behind_time = first.strip_prefix('(').and_then(|rest| rest.split_once(')'));
    let mut words = behind_time.map_or(first, |(_, rest)| rest).split_whitespace();
    let (Some(_), Some(frame)) = (words.next(), words.next()) else { return false };
    let (id, has_length) = match frame.split_once('#') {
        Some((id, _)) => (id, true),
        None => (frame, words.any(|word| word.starts_with('[') && word.ends_with(']'))),
    };
    has_length && matches!(id.len(), 3 | 8) && id.bytes().all(|byte| byte.is_ascii_hexdigit())
}

/// Whether a text begins like Vector's: with the base of its numbers in the first lines.
pub(super) fn is_asc(head: &str) -> bool {
    head.lines().take(4).any(|line| {
        let words: Vec<&str> = line.split_whitespace().collect();
        matches!(words.as_slice(), ["base", "hex" | "dec", "timestamps", ..])
    })
}

#[cfg(test)]
mod tests {
    use super::{is_asc, is_candump};

    #[test]
    fn logs_are_told_from_tables() {
        for log in
            ["(1.5) can0 123#DEADBEEF\n", "\n (1.5)  vcan0  18FEF100   [2]  DE AD\n", "can0  123   [0]\n"]
        {
            assert!(is_candump(log), "{log}");
        }
        for table in ["time,speed\n", "(s) rpm\n", "1 123 4\n", "a 12#3\n", "torque [Nm]\n", "t abc [Nm\n"] {
            assert!(!is_candump(table), "{table}");
        }
        assert!(is_asc("date Sat Jan 1 00:00:00.000 2021\nbase hex  timestamps absolute\n"));
        assert!(!is_asc("base,height\n1,2\n"));
    }
}
