//! Runs the core's exercises on the board's processor and writes the results to the first serial line. Not part of the
//! firmware: `tests/tests/core_on_board.rs` compares it with the host.
#![no_std]
#![no_main]

#[path = "../../src/divider.rs"]
mod divider;
mod exercises;

use core::fmt::Write;

use embassy_rp::pac;

/// UART 0, which an emulator listens to whatever its rate.
struct Serial;

impl Write for Serial {
    fn write_str(&mut self, text: &str) -> core::fmt::Result {
        text.bytes().for_each(|byte| pac::UART0.uartdr().write(|word| word.set_data(byte)));
        Ok(())
    }
}

#[cortex_m_rt::entry]
fn main() -> ! {
    exercises::run(|name, digest| {
        let _ = writeln!(Serial, "{name}: {digest:016x}");
    });
    end()
}

#[panic_handler]
fn panic(info: &core::panic::PanicInfo<'_>) -> ! {
    let _ = writeln!(Serial, "{info}");
    end()
}

fn end() -> ! {
    cortex_m::asm::bkpt();
    loop {
        cortex_m::asm::nop();
    }
}
