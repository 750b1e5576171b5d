//! The core's exercises on the board's processor (Cortex-M0+, floating point in software) and on this machine: the same bits.

use socam_tests::{emulator, firmware};

#[path = "../../firmware/examples/core_on_board/exercises.rs"]
mod exercises;

#[test]
fn the_core_computes_the_same_on_the_board_and_here() {
    let Some(said) = firmware::core_on_board().and_then(|program| emulator::say(&program)) else { return };
    let mut here = String::new();
    exercises::run(|name, digest| here += &format!("{name}: {digest:016x}\n"));
    println!("{here}");
    assert_eq!(said, here);
}
