//! A unit in FMPy: it validates, and simulates as socam does.

use std::{
    path::{Path, PathBuf},
    process::Command,
};

use socam_fmu::Unit;
use socam_identify::{Intersample, Predictor, Start};
use socam_model::Model;
use socam_sim::Plant;
use socam_tests::readers::python;

const STEP_S: f64 = 1e-3;
const ROWS: usize = 2000;

fn model() -> Model {
    Model::builtin("two-mass").expect("an embedded model")
}

/// Torques held over each step, N m.
fn torque() -> Vec<f64> {
    let wave = |t: f64| (31.0 * t).sin() + 0.5 * (83.0 * t * t).sin();
    (0..ROWS).map(|k| wave(k as f64 * STEP_S)).collect()
}

/// Outputs by the whole-recording predictor.
fn expected() -> Vec<Vec<f64>> {
    let model = model();
    let predictor = Predictor::new(&model, &model.values(), STEP_S).unwrap();
    let rest = vec![0.0; predictor.states()];
    predictor.run(&[&torque()], &[Intersample::Hold], Start::State(&rest)).unwrap().outputs
}

/// Largest difference relative to the largest value.
fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let size = a.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    a.iter().zip(b).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs())) / size
}

#[test]
fn steps_equal_the_predictor_and_the_simulator() {
    let model = model();
    let mut unit = Unit::new(&model.text).unwrap();
    unit.start(0.0);
    let plant = Plant::new(&model, &model.values()).unwrap();
    let mut trajectory = plant.start().unwrap();
    let (mut stepped, mut simulated) = ([Vec::new(), Vec::new()], [Vec::new(), Vec::new()]);
    for (k, torque) in torque().into_iter().enumerate() {
        unit.set(1, torque).unwrap();
        let mut outputs = [0.0; 2];
        trajectory.outputs(&mut outputs);
        for (column, (own, other)) in unit.get(&[2, 3]).unwrap().into_iter().zip(outputs).enumerate() {
            stepped[column].push(own);
            simulated[column].push(other);
        }
        unit.step(STEP_S).unwrap();
        trajectory.hold((k + 1) as f64 * STEP_S, &[torque]).unwrap();
    }
    for (column, expected) in expected().iter().enumerate() {
        let (rounding, integration) =
            (difference(expected, &stepped[column]), difference(expected, &simulated[column]));
        println!("output {column}: predictor {rounding:.1e}, simulator {integration:.1e}");
        assert!(rounding < 1e-10 && integration < 1e-4, "{rounding} {integration}");
    }
}

#[test]
fn what_cannot_be_set_or_read_is_said() {
    let mut unit = Unit::new(&model().text).unwrap();
    unit.start(0.0);
    assert!(unit.set(2, 1.0).unwrap_err().contains("cannot be set"));
    assert!(unit.set(1, f64::NAN).unwrap_err().contains("cannot be set"));
    assert!(unit.set(0, 1.0).unwrap_err().contains("reference 0"));
    assert!(unit.get(&[999]).unwrap_err().contains("reference 999"));
    assert!(unit.step(-1.0).unwrap_err().contains("sample time"));
    assert!(Unit::new("x = 1").is_err());
}

/// `target/PROFILE` of this test.
fn folder() -> PathBuf {
    let test = std::env::current_exe().unwrap();
    test.ancestors().nth(2).unwrap().to_owned()
}

#[test]
fn fmpy_validates_and_simulates_to_rounding() {
    let Some(python) = python() else {
        socam_tests::skip("no Python with FMPy (SOCAM_PYTHON names one)");
        return;
    };
    // Cargo builds the shared library with the tests, beside them.
    let library = folder().join("deps").join(socam_fmu::LIBRARY);
    let work = tempfile::tempdir().unwrap();
    let unit = work.path().join("two-mass.fmu");
    std::fs::write(&unit, socam_fmu::unit_bytes(&model().text, &library).unwrap()).unwrap();
    let mut table = String::from("time,motor_torque\n");
    torque().iter().enumerate().for_each(|(k, u)| table.push_str(&format!("{},{u}\n", k as f64 * STEP_S)));
    std::fs::write(work.path().join("in.csv"), table).unwrap();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/simulate.py");
    let output = Command::new(python)
        .arg(script)
        .arg(&unit)
        .args(["in.csv", "out.csv"])
        .current_dir(work.path())
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{}{}",
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    );
    let found = std::fs::read_to_string(work.path().join("out.csv")).unwrap();
    let rows: Vec<Vec<f64>> = found
        .lines()
        .skip(1)
        .map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect())
        .collect();
    for (column, expected) in expected().iter().enumerate() {
        let own: Vec<f64> = rows.iter().map(|row| row[column + 1]).collect();
        let rounding = difference(expected, &own);
        println!("output {column}: {rounding:.1e} in FMPy");
        assert!(rounding < 1e-10, "{rounding}");
    }
}
