//! Scales of an embedded model.

use super::*;

#[test]
fn the_rigid_stiffness_scales_with_the_unit_of_force() {
    let model = Model::builtin("speed-o-cam").unwrap();
    let values = model.values();
    let own = Rig::of_model(&model, &values).rigid_stiffness();
    let thousandth: Vec<f64> = values.iter().map(|value| 1e-3 * value).collect();
    let other = Rig::of_model(&model, &thousandth).rigid_stiffness();
    assert!((other / own - 1e-3).abs() < 1e-12);
    assert!((own / 1e6 - 1.0).abs() < 0.1, "{own}");
}

#[test]
fn torques_propagate_through_gears_and_shafts() {
    let model = Model::builtin("speed-o-cam").unwrap();
    let mut rig = Rig::of_model(&model, &model.values());
    let at = |name: &str| model.nodes.iter().position(|node| node.name == name).unwrap();
    rig.nodes[at("cam_shaft")].torque = 0.5;
    rig.spread_torques(&model);
    assert_eq!(rig.node("disk").torque, 4.0);
    assert_eq!(rig.node("load").torque, 0.0);
    assert_eq!(rig.gear("mesh").1.torque, 4.0);
}

#[test]
fn the_longest_time_constant_follows_from_modes_and_length() {
    let mut rig = Rig { longest_s: 10.0, modes_hz: vec![5.0, 40.0], ..Rig::default() };
    assert!((rig.longest_time_constant_s("speed") - 0.0318).abs() < 1e-4);
    rig.longest_s = 0.1;
    assert!((rig.longest_time_constant_s("speed") - 0.01).abs() < 1e-12);
    assert_eq!(rig.wave_hz().0, 50.0);
}
