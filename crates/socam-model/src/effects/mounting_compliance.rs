//! A mounting that gives way: the machine reacts on a frame that moves.

use std::f64::consts::TAU;

use super::{
    definition::{
        ActsAt, Amplitude, Coordinate, Discrepancy, Effect, EffectParameter, Family, Form, Linearisation,
        POSITIVE, Places, Prior, QuantityKind, Rig, Steady,
    },
    experiment, usual,
};

/// Drive, bearings, gears' housings and sensors stand on a frame that a spring and a damper hold: it carries their reactions, and what the
/// sensors read is relative to it. Accelerometers, which need no frame, read absolute accelerations.
///
/// A machine of one inertia J, driven by a torque T against its frame, then reads 1/(J s²) + 1/(k (1 + 2 d s/w + s²/w²)) per torque, with
/// w = 2 pi `frequency`, d = `damping_ratio` and k = `stiffness`: the frame's own inertia is k/w². The response is linear in 1/k.
///
/// Torques that act on a node from outside (a load's weight, a process force) are taken to reach the frame too.
pub(super) const EFFECT: Effect = Effect {
    id: "mounting_compliance",
    name: "compliance of the mounting",
    acts_at: ActsAt::Node,
    family: Family::Elastic,
    places: Places::DrivenOnAFrame,
    parameters: &[
        EffectParameter::new("stiffness", QuantityKind::Stiffness, POSITIVE),
        EffectParameter::new("frequency", QuantityKind::Frequency, POSITIVE),
        EffectParameter::new("damping_ratio", QuantityKind::Ratio, (0.0, 1.0)),
    ],
    borrows: None,
    form: Form::Mounting,
    amplitude: Amplitude { parameters: &["stiffness"], null: f64::INFINITY, coordinate: Coordinate::Inverse },
    linearisation: Linearisation::Restarts,
    starts: |rig, _| frequencies_hz(rig).into_iter().map(|hz| at(rig, NEARLY_RIGID, hz)).collect(),
    fit_starts: |rig, _, little, _| {
        let hz = little.iter().find(|(name, _)| *name == "frequency").map_or(0.0, |(_, hz)| *hz);
        HEAVIER.map(|times| at(rig, times, hz)).to_vec()
    },
    priors: |rig, _| {
        let [low_hz, .., high_hz] = frequencies_hz(rig);
        let usual_hz = (low_hz * high_hz).sqrt();
        let usual = stiffness(rig, 10.0, usual_hz);
        let source = "a frame has some ten times the moving inertia";
        let resonance =
            "benches and machine frames resonate within the band of the recording, or are not seen";
        vec![
            ("stiffness", Prior::log_normal([usual, 20.0], (1e-4 * usual, 1e6 * usual), source)),
            ("frequency", Prior::log_normal([usual_hz, 3.0], (0.5 * low_hz, 1.5 * high_hz), resonance)),
            (
                "damping_ratio",
                Prior::log_normal(
                    [0.05, 3.0],
                    (0.0, 1.0),
                    "welded frames have 0.02, bolted ones on feet 0.1",
                ),
            ),
        ]
    },
    discrepancy: &[
        Discrepancy::share("stiffness", 1e-2, "assumed: a frame has more than one mode"),
        Discrepancy::share("frequency", 3e-3, "assumed: a frame has more than one mode"),
    ],
    usual: usual::never,
    replaces: &[],
    equivalents: &[],
    steady: Steady::Unseen,
    equation: "J_f x_f'' + c x_f' + k x_f = -T, J_f = k/(2 pi f)², c = 2 d k/(2 pi f); sensors read x - x_f",
    sentence: |_| "The frame gives way under the drive's reaction and swings: a soft bench, a bracket, loose feet.",
    shows: "around the frame's own frequency",
    experiment: experiment::FAST_MOTION,
};

/// Inertia of the frame in units of all moving inertias where the score test linearises.
const NEARLY_RIGID: f64 = 1e4;
/// The same at the starts of a fit.
const HEAVIER: [f64; 2] = [3.0, 30.0];
/// Damping ratio of all starts.
const DAMPING_RATIO: f64 = 0.05;

/// Frequencies of a frame that recordings of the rig can show, Hz: five periods in the longest, eight samples in a period.
fn frequencies_hz(rig: &Rig) -> [f64; 5] {
    let low_hz = 5.0 / rig.longest_s.max(10.0 * rig.sample_time_s);
    let high_hz = (0.125 / rig.sample_time_s).max(2.0 * low_hz);
    [0.0, 0.25, 0.5, 0.75, 1.0].map(|share| low_hz * (high_hz / low_hz).powf(share))
}

fn at(rig: &Rig, heavier: f64, frequency_hz: f64) -> Vec<(&'static str, f64)> {
    let stiffness = stiffness(rig, heavier, frequency_hz);
    vec![("stiffness", stiffness), ("frequency", frequency_hz), ("damping_ratio", DAMPING_RATIO)]
}

/// Stiffness under a frame of so many times the moving inertias.
fn stiffness(rig: &Rig, heavier: f64, frequency_hz: f64) -> f64 {
    let moving: f64 = rig.nodes.iter().filter_map(|node| node.inertia).sum();
    heavier * moving * (TAU * frequency_hz).powi(2)
}
