//! The board's states, and the checks of readings that lead to a fault.

use core::fmt;

use crate::config::{Channel, ChannelKind, Config, MAX_CHANNELS};
use crate::{Fault, fixed};

/// What the board is doing. The output is live in `Running` and `Stopping` and nowhere else.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum State {
    /// 0 V, drive disabled; may be configured.
    Idle,
    /// 0 V, drive disabled; all limits and the host are watched.
    Armed,
    /// The drive is enabled and follows the profile.
    Running,
    /// The drive is enabled and ramps to 0.
    Stopping,
    /// 0 V, drive disabled, until the fault is cleared.
    Fault,
}

impl State {
    /// Its number, the same in all versions.
    pub fn code(self) -> u8 {
        match self {
            Self::Idle => 0,
            Self::Armed => 1,
            Self::Running => 2,
            Self::Stopping => 3,
            Self::Fault => 4,
        }
    }

    /// The state with this code.
    pub fn from_code(code: u8) -> Option<Self> {
        [Self::Idle, Self::Armed, Self::Running, Self::Stopping, Self::Fault]
            .into_iter()
            .find(|state| state.code() == code)
    }

    /// Whether the drive is enabled.
    pub fn is_live(self) -> bool {
        matches!(self, Self::Running | Self::Stopping)
    }

    /// Whether limits and the host are watched.
    pub(crate) fn is_watched(self) -> bool {
        matches!(self, Self::Armed | Self::Running | Self::Stopping)
    }
}

impl fmt::Display for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Idle => "idle",
            Self::Armed => "armed",
            Self::Running => "running",
            Self::Stopping => "stopping",
            Self::Fault => "in fault",
        })
    }
}

/// This many different sensors do not read the same count by chance, ...
const DISAGREE_FROM_CHANNELS: usize = 4;

/// ... unless at rest: a hundredth of the converter's range.
const AT_REST_COUNT: u16 = 328;

/// Watches the channels against their limits, sample by sample.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Watch {
    channels: [ChannelWatch; MAX_CHANNELS],
}

/// Consecutive samples of one channel with each symptom.
#[derive(Debug, Clone, Copy, Default)]
struct ChannelWatch {
    last_count: i16,
    over_limit: u8,
    saturated: u8,
    repeated: u32,
    nothing: u32,
    /// The configured times, in samples.
    stuck_after: Option<u32>,
    missing_after: u32,
}

impl Watch {
    pub(crate) fn new(config: &Config) -> Self {
        let samples = |time_us: u32| {
            let samples = fixed::samples_in(u64::from(time_us), config.sample_period_us);
            u32::try_from(samples).unwrap_or(u32::MAX).max(1)
        };
        let channels = config.channels.map(|channel| ChannelWatch {
            stuck_after: channel.stuck_after_us.map(samples),
            missing_after: samples(config.missing_after_us),
            ..ChannelWatch::default()
        });
        Self { channels }
    }

    /// Checks one set of readings, taken while `output_uv` was commanded, and returns the first fault found. A converter that repeats
    /// itself and a reading at the rail are checked before the limits, because they are not measurements.
    pub(crate) fn check(
        &mut self,
        config: &Config,
        counts: &[i16; MAX_CHANNELS],
        output_uv: i32,
    ) -> Option<Fault> {
        let moves = output_uv.unsigned_abs() >= config.moving_uv.unsigned_abs();
        let mut fault = repeated(counts.get(..usize::from(config.channel_count)).unwrap_or(counts));
        for (((index, watch), channel), &count) in
            (0u8..).zip(&mut self.channels).zip(config.used_channels()).zip(counts)
        {
            let found = watch
                .saturation(config, channel, index, count)
                .or_else(|| watch.limit(config, channel, index, count))
                .or_else(|| watch.stuck(config, index, count, moves))
                .or_else(|| watch.missing(channel, index, count, moves.then_some(output_uv)));
            watch.last_count = count;
            fault = fault.or(found);
        }
        fault
    }
}

/// A fault if every channel reads the same count.
fn repeated(counts: &[i16]) -> Option<Fault> {
    let &count = counts.first()?;
    let is_one = counts.len() >= DISAGREE_FROM_CHANNELS && counts.iter().all(|other| *other == count);
    (is_one && count.unsigned_abs() >= AT_REST_COUNT).then_some(Fault::ConverterStuck { count })
}

impl ChannelWatch {
    fn saturation(&mut self, config: &Config, channel: &Channel, index: u8, count: i16) -> Option<Fault> {
        let rail = channel.saturation_count?;
        let at_rail = count.unsigned_abs() >= rail.unsigned_abs();
        self.saturated = if at_rail { self.saturated.saturating_add(1) } else { 0 };
        (self.saturated >= config.confirm_samples).then_some(Fault::SensorSaturated { channel: index, count })
    }

    fn limit(&mut self, config: &Config, channel: &Channel, index: u8, count: i16) -> Option<Fault> {
        let limit_micro = channel.limit_micro?;
        let value_micro = channel.scale.value_micro(count);
        let over = value_micro.unsigned_abs() > limit_micro.unsigned_abs();
        self.over_limit = if over { self.over_limit.saturating_add(1) } else { 0 };
        (self.over_limit >= config.confirm_samples).then_some(match channel.kind {
            ChannelKind::Speed => Fault::OverSpeed { channel: index, value_micro, limit_micro },
            ChannelKind::Torque => Fault::OverTorque { channel: index, value_micro, limit_micro },
            ChannelKind::Other => Fault::OverLimit { channel: index, value_micro, limit_micro },
        })
    }

    fn stuck(&mut self, config: &Config, index: u8, count: i16, moves: bool) -> Option<Fault> {
        let stuck_after = self.stuck_after?;
        self.repeated = if moves && count == self.last_count { self.repeated.saturating_add(1) } else { 0 };
        let for_us = self.repeated.saturating_mul(config.sample_period_us);
        (self.repeated >= stuck_after).then_some(Fault::SensorStuck { channel: index, count, for_us })
    }

    fn missing(
        &mut self,
        channel: &Channel,
        index: u8,
        count: i16,
        moved_by_uv: Option<i32>,
    ) -> Option<Fault> {
        let below_micro = channel.missing_below_micro?;
        let value_micro = channel.scale.value_micro(count);
        let nothing = value_micro.unsigned_abs() <= below_micro.unsigned_abs();
        let Some(output_uv) = moved_by_uv.filter(|_| nothing) else {
            self.nothing = 0;
            return None;
        };
        self.nothing = self.nothing.saturating_add(1);
        (self.nothing >= self.missing_after).then_some(Fault::SensorMissing {
            channel: index,
            value_micro,
            output_uv,
        })
    }
}
