//! Differences of recordings: at the sample times of one recording, the reference interpolated.

use egui::Ui;

use super::content::{self, Frame, having};
use socam_chart::chart::Curve;
use socam_chart::theme;
use socam_chart::thin::thinned;
use socam_samples::Samples;
use socam_workbench::entry::{Entry, name_among};
use socam_workbench::signal::Signal;

/// Greatest number of rows in the picture for which differences are computed.
const MOST_ROWS: usize = 500_000;

/// Text of a chart without differences.
pub(super) const WHY_NONE: &str = "no difference here: the reference or the other recordings lack this channel, or more than 500 000 rows are shown (zoom in)";

/// Differences of channels between all shown recordings and the reference.
pub(super) fn curves(
    ui: &Ui,
    entries: &[Entry],
    reference: usize,
    signals: &[Signal],
    frame: Frame<'_>,
) -> Vec<Curve> {
    let other = &entries[reference];
    let per_si = content::axis(signals, frame.units).per_si;
    let mut curves = Vec::new();
    for signal in signals {
        let Some((other_samples, other_channel)) = other.find(signal) else { continue };
        for (entry, samples, channel) in having(entries, signal, frame.lit) {
            let [from, to] = frame.x.map(|x| samples.row_at(x - entry.shift_s));
            if entry.number == other.number || to.saturating_sub(from) > MOST_ROWS {
                continue;
            }
            let later = entry.shift_s - other.shift_s;
            let times = samples.times(from..to);
            let reference = at_times(other_samples, other_channel, times.iter().map(|time| time + later));
            let values = samples.values(channel, from..to);
            let differences = values.iter().zip(reference).map(|(value, other)| per_si * (value - other));
            let points: Vec<[f64; 2]> =
                times.iter().zip(differences).map(|(time, value)| [time + entry.shift_s, value]).collect();
            let parts = thinned(&points, frame.pixels);
            let name = name_among(entries, entry).to_owned();
            let colour = content::colour(ui, entry, frame.lit, entries.len());
            curves.push(Curve { name, colour, parts, style: theme::style(entry.number) });
        }
    }
    curves
}

/// Interpolated values at given times; NaN in gaps and outside.
fn at_times(samples: &Samples, channel: usize, times: impl Iterator<Item = f64>) -> Vec<f64> {
    let wanted: Vec<f64> = times.collect();
    let (Some(first), Some(last)) = (wanted.first(), wanted.last()) else { return Vec::new() };
    let rows = samples.row_at(*first).saturating_sub(1)..(samples.row_at(*last) + 2).min(samples.rows());
    let (times, values) = (samples.times(rows.clone()), samples.values(channel, rows.clone()));
    let mut ends = samples.segments().iter().map(|segment| segment.end_row() as usize).peekable();
    let mut next = 0;
    wanted
        .iter()
        .map(|time| {
            while next + 1 < times.len() && times[next + 1] <= *time {
                next += 1;
            }
            let row = rows.start + next;
            while ends.peek().is_some_and(|end| *end <= row) {
                ends.next();
            }
            let exact = times.get(next).is_some_and(|own| own == time);
            let crosses_gap = ends.peek().is_none_or(|end| row + 1 >= *end);
            match (times.get(next), times.get(next + 1)) {
                _ if exact => values[next],
                (Some(before), Some(after)) if before <= time && !crosses_gap => {
                    let share = (time - before) / (after - before);
                    values[next] + share * (values[next + 1] - values[next])
                }
                _ => f64::NAN,
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use socam_recording::{Channel, Dataset, Unit};

    #[test]
    fn values_are_interpolated_within_segments_only() {
        let time_s = vec![0.0, 1.0, 2.0, 10.0, 11.0];
        let values = vec![0.0, 10.0, 20.0, 100.0, 110.0];
        let channels = vec![Channel::new("x", Unit::V)];
        let data = Dataset::from_columns("r", channels, time_s.clone(), vec![values.clone()]).unwrap();
        let samples = Samples::in_memory(time_s, &[values], data.segments().to_vec());
        let found = at_times(&samples, 0, [-1.0, 0.0, 0.5, 2.0, 5.0, 10.0, 10.5, 11.0, 12.0].into_iter());
        let expected = [f64::NAN, 0.0, 5.0, 20.0, f64::NAN, 100.0, 105.0, 110.0, f64::NAN];
        for (found, expected) in found.iter().zip(expected) {
            assert!(
                (found - expected).abs() < 1e-4 || found.is_nan() && expected.is_nan(),
                "{found} {expected}"
            );
        }
    }
}
