//! The checks of readings that lead to a fault.

use crate::config::{Channel, ChannelKind, Config};
use crate::layout::MAX_CHANNELS;
use crate::transducer::TransducerWatch;
use crate::{Count, Fault, conversions_per_sample, fixed};

/// Number of sensors from which equal counts in all of them are a fault, not chance, ...
const DISAGREE_FROM_CHANNELS: usize = 4;

/// ... unless at rest: a hundredth of the converter's range.
const AT_REST_COUNT: u32 = 328;

/// Fewest equal codes in a row that are a stuck channel. Noise of standard deviation s repeats a code with a probability of at most
/// p = P(|x| < 1/2): where the signal rests in the middle of a code. The converter alone has s = 0.58 codes (ADS8688: 92 dB of
/// +-10.24 V), so p = 0.61 and p^100 = 4e-22: at 16,000 conversions a second one false alarm in 10^9 years. A channel with less than
/// 0.4 codes of noise, p = 0.79, would give one in 12 days; it cannot be told from a frozen one and needs a longer time or none.
const FEWEST_CODES: u32 = 100;

/// Fewest equal means in a row that are a stuck channel, for samples whose single conversions are not known. A mean over eight
/// conversions has 0.41 of their noise, 0.24 codes: p = 0.96 and p^1000 = 2e-17.
const FEWEST_MEANS: u32 = 1000;

/// Watches the channels against their limits, sample by sample.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Watch<C> {
    channels: [ChannelWatch<C>; MAX_CHANNELS],
    /// A board has one transducer at most.
    transducer: TransducerWatch,
}

/// Consecutive samples of one channel with each symptom.
#[derive(Debug, Clone, Copy, Default)]
struct ChannelWatch<C> {
    last_count: C,
    over_limit: u8,
    saturated: u8,
    repeated: u32,
    nothing: u32,
    stuck_after: Option<StuckAfter>,
    /// The configured time, in samples.
    missing_after: u32,
}

/// Number of equal readings in a row that are a stuck channel.
#[derive(Debug, Clone, Copy)]
struct StuckAfter {
    samples: u32,
    /// Single conversions, and the time of one.
    codes: u32,
    code_us: u32,
}

impl<C: Count> Watch<C> {
    pub(crate) fn new(config: &Config) -> Self {
        let samples = |time_us: u32| fixed::whole_samples(time_us, config.sample_period_us);
        let per_sample = conversions_per_sample(config.sample_period_us);
        let code_us = config.sample_period_us.checked_div(per_sample).unwrap_or(1).max(1);
        let channels = config.channels.map(|channel| ChannelWatch {
            stuck_after: channel.stuck_after_us.map(|time_us| StuckAfter {
                samples: samples(time_us).max(FEWEST_MEANS),
                codes: time_us.checked_div(code_us).unwrap_or(0).max(FEWEST_CODES),
                code_us,
            }),
            missing_after: samples(config.missing_after_us),
            ..ChannelWatch::default()
        });
        Self { channels, transducer: TransducerWatch::default() }
    }

    /// Checks one set of readings, taken while `output_uv` was commanded, and returns the first fault found. A converter that repeats
    /// itself and a reading at the rail are checked before the limits, because they are not measurements.
    pub(crate) fn check(
        &mut self,
        config: &Config,
        counts: &[C; MAX_CHANNELS],
        output_uv: i32,
        mut repeated_codes: impl FnMut(u8) -> Option<u32>,
    ) -> Option<Fault> {
        let moves = output_uv.unsigned_abs() >= config.moving_uv.unsigned_abs();
        let mut fault = repeated(counts.get(..usize::from(config.channel_count)).unwrap_or(counts));
        for (((index, watch), channel), &count) in
            (0u8..).zip(&mut self.channels).zip(config.used_channels()).zip(counts)
        {
            if C::MAY_BE_WIDE && channel.kind == ChannelKind::Transducer {
                fault = fault.or(self.transducer.check(config, channel, index, count.into()));
                continue;
            }
            let found = watch
                .saturation(config, channel, index, count)
                .or_else(|| watch.limit(config, channel, index, count))
                .or_else(|| watch.stuck(config, index, count, moves, repeated_codes(index)))
                .or_else(|| watch.missing(channel, index, count, moves.then_some(output_uv)));
            watch.last_count = count;
            fault = fault.or(found);
        }
        fault
    }
}

/// A fault if every channel reads the same count.
fn repeated<C: Count>(counts: &[C]) -> Option<Fault> {
    let &first = counts.first()?;
    let is_one = counts.len() >= DISAGREE_FROM_CHANNELS && counts.iter().all(|other| *other == first);
    let count: i32 = first.into();
    (is_one && count.unsigned_abs() >= AT_REST_COUNT).then_some(Fault::ConverterStuck { count })
}

impl<C: Count> ChannelWatch<C> {
    fn saturation(&mut self, config: &Config, channel: &Channel, index: u8, count: C) -> Option<Fault> {
        let rail = channel.saturation_count?;
        let count = count.into();
        let at_rail = count.unsigned_abs() >= rail.unsigned_abs().into();
        self.saturated = if at_rail { self.saturated.saturating_add(1) } else { 0 };
        (self.saturated >= config.confirm_samples).then_some(Fault::SensorSaturated { channel: index, count })
    }

    fn limit(&mut self, config: &Config, channel: &Channel, index: u8, count: C) -> Option<Fault> {
        let limit_micro = channel.limit_micro?;
        let value_micro = channel.scale.value_micro(count.into());
        let over = value_micro.unsigned_abs() > limit_micro.unsigned_abs();
        self.over_limit = if over { self.over_limit.saturating_add(1) } else { 0 };
        (self.over_limit >= config.confirm_samples).then_some(match channel.kind {
            ChannelKind::Speed | ChannelKind::EncoderSpeed => {
                Fault::OverSpeed { channel: index, value_micro, limit_micro }
            }
            ChannelKind::Torque | ChannelKind::Transducer => {
                Fault::OverTorque { channel: index, value_micro, limit_micro }
            }
            ChannelKind::Current => Fault::OverCurrent { channel: index, value_micro, limit_micro },
            ChannelKind::Other | ChannelKind::EncoderAngle => {
                Fault::OverLimit { channel: index, value_micro, limit_micro }
            }
        })
    }

    /// `codes`: number of single conversions that gave the code of the one before, where they are known.
    fn stuck(
        &mut self,
        config: &Config,
        index: u8,
        count: C,
        moves: bool,
        codes: Option<u32>,
    ) -> Option<Fault> {
        let stuck_after = self.stuck_after?;
        self.repeated = if moves && count == self.last_count { self.repeated.saturating_add(1) } else { 0 };
        let (repeated, enough, each_us) = match codes {
            Some(codes) => (if moves { codes } else { 0 }, stuck_after.codes, stuck_after.code_us),
            None => (self.repeated, stuck_after.samples, config.sample_period_us),
        };
        let for_us = repeated.saturating_mul(each_us);
        (repeated >= enough).then_some(Fault::SensorStuck { channel: index, count: count.into(), for_us })
    }

    fn missing(&mut self, channel: &Channel, index: u8, count: C, moved_by_uv: Option<i32>) -> Option<Fault> {
        let below_micro = channel.missing_below_micro?;
        let value_micro = channel.scale.value_micro(count.into());
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
