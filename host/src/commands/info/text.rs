//! The contents of a recording in words.

use std::fmt::Write;

use socam_recording::{LogContents, Statistics};

use super::contents::Info;

impl Info {
    pub(super) fn to_text(&self) -> String {
        let mut text = String::new();
        // Writing to a String cannot fail.
        let _ = self.write_text(&mut text);
        text
    }

    fn write_text(&self, out: &mut String) -> std::fmt::Result {
        match &self.foreign {
            Some(kind) => writeln!(out, "{}: {kind}", self.recording)?,
            None => writeln!(out, "{}: {}", self.recording, self.format)?,
        }
        match (self.duration_s, self.rate_hz) {
            (Some(duration_s), Some(rate_hz)) => writeln!(
                out,
                "  {} rows over {} s at {} Hz, from {} s",
                self.rows,
                short(duration_s),
                short(rate_hz),
                short(self.start_s.unwrap_or(0.0)),
            )?,
            _ => writeln!(out, "  {} rows", self.rows)?,
        }
        if let Some([from, to]) = &self.clock {
            writeln!(out, "  from {from} to {to} by the clock that stamped it")?;
        }
        self.write_channels(out)?;
        self.write_missing(out)?;
        if let Some(log) = &self.log {
            write_log(out, log)?;
        }
        for warning in &self.warnings {
            writeln!(out, "  warning: {warning}")?;
        }
        Ok(())
    }

    fn write_channels(&self, out: &mut String) -> std::fmt::Result {
        let width = self.channels.iter().map(|c| c.name.len()).max().unwrap_or(0);
        let width = width.max("channel".len());
        writeln!(
            out,
            "  {:width$}  {:6} {:>12} {:>12} {:>12} {:>12} {:>9}",
            "channel", "unit", "min", "mean", "max", "std", "missing"
        )?;
        for channel in &self.channels {
            let number = |of: fn(&Statistics) -> Option<f64>| {
                let value = channel.statistics.as_ref().and_then(of);
                value.map_or_else(|| "-".into(), short)
            };
            writeln!(
                out,
                "  {:width$}  {:6} {:>12} {:>12} {:>12} {:>12} {:>9}",
                channel.name,
                channel.unit.symbol(),
                number(|s| s.min),
                number(|s| s.mean),
                number(|s| s.max),
                number(|s| s.std),
                channel.statistics.map_or_else(|| "-".into(), |s| s.missing.to_string()),
            )?;
        }
        Ok(())
    }

    fn write_missing(&self, out: &mut String) -> std::fmt::Result {
        match self.gaps.len() {
            0 if self.duration_s.is_some() => writeln!(out, "  no gaps")?,
            0 => {}
            1 => writeln!(out, "  1 gap:")?,
            count => writeln!(out, "  {count} gaps:")?,
        }
        for gap in self.gaps.iter().take(10) {
            writeln!(out, "    {} s to {} s ({} rows)", gap.from_s, gap.to_s, gap.rows)?;
        }
        if self.gaps.len() > 10 {
            writeln!(out, "    and {} more (all with --json)", self.gaps.len() - 10)?;
        }
        if let Some(lost) = self.lost_samples {
            writeln!(out, "  {lost} samples missing: lost while recording, or in damaged parts")?;
        }
        if let Some(cut) = &self.cut {
            writeln!(
                out,
                "  cut off at byte {} ({} bytes after it are unusable); missing: {}",
                cut.byte, cut.unused_bytes, cut.missing
            )?;
        }
        Ok(())
    }
}

fn write_log(out: &mut String, log: &LogContents) -> std::fmt::Result {
    writeln!(out, "  written by {}", log.library)?;
    for (name, text) in &log.metadata {
        match text.parse().ok().filter(|_| name == "start_unix_ns") {
            Some(start_unix_ns) => writeln!(out, "  started: {}", utc(start_unix_ns))?,
            None => writeln!(out, "  {name}: {text}")?,
        }
    }
    for attachment in &log.attachments {
        writeln!(
            out,
            "  attachment {} ({}, {} bytes)",
            attachment.name, attachment.media_type, attachment.bytes
        )?;
    }
    if let Some(status) = &log.last_status {
        writeln!(
            out,
            "  last status: {}, {} overruns, {} lost, {} link errors",
            status.state, status.overruns, status.lost, status.link_errors
        )?;
    }
    for event in log.events.iter().take(20) {
        let time_s = event.device_time_ns as f64 / 1e9;
        writeln!(out, "  event at {time_s} s: {}: {}", event.kind, event.text)?;
    }
    if log.events.len() > 20 {
        writeln!(out, "  and {} more events (with --json)", log.events.len() - 20)?;
    }
    Ok(())
}

/// Date and time of day.
fn utc(unix_ns: u64) -> String {
    let seconds = unix_ns / 1_000_000_000;
    let (time, days) = (seconds % 86_400, seconds / 86_400);
    // Years that begin in March end with the leap day; every 400 of them have 146 097 days, from 0000-03-01 on.
    let days = days + 719_468;
    let (era, day) = (days / 146_097, days % 146_097);
    let year = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let month = (5 * day + 2) / 153;
    let day = day - (153 * month + 2) / 5 + 1;
    let (year, month) = if month < 10 { (year, month + 3) } else { (year + 1, month - 9) };
    let (hour, minute, second) = (time / 3600, time / 60 % 60, time % 60);
    format!("{:04}-{month:02}-{day:02} {hour:02}:{minute:02}:{second:02} UTC", era * 400 + year)
}

/// A number with six significant digits, in its shortest form.
fn short(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let magnitude = value.abs().log10().floor() as i32;
    if (-4..9).contains(&magnitude) {
        let decimals = (5 - magnitude).max(0) as usize;
        let text = format!("{value:.decimals$}");
        if text.contains('.') {
            return text.trim_end_matches('0').trim_end_matches('.').to_owned();
        }
        return text;
    }
    format!("{value:.5e}")
}

#[cfg(test)]
mod tests;
