//! How many channels a sample has, and which of them are wide.

/// Most converter channels that a board can sample.
pub const MAX_CHANNELS: usize = 8;

/// Number of the first channels that may be wide (32 bits): room for more would cost every board memory.
pub const WIDE_CHANNELS: usize = 4;

/// Number and widths of a sample's channels: 16 bits for a converter's count, 32 for an encoder's.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Layout {
    channels: u8,
    /// Bit n: channel n is wide.
    wide: u8,
}

impl Layout {
    /// The layout of these channels, at least one and at most [`MAX_CHANNELS`]; true for a wide one.
    pub fn of(channels: impl Iterator<Item = bool>) -> Self {
        let (mut count, mut wide) = (0u8, 0u8);
        for (index, is_wide) in (0u32..).zip(channels.take(MAX_CHANNELS)) {
            count = count.saturating_add(1);
            wide |= u8::from(is_wide).wrapping_shl(index);
        }
        Self { channels: count.max(1), wide }
    }

    /// A number of narrow channels.
    pub fn narrow(channels: u8) -> Self {
        Self { channels: channels.clamp(1, MAX_CHANNELS as u8), wide: 0 }
    }

    /// The layout of this number of channels and these bits, if a board can have it.
    pub fn from_bits(channels: u8, wide: u8) -> Option<Self> {
        let is_within = (1..=MAX_CHANNELS).contains(&usize::from(channels));
        let beyond = wide.checked_shr(channels.into()).unwrap_or(0);
        (is_within && beyond == 0).then_some(Self { channels, wide })
    }

    /// Number of channels.
    pub fn channels(self) -> u8 {
        self.channels
    }

    /// Bit n: channel n is wide.
    pub fn wide_bits(self) -> u8 {
        self.wide
    }

    /// Whether a channel is wide.
    pub fn is_wide(self, channel: usize) -> bool {
        u32::try_from(channel).ok().and_then(|channel| self.wide.checked_shr(channel)).unwrap_or(0) & 1 != 0
    }

    /// Bytes of a sample's counts.
    pub fn bytes(self) -> usize {
        2usize.saturating_mul(usize::from(self.channels).saturating_add(self.wide.count_ones() as usize))
    }
}
