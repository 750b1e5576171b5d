//! Loss of a gear in proportion to the transmitted torque, that gives elastically before it slips.

use super::{
    definition::{
        Acts, ActsAt, Discrepancy, Effect, EffectParameter, Family, Form, Law, LawInput, Linearisation,
        POSITIVE, Places, QuantityKind, Replaces, Response, Rule, Steady, begin_with_little,
    },
    experiment,
    mesh_loss::{self, Direction},
    presliding, shape, usual,
};

/// The mesh loses `fraction` of the torque that enters it once its flanks slide. Before, the friction between them builds up with their
/// deflection z, at the slow side: z' = w - |w| z / deflection, and z / deflection takes the place of the sign of the speed in the plain mesh
/// loss. At rest the flanks hold what they held when they stopped, up to the full loss either way.
pub(super) const MESH_LOSS: Effect = Effect {
    id: mesh_loss::EFFECT.id,
    name: "mesh loss with presliding",
    acts_at: ActsAt::Gear,
    family: Family::Friction,
    places: Places::Every,
    parameters: &[
        EffectParameter::new("fraction", QuantityKind::Ratio, (0.0, 0.95)),
        EffectParameter::new("deflection", QuantityKind::Angle, POSITIVE),
        EffectParameter::usual("transition_torque", QuantityKind::Torque, (0.1, 1.0)),
        presliding::TRANSITION,
    ],
    borrows: None,
    form: Form::Laws(&[
        Law {
            law_inputs: &[LawInput::Speed, LawInput::State],
            acts: Acts::State,
            rule: Rule::Code(|law_inputs, p| {
                let (rate, derivatives, [.., by_deflection, by_transition]) =
                    presliding::bend(law_inputs, [p[1], p[3]], presliding::STEADY);
                shape::response(rate, &derivatives, &[0.0, by_deflection, 0.0, by_transition])
            }),
            formula: "speed - speed*tanh(speed/transition_speed)*state/deflection",
            transition: |p| p[3],
            inactive: shape::never,
        },
        Law {
            law_inputs: &[LawInput::State, LawInput::Torque],
            acts: Acts::Drag,
            rule: Rule::Code(evaluate),
            formula: "-through*tanh(through/transition_torque)*state/deflection*fraction/(1 - \
                      0.5*fraction*(1 - state/deflection*tanh(through/transition_torque)))",
            transition: shape::no_transition,
            inactive: |parameters| parameters[0] == 0.0,
        },
    ]),
    amplitude: mesh_loss::EFFECT.amplitude,
    linearisation: Linearisation::Null,
    starts: |rig, _| {
        let each = presliding::deflections(rig).into_iter();
        each.map(|deflection| vec![("fraction", 0.0), ("deflection", deflection)]).collect()
    },
    fit_starts: begin_with_little,
    priors: |rig, place| {
        let mut all = (mesh_loss::EFFECT.priors)(rig, place);
        all.push(presliding::deflection(rig));
        all
    },
    discrepancy: &[Discrepancy::amplitude("fraction"), presliding::BENT],
    usual: usual::never,
    replaces: &[Replaces { law: mesh_loss::EFFECT.id, starts: presliding::giving }],
    equivalents: &[],
    steady: Steady::Unseen,
    equation: "|T_out| = (1 - f) |T_in| where the flanks slide; before, the loss grows as z/d, z' = w - |w| z/d",
    sentence: |_| {
        "The mesh loses a share of the torque that enters it, and gives a little before its flanks slide: it creeps back at rest instead \
         of holding still."
    },
    shows: "where torque is transmitted, about every reversal",
    experiment: experiment::THROUGH_STANDSTILL,
};

fn evaluate(law_inputs: &[f64], p: &[f64]) -> Response {
    let (bent, deflection) = (law_inputs[0], p[1]);
    let direction = Direction {
        sign: bent / deflection,
        by_input: 1.0 / deflection,
        by_width: -bent / (deflection * deflection),
    };
    mesh_loss::drag(direction, law_inputs[1], p[2], |driven| mesh_loss::equal_share(p[0], driven))
}
