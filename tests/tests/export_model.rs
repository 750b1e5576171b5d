//! `export-model`: a model that a diagnosis corrected, in the simulators of others, on a recording that the diagnosis did not see.
//!
//! The bench has dry friction in a bearing and a compliant shaft of which its model knows nothing. MuJoCo and scipy are those of
//! `readers/requirements.txt`; Octave must be installed. What is missing is skipped.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

use socam_tests::readers::{python, scripts};
use socam_tests::{run, skip};
use tempfile::TempDir;

const BASE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/models/drive.toml");
const HIDDEN: [&str; 2] =
    ["coulomb_friction@load_bearing:torque=0.1", "missing_compliance@load_shaft:stiffness=20,damping=0.02"];

/// Columns of a table by their names.
type Columns = BTreeMap<String, Vec<f64>>;

/// The bench with its held-out recording, the corrected model, and what both models predict here.
struct Bench {
    folder: TempDir,
    measured: Columns,
    before: Columns,
    predicted: Columns,
}

impl Bench {
    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Exports the corrected model to a file.
    fn export(&self, target: &str, name: &str) -> PathBuf {
        let (model, file) = (self.path("corrected.toml"), self.path(name));
        let [model, path] = [&model, &file].map(|path| path.to_str().unwrap());
        let ran = run(["export-model", model, "--to", target, "-o", path, "--force"]);
        assert_eq!(ran.code, Some(0), "{}", ran.stderr);
        file
    }

    /// Compares what a simulator predicts with the recording and with the prediction here; asserts the relative differences.
    fn compare(&self, simulator: &str, elsewhere: &Path, most: f64) {
        let elsewhere = columns(elsewhere);
        assert_eq!(elsewhere.len(), 4, "{:?}", elsewhere.keys());
        for (column, values) in elsewhere.iter().filter(|(column, _)| *column != "t_s") {
            // Octave replays a part.
            let part = |all: &Columns| all[column][..values.len()].to_vec();
            let (measured, here) = (part(&self.measured), part(&self.predicted));
            let size = rms(&here, &vec![0.0; here.len()]);
            let (before, after) = (rms(&part(&self.before), &measured), rms(values, &measured));
            let difference = rms(values, &here) / size;
            println!(
                "measured: {simulator}, {column}: error rms {before:.4} before, {after:.4} after; relative difference to socam {difference:.1e}"
            );
            assert!(after < 0.2 * before, "{simulator} {column}: {before} before, {after} after");
            assert!(difference < most, "{simulator} {column}: {difference}");
        }
    }
}

fn bench() -> &'static Bench {
    static BENCH: OnceLock<Bench> = OnceLock::new();
    BENCH.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
        for (profile, seed) in [("prbs", "1"), ("multisine", "2")] {
            let file = path(&format!("{profile}.csv"));
            let mut arguments = vec!["simulate", "--profile", profile, "--model", BASE, "--duration", "3s"];
            arguments.extend(["--seed", seed, "-o", &file]);
            arguments.extend(HIDDEN.iter().flat_map(|hide| ["--hide", hide]));
            assert_eq!(run(&arguments).code, Some(0), "{profile}");
        }
        let (training, held_out, model) = (path("prbs.csv"), path("multisine.csv"), path("corrected.toml"));
        let diagnosis =
            ["diagnose", &training, "--model", BASE, "--write-model", &model, "--json"].map(str::to_owned);
        let found = run(&diagnosis).json();
        let effects: Vec<&str> = found["findings"]
            .as_array()
            .unwrap()
            .iter()
            .map(|finding| finding["effect"].as_str().unwrap())
            .collect();
        assert_eq!(effects, ["coulomb_friction", "missing_compliance"]);
        let predict = |model: &str, name: &str| {
            let file = path(name);
            let ran = run(["simulate", "--input", &held_out, "--model", model, "--from-rest", "-o", &file]);
            assert_eq!(ran.code, Some(0), "{}", ran.stderr);
            columns(Path::new(&file))
        };
        let (before, predicted) = (predict(BASE, "before.csv"), predict(&model, "here.csv"));
        Bench { measured: columns(Path::new(&held_out)), before, predicted, folder }
    })
}

fn columns(path: &Path) -> Columns {
    let text = std::fs::read_to_string(path).unwrap();
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let rows: Vec<Vec<f64>> =
        lines.map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect();
    let column = |index: usize| rows.iter().map(|row| row[index]).collect();
    names.iter().enumerate().map(|(index, name)| ((*name).to_owned(), column(index))).collect()
}

fn rms(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let squares: f64 = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum();
    (squares / a.len() as f64).sqrt()
}

/// Runs a program that must succeed.
fn succeed(command: &mut Command) -> String {
    let output = command.output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    assert!(output.status.success(), "{}{}", text(&output.stdout), text(&output.stderr));
    text(&output.stdout)
}

#[test]
fn python_moves_as_the_corrected_model_does() {
    let Some(python) = python() else { return skip("no Python with scipy (SOCAM_PYTHON names one)") };
    let bench = bench();
    let (file, predicted) = (bench.export("python", "corrected.py"), bench.path("python.csv"));
    succeed(Command::new(python).arg(scripts().join("replay.py")).args([
        &file,
        &bench.path("multisine.csv"),
        &predicted,
    ]));
    bench.compare("Python", &predicted, 1e-3);
}

#[test]
fn mujoco_moves_as_the_corrected_model_does() {
    let Some(python) = python() else { return skip("no Python with mujoco (SOCAM_PYTHON names one)") };
    let bench = bench();
    let (file, predicted) = (bench.export("mujoco", "corrected.xml"), bench.path("mujoco.csv"));
    succeed(Command::new(python).arg(scripts().join("replay.py")).args([
        &file,
        &bench.path("multisine.csv"),
        &predicted,
    ]));
    // Semi-implicit steps, and friction that sticks where socam's creeps.
    bench.compare("MuJoCo", &predicted, 2e-2);
}

#[test]
fn octave_moves_as_the_corrected_model_does() {
    let version = Command::new("octave-cli").arg("--version").output();
    if !version.is_ok_and(|output| output.status.success()) {
        return skip("Octave is not installed (octave-cli)");
    }
    let bench = bench();
    bench.export("matlab", "corrected.m");
    let predicted = bench.path("octave.csv");
    std::fs::copy(scripts().join("replay.m"), bench.path("replay.m")).unwrap();
    let call = "replay('corrected', 3, 'multisine.csv', 'rows.csv')";
    // Some builds of Octave complain when they end, with exit code 0.
    succeed(
        Command::new("octave-cli")
            .args(["--norc", "--quiet", "--eval", call])
            .current_dir(bench.folder.path()),
    );
    let rows = std::fs::read_to_string(bench.path("rows.csv")).unwrap();
    let header = "t_s,motor_speed_rad_s,load_speed_rad_s,coupling_torque_Nm\n";
    std::fs::write(&predicted, header.to_owned() + &rows).unwrap();
    bench.compare("Octave", &predicted, 2e-3);
}

#[test]
fn what_a_simulator_cannot_hold_is_named() {
    let bench = bench();
    let model = bench.path("corrected.toml");
    let ran = run(["export-model", model.to_str().unwrap(), "--to", "urdf", "-o", "-"]);
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    for text in [&ran.stdout, &ran.stderr] {
        assert!(text.contains("spring load_shaft: taken as rigid"), "{text}");
    }
    // Intervals and origin are in the file.
    let text = std::fs::read_to_string(bench.export("modelica", "corrected.mo")).unwrap();
    for words in ["95 % interval", "from corrected.toml (sha-256", "load_bearing_coulomb_friction_torque"] {
        assert!(text.contains(words), "{words}: {text}");
    }
}

#[test]
fn robots_load_in_readers_of_others() {
    let Some(python) = python() else { return skip("no Python with yourdfpy (SOCAM_PYTHON names one)") };
    let bench = bench();
    let (urdf, scene) = (bench.export("urdf", "robot.urdf"), bench.export("mujoco", "scene.xml"));
    let found = succeed(Command::new(python).arg(scripts().join("check_robots.py")).args([&urdf, &scene]));
    assert_eq!(found.trim(), "3 2 3", "joints, those that mimic, degrees of freedom");
}

/// `SOCAM_MSL` names the folder of the Modelica Standard Library, which the package needs to run; without it the package is parsed only.
#[test]
fn modelica_moves_as_the_corrected_model_does() {
    let Some(python) = python() else { return skip("no Python with rumoca (SOCAM_PYTHON names one)") };
    let bench = bench();
    let (package, here) = (bench.export("modelica", "bench.mo"), bench.export("python", "bench.py"));
    let library = std::env::var_os("SOCAM_MSL");
    let found = succeed(
        Command::new(python).arg(scripts().join("check_modelica.py")).args([&package, &here]).args(&library),
    );
    for line in found.lines() {
        println!("measured: Modelica, relative difference to Python: {line}");
    }
    if library.is_none() {
        skip("SOCAM_MSL names no Modelica Standard Library, so that the package was parsed and not run");
    }
}
