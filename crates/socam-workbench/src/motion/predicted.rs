//! What a simulation adds to the measured motion.

use socam_model::{Model, Probe, Quantity};

use super::{Misfit, Motion, SpringLoad, Track, values};
use crate::recording::Recording;

/// Length of the window over which a misfit is averaged, s.
pub const WINDOW_S: f64 = 0.05;

impl Motion {
    /// Adds what a model predicts: `simulated` holds the outputs of the model and its [`Model::with_probes`], driven by the inputs of `recording`.
    #[must_use]
    pub fn predict(
        mut self,
        model: &Model,
        probes: &[Probe],
        recording: &Recording,
        simulated: &Recording,
    ) -> Self {
        let time_s = simulated.samples.times(0..simulated.samples.rows());
        let column = |name: &str| {
            let index = simulated.channel(name)?;
            Some(simulated.samples.values(index, 0..time_s.len()))
        };
        let probe = |quantity: Quantity, at: &str| {
            let probe = probes.iter().find(|probe| probe.quantity == quantity && probe.at == at)?;
            column(&probe.channel)
        };
        for (node, motion) in model.nodes.iter().zip(&mut self.nodes) {
            motion.predicted =
                probe(Quantity::Speed, &node.name).map(|speed| Track::integral(&time_s, &speed));
        }
        for spring in &model.springs {
            let Some(torque) = probe(Quantity::Torque, &spring.name) else { continue };
            let torque = Track::new(&time_s, &torque);
            let speed = probe(Quantity::Speed, &model.nodes[spring.from].name);
            let power = speed.map(|speed| torque.times(&Track::new(&time_s, &speed)));
            self.springs.push(SpringLoad { name: spring.name.clone(), torque, power });
        }
        let measured_s = recording.samples.times(0..recording.samples.rows());
        for channel in model.outputs() {
            let Some(predicted) = values(simulated, model, channel, &time_s) else { continue };
            let Some(measured) = values(recording, model, channel, &measured_s) else { continue };
            let share = misfit(&measured_s, &measured, &Track::new(&time_s, &predicted));
            if share.range().is_some() {
                self.misfits.push(Misfit { channel: channel.name.clone(), at: channel.at.clone(), share });
            }
        }
        self
    }
}

/// Root mean square of measured minus predicted over windows, as a share of the root mean square of all that was measured.
fn misfit(time_s: &[f64], measured: &[f64], predicted: &Track) -> Track {
    let squares = measured.iter().filter(|value| value.is_finite()).map(|value| value * value);
    let count = measured.iter().filter(|value| value.is_finite()).count().max(1);
    let whole = (squares.sum::<f64>() / count as f64).sqrt();
    let (Some(first), Some(last)) = (time_s.first(), time_s.last()) else { return Track::default() };
    let step_s = (last - first) / (time_s.len().max(2) - 1) as f64;
    if whole <= 0.0 || step_s <= 0.0 {
        return Track::default();
    }
    let window = ((WINDOW_S / step_s).round() as usize).max(1);
    let (mut times, mut shares) = (Vec::new(), Vec::new());
    for (times_s, values) in time_s.chunks(window).zip(measured.chunks(window)) {
        let errors =
            times_s.iter().zip(values).filter_map(|(time, value)| Some(value - predicted.at(*time)?));
        let squares: Vec<f64> = errors.filter(|error| error.is_finite()).map(|error| error * error).collect();
        if !squares.is_empty() {
            times.push(0.5 * (times_s[0] + times_s[times_s.len() - 1]));
            shares.push((squares.iter().sum::<f64>() / squares.len() as f64).sqrt() / whole);
        }
    }
    Track::new(&times, &shares)
}
