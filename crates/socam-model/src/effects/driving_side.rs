//! Loss of a gear in proportion to the transmitted torque, of which the slow side loses another share than the fast side.

use super::{
    definition::{
        Acts, ActsAt, Amplitude, Discrepancy, Effect, EffectParameter, Family, Form, Law, LawInput,
        Linearisation, Places, Prior, QuantityKind, Replaces, Response, Rule, Steady, all_zero,
        begin_with_little,
    },
    experiment,
    mesh_loss::{self, Direction, Share, drag},
    usual,
};

/// The mesh loses `fraction` of the torque that enters it while the fast side drives, and `back_fraction` while the slow side drives. It is
/// the plain mesh loss where both are equal. A loss in proportion to the torque of the fast side has back_fraction = fraction /
/// (1 + fraction); one in proportion to that of the slow side, as of a worm or screw, has fraction / (1 - fraction).
pub(super) const MESH_LOSS: Effect = Effect {
    id: mesh_loss::EFFECT.id,
    name: "mesh loss by driving side",
    acts_at: ActsAt::Gear,
    family: Family::Friction,
    places: Places::Every,
    parameters: &[
        EffectParameter::new("fraction", QuantityKind::Ratio, (0.0, 0.95)),
        EffectParameter::new("back_fraction", QuantityKind::Ratio, (0.0, 0.95)),
        EffectParameter::usual("transition_speed", QuantityKind::Speed, (0.05, 2e-3)),
        EffectParameter::usual("transition_torque", QuantityKind::Torque, (0.1, 1.0)),
    ],
    borrows: None,
    form: Form::Laws(&[Law {
        law_inputs: &[LawInput::Speed, LawInput::Torque],
        acts: Acts::Drag,
        rule: Rule::Code(evaluate),
        formula: "-through*tanh(through/transition_torque)*tanh(speed/transition_speed)*(fraction + \
                  0.5*(back_fraction - fraction)*(1 - \
                  tanh(speed/transition_speed)*tanh(through/transition_torque)))/(1 - \
                  0.5*back_fraction*(1 - tanh(speed/transition_speed)*tanh(through/transition_torque)))",
        transition: |parameters| parameters[2],
        inactive: |parameters| parameters[0] == 0.0 && parameters[1] == 0.0,
    }]),
    amplitude: Amplitude::of(&["fraction", "back_fraction"]),
    linearisation: Linearisation::Null,
    starts: |_, _| all_zero(["fraction", "back_fraction"]),
    fit_starts: begin_with_little,
    priors: |rig, place| {
        let mut all = (mesh_loss::EFFECT.priors)(rig, place);
        let source = "back-driven, a spur stage loses as much as while it drives, and a worm or screw f / (1 - f), up to self-locking";
        all.push(("back_fraction", Prior::log_normal([0.05, 4.0], (0.0, 0.95), source)));
        all
    },
    discrepancy: &[Discrepancy::amplitude("fraction"), Discrepancy::amplitude("back_fraction")],
    usual: usual::never,
    replaces: &[Replaces {
        law: mesh_loss::EFFECT.id,
        starts: |_, fitted| {
            let known = fitted.get("back_fraction");
            let start = if known.is_finite() { known } else { fitted.get("fraction").max(LEAST_START) };
            vec![vec![("back_fraction", start)]]
        },
    }],
    equivalents: &[],
    steady: Steady::Unseen,
    equation: "|T_out| = (1 - f) |T_in| while the fast side drives, (1 - g) |T_in| while the slow side drives, referred to one side",
    sentence: |fitted| {
        if fitted.get("back_fraction") > fitted.get("fraction") {
            "The mesh loses a share of the torque that enters it, and a larger share while the slow side drives: flanks that slide along a \
             slope, as of a worm, a screw or a gear of high ratio."
        } else {
            "The mesh loses a share of the torque that enters it, and a smaller share while the slow side drives: friction in proportion \
             to the torque of the fast side."
        }
    },
    shows: "where torque is transmitted, in proportion to it, and more while one of the two sides drives",
    experiment: experiment::DRIVEN_BY_LOAD,
};

/// Least start of the share that is lost while the slow side drives.
const LEAST_START: f64 = 0.01;

fn evaluate(law_inputs: &[f64], p: &[f64]) -> Response {
    let (fraction, back) = (p[0], p[1]);
    drag(Direction::of(law_inputs[0], p[2]), law_inputs[1], p[3], |driven| {
        // From f to g / (1 - g), and for equal fractions the share of the plain law in between too.
        let lost = fraction + (back - fraction) * driven;
        let left = 1.0 - back * driven;
        let square = left * left;
        Share {
            value: lost / left,
            by_driven: (back - fraction + back * fraction) / square,
            by_parameters: [(1.0 - driven) / left, driven * (1.0 + fraction * (1.0 - driven)) / square],
        }
    })
}
