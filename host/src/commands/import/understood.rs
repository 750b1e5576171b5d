//! Tables of the interpreted content of a file.

use std::fmt::Write as _;

use socam_import::{Imported, Proposal, Proposed, Understood};

use crate::table::{align, number};

/// Longest name that is shown whole.
const LONGEST: usize = 36;

/// The end of a long name is more informative than its middle.
fn short(name: &str) -> String {
    let letters: Vec<char> = name.chars().collect();
    if letters.len() <= LONGEST {
        return name.to_owned();
    }
    let (head, tail) = (LONGEST / 3, LONGEST - LONGEST / 3 - 3);
    format!(
        "{}...{}",
        letters[..head].iter().collect::<String>(),
        letters[letters.len() - tail..].iter().collect::<String>()
    )
}

fn range(range: Option<(f64, f64)>) -> [String; 2] {
    range.map_or_else(|| ["-".into(), "-".into()], |(low, high)| [number(low), number(high)])
}

fn rate(rate_hz: Option<f64>) -> String {
    rate_hz.map_or_else(|| "?".into(), number)
}

/// Table of the interpretation of each signal.
pub(super) fn imported(imported: &Imported) -> String {
    let head =
        ["channel", "from", "unit", "SI per unit", "values", "rate, Hz", "lowest, SI", "highest, SI", ""];
    let row = |channel: &Understood| {
        let [low, high] = range(channel.range);
        vec![
            channel.column.clone(),
            short(&channel.signal),
            channel.unit.clone(),
            number(channel.factor),
            channel.values.to_string(),
            rate(channel.rate_hz),
            low,
            high,
            channel.note.clone(),
        ]
    };
    let rows: Vec<_> =
        std::iter::once(head.map(String::from).to_vec()).chain(imported.channels.iter().map(row)).collect();
    align(&rows, &[false, false, false, true, true, true, true, true, false]).trim_end().to_owned()
}

/// Table of the probable contents of a file, and of the facts that it does not state.
pub(super) fn proposed(proposal: &Proposal) -> String {
    let head = ["signal", "unit", "lowest", "highest", "values", "rate, Hz", "channel"];
    let row = |proposed: &Proposed| {
        let [low, high] = range(proposed.range);
        vec![
            short(&proposed.signal),
            proposed.unit.clone().unwrap_or_else(|| "?".into()),
            low,
            high,
            (proposed.rows - proposed.missing).to_string(),
            rate(proposed.rate_hz),
            proposed.name.clone(),
        ]
    };
    let rows: Vec<_> =
        std::iter::once(head.map(String::from).to_vec()).chain(proposal.channels.iter().map(row)).collect();
    let mut text = format!("{} file; as written in it:\n", proposal.format);
    text.push_str(&align(&rows, &[false, false, true, true, true, true, false]));
    for (title, lines) in [
        ("The file does not say", &proposal.unknown),
        ("Assumed, because the file does not say it", &proposal.assumed),
        ("Left aside", &proposal.notes),
    ] {
        if lines.is_empty() {
            continue;
        }
        let _ = writeln!(text, "{title}:");
        lines.iter().for_each(|line| {
            let _ = writeln!(text, "  {line}");
        });
    }
    let next = if proposal.unknown.is_empty() {
        "The mapping is complete: check it, and import with --map."
    } else {
        "Replace each \"?\" in the mapping, and import with --map."
    };
    text.push_str(next);
    text
}
