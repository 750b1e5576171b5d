//! All end-to-end tests as one program: it is linked once, and its tests share the processors.

mod aalto;
mod bad_input;
mod board;
mod board_link;
mod board_memory;
mod board_safety;
mod browser;
mod catalogue;
mod challenge;
mod compare;
mod core_on_board;
mod diagnose;
mod diagnose_published;
mod diagnose_robust;
mod diagnose_steady;
mod export_model;
mod firmware_image;
#[cfg(unix)]
mod fleet;
mod frequency;
mod identify;
mod import;
#[cfg(unix)]
mod interrupt;
mod lab_jobs;
mod readers;
mod record;
mod watch;

/// A file that is not named above would never run.
#[test]
fn every_file_of_tests_is_part_of_this_program() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests");
    for entry in folder.read_dir().unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_stem().unwrap().to_str().unwrap();
        assert!(name == "main" || include_str!("main.rs").contains(&format!("mod {name};")), "{name}");
    }
}
