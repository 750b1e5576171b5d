//! The text of a proposed mapping.

use std::fmt::Write as _;
use std::path::Path;

use super::draft::Draft;
use super::{MOST_CHANNELS, Proposed, ProposedClock};
use crate::mapping::{SCHEMA, Stamps};
use crate::source::Source;
use crate::text::TextLayout;

pub(super) fn mapping(path: &Path, draft: &Draft) -> String {
    let source = &draft.source;
    let mut text = format!("schema = {}\n", quoted(SCHEMA));
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let _ = writeln!(text, "source = {}", quoted(&name));
    if let Some(layout) = &source.text {
        lines(&mut text, layout);
    }
    if let Some(dbc) = &source.dbc {
        let _ = writeln!(text, "\n[can]\ndbc = {}", quoted(&dbc.to_string_lossy()));
    }
    for clock in &draft.clocks {
        self::clock(&mut text, source, clock);
    }
    let (mut written, mut left) = (0, Vec::new());
    for proposed in &draft.channels {
        if proposed.is_constant() && proposed.unit.is_none() {
            let value = proposed.range.map_or(String::new(), |(low, _)| format!(": {low}"));
            left.push(format!("{} (constant{value})", proposed.signal));
        } else if written == MOST_CHANNELS {
            left.push(proposed.signal.clone());
        } else {
            written += 1;
            channel(&mut text, proposed);
        }
    }
    if !left.is_empty() {
        text.push_str("\n# Not proposed as channels:\n");
        left.iter().for_each(|signal| text.push_str(&format!("#   {}\n", comment(signal))));
    }
    text
}

pub(super) fn lines(text: &mut String, layout: &TextLayout) {
    let separator = match layout.separator {
        b'\t' => "tab".to_owned(),
        b' ' => "space".to_owned(),
        other => char::from(other).to_string(),
    };
    text.push_str("\n[text]\n");
    let _ = writeln!(text, "encoding = {}", quoted(&layout.encoding));
    let _ = writeln!(text, "separator = {}", quoted(&separator));
    let _ = writeln!(text, "decimal = {}", quoted(if layout.decimal_comma { "," } else { "." }));
    for (key, line) in [("header_line", layout.header_line), ("units_line", layout.units_line)] {
        if line > 0 {
            let _ = writeln!(text, "{key} = {line}");
        }
    }
    let _ = writeln!(text, "first_line = {}", layout.first_line);
    if layout.ends_in_separator {
        text.push_str("ends_in_separator = true\n");
    }
}

fn clock(text: &mut String, source: &Source, clock: &ProposedClock) {
    let group = &source.groups[clock.group];
    text.push_str("\n[[clocks]]\n");
    if !group.name.is_empty() || source.groups.len() > 1 {
        let _ = writeln!(text, "group = {}", quoted(&group.name));
    }
    match &clock.time {
        Some((column, unit)) => {
            let _ = writeln!(text, "time = {}", quoted(&group.signals[*column].name));
            let why = clock
                .assumed
                .as_ref()
                .map_or(String::new(), |why| format!("   # not stated in the file: {why}"));
            if !group.signals[*column].is_date {
                let _ = writeln!(text, "unit = {}{why}", quoted(unit));
            }
        }
        None => {
            text.push_str("# No signal of it increases like a time. Write its rate, or name the signal with the times and its unit:\n");
            text.push_str("# time = \"...\"\n# unit = \"s\"\nrate_Hz = \"?\"\n");
        }
    }
    if clock.stamps == Stamps::Jitter {
        text.push_str("stamps = \"jitter\"   # stamps repeat: they are coarser than the sampling\n");
    }
    if let Some((offset_s, why)) = &clock.offset {
        let _ = writeln!(text, "# offset_s = {offset_s:.6}   # {}", comment(why));
    }
}

fn channel(text: &mut String, proposed: &Proposed) {
    let key = if proposed.name.contains('.') { quoted(&proposed.name) } else { proposed.name.clone() };
    let _ = writeln!(text, "\n[channels.{key}]");
    let _ = writeln!(text, "signal = {}", quoted(&proposed.signal));
    match &proposed.unit {
        Some(unit) => {
            let by_letter = proposed.column.is_letter && !proposed.is_own;
            let doubt = if by_letter { "   # by the end of its name; is that an index?" } else { "" };
            let _ = writeln!(text, "unit = {}{doubt}", quoted(unit));
        }
        None if proposed.is_counts() => {
            text.push_str("unit = \"counts\"\ncounts_per_turn = \"?\"   # or counts_per_m; after four-fold decoding, if there is one\n");
        }
        None => {
            let guess = comment(proposed.guess.trim_start_matches(','));
            let _ = writeln!(
                text,
                "unit = \"?\"   # not stated in the file:{}",
                if guess.is_empty() { " write it".into() } else { format!(" {}", guess.trim_start()) }
            );
        }
    }
    if let Some((low, high)) = proposed.range {
        let missing = if proposed.missing > 0 {
            format!(", {} of {} missing", proposed.missing, proposed.rows)
        } else {
            String::new()
        };
        let _ = writeln!(text, "# in the file from {low} to {high}{missing}");
    }
}

/// Makes a text safe for a comment: names come from files of unknown origin.
fn comment(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}

/// A string of TOML.
pub(super) fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}
