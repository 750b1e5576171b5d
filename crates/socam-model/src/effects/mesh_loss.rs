//! Loss of a gear in proportion to the transmitted torque.

use super::{
    definition::{
        Acts, ActsAt, Amplitude, Condition, Discrepancy, Effect, EffectParameter, Equivalent, Family, Form,
        Law, LawInput, Linearisation, Places, Prior, QuantityKind, Response, Rule, Steady, all_zero,
        begin_with_little,
    },
    experiment, shape, usual,
};

/// The mesh loses `fraction` of the torque that enters it, whichever side drives. The drag acts on the slow side; speed and contact torque T
/// are those of the slow side. While the fast side drives, T enters the mesh, and the drag is fraction |T|. While the slow side drives, T
/// leaves it, and the drag is |T| fraction / (1 - fraction). This equals the load-dependent friction c (|T_in| + |T_out|) of the
/// literature on servo gearboxes with c = fraction / (2 - fraction).
pub(super) const EFFECT: Effect = Effect {
    id: "mesh_loss",
    name: "mesh loss",
    acts_at: ActsAt::Gear,
    family: Family::Friction,
    places: Places::Every,
    parameters: &[
        EffectParameter::new("fraction", QuantityKind::Ratio, (0.0, 0.95)),
        EffectParameter::usual("transition_speed", QuantityKind::Speed, (0.05, 2e-3)),
        EffectParameter::usual("transition_torque", QuantityKind::Torque, (0.1, 1.0)),
    ],
    borrows: None,
    form: Form::Laws(&[Law {
        law_inputs: &[LawInput::Speed, LawInput::Torque],
        acts: Acts::Drag,
        rule: Rule::Code(evaluate),
        formula: "-through*tanh(through/transition_torque)*tanh(speed/transition_speed)*fraction/(1 - \
                  0.5*fraction*(1 - tanh(speed/transition_speed)*tanh(through/transition_torque)))",
        transition: |parameters| parameters[1],
        inactive: |parameters| parameters[0] == 0.0,
    }]),
    amplitude: Amplitude::of(&["fraction"]),
    linearisation: Linearisation::Null,
    starts: |_, _| all_zero(["fraction"]),
    fit_starts: begin_with_little,
    priors: |_, _| {
        let source = "losses of gears: 1 to 2 % of a spur stage, 10 to 30 % of a cheap gearbox, 50 % and more of a worm";
        vec![("fraction", Prior::log_normal([0.05, 4.0], (0.0, 0.95), source))]
    },
    discrepancy: &[Discrepancy::amplitude("fraction")],
    usual: usual::never,
    replaces: &[],
    equivalents: &[Equivalent {
        effect: "sensor_gain",
        holds: Condition::Stated(
            "of a torque sensor behind the gear, while the drive always drives and never brakes",
        ),
    }],
    steady: Steady::Linear,
    equation: "|T_out| = (1 - f) |T_in|, both referred to one side",
    sentence: |_| "The mesh loses a fixed share of the torque that enters it, whichever side drives: sliding between cam and rollers, or between teeth.",
    shows: "where torque is transmitted, in proportion to it",
    experiment: experiment::DRIVEN_BY_LOAD,
};

fn evaluate(law_inputs: &[f64], p: &[f64]) -> Response {
    drag(Direction::of(law_inputs[0], p[1]), law_inputs[1], p[2], |driven| equal_share(p[0], driven))
}

/// The drag as a share of the contact torque, where either side loses `fraction` of what enters.
pub(super) fn equal_share(fraction: f64, driven: f64) -> Share<1> {
    let left = 1.0 - fraction * driven;
    let value = fraction / left;
    Share { value, by_driven: value * value, by_parameters: [1.0 / (left * left)] }
}

/// The direction in which the flanks slide, -1 to 1, and its derivatives by the law's first input and by the width of its transition.
pub(super) struct Direction {
    pub(super) sign: f64,
    pub(super) by_input: f64,
    pub(super) by_width: f64,
}

impl Direction {
    /// The sign of a speed, over a transition speed.
    pub(super) fn of(speed: f64, transition: f64) -> Self {
        let (sign, by_input, by_width) = shape::sign(speed, transition);
        Self { sign, by_input, by_width }
    }
}

/// The drag of a mesh as a share of its contact torque, with its derivatives by `driven` (see [`drag`]) and by the law's own parameters.
pub(super) struct Share<const N: usize> {
    pub(super) value: f64,
    pub(super) by_driven: f64,
    pub(super) by_parameters: [f64; N],
}

/// The drag of a mesh that slides in a direction under a contact torque. `share` is called with 0 while the fast side drives and 1 while the
/// slow side does. After its own parameters the law has the width of the direction's transition and the transition torque.
pub(super) fn drag<const N: usize>(
    Direction { sign, by_input, by_width }: Direction,
    torque: f64,
    transition: f64,
    share: impl FnOnce(f64) -> Share<N>,
) -> Response {
    let (turn, turn_bend, by_transition) = shape::sign(torque, transition);
    // |torque|, rounded over the transition torque.
    let size = torque * turn;
    let Share { value, by_driven, by_parameters } = share(0.5 * (1.0 - sign * turn));
    let by_sign = size * (value - 0.5 * sign * turn * by_driven);
    let by_turn = torque * value - 0.5 * size * sign * by_driven;
    let mut response = shape::response(
        -size * value * sign,
        &[-by_sign * by_input, -sign * (turn * value + by_turn * turn_bend)],
        &by_parameters.map(|by_parameter| -size * sign * by_parameter),
    );
    response.by_parameter[N] = -by_sign * by_width;
    response.by_parameter[N + 1] = -sign * by_turn * by_transition;
    response
}
