//! Play between the teeth of a gear.

use super::{
    definition::{
        Acts, ActsAt, Amplitude, Borrowed, Discrepancy, Effect, EffectParameter, Family, Form, Law, LawInput,
        Linearisation, POSITIVE, Places, Prior, QuantityKind, Response, Rule, Steady, all_zero,
        begin_with_little,
    },
    experiment,
    kinds::CONTACT_DAMPING,
    shape, usual,
};

/// The contact of the teeth is a stiff linear spring and damper. The law cancels their torque while the play (twist at the slow side) is
/// within -gap/2 .. gap/2. `contact_damping` sets the rebound after an impact: at its default value there is almost none, and a smaller
/// damping gives a larger rebound.
pub(super) const EFFECT: Effect = Effect {
    id: "backlash",
    name: "backlash",
    acts_at: ActsAt::Gear,
    family: Family::Elastic,
    places: Places::Every,
    parameters: &[
        EffectParameter::new("gap", QuantityKind::Angle, POSITIVE),
        // The damping of the contact, which is proportional to its stiffness, is used where a file gives none.
        EffectParameter::usual(CONTACT_DAMPING, QuantityKind::Damping, (0.0, 0.0)),
    ],
    borrows: Some(Borrowed::Contact),
    form: Form::Laws(&[Law {
        law_inputs: &[LawInput::Twist, LawInput::TwistRate],
        acts: Acts::Torque,
        rule: Rule::Code(evaluate),
        formula: "-stiffness*0.5*(sqrt((twist + 0.5*gap)^2 + 1e-16) - sqrt((twist - 0.5*gap)^2 + 1e-16)) - \
                  damping*twist_rate*0.5*((twist + 0.5*gap)/sqrt((twist + 0.5*gap)^2 + 1e-16) - (twist - \
                  0.5*gap)/sqrt((twist - 0.5*gap)^2 + 1e-16))",
        transition: |parameters| 0.5 * parameters[0],
        inactive: |parameters| parameters[0] == 0.0,
    }]),
    amplitude: Amplitude::of(&["gap"]),
    linearisation: Linearisation::NearNull,
    starts: |_, _| all_zero(["gap"]),
    fit_starts: begin_with_little,
    priors: |rig, _| {
        let (usual, most) = if rig.rotational { (3e-3, 0.5) } else { (1e-4, 0.05) };
        let source = "catalogues of gearboxes and screws: 1 to 60 arcmin, 0.01 to 0.5 mm; worn ones have ten times as much";
        vec![("gap", Prior::log_normal([usual, 5.0], (0.0, most), source))]
    },
    discrepancy: &[Discrepancy {
        upper_factor: REBOUND,
        source: "teeth that rebound look like a smaller gap: fitted gaps were 45 to 62 % of the true ones (docs/diagnosis-measured.md)",
        ..Discrepancy::amplitude("gap")
    }],
    usual: usual::never,
    replaces: &[],
    equivalents: &[],
    steady: Steady::Unseen,
    equation: "no torque while |play| < gap/2",
    sentence: |_| "The mesh has play: when the torque changes sign, the teeth separate for a moment and then strike.",
    shows: "where the transmitted torque changes its sign",
    experiment: experiment::THROUGH_STANDSTILL,
};

/// Where residuals exceed the noise, the true gap may be up to this factor times the fitted one.
const REBOUND: f64 = 2.5;
/// Width of the rounded corners, rad (m): 0.1 % of the smallest play that a sensor can resolve.
const ROUNDING: f64 = 1e-8;

fn evaluate(law_inputs: &[f64], p: &[f64]) -> Response {
    let (rate, stiffness, damping) = (law_inputs[1], p[2], p[3]);
    let inside = shape::clip(law_inputs[0], 0.5 * p[0], ROUNDING);
    shape::response(
        -stiffness * inside.value - damping * rate * inside.by_x,
        &[-stiffness * inside.by_x - damping * rate * inside.by_x_x, -damping * inside.by_x],
        &[
            -0.5 * (stiffness * inside.by_half + damping * rate * inside.by_x_half),
            0.0,
            -inside.value,
            -rate * inside.by_x,
        ],
    )
}

impl Effect {
    /// Whether it is backlash, whose law is piecewise linear with three modes (contact on either flank, and none).
    pub(crate) fn is_play(&self) -> bool {
        self.id == EFFECT.id
    }
}
