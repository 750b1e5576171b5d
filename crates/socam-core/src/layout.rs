//! How many channels a sample has, and which of them are wide.

/// Most converter channels that a board can sample.
pub const MAX_CHANNELS: usize = 8;

/// Number and widths of a sample's channels: 16 bits for a converter's count, 32 for an encoder's.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(into = "[u8; 2]", try_from = "[u8; 2]"))]
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

    /// Number of channels.
    pub fn channels(self) -> u8 {
        self.channels
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

impl From<Layout> for [u8; 2] {
    fn from(layout: Layout) -> Self {
        [layout.channels, layout.wide]
    }
}

/// The number of channels, and bits as above.
impl TryFrom<[u8; 2]> for Layout {
    type Error = &'static str;

    fn try_from([channels, wide]: [u8; 2]) -> Result<Self, Self::Error> {
        let is_within = (1..=MAX_CHANNELS).contains(&usize::from(channels));
        let beyond = wide.checked_shr(channels.into()).unwrap_or(0);
        if !is_within || beyond != 0 {
            return Err("a batch has 1 to 8 channels, and none of those that it lacks is wide");
        }
        Ok(Self { channels, wide })
    }
}
