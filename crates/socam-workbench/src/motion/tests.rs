use socam_model::Model;
use socam_recording::{Channel, Dataset, Unit};

use super::*;
use crate::job::Handle;

/// A recording of speeds of the default bench: the motor at 80 rad/s, the load at 10 rad/s, and a torque.
fn recording(names: &[(&str, Unit, f64)]) -> Recording {
    let time_s: Vec<f64> = (0..2001).map(|row| f64::from(row) * 1e-3).collect();
    let channels = names.iter().map(|(name, unit, _)| Channel::new(*name, *unit)).collect();
    let columns = names.iter().map(|(.., value)| vec![*value; time_s.len()]).collect();
    let data = Dataset::from_columns("run.csv", channels, time_s, columns).unwrap();
    Recording::of(&data, &Handle::default()).unwrap()
}

#[test]
fn a_node_without_a_sensor_follows_the_nearest_one_by_the_gears() {
    let model = Model::builtin("speed-o-cam").unwrap();
    let run = recording(&[("motor_speed", Unit::RadPerS, 80.0)]);
    let motion = Motion::measured(&model, &run).unwrap();
    let at = |name: &str| {
        let node = model.nodes.iter().position(|node| node.name == name).unwrap();
        let measured = motion.nodes[node].measured.as_ref().unwrap();
        (measured.at(1.5).unwrap(), measured.is_here)
    };
    // 120 rad of the motor are 15 rad behind the gear of 8 : 1.
    assert!((at("motor").0 - 120.0).abs() < 1e-3 && at("motor").1, "{:?}", at("motor"));
    assert!((at("load").0 - 15.0).abs() < 1e-3 && !at("load").1, "{:?}", at("load"));
    assert!((motion.fastest - 80.0).abs() < 0.1 && (motion.farthest - 160.0).abs() < 0.1, "{motion:?}");
    assert_eq!(motion.nodes[0].measured.as_ref().unwrap().at(3.0), None);

    // With a sensor at the load, whose shaft is rigid, the hub has that sensor too, and the disk no motor in between.
    let run = recording(&[("motor_speed", Unit::RadPerS, 80.0), ("output_speed", Unit::RadPerS, 9.0)]);
    let motion = Motion::measured(&model, &run).unwrap();
    let hub = model.nodes.iter().position(|node| node.name == "load_hub").unwrap();
    let hub = motion.nodes[hub].measured.as_ref().unwrap();
    assert!(hub.is_here && hub.channel == "output_speed" && (hub.at(1.0).unwrap() - 9.0).abs() < 1e-3);
}

#[test]
fn what_cannot_be_played_says_why() {
    let model = Model::builtin("two-mass").unwrap();
    let run = recording(&[("torque_in", Unit::Nm, 1.0)]);
    let said = Motion::measured(&model, &run).unwrap_err();
    let expected = "none of the speeds and angles that the model two-mass reads (motor_speed, load_speed); it has torque_in";
    assert!(said.contains(expected), "{said}");
}

#[test]
fn a_prediction_brings_loads_of_springs_and_misfits_of_channels() {
    let model = Model::builtin("two-mass").unwrap();
    let (_, probes) = model.with_probes().unwrap();
    let run = recording(&[
        ("motor_torque", Unit::Nm, 1.0),
        ("motor_speed", Unit::RadPerS, 4.0),
        ("load_speed", Unit::RadPerS, 4.0),
    ]);
    let simulated = recording(&[
        ("motor_speed", Unit::RadPerS, 4.0),
        ("load_speed", Unit::RadPerS, 3.0),
        ("probe_1", Unit::RadPerS, 4.0),
        ("probe_2", Unit::RadPerS, 3.0),
        ("probe_3", Unit::Nm, 0.5),
    ]);
    let motion = Motion::measured(&model, &run).unwrap().predict(&model, &probes, &run, &simulated);
    let load = motion.nodes[1].predicted.as_ref().unwrap();
    assert!((load.at(2.0).unwrap() - 6.0).abs() < 1e-6);
    let [shaft] = &motion.springs[..] else { panic!("{:?}", motion.springs) };
    let power = shaft.power.as_ref().unwrap().at(1.0).unwrap();
    assert!((shaft.torque.at(1.0).unwrap() - 0.5).abs() < 1e-6 && (power - 2.0).abs() < 1e-6, "{power}");
    let shares: Vec<f64> = motion.misfits.iter().map(|misfit| misfit.share.at(1.0).unwrap()).collect();
    assert!(shares[0] < 1e-6 && (shares[1] - 0.25).abs() < 1e-6, "{shares:?}");
}

#[test]
fn a_gap_has_no_value_and_missing_values_do_not_turn() {
    let time_s: Vec<f64> = (0..100).chain(200..300).map(|row| f64::from(row) * 0.01).collect();
    let mut rate = vec![1.0; 200];
    rate[50] = f64::NAN;
    let track = Track::integral(&time_s, &rate);
    assert!((track.at(0.99).unwrap() - 0.99).abs() < 1e-9, "{:?}", track.at(0.99));
    assert_eq!(track.at(1.5), None);
    assert!((track.at(2.5).unwrap() - 1.49).abs() < 1e-9, "{:?}", track.at(2.5));
}
