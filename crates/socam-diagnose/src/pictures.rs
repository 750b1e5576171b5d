//! Data of the pictures: residuals before and after the correction, over time, frequency, speed, angle and torque.

mod overlay;

use socam_identify::{
    IdentifyError, Problem,
    comparison::{self, Evaluation, Traces},
};
use socam_model::{Model, Quantity};

use crate::{
    context::Context,
    evidence::{Binned, ChannelEvidence, Evidence, RecordingTraces, Spectrum, Trace},
    proof::Proof,
    selection::Path,
    spectrum::{self, residual, step_s},
};

pub(crate) use overlay::overlay;

/// Number of bins over speed, angle or torque.
const BINS: usize = 40;
/// Largest number of frequency bands of a spectrum.
const LINES: usize = 400;

/// Measured and predicted signals of one recording, of the base model and of the corrected one.
pub(crate) struct Pair {
    name: String,
    held_out: bool,
    before: Traces,
    after: Option<Traces>,
}

impl Pair {
    /// One pair for each segment of the training recordings, then of the held-out ones.
    pub(crate) fn all(
        context: &Context<'_>,
        path: &Path,
        proof: Option<&Proof>,
    ) -> Result<Vec<Self>, IdentifyError> {
        let mut pairs = Vec::new();
        let training: Vec<String> = context.training.iter().map(|data| data.name().to_owned()).collect();
        let (base, corrected) = (&path.base, path.corrected());
        let before = comparison::traces(&context.problem(&base.model)?, &base.at, None)?;
        let after = match corrected {
            Some(after) => comparison::traces(&context.problem(&after.model)?, &after.at, None)?,
            None => Vec::new(),
        };
        pairs.extend(paired(&training, false, before, after));
        if let Some(proof) = proof {
            let names: Vec<String> = proof.recordings.iter().map(|data| data.name().to_owned()).collect();
            let of = |model: &Model, at: &Evaluation| {
                comparison::traces(&Problem::new(model, &proof.recordings, context.fit.clone())?, at, None)
            };
            let before = of(&base.model, &proof.base)?;
            let after = match corrected {
                Some(after) => of(&after.model, &proof.corrected)?,
                None => Vec::new(),
            };
            pairs.extend(paired(&names, true, before, after));
        }
        Ok(pairs)
    }

    /// The base model's signals on the held-out recordings, or on all where none is held out.
    pub(crate) fn shown(pairs: &[Self]) -> Vec<&Traces> {
        let held_out = pairs.iter().any(|pair| pair.held_out);
        pairs.iter().filter(|pair| pair.held_out == held_out).map(|pair| &pair.before).collect()
    }
}

/// Data of all pictures. `floor` is the noise floor of each output, SI.
pub(crate) fn evidence(model: &Model, pairs: &[Pair], floor: &[f64]) -> Evidence {
    let recordings = pairs.iter().map(|pair| recording(model, pair)).collect();
    let outputs = model.outputs().enumerate();
    let channels = outputs.map(|(output, channel)| ChannelEvidence {
        name: channel.name.clone(),
        unit: channel.unit.to_owned(),
        noise_std: floor[output],
        over_speed: over(model, pairs, output, Quantity::Speed),
        over_angle: over(model, pairs, output, Quantity::Turned),
        over_torque: over(model, pairs, output, Quantity::Torque),
        spectrum: lines(pairs, output, floor[output]),
    });
    Evidence { recordings, channels: channels.collect() }
}

/// Pairs the two models' signals of each segment.
fn paired(names: &[String], held_out: bool, before: Vec<Traces>, after: Vec<Traces>) -> Vec<Pair> {
    let mut after = after.into_iter();
    let pair = |before: Traces| Pair {
        name: names.get(before.recording).cloned().unwrap_or_default(),
        held_out,
        after: after.next(),
        before,
    };
    before.into_iter().map(pair).collect()
}

/// Residuals of one recording over time.
fn recording(model: &Model, pair: &Pair) -> RecordingTraces {
    let trace = |(output, channel): (usize, &socam_model::Channel)| Trace {
        channel: channel.name.clone(),
        time_s: pair.before.time_s.clone(),
        before: residual(&pair.before, output),
        after: pair.after.as_ref().map_or_else(Vec::new, |after| residual(after, output)),
    };
    RecordingTraces {
        name: pair.name.clone(),
        held_out: pair.held_out,
        channels: model.outputs().enumerate().map(trace).collect(),
    }
}

/// Abscissa of a picture: the first output of this quantity. An angle is the integral of the first speed.
fn abscissa(model: &Model, trace: &Traces, quantity: Quantity) -> Option<Vec<f64>> {
    let kind = if quantity == Quantity::Turned { Quantity::Speed } else { quantity };
    let output = model.outputs().position(|channel| channel.quantity == kind)?;
    let values = &trace.measured[output];
    if quantity != Quantity::Turned {
        return Some(values.clone());
    }
    let step_s = step_s(trace);
    let turned = values.iter().scan(0.0_f64, |angle, speed| {
        *angle += if speed.is_nan() { 0.0 } else { speed * step_s };
        Some(angle.rem_euclid(std::f64::consts::TAU))
    });
    Some(turned.collect())
}

/// Mean residuals in bins of a quantity; `None` where it is not measured or constant.
fn over(model: &Model, pairs: &[Pair], output: usize, quantity: Quantity) -> Option<Binned> {
    let mut rows: Vec<(f64, f64, f64)> = Vec::new();
    for pair in pairs {
        let x = abscissa(model, &pair.before, quantity)?;
        let before = residual(&pair.before, output);
        let after = pair.after.as_ref().map(|after| residual(after, output));
        for (k, (x, before)) in x.iter().zip(&before).enumerate() {
            let after = after.as_ref().and_then(|after| after.get(k)).copied().unwrap_or(f64::NAN);
            if x.is_finite() && before.is_finite() {
                rows.push((*x, *before, after));
            }
        }
    }
    let (low, high) =
        rows.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), (x, ..)| (l.min(*x), h.max(*x)));
    if rows.len() < BINS || high <= low {
        return None;
    }
    let mut sums = vec![[0.0_f64; 5]; BINS];
    for (x, before, after) in &rows {
        let bin = (((x - low) / (high - low) * BINS as f64) as usize).min(BINS - 1);
        let own = &mut sums[bin];
        own[0] += 1.0;
        own[1] += before;
        own[2] += before * before;
        own[3] += after;
        own[4] += after * after;
    }
    let centre = |bin: usize| low + (high - low) * (bin as f64 + 0.5) / BINS as f64;
    let mean = |own: &[f64; 5], at: usize| if own[0] > 0.0 { own[at] / own[0] } else { f64::NAN };
    // Neighbouring samples are correlated: a standard error counts one sample in ten.
    let error = |own: &[f64; 5], at: usize| {
        let mean = mean(own, at);
        ((own[at + 1] / own[0] - mean * mean).max(0.0) / (own[0] / 10.0).max(1.0)).sqrt()
    };
    let corrected = pairs.iter().any(|pair| pair.after.is_some());
    let after = |f: &dyn Fn(&[f64; 5], usize) -> f64| {
        if corrected { sums.iter().map(|own| f(own, 3)).collect() } else { Vec::new() }
    };
    Some(Binned {
        x: (0..BINS).map(centre).collect(),
        before: sums.iter().map(|own| mean(own, 1)).collect(),
        before_std: sums.iter().map(|own| error(own, 1)).collect(),
        after: after(&mean),
        after_std: after(&error),
    })
}

/// Amplitude spectrum of the residual in the longest segment; `None` where it is too short.
fn lines(pairs: &[Pair], output: usize, floor: f64) -> Option<Spectrum> {
    let longest = pairs.iter().max_by_key(|pair| pair.before.time_s.len())?;
    let step_s = step_s(&longest.before);
    let (frequency_hz, before) = spectrum::power(&residual(&longest.before, output), step_s);
    let after = longest.after.as_ref().map(|after| spectrum::power(&residual(after, output), step_s).1);
    let after = after.filter(|after| after.len() == before.len());
    if frequency_hz.len() < 8 {
        return None;
    }
    // Bands are equally wide on a logarithmic scale.
    let count = frequency_hz.len();
    let edge = |k: usize| ((count as f64).powf(k as f64 / LINES as f64)).round() as usize;
    let mut edges: Vec<usize> = (0..=LINES).map(edge).collect();
    edges.dedup();
    let band = |values: &[f64]| -> Vec<f64> {
        edges
            .windows(2)
            .map(|pair| (values[pair[0]..pair[1]].iter().sum::<f64>() / (pair[1] - pair[0]) as f64).sqrt())
            .collect()
    };
    let centres =
        edges.windows(2).map(|pair| 0.5 * (frequency_hz[pair[0]] + frequency_hz[pair[1] - 1])).collect();
    Some(Spectrum {
        frequency_hz: centres,
        before: band(&before),
        after: after.as_deref().map(band).unwrap_or_default(),
        noise: vec![floor * (2.0 * step_s).sqrt(); edges.len() - 1],
    })
}
