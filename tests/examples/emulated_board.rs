//! The firmware's image on an emulated board at a simulated bench, until Ctrl-C: prints what to tell `socam-host record --device`.

use socam_tests::emulator::{Emulator, FILTERS, bench};

fn main() {
    let Some(board) = Emulator::start(bench(&FILTERS, 1)) else {
        std::process::exit(1);
    };
    println!("{}", board.device);
    loop {
        std::thread::park();
    }
}
