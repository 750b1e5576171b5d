//! The recordings that were used, and how well each channel is predicted on them.

use socam_identify::comparison::Evaluation;

use super::inputs::Inputs;
use crate::document::{ChannelFit, Fit, RecordingUse};

/// Training recordings, then held-out ones.
pub(super) fn recordings(inputs: &Inputs<'_>) -> Vec<RecordingUse> {
    let held_out =
        inputs.held_out.proof().into_iter().flat_map(|proof| &proof.recordings).map(|data| (data, true));
    let all = inputs.context.training.iter().map(|data| (data, false)).chain(held_out);
    all.map(|(data, held_out)| RecordingUse {
        name: data.name().to_owned(),
        held_out,
        samples: data.rows(),
        duration_s: data.end_s() - data.start_s(),
    })
    .collect()
}

/// Root mean square residuals of each channel, of the base model and of the corrected one.
pub(super) fn fit(inputs: &Inputs<'_>) -> Fit {
    let Inputs { path, floor, .. } = *inputs;
    let proof = inputs.held_out.proof();
    let last = path.corrected().unwrap_or(&path.base);
    let rms = |at: &Evaluation, output: usize| (at.read[output] > 0.0).then(|| at.rms[output]);
    let channels = path.base.model.outputs().enumerate().map(|(output, channel)| {
        let fit = ChannelFit {
            noise_std: (path.base.at.read[output] > 0.0).then_some(floor[output]),
            rms_before: rms(&path.base.at, output),
            rms_after: rms(&last.at, output),
            holdout_rms_before: proof.and_then(|proof| rms(&proof.base, output)),
            holdout_rms_after: proof.and_then(|proof| rms(&proof.corrected, output)),
            unit: channel.unit.into(),
        };
        (channel.name.clone(), fit)
    });
    Fit { channels: channels.collect() }
}
