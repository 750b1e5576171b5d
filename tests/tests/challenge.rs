//! The challenge as a user would run it, on two benches: nothing hidden, and one effect. Rates over many benches are what
//! `socam-host challenge` prints; docs/diagnosis.md has them.

use std::path::Path;

use serde_json::Value;
use socam_tests::run;

fn file(folder: &Path, number: u64, what: &str) -> Value {
    let path = folder.join(format!("seed-1-case-{number:05}.{what}.json"));
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

#[test]
fn two_benches_are_sealed_diagnosed_scored_and_not_done_again() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let challenge =
        || run(["challenge", "--cases", "3..5", "--resume", folder.to_str().unwrap(), "--json"]).json();
    let document = challenge();
    assert_eq!((&document["schema"], &document["seed"]), (&"socam.challenge/1".into(), &1.into()));
    for kind in document["kinds"].as_array().unwrap() {
        let cases = u64::from(["clean", "single"].contains(&kind["kind"].as_str().unwrap()));
        assert_eq!((&kind["cases"], &kind["right"]["hits"]), (&cases.into(), &cases.into()), "{kind:#}");
        assert_eq!((&kind["failed"], &kind["wrong_name"]["hits"]), (&0.into(), &0.into()), "{kind:#}");
    }
    let cases = document["cases"].as_array().unwrap();
    for (case, number) in cases.iter().zip(3..) {
        assert_eq!(case["number"], number);
        assert_eq!(case["hidden"], file(folder, number, "sealed")["hidden"], "{case:#}");
        let findings = file(folder, number, "diagnosis")["findings"].take();
        let named = findings.as_array().unwrap().iter();
        let named: Vec<_> = named.map(|one| vec![one["effect"].clone(), one["location"].clone()]).collect();
        assert_eq!(case["named"], serde_json::json!(named), "{case:#}");
    }
    // Times of the processor would differ, were any of it done again.
    assert_eq!(challenge(), document);
}
