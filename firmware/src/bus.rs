//! An SPI bus with one chip on it.

use core::convert::Infallible;

use embassy_rp::gpio::Output;
use embassy_rp::pac;
use embedded_hal::spi::{ErrorType, Operation, SpiDevice};

/// Size of the controller's buffer, bytes.
const FIFO: usize = 8;

/// A chip on its own bus. A transfer lasts exactly its clock edges; nothing waits for the chip.
pub(crate) struct Chip {
    controller: pac::spi::Spi,
    select: Output<'static>,
}

impl Chip {
    /// A chip on a controller whose pins and clock are configured.
    pub(crate) fn new(controller: pac::spi::Spi, select: Output<'static>) -> Self {
        Self { controller, select }
    }

    /// Sends `bytes` and replaces them by the received ones, in portions of the controller's buffer.
    fn transfer(&mut self, bytes: &mut [u8]) {
        for portion in bytes.chunks_mut(FIFO) {
            for &mut byte in &mut *portion {
                self.controller.dr().write(|word| word.set_data(u16::from(byte)));
            }
            for byte in portion {
                while !self.controller.sr().read().rne() {}
                *byte = self.controller.dr().read().data() as u8;
            }
        }
    }
}

impl ErrorType for Chip {
    type Error = Infallible;
}

impl SpiDevice for Chip {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), Infallible> {
        self.select.set_low();
        for operation in operations {
            match operation {
                Operation::TransferInPlace(bytes) => self.transfer(bytes),
                Operation::Read(bytes) => {
                    bytes.fill(0);
                    self.transfer(bytes);
                }
                Operation::Write(bytes) => bytes.iter().for_each(|&byte| self.transfer(&mut [byte])),
                Operation::Transfer(read, write) => {
                    for place in 0..read.len().max(write.len()) {
                        let mut byte = [write.get(place).copied().unwrap_or(0)];
                        self.transfer(&mut byte);
                        if let Some(read) = read.get_mut(place) {
                            [*read] = byte;
                        }
                    }
                }
                // The converters need no delay.
                Operation::DelayNs(_) => {}
            }
        }
        self.select.set_high();
        Ok(())
    }

    /// The drivers' only operation, without a list of operations.
    fn transfer_in_place(&mut self, bytes: &mut [u8]) -> Result<(), Infallible> {
        self.select.set_low();
        self.transfer(bytes);
        self.select.set_high();
        Ok(())
    }
}
