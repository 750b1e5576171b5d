//! Laws that real rigs required, against closed forms.

use crate::{
    Model, Quantity,
    effects::{self, Effect, FittedValues, Rig},
};

fn evaluate(effect: &Effect, law_inputs: &[f64], parameters: &[f64]) -> f64 {
    effect.laws()[0].evaluate(law_inputs, parameters).torque
}

/// The servo of the BAM data set loses 0.272 (|T_motor| + |T_arm|), which is a fraction of 0.428 of the entering torque in either direction.
#[test]
fn a_mesh_loses_the_same_share_of_what_enters_whichever_side_drives() {
    let loss = effects::find("mesh_loss").unwrap();
    let widths = [1e-9, 1e-9];
    let drag = |torque: f64, speed: f64, fraction: f64| {
        -evaluate(loss, &[speed, torque], &[fraction, widths[0], widths[1]])
    };
    let coefficient = 0.272;
    let fraction = 2.0 * coefficient / (1.0 + coefficient);
    for speed in [3.0, -3.0] {
        let driving = drag(2.0 * f64::signum(speed), speed, fraction) * f64::signum(speed);
        let driven = drag(-2.0 * f64::signum(speed), speed, fraction) * f64::signum(speed);
        assert!((driving - coefficient * (2.0 + (2.0 - driving))).abs() < 1e-9, "{driving}");
        assert!((driven - coefficient * (2.0 + (2.0 + driven))).abs() < 1e-9, "{driven}");
        assert!((driven / (2.0 + driven) - fraction).abs() < 1e-9);
    }
}

/// Three known losses: of equal efficiencies, in proportion to the torque of the fast side, and of a screw, whose efficiency while
/// back-driven is 2 - 1/efficiency.
#[test]
fn a_mesh_may_lose_another_share_while_the_slow_side_drives() {
    let plain = effects::find("mesh_loss").unwrap();
    let both = effects::find_with("mesh_loss", ["fraction", "back_fraction"].into_iter()).unwrap();
    let fraction = 0.3;
    let efficiency = 1.0 - fraction;
    // Drag against the motion at a contact torque of 2 N m: while the fast side drives, and while the slow side does.
    let drags = |back: f64| {
        [2.0, -2.0].map(|torque| {
            let at = |turn: f64| {
                turn * -evaluate(both, &[3.0 * turn, torque * turn], &[fraction, back, 1e-9, 1e-9])
            };
            assert_eq!(at(1.0), at(-1.0));
            at(1.0)
        })
    };
    let close = |[a, b]: [f64; 2], [c, d]: [f64; 2]| (a - c).abs() < 1e-12 && (b - d).abs() < 1e-12;
    assert!(close(drags(fraction), [2.0 * fraction, 2.0 / efficiency - 2.0]));
    assert!(close(drags(fraction / (1.0 + fraction)), [2.0 * fraction, 2.0 * fraction]));
    let [_, of_screw] = drags(1.0 / efficiency - 1.0);
    assert!((2.0 / (2.0 + of_screw) - (2.0 - 1.0 / efficiency)).abs() < 1e-12);
    // Equal shares are the plain law, in its transitions too. A fit of the richer law starts there.
    for seen in [[0.02, 0.1], [-0.02, 0.1], [0.05, -0.3], [0.0, 0.2], [3.0, -2.0]] {
        let [a, b] = [(plain, &[fraction, 0.05, 0.1][..]), (both, &[fraction, fraction, 0.05, 0.1])]
            .map(|(law, parameters)| evaluate(law, &seen, parameters));
        assert!((a - b).abs() < 1e-15, "{seen:?}: {a}, {b}");
    }
    let model = Model::builtin("speed-o-cam").unwrap();
    let rig = Rig::of_model(&model, &model.values());
    let starts = (both.replaces[0].starts)(&rig, &FittedValues(&[("fraction", fraction)]));
    assert_eq!((both.replaces[0].law, starts), (plain.id, vec![vec![("back_fraction", fraction)]]));
}

#[test]
fn sensors_fold_and_differ_by_direction() {
    let fold = effects::find("sensor_fold").unwrap();
    assert_eq!([3.0, -3.0].map(|truth| truth + evaluate(fold, &[truth], &[1.0])), [3.0, 3.0]);
    let gain = effects::find("direction_gain").unwrap();
    let read = [2.0, -2.0].map(|truth| truth + evaluate(gain, &[truth], &[0.1]));
    assert!((read[0] - 2.1).abs() < 1e-12 && (read[1] + 1.9).abs() < 1e-12);
}

#[test]
fn friction_that_falls_with_speed_does_not_jump_at_standstill() {
    let weakening = effects::find("velocity_weakening").unwrap();
    let at = |speed: f64| evaluate(weakening, &[speed], &[0.4, 2.0]);
    assert!((at(1e-9) - at(-1e-9)).abs() < 1e-9 && (at(0.0) + 0.4).abs() < 1e-12 && at(20.0).abs() < 1e-12);
}

/// Scales of a bench with a given `reverse_share`.
fn one_way(model: &Model, reverse_share: f64) -> Rig {
    let mut rig = Rig::of_model(model, &model.values());
    for node in &mut rig.nodes {
        (node.speed, node.torque, node.reverse_share) = (20.0, 1.0, reverse_share);
    }
    rig
}

#[test]
fn laws_are_looked_for_only_where_the_motion_shows_them() {
    let model = Model::builtin("speed-o-cam").unwrap();
    let starts = |effect: &Effect, rig: &Rig| (effect.starts)(rig, "load_bearing").len();
    let weakening = effects::find("velocity_weakening").unwrap();
    assert!(starts(weakening, &one_way(&model, 0.0)) > 0 && starts(weakening, &one_way(&model, 1.0)) == 0);
    let sticking = effects::REFINED.iter().find(|effect| effect.id == "coulomb_friction").unwrap();
    let mut rig = one_way(&model, 1.0);
    assert_eq!(starts(sticking, &rig), 0);
    rig.nodes.iter_mut().for_each(|node| node.rest_share = 0.3);
    assert!(starts(sticking, &rig) > 0);
}

/// A limited input acts by more than it reads; an early or late one acts by its reading at another time.
#[test]
fn inputs_clip_and_are_late() {
    let base = Model::builtin("speed-o-cam").unwrap();
    let clipped =
        base.with_effect("sensor_saturation", "motor_speed", &[("limit", 150.0), ("excess", 16.0)]).unwrap();
    let law = clipped.effects[0].effect;
    let truth = |reading: f64| reading - evaluate(law, &[reading], &[150.0, 16.0]);
    assert!(
        (truth(150.0) - 166.0).abs() < 0.1
            && (truth(-150.0) + 166.0).abs() < 0.1
            && (truth(140.0) - 140.0).abs() < 1e-9
    );
    let late = base.with_effect("sensor_delay", "motor_speed", &[("delay", -2e-3)]).unwrap();
    assert!(
        late.inputs().any(|input| input.quantity == Quantity::Change && input.name == "motor_speed changes")
    );
    let law = late.effects[0].effect;
    assert_eq!(10.0 - evaluate(law, &[300.0], &[-2e-3]), 9.4);
    // A negative delay is possible at inputs only.
    assert!(base.with_effect("sensor_delay", "output_speed", &[("delay", -2e-3)]).is_err());
    assert!((law.sentence)(&FittedValues(&[("delay", -2e-3)])).contains("early"));
}

const PRESCRIBED: &str = r#"
schema = "socam.model/1"
name = "cogging"
description = "A rotor whose motion is prescribed: the drive's torque is an output"
motion = "rotation"

[parameters]
drive = { value = 100, unit = "N m/rad", fixed = true, source = "rigid" }
J = { value = 2e-4, unit = "kg m2", bounds = [1e-5, 1e-2], source = "guess" }

[[nodes]]
name = "encoder"
[[nodes]]
name = "rotor"
inertia = "J"

[[springs]]
name = "drive"
from = "encoder"
to = "rotor"
stiffness = "drive"

[channels.speed]
role = "input"
quantity = "speed"
at = "encoder"
[channels.torque]
role = "output"
quantity = "torque"
at = "drive"
"#;

#[test]
fn cogging_is_looked_for_where_the_motion_is_prescribed() {
    let ripple = effects::find("torque_ripple").unwrap();
    let model = Model::parse(PRESCRIBED).unwrap();
    assert_eq!(ripple.places_in(&model), ["rotor"]);
    assert!(ripple.places_in(&Model::builtin("speed-o-cam").unwrap()).is_empty());
    let mut rig = Rig::of_model(&model, &model.values());
    rig.nodes[1].orders = vec![7.0, 28.0, 14.0, 12.0];
    let orders: Vec<f64> =
        (ripple.starts)(&rig, "rotor").iter().map(|start| FittedValues(start).get("order")).collect();
    assert_eq!(orders[..4], [7.0, 28.0, 14.0, 12.0]);
    assert_eq!(orders.iter().filter(|order| **order == 7.0).count(), 1);
    let cogging =
        model.with_effect("torque_ripple", "rotor", &[("order", 7.0), ("torque", 0.05), ("phase", 0.0)]);
    assert!(cogging.is_ok());
}
