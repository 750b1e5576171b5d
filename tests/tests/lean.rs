//! The lean command line names the feature that a missing command needs.

use socam_tests::run;

#[test]
fn a_command_that_is_not_built_names_its_feature() {
    for (command, feature) in [
        ("dashboard", "window"),
        ("fleet", "fleet"),
        ("export-model", "exchange"),
        ("challenge", "challenge"),
        ("thesis", "thesis"),
        ("mcp", "agents"),
    ] {
        let ran = run([command, "--json"]);
        assert!(ran.refusal(1).contains(&format!("feature `{feature}`")), "{ran:?}");
    }
    let ran = run(["--help"]).done();
    assert!(ran.contains("diagnose") && ran.contains("Not part of this build"), "{ran}");
}
