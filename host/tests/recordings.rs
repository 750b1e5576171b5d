//! The commands about recordings, as processes: exit codes, stdout for results only, no partial files.

use std::path::Path;
use std::process::{Command, Output};

fn socam(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_socam-host")).args(arguments).output().expect("it starts")
}

fn text(path: &Path) -> &str {
    path.to_str().expect("a plain path")
}

fn write_run(folder: &Path) -> String {
    let path = folder.join("run.csv");
    let mut content = String::from("t_s,motor_speed_rad_s,output_speed_rad_s,note\n");
    for i in 0..20_000 {
        let t = f64::from(i) / 1000.0;
        let speed = 100.0 + (7.0 * t).sin() + (19.0 * t).sin() + (40.0 * t).sin();
        content += &format!("{t},{speed},{},x\n", speed / 8.0);
    }
    std::fs::write(&path, content).expect("a file");
    text(&path).to_owned()
}

/// One sentence on stderr, nothing on stdout, this exit code.
fn refused(arguments: &[&str], code: i32, expected: &str) {
    let output = socam(arguments);
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {stderr}");
    assert!(output.stdout.is_empty(), "{arguments:?}");
    assert!(stderr.contains(expected), "{arguments:?}: {stderr}");
    let errors = stderr.lines().filter(|line| !line.starts_with("warning:"));
    assert_eq!(errors.count(), 1, "{arguments:?}: {stderr}");
}

#[test]
fn json_is_one_document_and_nothing_else() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = write_run(folder.path());
    for command in ["info", "check"] {
        let output = socam(&[command, "--json", &run, &format!("{run}@1..2")]);
        assert_eq!(output.status.code(), Some(0));
        let document: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
        assert_eq!(document["schema"], format!("socam.{command}/1"));
        assert_eq!(document["recordings"].as_array().map(Vec::len), Some(2));
    }
}

#[test]
fn a_recording_goes_to_mcap_and_back() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = write_run(folder.path());
    assert_eq!(socam(&["import", &run]).status.code(), Some(0));
    let log = folder.path().join("run.mcap");
    let back = folder.path().join("back.csv");
    assert_eq!(socam(&["export", text(&log), "-o", text(&back)]).status.code(), Some(0));
    let read = |path: &str| -> Vec<Vec<f64>> {
        let content = std::fs::read_to_string(path).expect("a table");
        let row = |line: &str| line.split(',').take(3).map(|cell| cell.parse().expect("a number")).collect();
        content.lines().skip(1).map(row).collect()
    };
    assert_eq!(read(&run), read(text(&back)));
    // A log that lost its end is exported as far as it goes, and the exit code says so.
    let bytes = std::fs::read(&log).expect("the log");
    std::fs::write(&log, &bytes[..bytes.len() / 2]).expect("a cut log");
    for command in ["info", "check"] {
        assert_eq!(socam(&[command, text(&log)]).status.code(), Some(3), "{command}");
    }
    assert!(String::from_utf8_lossy(&socam(&["info", text(&log)]).stdout).contains("cut off"));
}

/// A mass of 1 kg that a force swings at three frequencies.
fn swinging_row(t: f64) -> String {
    let sum = |of: fn(f64, f64) -> f64| [3.0, 11.0, 40.0].iter().map(|w| of(*w, w * t)).sum::<f64>();
    format!("{t},{},{}\n", sum(|_, angle| angle.sin()), sum(|w, angle| 0.05 - angle.sin() / (w * w)))
}

#[test]
fn every_command_says_by_its_exit_code_that_a_recording_is_cut_off() {
    let folder = tempfile::tempdir().expect("a folder");
    let table = folder.path().join("axis.csv");
    let rows: String = (0..3000).map(|i| swinging_row(f64::from(i) / 1000.0)).collect();
    std::fs::write(&table, format!("t_s,force_N,position_m\n{rows}")).expect("a file");
    assert_eq!(socam(&["import", text(&table)]).status.code(), Some(0));
    let (log, cut) = (table.with_extension("mcap"), folder.path().join("cut.mcap"));
    let bytes = std::fs::read(&log).expect("the log");
    std::fs::write(&cut, &bytes[..bytes.len() * 3 / 4]).expect("a cut log");
    let diagnose = ["--most", "1", "--holdout", text(&log)];
    for (command, more) in [
        (&["info"][..], &[][..]),
        (&["check", "--model", "emps"], &[]),
        (&["export", "--force"], &[]),
        (&["identify", "--model", "emps", "--starts", "1"], &[]),
        (&["identify", "--model", "emps", "--method", "frf"], &[]),
        (&["simulate", "--model", "emps", "--input"], &[]),
        (&["diagnose", "--model", "emps"], &diagnose),
    ] {
        let output = socam(&[command, &[text(&cut)], more].concat());
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(3), "{command:?}: {stderr}");
    }
}

/// A mass of 1 kg that a force swings.
fn axis_row(t: f64) -> String {
    format!("{t},{},{}\n", (6.0 * t).sin(), 0.2 - (6.0 * t).sin() / 36.0)
}

#[test]
fn bad_input_gets_one_sentence_and_leaves_no_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = write_run(folder.path());
    let empty = folder.path().join("empty.mcap");
    std::fs::write(&empty, "").expect("a file");
    refused(&["info", text(folder.path())], 1, "is a directory");
    refused(&["info", text(&empty)], 1, "is empty");
    refused(&["check", "absent.csv"], 1, "no such file");
    refused(&["info", &format!("{run}@3..1")], 2, "FROM must be before TO");
    refused(&["check", "--input", "nothing", &run], 1, "no channel `nothing`");
    refused(&["check", "--model", "emps", &run], 1, "none of the channels that the model emps reads");
    refused(&["check", "--model", "nothing", &run], 2, "embedded models are");
    refused(&["check", "--ratio-tolerance", "-1", &run], 2, "expected 0 to 100");
    refused(&["export", &run, "-o", &run], 2, "over itself");
    refused(&["export", &run, "-o", "x.mcap"], 2, "export writes .csv");
    refused(&["import", &run, "-o", &run], 2, "over itself");
    refused(&["import", &run, "--calibration", "absent.toml"], 1, "absent.toml");
    refused(&["simulate", "--input", &run, "-o", &run], 2, "over itself");
    let axis = folder.path().join("axis.csv");
    let rows: String = (0..4000).map(|i| axis_row(f64::from(i) / 1000.0)).collect();
    std::fs::write(&axis, format!("t_s,force_N,position_m\n{rows}")).expect("a file");
    let identify =
        ["identify", text(&axis), "--model", "emps", "--starts", "1", "--write-model", text(&axis)];
    refused(&identify, 2, "is a recording; name another file");
    if Path::new("/dev/zero").exists() {
        refused(&["info", "/dev/zero"], 1, "is a pipe or a device");
    }
    refused(&["export", &run], 2, "name the file to write with -o");
    refused(&["export", &run, "-o", "x.parquet"], 2, "not there yet");
    refused(&["import", &run, &run, "-o", "x.mcap"], 2, "for one output");
    if Path::new("/dev/full").exists() {
        refused(&["export", &run, "-o", "/dev/full"], 1, "disk is full");
        refused(&["import", &run, "-o", "/dev/full"], 1, "disk is full");
    }
    assert_eq!(std::fs::read_dir(folder.path()).expect("the folder").count(), 3);
}

#[test]
fn conversions_replace_nothing_unasked() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = write_run(folder.path());
    assert_eq!(socam(&["import", &run]).status.code(), Some(0));
    refused(&["import", &run], 1, "run.mcap` exists already; choose another name, or --force");
    assert_eq!(socam(&["import", "--force", &run]).status.code(), Some(0));
    let log = folder.path().join("run.mcap");
    refused(&["export", text(&log)], 1, "run.csv` exists already");
    assert_eq!(socam(&["export", "--force", text(&log)]).status.code(), Some(0));
}

#[test]
fn models_and_calibrations_replace_nothing_unasked() {
    let folder = tempfile::tempdir().expect("a folder");
    let [axis, model] = ["axis.csv", "model.toml"].map(|name| folder.path().join(name));
    // With friction: the model refuses a fit that is a trace below zero.
    let rows = (0..4000).map(|i| f64::from(i) / 1000.0).map(|t| {
        let (acceleration, speed) = ((6.0 * t).sin(), -(6.0 * t).cos() / 6.0);
        let force = acceleration + 0.6 * speed + 0.3 * speed.signum();
        format!("{t},{force},{}\n", 0.2 - acceleration / 36.0)
    });
    let rows: String = rows.collect();
    std::fs::write(&axis, format!("t_s,force_N,position_m\n{rows}")).expect("a file");
    std::fs::write(&model, "# edited by hand").expect("a file");
    let (axis, written) = (text(&axis), ["--write-model", text(&model)]);
    let identify =
        [&["identify", axis, "--model", "emps", "--method", "inverse-dynamics"], &written[..]].concat();
    refused(&identify, 1, "model.toml` exists already; choose another name, or --force to replace it");
    refused(&[&["diagnose", axis, "--model", "emps"], &written[..]].concat(), 1, "exists already");
    refused(&[&["calibrate", axis], &written[..]].concat(), 1, "exists already");
    refused(&["calibrate", axis, "-o", text(&model)], 1, "exists already");
    assert_eq!(std::fs::read_to_string(&model).expect("the file"), "# edited by hand");
    let forced = socam(&[&identify[..], &["--force"]].concat());
    assert_eq!(forced.status.code(), Some(0), "{}", String::from_utf8_lossy(&forced.stderr));
    assert!(std::fs::read_to_string(&model).expect("the model").contains("schema = "));
}

#[test]
fn a_legacy_log_becomes_si_by_its_calibration() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let log = "samprate=0.01\ndata=[\n6.9 1.93 0.5 -1 1.2\n6.9 1.93 0.5 -1 1.2\n];\n";
    std::fs::write(path("old.m"), log).expect("a log");
    let calibration = "schema = \"socam.calibration/1\"\n\
        [speed_control]\ntachometer = \"motor_speed\"\n\
        [[channel]]\nname = \"motor_speed\"\nunit = \"krpm\"\nvolts_per_unit = 6.9\n\
        [[channel]]\nname = \"output_speed\"\nunit = \"krpm\"\nvolts_per_unit = 19.3\n\
        [[channel]]\nname = \"torque_in\"\nunit = \"N mm\"\nvolts_per_unit = 0.001\noffset_V = 0.1\n";
    std::fs::write(path("bench.toml"), calibration).expect("a calibration");
    let (old, bench) = (path("old.m"), path("bench.toml"));
    let import = socam(&["import", text(&old), "--calibration", text(&bench)]);
    assert_eq!(import.status.code(), Some(0), "{}", String::from_utf8_lossy(&import.stderr));
    let table = socam(&["export", text(&path("old.mcap")), "-o", "-"]);
    let table = String::from_utf8(table.stdout).expect("text");
    let mut lines = table.lines();
    assert_eq!(lines.next(), Some("t_s,command_V,motor_speed_rad_s,output_speed_rad_s,torque_in_Nm"));
    let row: Vec<f64> =
        lines.next().expect("a row").split(',').map(|cell| cell.parse().expect("a number")).collect();
    let expected = [0.0, 1.2, 104.719_755, 10.471_975, 0.4];
    assert!(row.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-5), "{row:?}");
    let info = socam(&["info", text(&path("old.mcap"))]);
    assert!(String::from_utf8_lossy(&info.stdout).contains("attachment calibration.toml"));
    refused(&["import", "--calibration", text(&bench), &write_run(folder.path())], 1, "is in SI already");
}

#[test]
fn templates_are_files_that_commands_take() {
    let folder = tempfile::tempdir().expect("a folder");
    let template = |kind: &[&str], name: &str| {
        let output = socam(&[&["template"], kind].concat());
        assert_eq!(output.status.code(), Some(0));
        let path = folder.path().join(name);
        std::fs::write(&path, output.stdout).expect("a file");
        text(&path).to_owned()
    };
    let model = template(&["model"], "model.toml");
    let profile = template(&["profile", "steps"], "profile.toml");
    let calibration = template(&["calibration"], "calibration.toml");
    let run = folder.path().join("run.mcap");
    let files = ["--model", &model, "--profile", &profile, "--calibration", &calibration];
    let record = ["record", "--device", "sim", "--duration", "2s", "-o", text(&run)];
    let output = socam(&[&record[..], &files].concat());
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    refused(&["template", "calibration", "mine"], 2, "needs no name");
}

#[cfg(unix)]
#[test]
fn what_is_no_readable_file_is_refused_at_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = write_run(folder.path());
    let at = |name: &str| folder.path().join(name).to_str().expect("a plain path").to_owned();
    let (pipe, out) = (at("pipe.csv"), at("out.mcap"));
    assert!(Command::new("mkfifo").arg(&pipe).status().expect("mkfifo").success());
    let directory = at("");
    for (file, said) in
        [(pipe.as_str(), "pipe or a device"), ("/dev/zero", "pipe or a device"), (&directory, "directory")]
    {
        for arguments in [
            vec!["info", file],
            vec!["identify", file],
            vec!["check", "--model", file, &run],
            vec!["identify", "--model", file, &run],
            vec!["simulate", "--profile", file, "-o", &out],
            vec!["record", "--device", "sim", "--profile", "steps", "--calibration", file, "-o", &out],
            vec!["calibrate", file],
        ] {
            refused(&arguments, 1, said);
        }
    }
    let utf16: Vec<u8> = "t_s,a_1\n0,1\n".encode_utf16().flat_map(u16::to_le_bytes).collect();
    std::fs::write(at("utf16.csv"), [b"\xff\xfe", utf16.as_slice()].concat()).expect("a file");
    std::fs::write(at("utf16.toml"), [b"\xff\xfe", utf16.as_slice()].concat()).expect("a file");
    // A table may be in UTF-16; this one names a channel and holds a single row.
    assert_eq!(socam(&["info", &at("utf16.csv")]).status.code(), Some(0));
    refused(&["check", "--model", &at("utf16.toml"), &run], 1, "UTF-16");
    let header: String = (0..1_000_000).map(|column| format!(",c{column}_1")).collect();
    std::fs::write(at("wide.csv"), format!("t_s{header}\n")).expect("a file");
    let begin = std::time::Instant::now();
    refused(&["info", &at("wide.csv")], 1, "names 1000001 columns; at most 10000");
    assert!(begin.elapsed().as_secs() < 5, "it took {:?}", begin.elapsed());
}

#[test]
fn a_model_that_would_be_fitted_for_minutes_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let (run, model) = (write_run(folder.path()), folder.path().join("chain.toml"));
    let template = String::from_utf8(socam(&["template", "model"]).stdout).expect("text");
    let chain: String = (0..50)
        .map(|n| {
            let from = if n == 0 { "load".to_owned() } else { format!("n{}", n - 1) };
            format!(
                "[[nodes]]\nname = \"n{n}\"\ninertia = \"J4\"\n[[springs]]\nname = \"s{n}\"\nfrom = \"{from}\"\nto = \"n{n}\"\nstiffness = \"k4\"\n"
            )
        })
        .collect();
    std::fs::write(&model, format!("{template}\n{chain}")).expect("a model");
    refused(&["identify", &run, "--model", text(&model)], 1, "at most 40");
}

#[test]
fn noise_that_is_given_on_every_channel_is_no_panic() {
    let folder = tempfile::tempdir().expect("a folder");
    let [model, log] = ["model.toml", "run.mcap"].map(|name| folder.path().join(name));
    let template = String::from_utf8(socam(&["template", "model"]).stdout).expect("text");
    let noisy = template.replace("role = ", "noise_std = 0.01\nrole = ");
    assert!(noisy.matches("noise_std").count() >= 4);
    std::fs::write(&model, noisy).expect("a model");
    let simulated = ["simulate", "--profile", "multisine", "--duration", "3s", "-o", text(&log)];
    assert!(socam(&simulated).status.success());
    for command in ["identify", "diagnose"] {
        let output = socam(&[command, text(&log), "--model", text(&model)]);
        assert!(output.status.success(), "{command}: {}", String::from_utf8_lossy(&output.stderr));
    }
}
