//! `mcp`: the protocol's own client calls the tools, and lines of a stranger end in a sentence.

use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

use serde_json::{Value, json};
use socam_tests::readers::{python, scripts};
use socam_tests::{program, run, skip, socam_host};

/// A folder with a recording of the virtual bench that has 0.3 N m of friction, and one to hold out.
fn bench() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, seed) in [("a.mcap", "1"), ("b.mcap", "2")] {
        let path = folder.path().join(name).display().to_string();
        let hidden = "coulomb_friction@load_bearing:torque=0.3";
        let _ = run([
            "simulate",
            "--profile",
            "multisine",
            "--duration",
            "4s",
            "--seed",
            seed,
            "--hide",
            hidden,
            "-o",
            &path,
        ])
        .done();
    }
    folder
}

/// What the client of `readers/agent.py` got.
fn called(python: &Path, folder: &Path, calls: &Value, arguments: &[&str]) -> Value {
    let file = folder.join("calls.json");
    std::fs::write(&file, calls.to_string()).unwrap();
    let mut client = Command::new(python);
    client.arg(scripts().join("agent.py")).arg(program()).arg(folder).arg(&file).args(arguments);
    let output = client.output().unwrap();
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{errors}");
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {errors}"))
}

#[test]
fn an_agent_does_the_whole_job_and_writes_only_where_it_may() {
    let Some(python) = python() else { return skip("no Python with mcp (SOCAM_PYTHON names one)") };
    let folder = bench();
    let calls = json!([
        ["info", { "recordings": ["a.mcap"] }],
        ["model", { "model": "speed-o-cam" }],
        ["identify", { "recordings": ["a.mcap"], "model": "speed-o-cam" }],
        ["diagnose", { "recordings": ["a.mcap"], "holdout": ["b.mcap"], "model": "speed-o-cam", "most": 1 }],
        ["picture", { "files": ["a.mcap"], "view": "time", "size": "800x500" }],
        ["check", { "recordings": ["absent.mcap"] }],
        ["diagnose", { "recordings": ["a.mcap"], "write_model": "m.toml" }],
        ["report", { "recordings": ["a.mcap"], "report": "page" }],
    ]);
    let got = called(&python, folder.path(), &calls, &[]);
    assert_eq!(got["server"], "socam");
    assert!(
        got["tools"]["diagnose"].as_array().unwrap().contains(&json!("false_alarm_rate")),
        "{}",
        got["tools"]
    );
    assert_eq!(got["read_only"].as_array().unwrap().len(), got["tools"].as_object().unwrap().len());
    let answers = got["answers"].as_array().unwrap();
    let text = |call: usize| answers[call]["content"][0].as_str().unwrap();
    let document = |call: usize| serde_json::from_str::<Value>(text(call)).unwrap();
    for (call, is_error) in [false, false, false, false, false, true, true, true].into_iter().enumerate() {
        assert_eq!(answers[call]["error"], is_error, "{}: {}", calls[call], answers[call]);
    }
    assert!(text(1).contains("load_bearing"), "{}", text(1));
    assert_eq!(document(2)["schema"], "socam.identification/1");
    let diagnosis = document(3);
    assert_eq!(diagnosis["findings"][0]["effect"], "coulomb_friction", "{diagnosis}");
    assert_eq!(diagnosis["held_out"]["outcome"], "holds", "{diagnosis}");
    assert_eq!(answers[4]["content"][0], json!({ "image": "89504e470d0a1a0a", "type": "image/png" }));
    assert!(text(5).contains("absent.mcap"), "{}", text(5));
    assert!(text(6).contains("started with `--write DIR`"), "{}", text(6));
    assert!(text(7).contains("there is no tool `report`"), "{}", text(7));

    let calls = json!([
        ["identify", { "recordings": ["a.mcap"], "write_model": "fitted.toml" }],
        ["identify", { "recordings": ["a.mcap"], "write_model": "fitted.toml" }],
        ["identify", { "recordings": ["a.mcap"], "write_model": "../fitted.toml" }],
        ["simulate", { "profile": "steps", "duration_s": 2, "output": "steps.csv" }],
    ]);
    std::fs::create_dir(folder.path().join("results")).unwrap();
    let got = called(&python, folder.path(), &calls, &["--write", "results"]);
    let errors: Vec<bool> =
        got["answers"].as_array().unwrap().iter().map(|one| one["error"] == true).collect();
    assert_eq!(errors, [false, true, true, false], "{got}");
    assert!(
        folder.path().join("results/fitted.toml").exists()
            && folder.path().join("results/steps.csv").exists()
    );
    assert!(!folder.path().join("fitted.toml").exists());
}

#[test]
fn lines_that_are_no_protocol_end_in_a_sentence() {
    let mut server = socam_host()
        .arg("mcp")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    server.stdin.take().unwrap().write_all(b"hello\n{\"a\": [1, 2\n\xff\xfe\n").unwrap();
    let output = server.wait_with_output().unwrap();
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{errors}");
    assert!(errors.contains("Model Context Protocol") && errors.trim().lines().count() == 1, "{errors}");
    assert!(run(["mcp", "--write", "no/such/folder"]).refusal(2).contains("no such folder"));
}
