//! The README's excerpt of the first command against what it prints.

use socam_tests::run;

use super::read;

#[test]
fn the_readme_shows_what_the_demo_prints() {
    let dir = tempfile::tempdir().unwrap();
    let folder = dir.path().join("demo");
    let printed = run(["demo", "--dir", folder.to_str().unwrap()]).done();
    let readme = read("README.md");
    let excerpt = readme.split_once("```text\n").and_then(|(_, rest)| rest.split_once("```")).unwrap().0;
    // How undetermined a parameter is depends on the machine's last digits.
    let firm = excerpt.lines().filter(|line| line.trim() != "..." && !line.contains("not determined"));
    let missing: Vec<&str> = firm.filter(|line| !printed.contains(line)).collect();
    assert!(excerpt.lines().count() > 6 && missing.is_empty(), "{missing:?} are not in\n{printed}");
}
