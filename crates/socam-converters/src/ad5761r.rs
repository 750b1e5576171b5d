//! Analog Devices AD5761R: one 16-bit output, +-10 V, with its own reference. (Data sheet Rev. C.)
//!
//! SPI mode 1. Frames are 24 bits: `XXX0`, a 4-bit register address, 16 bits of data. The answer to a read command is in the
//! next frame. After power-on, and while its RESET pin is low, the output is clamped to ground; writing the control register
//! ends that.

use embedded_hal::spi::SpiDevice;

use crate::{Error, offset_binary};

const WRITE_AND_UPDATE: u8 = 0x3;
const WRITE_CONTROL: u8 = 0x4;
const READ_DAC: u8 = 0xb;
const READ_CONTROL: u8 = 0xc;
const FULL_RESET: u8 = 0xf;
const NOTHING: u8 = 0x0;

/// Clear voltage and power-up voltage: midscale (0 V). Thermal shutdown and internal reference: on. Range: +-10 V, offset binary.
const CONTROL: u16 = 1 << 9 | 1 << 6 | 1 << 5 | 1 << 3;
/// Bits of the control register that are compared; above are the short-circuit and brown-out flags.
const CONTROL_BITS: u16 = 0x07ff;

/// The output.
#[derive(Debug)]
pub struct Ad5761r<S> {
    spi: S,
}

impl<S: SpiDevice> Ad5761r<S> {
    /// Voltage at 2^15 counts, in microvolt.
    pub const FULL_SCALE_UV: u32 = 10_000_000;

    /// An output that is not configured yet.
    pub fn new(spi: S) -> Self {
        Self { spi }
    }

    /// Configures the output, from any state, to be live at 0 V; reads the control register back.
    ///
    /// # Errors
    /// When a register does not hold the written value. The call may be repeated.
    pub fn configure(&mut self) -> Result<(), Error<S::Error>> {
        self.frame(FULL_RESET, 0)?;
        self.frame(WRITE_CONTROL, CONTROL)?;
        if self.read(READ_CONTROL)? & CONTROL_BITS != CONTROL {
            return Err(Error::NoAnswer);
        }
        self.write(0)
    }

    /// Sets the output, in counts around 0 V, and reads it back.
    ///
    /// # Errors
    /// When the output register does not hold the written value.
    pub fn write(&mut self, count: i16) -> Result<(), Error<S::Error>> {
        let code = offset_binary(count);
        self.frame(WRITE_AND_UPDATE, code)?;
        if self.read(READ_DAC)? == code { Ok(()) } else { Err(Error::NoAnswer) }
    }

    fn read(&mut self, register: u8) -> Result<u16, Error<S::Error>> {
        self.frame(register, 0)?;
        let [address, high, low] = self.frame(NOTHING, 0)?;
        if address & 0x1f == register { Ok(u16::from_be_bytes([high, low])) } else { Err(Error::NoAnswer) }
    }

    fn frame(&mut self, address: u8, data: u16) -> Result<[u8; 3], Error<S::Error>> {
        let [high, low] = data.to_be_bytes();
        let mut frame = [address, high, low];
        self.spi.transfer_in_place(&mut frame)?;
        Ok(frame)
    }
}
