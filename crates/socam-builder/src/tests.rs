//! Descriptions, the models that they give, and the messages of those that give none.

mod refusals;

use socam_model::{Model, Motion};
use socam_recording::{Channel, Dataset};

use crate::{Described, Description, describe, draw};

fn described(
    chain: &str,
    drives: &[&str],
    measures: &[&str],
    data: Option<&Dataset>,
) -> Result<Described, String> {
    let own = |all: &[&str]| all.iter().map(|text| (*text).to_owned()).collect::<Vec<_>>();
    let (drives, measures) = (own(drives), own(measures));
    let description = Description { name: "test", chain, drives: &drives, measures: &measures };
    describe(&description, data).map_err(|error| error.to_string())
}

fn model(chain: &str, drives: &[&str], measures: &[&str]) -> Model {
    let text = described(chain, drives, measures, None).unwrap().text;
    let model = Model::parse(&text).unwrap();
    assert_eq!(model.warnings(), Vec::<String>::new(), "{text}");
    for own in &model.parameters {
        assert!(!own.source.is_empty(), "{}", own.name);
        assert!(own.fixed || own.bounds.0 < own.value && own.value < own.bounds.1, "{own:?}");
    }
    model
}

fn value(model: &Model, name: &str) -> f64 {
    let index = model.parameter(name).unwrap_or_else(|| panic!("no {name} in {}", model.text));
    model.parameters[index].value
}

fn near(found: f64, expected: f64) {
    assert!((found / expected - 1.0).abs() < 5e-3, "{found}, {expected}");
}

#[test]
fn sizes_and_masses_become_start_values() {
    let axis = model(
        "motor 0.9kgcm2 | coupling 800Nm/rad | gear 5 | shaft 20x300mm steel | load disc 4kg 200mm",
        &["torque@motor:motor_current_A*0.055"],
        &["speed@motor:motor_speed_rad_s", "angle@load"],
    );
    let inertia = std::f64::consts::PI * 0.02_f64.powi(4) / 32.0;
    for (name, expected) in [
        ("motor_inertia", 0.9e-4),
        ("coupling_stiffness", 800.0),
        ("gear_ratio", 5.0),
        ("shaft_stiffness", 79e9 * inertia / 0.3),
        ("load_inertia", 4.0 * 0.1 * 0.1 / 2.0),
    ] {
        near(value(&axis, name), expected);
    }
    assert_eq!(axis.channels[0].scale, 0.055);
    // Coupling and shaft have no inertia between them: the shaft's size is known less well.
    let fixed = |name: &str| axis.parameters[axis.parameter(name).unwrap()].fixed;
    assert!(fixed("coupling_stiffness") && !fixed("shaft_stiffness"));

    for (load, expected) in [
        ("load rod 2 kg 500 mm", 2.0 * 0.25 / 3.0),
        ("load rod centre 2kg 0.5m", 2.0 * 0.25 / 12.0),
        ("load 2kg 300mm", 0.18),
        ("load 0.9 kg cm2", 0.9e-4),
    ] {
        let arm = model(&format!("motor | coupling jaw | {load}"), &["torque@motor"], &["angle@load"]);
        near(value(&arm, "load_inertia"), expected);
    }
}

#[test]
fn belts_screws_and_racks_are_referred_to_their_axis() {
    let belt = model(
        "motor 1kgcm2 | belt 20:60 span 400mm width 15mm | load 0.01kgm2",
        &["torque@motor"],
        &["speed@load"],
    );
    near(value(&belt, "belt_pulleys_ratio"), 3.0);
    let radius_m = 60.0 * 5e-3 / std::f64::consts::TAU;
    near(value(&belt, "belt_stiffness"), 2.0 * 5e6 * 15e-3 / 0.4 * radius_m * radius_m);

    let stage = model(
        "motor 0.5kgcm2 0.1Nm/A | coupling jaw | screw 5mm | slide 12kg",
        &["current@motor:i_A"],
        &["position@slide:x_m", "speed@motor"],
    );
    let per_rad = 5e-3 / std::f64::consts::TAU;
    near(value(&stage, "slide_inertia"), 12.0 * per_rad * per_rad);
    near(stage.channels[1].scale, 1.0 / per_rad);
    assert_eq!(stage.channels[0].scale, 0.1);
    let rack = model(
        "motor | gear 20:100 teeth | rack 120mm 2N/um | slide 40kg",
        &["torque@motor"],
        &["speed@slide:v_1 mm/s"],
    );
    near(value(&rack, "gear_ratio"), 5.0);
    near(value(&rack, "rack_stiffness"), 2e6 * (0.12 / std::f64::consts::TAU).powi(2));
    near(rack.channels[1].scale, 1e-3 * std::f64::consts::TAU / 0.12);
}

#[test]
fn each_drive_gives_its_model() {
    let voltage = model(
        "motor 0.9kgcm2 6.3V/krpm 1.2ohm 2mH | load 2kgcm2",
        &["voltage@motor"],
        &["speed@motor", "current@motor"],
    );
    assert_eq!(voltage.motors.len(), 1);
    near(value(&voltage, "motor_winding_torque_constant"), 0.0602);
    assert!(voltage.motors[0].inductance.is_some());
    // One rigid body: only the sum of both inertias shows.
    assert_eq!(
        voltage.parameters.iter().filter(|own| own.name.ends_with("_inertia") && own.fixed).count(),
        1
    );

    let servo = model("motor | coupling jaw | load", &["position@motor"], &["angle@motor", "torque@servo"]);
    assert_eq!(servo.servo.unwrap().name, "servo");
    let encoder = model("motor | coupling jaw | load", &["speed@motor:encoder_rad"], &["speed@load"]);
    assert!(encoder.parameters[encoder.parameter("motor_inertia").unwrap()].fixed);
    let axis = model("slide 95kg", &["force@slide"], &["position@slide"]);
    assert_eq!(axis.motion, Motion::Translation);
    let chained = model("slide 95kg | coupling 2N/um | slide 5kg", &["force@slide"], &["position@slide_2"]);
    assert_eq!(chained.nodes.len(), 2);
}

/// A rigid body of this inertia, driven by a torque that changes: torque, speed, and the angle of another shaft.
fn rigid(inertia: f64) -> Dataset {
    let step_s = 1e-3;
    let torque: Vec<f64> =
        (0..4000).map(|k| (f64::from(k) * 0.02).sin() + 0.5 * (f64::from(k) * 0.11).sin()).collect();
    let mut speed = vec![0.0];
    for pair in torque.windows(2) {
        let last = speed[speed.len() - 1];
        speed.push(last + step_s * (0.5 * (pair[0] + pair[1]) - 0.01 * last) / inertia);
    }
    let channels =
        ["drive_Nm", "motor_rad_s", "other_rad_s"].map(|name| Channel::from_column_name(name).unwrap());
    let time_s = (0..4000).map(|k| f64::from(k) * step_s).collect();
    Dataset::from_columns("run", channels.to_vec(), time_s, vec![torque, speed.clone(), speed]).unwrap()
}

#[test]
fn a_recording_gives_columns_and_the_inertia_that_has_no_size() {
    let data = rigid(5e-3);
    let chain = "motor 10kgcm2 | coupling jaw | gear 2 | load";
    let found = described(chain, &["torque@motor"], &["speed@motor"], Some(&data)).unwrap();
    let model = Model::parse(&found.text).unwrap();
    assert_eq!(
        model.channels.iter().map(|c| c.column.as_str()).collect::<Vec<_>>(),
        ["drive_Nm", "motor_rad_s"]
    );
    near(value(&model, "load_inertia"), 4.0 * (5e-3 - 1e-3));
    assert_eq!(
        found.notes,
        ["the inertia of load starts from torque over acceleration at motor: 0.005 kg m2 in all"]
    );
    let ambiguous = described(chain, &["torque@motor"], &["speed@load"], Some(&data)).unwrap_err();
    assert_eq!(
        ambiguous,
        "`speed@load`: which column is it? write speed@load:COLUMN, where COLUMN is one of motor_rad_s, other_rad_s"
    );
    let absent = described(chain, &["torque@motor:t_Nm"], &["speed@load"], Some(&data)).unwrap_err();
    assert_eq!(
        absent,
        "`torque@motor:t_Nm`: the recording has no column \"t_Nm\"; it has drive_Nm, motor_rad_s, other_rad_s"
    );
    let kept =
        described(chain, &["speed@motor:motor_rad_s"], &["speed@load:other_rad_s"], Some(&data)).unwrap();
    assert_eq!(kept.notes, ["the inertia of load keeps its typical start value: no torque drives the model"]);
}

#[test]
fn a_drawing_keeps_to_its_width_and_shows_branches() {
    let bench = Model::builtin("speed-o-cam").unwrap();
    for width in [60, 100, 200] {
        assert!(draw(&bench, width).lines().all(|line| line.chars().count() <= width));
    }
    let branches = Model::parse(include_str!("../../socam-model/tests/branches.toml")).unwrap();
    let expected = "
  ▼ drive
  [motor]┬────~shaft~────┬──[hub]──┬─~belt~────[roll]
         │               │ ┴ ~held~│
         │               │         │         △ fan_speed
         │               │         └─~arm~──────[fan]
         └─~second_shaft~┘
";
    assert_eq!(format!("\n{}", draw(&branches, 80)), expected);
    // The wires of roll_drum and of pitch lie beside one another.
    let machines = include_str!("../../../docs/machines.md");
    let wrist = machines.split("```toml\n").nth(2).and_then(|rest| rest.split("```").next()).unwrap();
    let expected = "
   △ left_speed
  ▼ left_torque
      [left]────┬─<roll_mix ×0.02>────(roll_drum)──┬────~roll_cable~─────────[roll]
  ┴ left_bearing│                                  │
                │                    △ pitch_angle │
                └─<pitch_mix ×0.02>─────[pitch]───┐│
                                                  ││                      △ right_speed
                                                  ││                     ▼ right_torque
                                                  │└──<roll_mix ×0.02>─┬─────[right]
                                                  │                    │ ┴ right_bearing
                                                  └──<pitch_mix ×-0.02>┘
";
    assert_eq!(format!("\n{}", draw(&Model::parse(wrist).unwrap(), 110)), expected);
}

#[test]
fn every_order_of_parts_gives_a_model() {
    let links = [
        "coupling jaw",
        "coupling rigid",
        "shaft 20x300mm",
        "shaft",
        "sensor",
        "gear 5",
        "gear 50 8kNm/rad 0.1kgcm2",
        "belt 20:60 span 400mm",
        "belt 16:16mm",
        "inertia 2kgcm2",
    ];
    let ends = ["load", "load disc 4kg 200mm", "screw 5mm | slide 12kg", "rack 120mm 80N/um | slide"];
    let drives = ["torque@motor", "voltage@motor", "speed@motor", "speed@motor:enc_rad", "position@motor"];
    for (first, second) in links.iter().flat_map(|first| links.map(|second| (*first, second))) {
        for (end, drive) in ends.iter().flat_map(|end| drives.map(|drive| (*end, drive))) {
            let chain = format!("motor | {first} | {second} | {end}");
            let last = if end.starts_with("load") { "load" } else { "slide" };
            let measure = format!("speed@{last}");
            let found = described(&chain, &[drive], &[&measure], None);
            let text = found.unwrap_or_else(|error| panic!("{chain}, {drive}: {error}")).text;
            let warnings = Model::parse(&text).unwrap().warnings();
            // A rigid machine whose speed is prescribed has nothing left to predict.
            let is_idle = warnings.iter().all(|warning| warning.contains("no information on the drivetrain"));
            assert!(is_idle, "{chain}, {drive}: {warnings:?}");
        }
    }
}
