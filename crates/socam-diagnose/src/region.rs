//! Localisation of a finding: the speeds, torques, angles, frequencies and times at which a correction reduces the residuals most.

use socam_identify::{
    IdentifyError,
    comparison::{self, Traces},
};
use socam_model::{Model, Motion, Quantity};

use crate::{
    context::{Context, FittedModel},
    document::Region,
    scales::with_sensor,
    spectrum,
    words::short,
};

#[cfg(test)]
mod tests;

/// Share of the gain that a region contains.
const HELD: f64 = 0.8;
/// Largest share of the samples that may lie in a range for it to be reported.
const CONFINED: f64 = 0.6;
/// Largest share of all frequencies below half the sampling rate that a reported band may cover.
const CONFINED_BAND: f64 = 0.25;
/// Number of bins of a range.
const BINS: usize = 40;

/// A range, and the share of all samples that lies in it.
type Range = Option<([f64; 2], f64)>;

/// Motion at one sample, and the fall of its squared residuals, in units of the noise floors.
#[derive(Clone, Copy)]
struct Sample {
    speed: f64,
    torque: f64,
    angle: f64,
    /// Time in the recording, s.
    time_s: f64,
    gain: f64,
}

/// Samples at a place and the spectrum, with the gain of each.
struct Gains {
    samples: Vec<Sample>,
    /// Bins of `(gain, upper end in Hz)`.
    spectrum: Vec<(f64, f64)>,
}

/// The region in which `after` explains the residuals of `before`, at the place of the added effect. Without `after`, the region in which
/// the residuals of `before` are largest. `levels` are the outputs' noise floors, SI.
pub(crate) fn region(
    context: &Context<'_>,
    before: &FittedModel,
    after: Option<&FittedModel>,
    place: &str,
    levels: &[f64],
) -> Result<Region, IdentifyError> {
    let Gains { samples, spectrum } = gains(context, before, after, place, levels)?;
    let rotates = after.unwrap_or(before).model.motion == Motion::Rotation;
    let turns = samples.iter().map(|sample| sample.speed.abs()).sum::<f64>() > 0.0 && rotates;
    let confined = |range: Range, most: f64| range.filter(|(_, share)| *share <= most);
    let speed = confined(range(&samples, |sample| sample.speed), CONFINED);
    let torque = confined(range(&samples, |sample| sample.torque), CONFINED);
    let angle = confined(range(&samples, |sample| sample.angle).filter(|_| turns), CONFINED);
    let time = confined(range(&samples, |sample| sample.time_s), CONFINED);
    let frequency = confined(band(&spectrum), CONFINED_BAND);
    let units = if rotates { ["rad/s", "N m", "rad"] } else { ["m/s", "N", "m"] };
    let each = [
        words(speed, units[0], "of the samples"),
        words(torque, units[1], "of the samples"),
        words(angle, units[2], "of the turn"),
        words(time, "s", "of the samples"),
        words(frequency, "Hz", "of the band"),
    ];
    let each: Vec<String> = each.into_iter().flatten().collect();
    let what = if after.is_some() { "of what it gains" } else { "of the misfit" };
    let text = if each.is_empty() {
        format!("everywhere: no range holds four fifths {what}")
    } else {
        format!("four fifths {what} lie at {}", each.join("; at "))
    };
    let ends = |range: Range| range.map(|(ends, _)| ends);
    Ok(Region {
        speed_rad_s: ends(speed),
        torque_nm: ends(torque),
        angle_rad: ends(angle),
        frequency_hz: ends(frequency),
        time_s: ends(time),
        text,
    })
}

/// Gain of each sample and of each frequency on the training recordings.
fn gains(
    context: &Context<'_>,
    before: &FittedModel,
    after: Option<&FittedModel>,
    place: &str,
    levels: &[f64],
) -> Result<Gains, IdentifyError> {
    let of = |fitted: &FittedModel| comparison::traces(&context.problem(&fitted.model)?, &fitted.at, None);
    let (old, new) = (of(before)?, after.map(of).transpose()?);
    let mover = after.unwrap_or(before);
    let probe = probe(&mover.model, &mover.at.values, place);
    let motion = comparison::traces(&context.problem(&mover.model)?, &mover.at, Some(&probe.model))?;
    let mut samples = Vec::new();
    let mut spectrum = vec![(0.0, 0.0); spectrum_bins(&old)];
    let highest_hz = old.iter().map(|trace| 0.5 / spectrum::step_s(trace)).fold(0.0, f64::max);
    for (index, old) in old.iter().enumerate() {
        let new = new.as_ref().and_then(|new| new.get(index));
        let signal = |output: Option<usize>, row: usize| {
            let predicted = output.and_then(|output| motion.get(index)?.predicted.get(output)?.get(row));
            predicted.copied().unwrap_or(f64::NAN)
        };
        let mut angle = 0.0;
        for row in 0..old.time_s.len() {
            let speed = signal(probe.speed, row);
            let step_s = if row > 0 { old.time_s[row] - old.time_s[row - 1] } else { 0.0 };
            angle += speed * step_s;
            samples.push(Sample {
                speed,
                torque: signal(probe.torque, row),
                angle: angle.rem_euclid(std::f64::consts::TAU),
                time_s: old.time_s[row],
                gain: gain(old, new, row, levels),
            });
        }
        add_spectrum(&mut spectrum, highest_hz, old, new, levels);
    }
    Ok(Gains { samples, spectrum })
}

/// A range in words; `None` where there is none.
fn words(range: Range, unit: &str, of: &str) -> Option<String> {
    let ([low, high], share) = range?;
    Some(format!("{} to {} {unit} ({:.0} % {of})", short(low), short(high), 100.0 * share))
}

/// The model with sensors of speed and torque at a place, and the indices of these outputs.
struct Probe {
    model: Model,
    speed: Option<usize>,
    torque: Option<usize>,
}

/// Adds sensors at a place, or at the nearest node or spring where that quantity is determined.
fn probe(model: &Model, values: &[f64], place: &str) -> Probe {
    let channel = model.channels.iter().find(|channel| channel.name == place);
    let at = channel.map_or(place, |channel| channel.at.as_str());
    let node = |index: usize| model.nodes[index].name.clone();
    let spring = model.springs.iter().find(|spring| spring.name == at);
    let gear = model.gears.iter().find(|gear| gear.name == at);
    let shaft = model.shafts.iter().find(|shaft| shaft.name == at);
    let bearing = model.bearings.iter().find(|bearing| bearing.name == at);
    let place = (model.nodes.iter().position(|node| node.name == at))
        .or(bearing.map(|bearing| bearing.node))
        .or(gear.map(|gear| gear.to))
        .or(shaft.map(|shaft| shaft.nodes.1));
    // The speed of a massless point may not be determined: then that of its neighbour is used.
    let mut nodes: Vec<usize> = place.into_iter().collect();
    nodes.extend(spring.and_then(|spring| spring.to));
    nodes.extend(spring.map(|spring| spring.from));
    nodes.extend(shaft.map(|shaft| shaft.nodes.0));
    let beside = |index: &usize| {
        let mut ends =
            model.springs.iter().flat_map(|s| [(s.from, s.to), (s.to.unwrap_or(s.from), Some(s.from))]);
        ends.find(|(from, _)| from == index).and_then(|(_, to)| to)
    };
    nodes.extend(nodes.clone().iter().filter_map(beside));
    let carries = |index: usize| model.springs.iter().find(|s| s.to == Some(index) || s.from == index);
    let springs = spring.or_else(|| place.and_then(carries)).map(|spring| spring.name.clone());
    let mut probe = Probe { model: model.clone(), speed: None, torque: None };
    let mut put = |at: &str, quantity: Quantity| {
        probe.model = with_sensor(&probe.model, values, at, quantity)?;
        Some(probe.model.outputs().count() - 1)
    };
    let speed = nodes.iter().find_map(|index| put(&node(*index), Quantity::Speed));
    let torque = springs.and_then(|name| put(&name, Quantity::Torque));
    Probe { speed, torque, ..probe }
}

/// Fall of the squared residuals at one sample in units of the noise floors, or their excess over the noise without a correction.
fn gain(old: &Traces, new: Option<&Traces>, row: usize, levels: &[f64]) -> f64 {
    let square = |traces: &Traces, output: usize| {
        let residual = traces.measured[output].get(row)? - traces.predicted[output].get(row)?;
        if residual.is_nan() { None } else { Some((residual / levels[output]).powi(2)) }
    };
    let each = (0..levels.len()).filter_map(|output| {
        let rest = new.map_or(Some(1.0), |new| square(new, output))?;
        Some(square(old, output)? - rest)
    });
    each.sum()
}

/// The range of a quantity with the fewest samples that contains [`HELD`] of the gain, and its share of the samples.
fn range(samples: &[Sample], of: impl Fn(&Sample) -> f64) -> Range {
    let known = || samples.iter().map(|sample| (of(sample), sample.gain)).filter(|(x, _)| x.is_finite());
    let (low, high) = known().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), (x, _)| (l.min(x), h.max(x)));
    if high <= low {
        return None;
    }
    let width = (high - low) / BINS as f64;
    let mut bins = vec![(0.0, 0.0); BINS];
    for (x, gain) in known() {
        let bin = &mut bins[(((x - low) / width) as usize).min(BINS - 1)];
        (bin.0, bin.1) = (bin.0 + gain, bin.1 + 1.0);
    }
    let (from, to, share) = narrowest(&bins)?;
    Some(([low + width * from as f64, low + width * to as f64], share))
}

/// The consecutive bins `(gain, count)` with the least count that contain [`HELD`] of the gain: first bin, last bin plus one, share of all
/// counts.
fn narrowest(bins: &[(f64, f64)]) -> Option<(usize, usize, f64)> {
    let total: f64 = bins.iter().map(|bin| bin.0).sum();
    let count: f64 = bins.iter().map(|bin| bin.1).sum();
    if total <= 0.0 || count <= 0.0 {
        return None;
    }
    let mut best: Option<(usize, usize, f64)> = None;
    for from in 0..bins.len() {
        let (mut gain, mut inside) = (0.0, 0.0);
        for (to, bin) in bins.iter().enumerate().skip(from) {
            (gain, inside) = (gain + bin.0, inside + bin.1);
            if gain >= HELD * total {
                let share = inside / count;
                if best.is_none_or(|(.., least)| share < least) {
                    best = Some((from, to + 1, share));
                }
                break;
            }
        }
    }
    best
}

/// Number of bins of the spectrum, at most the number of rows of the longest segment.
fn spectrum_bins(traces: &[Traces]) -> usize {
    traces.iter().map(|trace| trace.time_s.len()).max().map_or(0, |rows| rows.min(4 * BINS))
}

/// Adds a segment's fall of power to bins of `(gain, upper end in Hz)`. Bins are equally wide up to half of the highest sampling rate.
fn add_spectrum(
    bins: &mut [(f64, f64)],
    highest_hz: f64,
    old: &Traces,
    new: Option<&Traces>,
    levels: &[f64],
) {
    let rows = old.time_s.len();
    if rows < 2 || bins.is_empty() {
        return;
    }
    let step_s = spectrum::step_s(old);
    let power = |traces: &Traces, output: usize| {
        let each = spectrum::residual(traces, output).into_iter().map(|residual| residual / levels[output]);
        spectrum::power(&each.collect::<Vec<_>>(), step_s)
    };
    for output in 0..levels.len() {
        let (frequency_hz, before) = power(old, output);
        // Without a correction, the gain is the excess over white noise of the noise floor.
        let after = new.map_or_else(|| vec![2.0 * step_s; before.len()], |new| power(new, output).1);
        for ((hz, before), after) in frequency_hz.iter().zip(&before).zip(&after) {
            let last = bins.len() - 1;
            let bin = &mut bins[((hz / highest_hz * (last + 1) as f64) as usize).min(last)];
            bin.0 += (before - after) * rows as f64;
            bin.1 = bin.1.max(*hz);
        }
    }
}

/// The narrowest band that contains [`HELD`] of the fall of power, and its share of all frequencies.
fn band(bins: &[(f64, f64)]) -> Range {
    let even: Vec<(f64, f64)> = bins.iter().map(|(gain, _)| (*gain, 1.0)).collect();
    let (from, to, share) = narrowest(&even)?;
    let edge = |bin: usize| if bin == 0 { 0.0 } else { bins[bin - 1].1 };
    Some(([edge(from), edge(to)], share))
}
