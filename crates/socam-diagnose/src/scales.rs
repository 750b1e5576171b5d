//! How large motions and torques are on these recordings, at every place: where grids and first guesses are taken from.

use socam_identify::{
    IdentifyError, Problem,
    compare::{self, Innovations, Measured, Traces, Yardstick},
};
use socam_model::{Channel, Model, Quantity, Role, Take};

use crate::spectrum::{self, Lines};

/// Frequencies at which a channel's residuals stand out, and those of all together.
const PEAKS: usize = 3;
const PEAKS_OF_ALL: usize = 4;
/// Share of readings that are larger than what an output almost ever reads; so many that are predicted to be are no chance.
const RARE: f64 = 1e-3;
const OFTEN: usize = 20;

/// What is seen at the places of a model.
#[derive(Debug, Clone, Default)]
pub(crate) struct Scales {
    /// By node: largest speed, rad/s.
    speeds: Vec<f64>,
    /// By spring: largest torque, N m.
    torques: Vec<f64>,
    /// By spring: the recording in which that is.
    loudest: Vec<usize>,
    /// By output: frequencies at which its whitened residuals have lines, Hz; and at which those of all have.
    peaks: Vec<Vec<f64>>,
    peaks_of_all: Vec<f64>,
    /// By output: largest reading.
    readings: Vec<f64>,
    /// By output: where its readings seem to be cut off.
    limits: Vec<Option<f64>>,
}

impl Scales {
    pub(crate) fn new(
        problem: &Problem<'_>,
        model: &Model,
        yardstick: &Yardstick,
        at: &Measured,
    ) -> Result<Self, IdentifyError> {
        // Besides its own sensors: effects may sit in those.
        let mut probe = model.clone();
        let own = model.outputs().count();
        let mut seen = Vec::new();
        let nodes = model.nodes.iter().map(|node| (&node.name, Quantity::Speed));
        for (name, quantity) in nodes.chain(model.springs.iter().map(|s| (&s.name, Quantity::Torque))) {
            let grown = with_sensor(&probe, &at.values, name, quantity);
            seen.push(grown.is_some());
            probe = grown.unwrap_or(probe);
        }
        let traces = compare::traces(problem, at, Some(&probe))?;
        let mut largest = (own..probe.outputs().count()).map(|output| largest(&traces, output));
        let mut all =
            seen.into_iter().map(|works| if works { largest.next().unwrap_or_default() } else { (0.0, 0) });
        let speeds = all.by_ref().take(model.nodes.len()).map(|(speed, _)| speed).collect();
        let (torques, loudest) = all.unzip();
        let residuals = compare::traces(problem, at, None)?;
        let white = compare::innovations(problem, yardstick, at)?.unwrap_or_default();
        let lines: Vec<Vec<Option<Lines>>> = white.iter().map(lines).collect();
        let of = |output: usize| lines.iter().filter_map(move |one| one[output].as_ref());
        let peaks = (0..own).map(|output| spectrum::peaks(of(output), PEAKS)).collect();
        let peaks_of_all = spectrum::peaks(lines.iter().flatten().flatten(), PEAKS_OF_ALL);
        let limits = (0..own).map(|output| limit(&residuals, output)).collect();
        let readings = (0..own).map(|output| sizes_read(&residuals, output).fold(0.0, f64::max)).collect();
        Ok(Self { speeds, torques, loudest, peaks, peaks_of_all, readings, limits })
    }

    pub(crate) fn speed(&self, node: usize) -> f64 {
        self.speeds.get(node).copied().unwrap_or(0.0)
    }

    pub(crate) fn torque(&self, spring: usize) -> f64 {
        self.torques.get(spring).copied().unwrap_or(0.0)
    }

    /// Recording in which a spring carries that.
    pub(crate) fn loudest(&self, spring: usize) -> usize {
        self.loudest.get(spring).copied().unwrap_or(0)
    }

    /// Largest magnitude that an output reads.
    pub(crate) fn reading(&self, output: usize) -> f64 {
        self.readings.get(output).copied().unwrap_or(0.0)
    }

    /// Magnitude that an output seems not to read beyond.
    pub(crate) fn limit(&self, output: usize) -> Option<f64> {
        self.limits.get(output).copied().flatten()
    }

    /// Lines of one output, or of all together.
    pub(crate) fn lines(&self, output: Option<usize>) -> &[f64] {
        match output {
            Some(output) => self.peaks.get(output).map_or(&[], Vec::as_slice),
            None => &self.peaks_of_all,
        }
    }
}

/// Largest size that an output is predicted to have, and the recording in which it has it.
fn largest(traces: &[Traces], output: usize) -> (f64, usize) {
    let all = traces
        .iter()
        .flat_map(|trace| trace.predicted[output].iter().map(|value| (value.abs(), trace.recording)));
    all.fold((0.0, 0), |most, one| if one.0 > most.0 { one } else { most })
}

/// By output, the lines of one stretch's whitened residuals.
fn lines(white: &Innovations) -> Vec<Option<Lines>> {
    white.outputs.iter().map(|values| Lines::new(values, white.sample_time_s)).collect()
}

fn sizes_read(traces: &[Traces], output: usize) -> impl Iterator<Item = f64> {
    let all = traces.iter().flat_map(move |trace| &trace.measured[output]);
    all.map(|value| value.abs()).filter(|size| !size.is_nan())
}

/// What an output reads where it should read more than it almost ever does, if that is often enough.
fn limit(traces: &[Traces], output: usize) -> Option<f64> {
    let pairs =
        || traces.iter().flat_map(|trace| trace.measured[output].iter().zip(&trace.predicted[output]));
    let mut sizes: Vec<f64> = sizes_read(traces, output).collect();
    sizes.sort_by(f64::total_cmp);
    let most = *sizes.get(((1.0 - RARE) * sizes.len() as f64) as usize)?;
    let beyond = pairs().filter(|(y, should)| should.abs() > most && **y * **should > 0.0);
    let mut cut: Vec<f64> = beyond.map(|(y, _)| y.abs()).collect();
    cut.sort_by(f64::total_cmp);
    (cut.len() >= OFTEN).then(|| cut[cut.len() / 2])
}

/// The model with one more sensor; `None` for the speed of a point that has none of its own, without inertia or damper.
pub(crate) fn with_sensor(model: &Model, values: &[f64], at: &str, quantity: Quantity) -> Option<Model> {
    let mut grown = model.clone();
    grown.channels.push(sensor(at, quantity));
    grown.equations(values).is_ok().then_some(grown)
}

/// A sensor that no recording knows.
fn sensor(at: &str, quantity: Quantity) -> Channel {
    Channel {
        name: format!("{at} seen"),
        column: String::new(),
        role: Role::Output,
        quantity,
        at: at.to_owned(),
        take: Take::Value,
        scale: 1.0,
        offset: 0.0,
        gain: None,
        noise_std: None,
        estimate_offset: false,
        between: None,
        unit: "",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sine of amplitude 4 with noise, read up to `most`.
    fn read(most: f64) -> Traces {
        let truth = |k: usize| 4.0 * (0.01 * k as f64).sin();
        let noise = |k: usize| 0.02 * (78.233 * k as f64).sin();
        Traces {
            recording: 0,
            time_s: (0..5000).map(|k| 1e-3 * k as f64).collect(),
            inputs: Vec::new(),
            measured: vec![(0..5000).map(|k| truth(k).clamp(-most, most) + noise(k)).collect()],
            predicted: vec![(0..5000).map(truth).collect()],
        }
    }

    #[test]
    fn readings_are_cut_off_only_where_more_should_be_read() {
        let found = limit(&[read(3.0)], 0).unwrap();
        assert!((found - 3.0).abs() < 0.02, "{found}");
        assert_eq!(limit(&[read(10.0)], 0), None);
        assert_eq!(limit(&[], 0), None);
    }
}
