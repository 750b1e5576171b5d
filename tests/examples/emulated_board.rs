//! The firmware's image on an emulated board at a simulated bench, until Ctrl-C: prints what to tell `socam-host record --device`. With the
//! argument `gearmotor`: the gearmotor board's image. All further arguments are concealed in the bench, as after `socam-host record --hide`.

use socam_tests::emulator::{Emulator, FILTERS, bench, gearmotor};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let mut hidden: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let board = if hidden.first() == Some(&"gearmotor") {
        Emulator::start_gearmotor(gearmotor(&hidden[1..], 1))
    } else {
        hidden.extend(FILTERS);
        Emulator::start(bench(&hidden, 1))
    };
    let Some(board) = board else {
        std::process::exit(1);
    };
    println!("{}", board.device);
    loop {
        std::thread::park();
    }
}
