use std::collections::HashSet;

use super::*;
use crate::{Quantity, Role};

const AALTO: &str = include_str!("../../../../tests/models/aalto.toml");

/// The grid of the layout with the elements' names.
fn text(layout: &Layout) -> Vec<Vec<&str>> {
    let mut grid = vec![vec![""; layout.columns]; layout.rows];
    for element in &layout.elements {
        let place = &mut grid[element.row][element.column];
        assert_eq!(*place, "", "{} stands on {place}", element.name);
        *place = &element.name;
    }
    grid
}

fn kind(layout: &Layout, name: &str) -> ElementKind {
    layout.elements[layout.find(name).unwrap()].kind
}

#[test]
fn the_default_bench_is_drawn_as_in_the_thesis() {
    let layout = Layout::of(&Model::builtin("speed-o-cam").unwrap());
    let chain = [
        "motor",
        "coupling_1",
        "torque_sensor_in",
        "coupling_2",
        "cam_shaft",
        "mesh",
        "disk",
        "roller_pins",
        "torque_sensor_out",
        "coupling_3",
        "load_hub",
        "load_shaft",
        "load",
    ];
    let mut above = [""; 13];
    (above[0], above[1], above[7], above[12]) = ("motor_speed", "torque_in", "torque_out", "output_speed");
    let mut below = [""; 13];
    (below[4], below[12]) = ("cam_bearing", "load_bearing");
    assert_eq!(text(&layout), [above, chain, below]);

    assert_eq!(kind(&layout, "motor"), ElementKind::Motor);
    assert_eq!(kind(&layout, "torque_sensor_in"), ElementKind::Point);
    assert_eq!(kind(&layout, "coupling_1"), ElementKind::Spring { damped: true });
    assert_eq!(kind(&layout, "roller_pins"), ElementKind::Spring { damped: false });
    assert_eq!(kind(&layout, "mesh"), ElementKind::Gear { ratio: 8.0 });
    assert_eq!(kind(&layout, "load_shaft"), ElementKind::Shaft);
    assert_eq!(kind(&layout, "cam_bearing"), ElementKind::Bearing { damped: false });
    assert_eq!(kind(&layout, "load"), ElementKind::Load);
    assert_eq!(
        kind(&layout, "motor_speed"),
        ElementKind::Sensor { role: Role::Input, quantity: Quantity::Speed }
    );
}

#[test]
fn small_models() {
    let two_mass = Layout::of(&Model::builtin("two-mass").unwrap());
    assert_eq!(
        text(&two_mass),
        [
            ["motor_speed", "", ""],
            ["motor_torque", "", "load_speed"],
            ["motor", "shaft", "load"],
            ["motor_bearing", "", "load_bearing"]
        ]
    );
    let emps = Layout::of(&Model::builtin("emps").unwrap());
    assert_eq!(text(&emps), [["position"], ["force"], ["carriage"], ["guide"]]);
    assert_eq!(kind(&emps, "carriage"), ElementKind::Inertia);
    assert_eq!(emps.elements[emps.find("guide").unwrap()].effects, ["coulomb_friction"]);
    let with_servo = Layout::of(&Model::builtin("emps-loop").unwrap());
    assert_eq!(
        text(&with_servo),
        [["force", ""], ["position_ref", "position"], ["servo", "carriage"], ["", "guide"]]
    );
}

#[test]
fn a_long_chain_is_wrapped() {
    let model = Model::parse(AALTO).unwrap();
    let whole = Layout::of(&model);
    assert_eq!((whole.columns, whole.rows), (47, 3));
    let wrapped = Layout::wrapped(&model, 13);
    text(&wrapped);
    assert_eq!(wrapped.columns, 13);
    assert_eq!(wrapped.joints, whole.joints);
    let row = |name: &str| wrapped.elements[wrapped.find(name).unwrap()].row;
    let ends_of_lines = ["motor", "part_7", "spring_7", "part_13", "spring_13", "load"];
    assert_eq!(ends_of_lines.map(row), [1, 1, 4, 6, 6, 9]);
}

#[test]
fn every_place_and_channel_has_one_element() {
    let builtin = crate::BUILTIN.iter().map(|(name, _)| Model::builtin(name).unwrap());
    for model in builtin.chain([AALTO, BRANCHES, WRIST].map(|text| Model::parse(text).unwrap())) {
        let layout = Layout::wrapped(&model, 5);
        let places = model
            .nodes
            .iter()
            .map(|node| &node.name)
            .chain(model.springs.iter().map(|spring| &spring.name))
            .chain(model.gears.iter().map(|gear| &gear.name))
            .chain(model.shafts.iter().map(|shaft| &shaft.name))
            .chain(model.bearings.iter().map(|bearing| &bearing.name))
            .chain(model.differentials.iter().map(|differential| &differential.name))
            .chain(model.motors.iter().map(|motor| &motor.name))
            .chain(model.servo.iter().map(|servo| &servo.name));
        let names: HashSet<_> = places.chain(model.channels.iter().map(|channel| &channel.name)).collect();
        let drawn: Vec<_> = layout.elements.iter().map(|element| &element.name).collect();
        assert_eq!(drawn.len(), names.len() + model.differentials.len(), "{}", model.name);
        assert_eq!(drawn.into_iter().collect::<HashSet<_>>(), names, "{}", model.name);
        text(&layout);
    }
}

#[test]
fn branches_and_loops_get_their_own_lanes() {
    let layout = Layout::of(&Model::parse(BRANCHES).unwrap());
    assert_eq!(
        text(&layout),
        [
            ["drive", "", "", "", ""],
            ["motor", "shaft", "hub", "belt", "roll"],
            ["", "", "held", "", ""],
            ["", "", "", "", "fan_speed"],
            ["", "", "", "arm", "fan"],
            ["", "second_shaft", "", "", ""],
        ]
    );
}

#[test]
fn each_way_into_a_differential_and_each_winding_is_drawn() {
    let layout = Layout::of(&Model::parse(WRIST).unwrap());
    assert_eq!(
        text(&layout),
        [
            ["left_amperes", "", "", "", "", "", "right_amperes"],
            ["left_volts", "left_speed", "", "", "", "", "right_volts"],
            ["left_winding", "left", "roll_mix", "roll", "roll_mix", "right", "right_winding"],
            ["", "left_bearing", "", "", "", "", ""],
            ["", "", "", "pitch_speed", "", "", ""],
            ["", "", "pitch_mix", "pitch", "", "", ""],
            ["", "", "", "", "pitch_mix", "", ""],
        ]
    );
}

/// Two windings, two differentials.
const WRIST: &str = include_str!("../../tests/wrist.toml");

/// A branch at the hub, two shafts side by side, and a spring to the ground.
const BRANCHES: &str = include_str!("../../tests/branches.toml");
