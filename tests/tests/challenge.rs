//! The challenge as a user would run it. Rates over many cases are what the command is for; here it is run on one.

use serde_json::Value;
use socam_tests::run;

/// An empty machine of a family that is quick to diagnose: the truth is sealed, the answer kept, and the report complete.
#[test]
fn a_case_is_drawn_diagnosed_and_scored() {
    let folder = tempfile::tempdir().unwrap();
    let kept = folder.path().to_str().unwrap();
    let command = ["challenge", "--cases", "6..7", "--resume", kept, "--json"];
    let document = run(command).json();
    assert_eq!(document["schema"], "socam.challenge/2");
    let case = &document["cases"][0];
    assert_eq!((&case["family"], &case["kind"]), (&Value::from("encoder-only"), &Value::from("clean")));
    assert_eq!(case["error"], Value::Null, "{case:#}");
    assert!(case["cpu_s"].as_f64().unwrap() > 0.0);
    assert_eq!((&document["clean"]["cases"], &document["realistic"]["cases"]), (&1.into(), &0.into()));
    assert_eq!(document["clean"]["false_alarms"]["beside_background"]["of"], 1);
    for file in ["sealed", "diagnosis", "score"] {
        assert!(folder.path().join(format!("seed-1-case-00006.{file}.json")).exists(), "{file}");
    }
    // Finished cases are not done again: the same digits, the processor time among them.
    assert_eq!(run(command).json(), document);
}
