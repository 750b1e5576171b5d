//! TI ADS8688: eight inputs on one 16-bit converter, +-10.24 V. (Data sheet SBAS582C.)
//!
//! SPI mode 1, up to 17 MHz. A frame carries a 16-bit command to the chip; from its 16th falling clock edge on the chip sends the
//! conversion of the channel that the *previous* command selected, sampled when chip select fell. When configured, it sends channel,
//! device and range after the value (section 8.5.2.3.2, SDO format 3): 41 clocks in all, 48 as whole bytes.

use embedded_hal::spi::SpiDevice;

use crate::{Error, offset_binary};

const MAN_CH: u8 = 0xc0;
const RST: u8 = 0x85;
const FEATURE_SELECT: u8 = 0x03;
const CHANNEL_RANGE: u8 = 0x05;

/// Value, then channel, device and range.
const SDO_FORMAT: u8 = 0x03;
/// +-2.5 times the reference of 4.096 V.
const RANGE: u8 = 0x00;

/// Order in which the channels are converted. Alternated, all channels have the same mean instant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Order {
    /// Channels are converted from the first to the last.
    Forth,
    /// Channels are converted from the last to the first.
    Back,
}

/// The converter, of which the first channels are used.
#[derive(Debug)]
pub struct Ads8688<S> {
    spi: S,
    channels: u8,
    /// The channel that the next frame converts.
    selected: Option<u8>,
}

impl<S: SpiDevice> Ads8688<S> {
    /// Voltage at 2^15 counts, in microvolt.
    pub const FULL_SCALE_UV: u32 = 10_240_000;

    /// A converter of which the first `channels` (1 to 8) are used; it is not configured yet.
    pub fn new(spi: S, channels: u8) -> Self {
        Self { spi, channels: channels.clamp(1, 8), selected: None }
    }

    /// Sets output format and ranges, and reads every register back.
    ///
    /// # Errors
    /// When a register does not hold the written value. The call may be repeated.
    pub fn configure(&mut self) -> Result<(), Error<S::Error>> {
        self.selected = None;
        self.frame(RST, 0)?;
        self.set(FEATURE_SELECT, SDO_FORMAT)?;
        for channel in 0..self.channels {
            self.set(CHANNEL_RANGE.wrapping_add(channel), RANGE)?;
        }
        Ok(())
    }

    /// Converts the channels in use and puts their counts into the first entries of `counts`.
    ///
    /// # Errors
    /// When an answer does not carry the requested channel and its range.
    pub fn convert(&mut self, order: Order, counts: &mut [i16]) -> Result<(), Error<S::Error>> {
        let last = self.channels.wrapping_sub(1);
        let (from, to) = match order {
            Order::Forth => (0, last),
            Order::Back => (last, 0),
        };
        if self.selected != Some(from) {
            self.frame(select(from), 0)?;
        }
        // Unknown until all channels are converted.
        self.selected = None;
        for step in 0..self.channels {
            let (channel, next) = match order {
                Order::Forth => (step, step.wrapping_add(1).min(last)),
                Order::Back => (last.wrapping_sub(step), last.wrapping_sub(step).saturating_sub(1)),
            };
            let answer = self.frame(select(next), 0)?;
            let count = value(channel, answer).ok_or(Error::NoAnswer)?;
            if let Some(place) = counts.get_mut(usize::from(channel)) {
                *place = count;
            }
        }
        self.selected = Some(to);
        Ok(())
    }

    /// Writes a program register and reads it back (section 8.5.2.2).
    fn set(&mut self, register: u8, value: u8) -> Result<(), Error<S::Error>> {
        self.frame(register.wrapping_shl(1) | 1, value)?;
        let [_, _, read, ..] = self.frame(register.wrapping_shl(1), 0)?;
        if read == value { Ok(()) } else { Err(Error::NoAnswer) }
    }

    fn frame(&mut self, command: u8, data: u8) -> Result<[u8; 6], Error<S::Error>> {
        let mut frame = [command, data, 0, 0, 0, 0];
        self.spi.transfer_in_place(&mut frame)?;
        Ok(frame)
    }
}

/// The command that selects a channel.
fn select(channel: u8) -> u8 {
    MAN_CH | channel.wrapping_shl(2)
}

/// The conversion in an answer, if it is this channel's: four bits of channel, two of device (0), three of range.
fn value(channel: u8, [_, _, high, low, tail, end]: [u8; 6]) -> Option<i16> {
    let is_ours = tail == channel.wrapping_shl(4) | RANGE >> 1 && end & 0x80 == RANGE.wrapping_shl(7);
    is_ours.then(|| offset_binary(i16::from_be_bytes([high, low])) as i16)
}
