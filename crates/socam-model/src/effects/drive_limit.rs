//! A drive that delivers less than it is told: its current, its voltage or its speed is limited.

use super::{
    definition::{
        Acts, ActsAt, Amplitude, Coordinate, Discrepancy, Effect, EffectParameter, Family, Form, Law,
        LawInput, Linearisation, POSITIVE, Places, Prior, QuantityKind, Response, Rule, Steady,
        begin_with_little,
    },
    experiment, shape, usual,
};

/// What acts on the machine is the input as recorded, limited to -limit .. limit: the column is a command, and the drive has less to give.
pub(super) const EFFECT: Effect = Effect {
    id: "drive_limit",
    name: "drive limit",
    acts_at: ActsAt::Channel,
    family: Family::Load,
    places: Places::Inputs,
    parameters: &[EffectParameter::new("limit", QuantityKind::Gain, POSITIVE)],
    borrows: None,
    form: Form::Laws(&[Law {
        law_inputs: &[LawInput::Reading],
        acts: Acts::Reading,
        rule: Rule::Code(evaluate),
        // An input's law says what its column reads beyond what acts.
        formula: "reading - 0.5*(sqrt((reading + limit)^2 + 1e-6*limit^2) - sqrt((reading - limit)^2 + 1e-6*limit^2))",
        transition: shape::no_transition,
        inactive: shape::never,
    }]),
    amplitude: Amplitude { parameters: &["limit"], null: f64::INFINITY, coordinate: Coordinate::Value },
    linearisation: Linearisation::NonNull,
    starts: |rig, place| {
        let largest = rig.channel(place).largest;
        [0.9, 0.7, 0.45].map(|share| vec![("limit", share * largest)]).to_vec()
    },
    fit_starts: begin_with_little,
    priors: |rig, place| {
        let largest = rig.channel(place).largest;
        let source = "a limit is seen only below the largest command; a drive that gives a tenth of it was not chosen for this machine";
        vec![("limit", Prior::log_normal([0.7 * largest, 1.5], (0.1 * largest, largest), source))]
    },
    discrepancy: &[Discrepancy::share(
        "limit",
        2e-2,
        "assumed: a real limit moves with temperature and supply, and is approached through a controller",
    )],
    usual: usual::never,
    replaces: &[],
    equivalents: &[],
    steady: Steady::Unseen,
    equation: "|u_true| <= u_max",
    sentence: |_| "The drive gives less than it is told beyond a limit: of its current, its supply or its own settings.",
    shows: "where the command is large",
    experiment: experiment::LARGE_TORQUE,
};

/// Width of the rounded corners as a fraction of the limit.
const ROUNDING: f64 = 1e-3;

fn evaluate(law_inputs: &[f64], p: &[f64]) -> Response {
    let (kept, by_reading, by_limit) = shape::limited(law_inputs[0], p[0], ROUNDING);
    shape::response(law_inputs[0] - kept, &[1.0 - by_reading], &[-by_limit])
}
