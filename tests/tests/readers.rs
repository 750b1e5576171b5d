//! A recording and a recovered one open, checksums verified and every value equal, in readers that others wrote.
//!
//! `tests/run --set-up` puts the Python and JavaScript readers into `target/readers`. `SOCAM_PYTHON` names another Python that has
//! the packages of `readers/requirements.txt`, `SOCAM_NODE_MODULES` another folder with those of `readers/package.json`.
//! Rerun is large, so it is only asked when `SOCAM_RERUN_PYTHON` names a Python that has `rerun-sdk`.
//! What cannot run is skipped, and said on stderr.

use std::path::{Path, PathBuf};
use std::process::Command;

use socam_recording::{
    Attachment, Channel, Dataset, Event, Recorder, RecordingHeader, SampleRow, Status, Unit, export_csv,
    recover,
};
use socam_tests::readers::{node_modules, python, scripts};

const ROWS: u64 = 30_000;

/// A recording with missing values, lost samples, raw counts and attachments; and what it should read as.
fn recording(folder: &Path) -> (PathBuf, PathBuf) {
    let log = folder.join("run.mcap");
    let mut header = RecordingHeader::new(vec![
        Channel::new("command", Unit::V),
        Channel::new("motor_speed", Unit::RadPerS),
        Channel::new("torque_in", Unit::Nm),
    ]);
    header.start_unix_ns = 1_700_000_000_123_456_789;
    header.metadata.insert("note".into(), "conformance".into());
    header.attachments.push(Attachment {
        name: "model.toml".into(),
        media_type: "application/toml".into(),
        data: vec![b'#'; 5000],
    });
    let mut recorder = Recorder::create(&log, &header).expect("a recording");
    for index in (0..ROWS).filter(|index| *index != 777) {
        let t = index as f64 * 1e-4;
        let torque = if index % 7 == 0 { f64::NAN } else { (70.0 * t).cos() };
        recorder.push_samples(&[SampleRow {
            device_time_ns: index as i64 * 100_000,
            sequence: index,
            flags: u32::from(index % 3 == 0),
            raw_counts: &[index as i32, -(index as i32)],
            values: &[0.0, (11.0 * t).sin() * 1e-3, torque],
        }]);
        if index % 5000 == 0 {
            recorder.status(&Status {
                device_time_ns: index as i64 * 100_000,
                state: "running".into(),
                overruns: 0,
                lost: 0,
                link_errors: 0,
            });
            recorder.event(&Event {
                device_time_ns: index as i64 * 100_000 - 50_000,
                kind: "phase".into(),
                text: format!("step {index}"),
            });
            std::thread::sleep(std::time::Duration::from_millis(200));
        }
    }
    recorder.finish().expect("a finished recording");
    let (table, rows) = exported(&log);
    assert_eq!(rows, ROWS - 1);
    (log, table)
}

/// The first half of a recording, recovered, and what it should read as.
fn recovered(log: &Path) -> (PathBuf, PathBuf) {
    let (cut, clean) = (log.with_extension("cut.mcap"), log.with_extension("clean.mcap"));
    let whole = std::fs::read(log).expect("the log");
    std::fs::write(&cut, &whole[..whole.len() / 2]).expect("a cut log");
    recover(&cut, &clean).expect("a recovered log");
    let (table, rows) = exported(&clean);
    assert!((1000..ROWS - 1).contains(&rows), "{rows}");
    (clean, table)
}

/// A table of a log beside it, and its number of rows.
fn exported(log: &Path) -> (PathBuf, u64) {
    let table = log.with_extension("csv");
    let data = Dataset::open(log.to_str().expect("a plain path")).expect("it opens");
    export_csv(&data, &table).expect("a table");
    (table, data.rows())
}

/// Runs a reader's script on a finished and a recovered log; it fails when any value differs.
fn read_with(program: &Path, script: &str, working_directory: &Path) {
    let folder = tempfile::tempdir().expect("a folder");
    let finished = recording(folder.path());
    for (log, table) in [recovered(&finished.0), finished] {
        let output = Command::new(program)
            .arg(scripts().join(script))
            .args([&log, &table])
            .current_dir(working_directory)
            .output()
            .expect("the reader starts");
        assert!(
            output.status.success(),
            "{}: {}{}",
            log.display(),
            String::from_utf8_lossy(&output.stdout),
            String::from_utf8_lossy(&output.stderr)
        );
    }
}

#[test]
fn python_reads_every_value() {
    let Some(python) = python() else {
        eprintln!("skipped: no Python with the mcap packages (SOCAM_PYTHON names one)");
        return;
    };
    read_with(&python, "read_python.py", &scripts());
}

#[test]
fn javascript_reads_every_value() {
    let Some(folder) = node_modules() else {
        eprintln!("skipped: no Node with the mcap packages (SOCAM_NODE_MODULES names a folder)");
        return;
    };
    read_with(Path::new("node"), "read_node.mjs", &folder);
}

#[test]
fn rerun_loads_every_sample() {
    let Some(python) = std::env::var_os("SOCAM_RERUN_PYTHON") else {
        eprintln!("skipped: SOCAM_RERUN_PYTHON names no Python with rerun-sdk");
        return;
    };
    read_with(Path::new(&python), "read_rerun.py", &scripts());
}
