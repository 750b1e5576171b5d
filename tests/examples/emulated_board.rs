//! The firmware's image on an emulated board at a simulated bench, until Ctrl-C: prints what to tell `socam-host record --device`. With the
//! argument `gearmotor`: the gearmotor board's image.

use socam_tests::emulator::{Emulator, FILTERS, bench, gearmotor};

fn main() {
    let is_gearmotor = std::env::args().nth(1).is_some_and(|kind| kind == "gearmotor");
    let board = if is_gearmotor {
        Emulator::start_gearmotor(gearmotor(&[], 1))
    } else {
        Emulator::start(bench(&FILTERS, 1))
    };
    let Some(board) = board else {
        std::process::exit(1);
    };
    println!("{}", board.device);
    loop {
        std::thread::park();
    }
}
