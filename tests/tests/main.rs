//! All end-to-end tests as one program: it is linked once, and its tests share the processors.
//!
//! What is marked `full` is left out of the fast tier of `tests/run`: it needs the window, formats of other programs, fleets, exports, Python,
//! a browser or the emulated board, or takes more than ten seconds. Of each command the fast tier runs what is quicker.

mod aalto;
mod bad_input;
#[cfg(feature = "full")]
mod board;
#[cfg(feature = "full")]
mod board_link;
#[cfg(feature = "full")]
mod board_memory;
#[cfg(feature = "full")]
mod board_safety;
#[cfg(feature = "full")]
mod browser;
#[cfg(all(unix, feature = "full"))]
mod can_drives;
mod catalogue;
#[cfg(feature = "full")]
mod challenge;
mod compare;
#[cfg(feature = "full")]
mod core_on_board;
mod diagnose;
#[cfg(feature = "full")]
mod diagnose_published;
#[cfg(feature = "full")]
mod diagnose_robust;
mod diagnose_steady;
mod documents;
#[cfg(unix)]
mod drives;
#[cfg(feature = "full")]
mod export_model;
#[cfg(feature = "full")]
mod firmware_image;
#[cfg(all(unix, feature = "full"))]
mod fleet;
#[cfg(feature = "full")]
mod foxglove;
mod frequency;
mod gearmotor;
#[cfg(feature = "full")]
mod gearmotor_board;
#[cfg(feature = "full")]
mod gearmotor_rates;
#[cfg(feature = "full")]
mod gearmotor_torque;
mod identify;
mod import;
#[cfg(feature = "full")]
mod import_model;
mod imports;
#[cfg(unix)]
mod interrupt;
mod lab_jobs;
#[cfg(not(feature = "full"))]
mod lean;
#[cfg(feature = "full")]
mod mcp;
#[cfg(feature = "full")]
mod readers;
mod record;
mod several;
#[cfg(all(unix, feature = "full"))]
mod soak;
#[cfg(unix)]
mod sources;
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
