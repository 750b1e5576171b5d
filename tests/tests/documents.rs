//! Documents against what they describe: a table that says something else than the code fails, and the failure prints the right one.
//!
//! With `SOCAM_WRITE_DOCUMENTS` set, the tests write these tables instead.

mod commands;
mod crates;
mod demo;
mod formats;
mod links;
#[cfg(all(unix, feature = "full"))]
mod pictures;

use std::fs;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize().unwrap()
}

fn read(document: &str) -> String {
    fs::read_to_string(root().join(document)).unwrap()
}

/// The lines of `text` between `<!-- name -->` and the next `<!-- end -->`, of which a document has one pair.
fn block<'t>(document: &str, text: &'t str, name: &str) -> &'t str {
    let begin = format!("<!-- {name} -->\n");
    let block = text.split_once(&begin).and_then(|(_, rest)| rest.split_once("<!-- end -->"));
    block.unwrap_or_else(|| panic!("{document} has no lines `<!-- {name} -->` and `<!-- end -->`")).0
}

/// Holds that the block `name` of a document is what `right` makes of it.
fn assert_block(document: &str, name: &str, right: impl Fn(&str) -> String) {
    let text = read(document);
    let stands = block(document, &text, name);
    let right = right(stands);
    if stands == right {
        return;
    }
    if std::env::var_os("SOCAM_WRITE_DOCUMENTS").is_some() {
        let begin = format!("<!-- {name} -->\n");
        let (stands, right) = (format!("{begin}{stands}"), format!("{begin}{right}"));
        fs::write(root().join(document), text.replacen(&stands, &right, 1)).unwrap();
        return;
    }
    panic!(
        "{document} must hold this between `<!-- {name} -->` and `<!-- end -->` \
         (SOCAM_WRITE_DOCUMENTS=1 in the environment of this test writes it):\n{right}"
    );
}

/// The cells of a row of a table; `None` for any other line.
fn cells(line: &str) -> Option<Vec<&str>> {
    let row = line.strip_prefix("| ")?.strip_suffix(" |")?;
    Some(row.split(" | ").map(str::trim).collect())
}

/// Files below a folder, without what is built, installed or drawn by tests.
fn files(folder: &Path) -> Vec<PathBuf> {
    const LEFT_OUT: [&str; 5] = ["target", "node_modules", ".git", ".venv", "corpus"];
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if !path.is_dir() {
            found.push(path);
        } else if path.file_name().is_none_or(|name| LEFT_OUT.iter().all(|left_out| name != *left_out)) {
            found.extend(files(&path));
        }
    }
    found.sort();
    found
}

/// The path of a file of the project as documents write it.
fn name(path: &Path) -> String {
    path.strip_prefix(root()).unwrap().to_string_lossy().replace('\\', "/")
}
