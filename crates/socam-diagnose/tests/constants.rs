//! Compares the table of decisive constants in docs/diagnosis.md with the code.

use std::path::Path;

/// Largest number of decisive constants.
const MOST: usize = 13;

#[test]
fn the_table_of_constants_holds_what_the_code_has() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(root.join("../../docs/diagnosis.md")).unwrap();
    let table = text.split("## Constants").nth(1).unwrap().split("\n## ").next().unwrap();
    let rows: Vec<Vec<&str>> = table
        .lines()
        .filter(|line| line.starts_with("| ") && !line.starts_with("| constant"))
        .map(|line| line.trim_matches('|').split('|').map(str::trim).collect())
        .collect();
    for row in &rows {
        let Some((file, name)) = row[0].trim_matches('`').split_once("::") else { continue };
        let source = std::fs::read_to_string(root.join(format!("src/{file}.rs"))).unwrap();
        let declared = format!("const {name}: f64 = ");
        let value = source.split(&declared).nth(1).unwrap_or_else(|| panic!("{file}.rs has no {name}"));
        let value: f64 = value.split(';').next().unwrap().parse().unwrap();
        assert_eq!(value, row[1].parse::<f64>().unwrap(), "{file}::{name}");
    }
    println!("{} constants decide", rows.len());
    assert!(rows.len() <= MOST, "{} constants decide", rows.len());
}
