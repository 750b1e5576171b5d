//! Several samples in one frame, so that 10 kHz with six channels fit through a full-speed USB link.

use core::fmt;

use serde::{Deserialize, Deserializer, Serialize, Serializer, de};
use socam_core::{Count, Flags, Layout, MAX_CHANNELS, Sample};

/// Largest number of samples in a batch; fewer where channels are wide.
pub const BATCH_SAMPLES: usize = 32;

/// Output count (2), setpoint (4) and flags (1).
const FIXED_BYTES: usize = 7;
const MAX_BYTES: usize = BATCH_SAMPLES * (FIXED_BYTES + 2 * MAX_CHANNELS);

/// Consecutive samples of one segment of the profile; what they have in common is sent once.
#[derive(Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "Unchecked")]
pub struct SampleBatch {
    first_tick: u32,
    first_seq: u32,
    segment: u16,
    /// The count of a wide channel has four bytes, that of another one two.
    layout: Layout,
    data: Data,
}

/// The sample does not continue the batch, or the batch is full.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct DoesNotFollow;

impl SampleBatch {
    /// A batch of one sample with the counts of this layout; a narrow one saturates.
    pub fn new<C: Count>(first: &Sample<C>, layout: Layout) -> Self {
        let mut batch = Self {
            first_tick: first.tick,
            first_seq: first.seq,
            segment: first.segment,
            layout,
            data: Data::EMPTY,
        };
        batch.append(first);
        batch
    }

    /// Adds the next sample, if there is room and it follows without a gap.
    pub(crate) fn push<C: Count>(&mut self, sample: &Sample<C>) -> Result<(), DoesNotFollow> {
        let len = self.len();
        let follows = sample.seq == self.first_seq.wrapping_add(len as u32)
            && sample.tick == self.first_tick.wrapping_add(len as u32)
            && sample.segment == self.segment;
        let has_room = len < BATCH_SAMPLES && self.data.len + self.stride() <= MAX_BYTES;
        if !has_room || !follows {
            return Err(DoesNotFollow);
        }
        self.append(sample);
        Ok(())
    }

    /// Number of samples.
    #[expect(clippy::len_without_is_empty, reason = "a batch is never empty")]
    pub fn len(&self) -> usize {
        self.data.len / self.stride()
    }

    /// Number of channels of each sample.
    pub fn channels(&self) -> usize {
        usize::from(self.layout.channels())
    }

    /// The samples; counts past the batch's channels are 0.
    pub fn samples(&self) -> impl Iterator<Item = Sample> + '_ {
        self.data.as_slice().chunks_exact(self.stride()).zip(0u32..).map(|(bytes, i)| {
            let mut bytes = bytes.iter().copied();
            let mut counts = [0; MAX_CHANNELS];
            for (channel, count) in counts.iter_mut().take(self.channels()).enumerate() {
                *count = if self.layout.is_wide(channel) {
                    i32::from_le_bytes(take(&mut bytes))
                } else {
                    i16::from_le_bytes(take(&mut bytes)).into()
                };
            }
            Sample {
                tick: self.first_tick.wrapping_add(i),
                seq: self.first_seq.wrapping_add(i),
                counts,
                output_count: i16::from_le_bytes(take(&mut bytes)),
                setpoint_micro: i32::from_le_bytes(take(&mut bytes)),
                segment: self.segment,
                flags: Flags(u8::from_le_bytes(take(&mut bytes))),
            }
        })
    }

    fn stride(&self) -> usize {
        FIXED_BYTES + self.layout.bytes()
    }

    fn append<C: Count>(&mut self, sample: &Sample<C>) {
        for (channel, count) in sample.counts.iter().take(self.channels()).enumerate() {
            let count: i32 = (*count).into();
            if C::MAY_BE_WIDE && self.layout.is_wide(channel) {
                self.data.extend(count.to_le_bytes());
            } else {
                let count = count.clamp(i16::MIN.into(), i16::MAX.into()) as i16;
                self.data.extend(count.to_le_bytes());
            }
        }
        self.data.extend(sample.output_count.to_le_bytes());
        self.data.extend(sample.setpoint_micro.to_le_bytes());
        self.data.extend([sample.flags.0]);
    }
}

fn take<const N: usize>(bytes: &mut impl Iterator<Item = u8>) -> [u8; N] {
    core::array::from_fn(|_| bytes.next().unwrap_or(0))
}

impl fmt::Debug for SampleBatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.samples()).finish()
    }
}

/// A received batch whose lengths are not checked yet.
#[derive(Deserialize)]
struct Unchecked {
    first_tick: u32,
    first_seq: u32,
    segment: u16,
    layout: Layout,
    data: Data,
}

impl TryFrom<Unchecked> for SampleBatch {
    type Error = &'static str;

    fn try_from(batch: Unchecked) -> Result<Self, Self::Error> {
        let Unchecked { first_tick, first_seq, segment, layout, data } = batch;
        let batch = Self { first_tick, first_seq, segment, layout, data };
        let is_whole = data.len.is_multiple_of(batch.stride());
        if is_whole && (1..=BATCH_SAMPLES).contains(&batch.len()) {
            Ok(batch)
        } else {
            Err("a batch has 1 to 32 whole samples")
        }
    }
}

/// The samples' bytes.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Data {
    bytes: [u8; MAX_BYTES],
    len: usize,
}

impl Data {
    const EMPTY: Self = Self { bytes: [0; MAX_BYTES], len: 0 };

    fn as_slice(&self) -> &[u8] {
        self.bytes.get(..self.len).unwrap_or_default()
    }

    fn extend<const N: usize>(&mut self, bytes: [u8; N]) {
        for (to, from) in self.bytes.iter_mut().skip(self.len).zip(bytes) {
            *to = from;
            self.len += 1;
        }
    }
}

impl Serialize for Data {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_bytes(self.as_slice())
    }
}

impl<'de> Deserialize<'de> for Data {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Visitor;

        impl de::Visitor<'_> for Visitor {
            type Value = Data;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "at most {MAX_BYTES} bytes")
            }

            fn visit_bytes<E: de::Error>(self, bytes: &[u8]) -> Result<Data, E> {
                let mut data = Data::EMPTY;
                let room =
                    data.bytes.get_mut(..bytes.len()).ok_or_else(|| E::invalid_length(bytes.len(), &self))?;
                room.copy_from_slice(bytes);
                data.len = bytes.len();
                Ok(data)
            }
        }

        deserializer.deserialize_bytes(Visitor)
    }
}
