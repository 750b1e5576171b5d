//! The spectrum of a channel over time.

use std::ops::Range;

use socam_recording::Segment;
use socam_spectrum::Welch;

use super::densities::TOO_SHORT;
use socam_chart::heat::Cells;
use socam_samples::Samples;
use socam_workbench::job::Handle;

/// Greatest number of windows that a column is averaged over: a picture of any recording takes as long.
const WINDOWS: usize = 4;
/// Greatest relative difference of the sample time of a segment from the usual one; others would have other frequencies.
const SAME_RATE: f64 = 0.01;
/// Decibels below the greatest density that are shown.
const SHOWN_DB: f64 = 90.0;

/// The power spectral density, dB relative to one unit squared per Hz, of the windows of `welch`: `columns` over a range of time,
/// s, and a row for each frequency, Hz. A column without a whole window, as in a gap, is missing.
///
/// # Errors
/// When no window fits into any segment, or the job was cancelled; one sentence.
pub fn spectrogram(
    samples: &Samples,
    channel: usize,
    [from_s, to_s]: [f64; 2],
    (columns, mut welch): (usize, Welch),
    handle: &Handle,
) -> Result<Cells, String> {
    let length = welch.length();
    let step_s = samples.segments().iter().map(|segment| segment.sample_time_s).fold(0.0, f64::max);
    let (rows, mut step_hz) = (length / 2, 0.0);
    let mut values = Vec::with_capacity(columns * rows);
    let at = |column: usize| from_s + (to_s - from_s) * column as f64 / columns as f64;
    for column in 0..columns {
        handle.reached(column as f32 / columns as f32)?;
        let range = samples.row_at(at(column))..samples.row_at(at(column + 1));
        for start in starts(samples.segments(), range, length, step_s) {
            welch.add([&samples.values(channel, start..start + length)]);
        }
        match welch.finish(step_s) {
            Some(spectra) => {
                step_hz = spectra.step_hz();
                values.extend(spectra.density(0)[1..].iter().map(|density| 10.0 * density.log10()));
            }
            None => values.extend(std::iter::repeat_n(f64::NAN, rows)),
        }
    }
    if rows == 0 || values.iter().all(|value| value.is_nan()) {
        return Err(TOO_SHORT.into());
    }
    // The mean is left out; each frequency is in the middle of its row.
    Ok(Cells { x: [from_s, to_s], y: [0.5 * step_hz, (rows as f64 + 0.5) * step_hz], rows, values })
}

/// Range of the colours of a spectrogram, up to its greatest density. The number of decibels below that is limited.
#[must_use]
pub fn colours(cells: &Cells) -> [f64; 2] {
    let finite = cells.values.iter().copied().filter(|value| value.is_finite());
    socam_chart::chart::range_of(finite).map_or([0.0, 1.0], |[low, high]| [low.max(high - SHOWN_DB), high])
}

/// First rows of windows about some rows, evenly apart, each within a segment.
fn starts(segments: &[Segment], rows: Range<usize>, length: usize, step_s: f64) -> Vec<usize> {
    let count = (2 * rows.len()).checked_div(length).unwrap_or(0).clamp(1, WINDOWS);
    let fits = |number: usize| {
        let middle = rows.start + (2 * number + 1) * rows.len() / (2 * count);
        let next = segments.partition_point(|segment| segment.first_row as usize <= middle);
        let segment = segments.get(next.checked_sub(1)?)?;
        let (first, end) = (segment.first_row as usize, segment.end_row() as usize);
        let is_usual = (segment.sample_time_s / step_s - 1.0).abs() < SAME_RATE;
        (is_usual && middle < end && first + length <= end)
            .then(|| middle.saturating_sub(length / 2).clamp(first, end - length))
    };
    if rows.is_empty() {
        return Vec::new();
    }
    let mut starts: Vec<usize> = (0..count).filter_map(fits).collect();
    starts.dedup();
    starts
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use socam_recording::{Channel, Dataset, Unit};

    /// A chirp from 20 to 120 Hz in 10 s with an amplitude of 2, and a gap from 4 to 5 s.
    fn chirp() -> Samples {
        let time_s: Vec<f64> =
            (0..10_000).filter(|n| !(4000..5000).contains(n)).map(|n| f64::from(n) * 1e-3).collect();
        let values: Vec<f64> = time_s.iter().map(|t| 2.0 * (TAU * (20.0 * t + 5.0 * t * t)).sin()).collect();
        let channels = vec![Channel::new("u", Unit::V)];
        let data = Dataset::from_columns("r", channels, time_s.clone(), vec![values.clone()]).unwrap();
        Samples::in_memory(time_s, &[values], data.segments().to_vec())
    }

    #[test]
    fn a_chirp_is_a_line_that_rises_with_its_power() {
        let cells =
            spectrogram(&chirp(), 0, [0.0, 10.0], (100, Welch::new(256)), &Handle::default()).unwrap();
        let step_hz = (cells.y[1] - cells.y[0]) / cells.rows as f64;
        for column in (4..38).chain(54..96) {
            let middle_s = (column as f64 + 0.5) * 0.1;
            let values = &cells.values[column * cells.rows..(column + 1) * cells.rows];
            let peak = (0..cells.rows).max_by(|a, b| values[*a].total_cmp(&values[*b])).unwrap();
            let found_hz = cells.y[0] + (peak as f64 + 0.5) * step_hz;
            assert!((found_hz - 20.0 - 10.0 * middle_s).abs() < 1.5 * step_hz, "{found_hz} at {middle_s}");
            let power: f64 = values.iter().map(|value| 10_f64.powf(0.1 * value) * step_hz).sum();
            assert!((power - 2.0).abs() < 0.3, "half of the squared amplitude, not {power}, at {middle_s}");
        }
        assert!(cells.at(4.5, 60.0).is_none(), "a gap has no spectrum");
        let [low, high] = colours(&cells);
        assert!((-8.0..0.0).contains(&high) && high - low <= SHOWN_DB + 1e-9, "{low} {high}");
    }

    #[test]
    fn what_is_too_short_says_so() {
        let found = spectrogram(&chirp(), 0, [0.0, 10.0], (10, Welch::new(8192)), &Handle::default());
        assert_eq!(found.err().as_deref(), Some(TOO_SHORT));
    }
}
