//! Whether recordings move alike at equal times. A curve over time then also follows whatever depends on the motion.

use socam_identify::IdentifyError;
use socam_model::{Channel, Model};
use socam_recording::Dataset;

/// Number of equal times at which two recordings are compared.
const TIMES: u32 = 500;
/// Least correlation of a channel of two recordings that move alike.
const ALIKE: f64 = 0.5;

/// Whether no two of the recordings have inputs (or outputs, where no input varies) of different courses: time then cannot be told apart from
/// what moves with it. True for a single recording.
pub(super) fn is_shared(model: &Model, recordings: &[Dataset]) -> Result<bool, IdentifyError> {
    for (index, one) in recordings.iter().enumerate() {
        for other in &recordings[..index] {
            let inputs = least_correlation(model.inputs(), one, other)?;
            let least =
                if inputs.is_some() { inputs } else { least_correlation(model.outputs(), one, other)? };
            if least.is_some_and(|least| least < ALIKE) {
                return Ok(false);
            }
        }
    }
    Ok(true)
}

/// Least correlation, without its sign, of the channels that vary in both recordings, at equal times; `None` where none does.
fn least_correlation<'m>(
    channels: impl Iterator<Item = &'m Channel>,
    one: &Dataset,
    other: &Dataset,
) -> Result<Option<f64>, IdentifyError> {
    let span_s = (one.end_s() - one.start_s()).min(other.end_s() - other.start_s());
    let mut least: Option<f64> = None;
    for channel in channels {
        let a = at_times(one, &channel.column, span_s)?;
        let b = at_times(other, &channel.column, span_s)?;
        let correlation =
            correlation(a.iter().copied().zip(b).filter(|(a, b)| a.is_finite() && b.is_finite()));
        least = correlation.map_or(least, |own| Some(least.unwrap_or(1.0).min(own.abs())));
    }
    Ok(least)
}

/// Values of a column at equal times from the first row on; missing where the recording has no such column.
fn at_times(recording: &Dataset, column: &str, span_s: f64) -> Result<Vec<f64>, IdentifyError> {
    let all = recording.shared()?;
    let values = recording.channel_index(column).ok().and_then(|index| all.values(index)).unwrap_or_default();
    let value = |time: u32| {
        let time_s = recording.start_s() + span_s * f64::from(time) / f64::from(TIMES);
        let row = all.time_s().partition_point(|known| *known < time_s);
        values.get(row).copied().unwrap_or(f64::NAN)
    };
    Ok((0..TIMES).map(value).collect())
}

/// Correlation of pairs; `None` where either does not vary.
fn correlation(pairs: impl Iterator<Item = (f64, f64)> + Clone) -> Option<f64> {
    let count = pairs.clone().count() as f64;
    let sums = pairs.clone().fold((0.0, 0.0), |sums, (a, b)| (sums.0 + a, sums.1 + b));
    let (mean_a, mean_b) = (sums.0 / count, sums.1 / count);
    let (aa, ab, bb) = pairs.fold((0.0, 0.0, 0.0), |(aa, ab, bb), (a, b)| {
        let (a, b) = (a - mean_a, b - mean_b);
        (aa + a * a, ab + a * b, bb + b * b)
    });
    let size = (aa * bb).sqrt();
    (size > 0.0).then(|| ab / size)
}

#[cfg(test)]
mod tests {
    use socam_recording::{Channel, Unit};

    use super::*;

    #[test]
    fn recordings_with_inputs_of_other_courses_tell_time_apart() {
        let model = Model::builtin("emps").unwrap();
        let recording = |force: &dyn Fn(f64) -> f64, position: &dyn Fn(f64) -> f64| {
            let channels = [("force", Unit::N), ("position", Unit::M)];
            let channels = channels.map(|(name, unit)| Channel::new(name, unit)).to_vec();
            let time_s: Vec<f64> = (0..1000).map(|row| 0.01 * f64::from(row)).collect();
            let columns = [force, position].map(|of| time_s.iter().map(|t| of(*t)).collect()).to_vec();
            Dataset::from_columns("axis", channels, time_s, columns).unwrap()
        };
        let slow = recording(&|t| t.sin(), &|t| t.cos());
        let twice = recording(&|t| 2.0 * t.sin() + 1.0, &|t| (3.0 * t).cos());
        let fast = recording(&|t| (2.7 * t).sin(), &|t| t.cos());
        let shared = |all: &[&Dataset]| {
            let all: Vec<Dataset> = all.iter().map(|one| (*one).clone()).collect();
            is_shared(&model, &all).unwrap()
        };
        assert!(shared(&[&slow]) && shared(&[&slow, &twice]) && !shared(&[&slow, &twice, &fast]));
        // Where nothing drives, what is measured tells.
        let idle = [1.0, 3.0].map(|rate| recording(&|_| 0.0, &move |t| (rate * t).cos()));
        assert!(shared(&[&idle[0], &idle[0]]) && !shared(&[&idle[0], &idle[1]]));
    }
}
