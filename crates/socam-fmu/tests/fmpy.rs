//! FMUs in FMPy, an importer that others wrote: no problem is found, and every output is that of socam's simulator, which integrates by
//! another method.
//!
//! `SOCAM_PYTHON` names a Python that has the packages of `tests/readers/requirements.txt` already.

use std::fmt::Write as _;
use std::process::Command;

use socam_model::Model;
use socam_recording::{Channel, Dataset};
use socam_sim::{Replay, Start, Truth};
use socam_tests::readers::{python, scripts};

const ROWS: usize = 2000;
const SAMPLE_S: f64 = 1e-3;

/// A force that changes at random every 20 ms.
fn force(largest: f64) -> Vec<f64> {
    let mut state = 7_u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (state >> 33) as f64 / f64::from(1_u32 << 30) - 1.0
    };
    (0..ROWS / 20).flat_map(|_| [largest * random(); 20]).collect()
}

/// The simulator's answer to a force, as a table: time, force, outputs.
fn simulated(model: &Model, (parameter, value): (&str, f64), force: &[f64]) -> String {
    let mut truth = Truth::new(model, &[], &[]).unwrap();
    truth.values[model.parameter(parameter).unwrap()] = value;
    let channels = model.inputs().map(|input| Channel::from_column_name(&input.column).unwrap()).collect();
    let time_s: Vec<f64> = (0..ROWS).map(|row| row as f64 * SAMPLE_S).collect();
    let recording = Dataset::from_columns("force", channels, time_s, vec![force.to_vec()]).unwrap();
    let replay = Replay { truth, disturbances: Vec::new(), start: Start::Rest };
    let replayed = replay.run(&recording).unwrap();
    let mut table = String::from("time");
    model.inputs().chain(model.outputs()).for_each(|channel| write!(table, ",{}", channel.name).unwrap());
    for row in 0..ROWS {
        write!(table, "\n{}", replayed.time_s[row]).unwrap();
        replayed.values.iter().for_each(|column| write!(table, ",{}", column[row]).unwrap());
    }
    table
}

fn assert_equal_in_fmpy(interface: &str, text: &str, changed: (&str, f64), force: &[f64]) {
    let Some(python) = python() else {
        eprintln!("skipped: no Python with FMPy (SOCAM_PYTHON names one)");
        return;
    };
    let model = Model::parse(text).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let (fmu, table) = (folder.path().join("model.fmu"), folder.path().join("table.csv"));
    std::fs::write(&fmu, socam_fmu::fmu(text).unwrap()).unwrap();
    std::fs::write(&table, simulated(&model, changed, force)).unwrap();
    let output = Command::new(python)
        .arg(scripts().join("simulate_fmu.py"))
        .args([&fmu, &table])
        .args([interface, "1", &format!("parameter.{}", changed.0), &changed.1.to_string()])
        .output()
        .unwrap();
    let said =
        [output.stdout, output.stderr].map(|text| String::from_utf8_lossy(&text).into_owned()).concat();
    assert!(output.status.success(), "{said}");
    println!("{said}");
}

/// The text of an embedded model whose first input is held between samples.
fn held(name: &str, input: &str) -> String {
    let table = format!("[channels.{input}]");
    let text = Model::builtin(name).unwrap().text.replace(&table, &format!("{table}\nbetween = \"hold\""));
    assert!(text.contains("hold"));
    text
}

#[test]
fn co_simulation_of_a_linear_model_is_equal() {
    let text = held("two-mass", "motor_torque");
    assert_equal_in_fmpy("CoSimulation", &text, ("stiffness", 200.0), &force(1.0));
}

#[test]
fn co_simulation_with_friction_is_equal() {
    let text = held("emps", "force");
    assert_equal_in_fmpy("CoSimulation", &text, ("coulomb", 30.0), &force(300.0));
}

/// The force is constant, because FMPy sets inputs at communication points and its integrator steps beyond them.
#[test]
fn model_exchange_with_friction_is_equal() {
    let text = held("emps", "force");
    assert_equal_in_fmpy("ModelExchange", &text, ("coulomb", 30.0), &[100.0; ROWS]);
}
