//! How large motions and torques are on these recordings, at every place: where grids and first guesses are taken from.

use socam_identify::{
    IdentifyError, Problem,
    comparison::{self, Evaluation, Innovations, NoiseModel, Traces},
};
use socam_model::{
    Channel, ChannelTransform, Model, Quantity, Role,
    effects::{self, ActsAt, Rig},
};

use crate::{
    orders,
    spectrum::{self, Lines},
};

/// Share of its largest reading within which an input's readings are all the same: so many of them lie there where it is cut off.
const FLAT: f64 = 1e-4;
/// Share of the largest speed below which a place is at rest.
const AT_REST: f64 = 0.01;
/// Frequencies at which a channel's residuals stand out, and those of all together.
const PEAKS: usize = 3;
const PEAKS_OF_ALL: usize = 4;
/// Share of readings that are larger than what an output almost ever reads; so many that are predicted to be are no chance.
const RARE: f64 = 1e-3;
const OFTEN: usize = 20;

/// What is seen at the places of a model.
#[derive(Debug, Clone, Default)]
pub(crate) struct Scales {
    /// The machine in numbers: effects take their grids, starts and priors from it.
    pub(crate) rig: Rig,
    /// By spring: the recording in which its torque is largest.
    largest_amplitude: Vec<usize>,
    /// By output: largest reading.
    readings: Vec<f64>,
}

impl Scales {
    pub(crate) fn new(
        problem: &Problem<'_>,
        model: &Model,
        noise_model: &NoiseModel,
        at: &Evaluation,
    ) -> Result<Self, IdentifyError> {
        let mut rig = Rig::of_model(model, &at.values);
        for (known, spring) in rig.springs.iter_mut().zip(&model.springs) {
            // By the file: of two springs in a row a fit may make anything.
            known.stiffness = model.parameters[spring.stiffness].value;
        }
        let read = comparison::traces(problem, at, None)?;
        rig.sample_time_s = read.iter().map(spectrum::step_s).reduce(f64::min).unwrap_or(0.0);
        rig.longest_s = longest_s(&read);
        let highest_hz = rig.wave_hz().1;
        rig.modes_hz.retain(|hz| *hz < highest_hz);
        let largest_amplitude = add_motion(&mut rig, &read, (problem, model, at))?;
        add_torques(&mut rig, &read, (model, &at.values));
        add_channels(&mut rig, &read, model);
        let white = comparison::innovations(problem, noise_model, at)?.unwrap_or_default();
        let lines: Vec<Vec<Option<Lines>>> = white.iter().map(lines).collect();
        rig.lines_hz = spectrum::peaks(lines.iter().flatten().flatten(), PEAKS_OF_ALL);
        for (output, channel) in model.outputs().enumerate() {
            let of = lines.iter().filter_map(|one| one[output].as_ref());
            let own = rig.channels.iter_mut().find(|known| known.name == channel.name);
            if let Some(own) = own {
                own.lines_hz = spectrum::peaks(of, PEAKS);
                own.limit = limit(&read, output);
            }
        }
        let readings =
            (0..model.outputs().count()).map(|output| sizes_read(&read, output).fold(0.0, f64::max));
        Ok(Self { readings: readings.collect(), rig, largest_amplitude })
    }

    pub(crate) fn speed(&self, node: usize) -> f64 {
        self.rig.nodes.get(node).map_or(0.0, |node| node.speed)
    }

    pub(crate) fn torque(&self, spring: usize) -> f64 {
        self.rig.springs.get(spring).map_or(0.0, |spring| spring.torque)
    }

    /// Recording in which a spring carries that.
    pub(crate) fn largest_amplitude(&self, spring: usize) -> usize {
        self.largest_amplitude.get(spring).copied().unwrap_or(0)
    }

    /// Largest magnitude that an output reads.
    pub(crate) fn reading(&self, output: usize) -> f64 {
        self.readings.get(output).copied().unwrap_or(0.0)
    }
}

/// Length of the longest recording, s.
fn longest_s(read: &[Traces]) -> f64 {
    let ends = |trace: &Traces| Some((*trace.time_s.first()?, *trace.time_s.last()?));
    let length = |recording: usize| {
        let own = read.iter().filter(|trace| trace.recording == recording).filter_map(ends);
        let (start, end) = own.fold((f64::INFINITY, f64::NEG_INFINITY), |a, b| (a.0.min(b.0), a.1.max(b.1)));
        end - start
    };
    read.iter().map(|trace| length(trace.recording)).fold(0.0, f64::max)
}

/// Speeds and turns of nodes and torques through springs, as predicted; for each spring the recording in which its torque is largest.
fn add_motion(
    rig: &mut Rig,
    read: &[Traces],
    (problem, model, at): (&Problem<'_>, &Model, &Evaluation),
) -> Result<Vec<usize>, IdentifyError> {
    // Besides the model's own sensors: effects may sit in those.
    let mut probe = model.clone();
    let mut seen = Vec::new();
    let nodes = model.nodes.iter().map(|node| (&node.name, Quantity::Speed));
    for (name, quantity) in nodes.chain(model.springs.iter().map(|s| (&s.name, Quantity::Torque))) {
        let grown = with_sensor(&probe, &at.values, name, quantity);
        seen.push(grown.is_some().then(|| probe.outputs().count()));
        probe = grown.unwrap_or(probe);
    }
    let traces = comparison::traces(problem, at, Some(&probe))?;
    let (of_nodes, of_springs) = seen.split_at(model.nodes.len());
    let waves = effects::screened().filter(|effect| effect.acts_at == ActsAt::Node && effect.is_by_turn());
    let waves = waves.filter(|effect| effect.given().any(|own| own.name == "order"));
    let by_turn: Vec<String> = waves.flat_map(|effect| effect.places_in(model)).collect();
    for (node, output) in rig.nodes.iter_mut().zip(of_nodes) {
        let Some(output) = output else { continue };
        node.speed = largest(&traces, *output).0;
        let speeds = || traces.iter().flat_map(|trace| &trace.predicted[*output]).copied();
        let (back, forth) = speeds().fold((0.0_f64, 0.0_f64), |(least, most), w| (least.min(w), most.max(w)));
        let fastest = forth.max(-back);
        if fastest > 0.0 {
            node.reverse_share = forth.min(-back) / fastest;
            let at_rest = speeds().filter(|speed| speed.abs() < AT_REST * fastest).count();
            node.rest_share = at_rest as f64 / speeds().count() as f64;
        }
        let turns = traces
            .iter()
            .zip(read)
            .map(|(trace, read)| turned(&trace.predicted[*output], spectrum::step_s(read)));
        node.angle_range = turns.fold(0.0, f64::max);
        if by_turn.contains(&node.name) {
            node.orders = orders_of(&traces, read, (model, *output));
        }
    }
    let torques = of_springs.iter().map(|output| output.map_or((0.0, 0), |output| largest(&traces, output)));
    let (torques, largest_amplitude): (Vec<f64>, Vec<usize>) = torques.unzip();
    rig.springs.iter_mut().zip(torques).for_each(|(spring, torque)| spring.torque = torque);
    Ok(largest_amplitude)
}

/// Orders at which residuals stand out over the turn of a node whose speed is an output of `traces`.
fn orders_of(traces: &[Traces], read: &[Traces], (model, speed): (&Model, usize)) -> Vec<f64> {
    let mut series: Vec<(Vec<f64>, Vec<f64>)> = Vec::new();
    for (trace, read) in traces.iter().zip(read) {
        let step_s = spectrum::step_s(read);
        let angle = trace.predicted[speed].iter().scan(0.0, |angle, speed| {
            *angle += step_s * speed;
            Some(*angle)
        });
        let angle: Vec<f64> = angle.collect();
        let outputs = 0..model.outputs().count();
        series.extend(outputs.map(|output| (angle.clone(), spectrum::residual(read, output))));
    }
    orders::standing_out(series.iter().map(|(angle, residual)| (angle.as_slice(), residual.as_slice())))
}

/// From the least to the greatest angle on the way.
fn turned(speeds: &[f64], step_s: f64) -> f64 {
    let (mut angle, mut least, mut most) = (0.0_f64, 0.0_f64, 0.0_f64);
    for speed in speeds {
        angle += step_s * speed;
        (least, most) = (least.min(angle), most.max(angle));
    }
    most - least
}

/// Largest torque that moves each node: through its springs, predicted or measured, or by an input.
fn add_torques(rig: &mut Rig, read: &[Traces], (model, values): (&Model, &[f64])) {
    let measured = |place: &str| {
        let own = model.outputs().enumerate();
        let own = own.filter(|(_, c)| c.at == place && c.quantity == Quantity::Torque);
        own.flat_map(|(output, _)| sizes_read(read, output)).fold(0.0, f64::max)
    };
    for (index, spring) in model.springs.iter().enumerate() {
        let torque = rig.springs[index].torque.max(measured(&spring.name));
        for node in [Some(spring.from), spring.to].into_iter().flatten() {
            rig.nodes[node].torque = rig.nodes[node].torque.max(torque);
        }
    }
    for (index, input) in model.inputs().enumerate().filter(|(_, input)| input.quantity == Quantity::Torque) {
        let node = model.nodes.iter().position(|node| node.name == input.at);
        let gain = input.gain.map_or(1.0, |gain| values[gain].abs());
        let most =
            read.iter().flat_map(|trace| &trace.inputs[index]).fold(0.0, |most: f64, x| most.max(x.abs()));
        if let Some(node) = node {
            rig.nodes[node].torque = rig.nodes[node].torque.max(gain * most);
        }
    }
    rig.spread_torques(model);
}

/// FittedValues of what channels read, and how fast that changes.
fn add_channels(rig: &mut Rig, read: &[Traces], model: &Model) {
    let names = model.channels.iter().map(|channel| channel.name.as_str());
    for (own, name) in rig.channels.iter_mut().zip(names) {
        let input = model.inputs().position(|channel| channel.name == name);
        let output = model.outputs().position(|channel| channel.name == name);
        // What an output should read is free of noise, which is fast whatever the motion.
        let both = |trace: &Traces| match (input, output) {
            (Some(input), _) => Some((trace.inputs[input].clone(), trace.inputs[input].clone())),
            (_, Some(output)) => Some((trace.measured[output].clone(), trace.predicted[output].clone())),
            _ => None,
        };
        let all: Vec<(Vec<f64>, Vec<f64>)> = read.iter().filter_map(both).collect();
        let present = || all.iter().flat_map(|(read, _)| read).copied().filter(|value| value.is_finite());
        let (count, sum) = present().fold((0.0, 0.0), |(n, sum), value| (n + 1.0, sum + value));
        let mean = sum / f64::max(count, 1.0);
        own.std = (present().map(|value| (value - mean).powi(2)).sum::<f64>() / f64::max(count, 1.0)).sqrt();
        own.largest = present().map(f64::abs).fold(0.0, f64::max);
        let at_largest = present().filter(|value| value.abs() > (1.0 - FLAT) * own.largest).count();
        own.limit = (input.is_some() && at_largest >= OFTEN).then_some(own.largest);
        let (least, most) =
            present().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), value| (a.min(value), b.max(value)));
        own.range = f64::max(most - least, 0.0);
        let medians = all
            .iter()
            .zip(read)
            .filter_map(|((_, clean), trace)| spectrum::median_hz(clean, spectrum::step_s(trace)));
        let slowest = medians.fold(f64::INFINITY, f64::min);
        own.median_hz = if slowest.is_finite() { slowest } else { 0.0 };
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
        take: ChannelTransform::Value,
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
