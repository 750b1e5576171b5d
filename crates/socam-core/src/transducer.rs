//! A torque transducer whose converter is slower than sampling: which samples hold one of its conversions, and what is wrong with it.
//!
//! A sample without a conversion is marked ([`NO_CONVERSION`]). A conversion is never repeated, so that nobody takes one for several.

use crate::config::{Channel, Config};
use crate::{Fault, fixed};

/// Count of a sample in which no conversion came.
pub const NO_CONVERSION: i32 = i32::MIN;

/// Largest and smallest code of 24 bits: the converter is at the end of its range.
pub const RAILS: [i32; 2] = [0x7f_ffff, -0x80_0000];

/// Longest time without a conversion: the slowest rate, 10 per second, comes three times in it.
const SILENT_AFTER_US: u32 = 350_000;

/// Equal conversions in a row that are a stuck converter. Its noise (HX711: 40 codes at 80 per second) repeats a code with a probability of
/// 0.01 at most, so that ten of them are no chance.
const STUCK_AFTER: u8 = 10;

/// Whether a count is a measurement: a conversion came, and it is within the converter's range.
pub fn is_measured(count: i32) -> bool {
    count != NO_CONVERSION && !RAILS.contains(&count)
}

/// Symptoms of a transducer.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct TransducerWatch {
    last: Option<i32>,
    /// Samples since the last conversion.
    waited: u32,
    /// Conversions in a row with each symptom.
    over_limit: u8,
    saturated: u8,
    repeated: u8,
    /// Samples since the code changed.
    same_for: u32,
}

impl TransducerWatch {
    /// Checks one sample; returns the fault found. Limits are compared with conversions, not with samples.
    // A call, so that the loop over the other channels stays as short as it is without a transducer.
    #[inline(never)]
    pub(crate) fn check(
        &mut self,
        config: &Config,
        channel: &Channel,
        index: u8,
        count: i32,
    ) -> Option<Fault> {
        let time_us = |samples: u32| samples.saturating_mul(config.sample_period_us);
        self.same_for = self.same_for.saturating_add(1);
        if count == NO_CONVERSION {
            self.waited = self.waited.saturating_add(1);
            let is_silent = self.waited >= fixed::whole_samples(SILENT_AFTER_US, config.sample_period_us);
            let for_us = time_us(self.waited);
            return is_silent.then_some(Fault::TransducerSilent { channel: index, for_us });
        }
        self.waited = 0;
        let lasts = |conversions: &mut u8, holds: bool| {
            *conversions = if holds { conversions.saturating_add(1) } else { 0 };
            *conversions
        };
        let is_repeated = self.last.replace(count) == Some(count);
        if !is_repeated {
            self.same_for = 0;
        }
        if lasts(&mut self.saturated, RAILS.contains(&count)) >= config.confirm_samples {
            return Some(Fault::SensorSaturated { channel: index, count });
        }
        let (value_micro, limit_micro) = (channel.scale.value_micro(count), channel.limit_micro);
        let is_over = limit_micro.is_some_and(|limit| value_micro.unsigned_abs() > limit.unsigned_abs());
        if lasts(&mut self.over_limit, is_over) >= config.confirm_samples {
            let limit_micro = limit_micro.unwrap_or_default();
            return Some(Fault::OverTorque { channel: index, value_micro, limit_micro });
        }
        let for_us = time_us(self.same_for);
        let is_long = channel.stuck_after_us.is_some_and(|after_us| for_us >= after_us);
        let is_stuck = lasts(&mut self.repeated, is_repeated) >= STUCK_AFTER && is_long;
        is_stuck.then_some(Fault::SensorStuck { channel: index, count, for_us })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ChannelKind, Scale};

    /// A transducer of 100 codes per N m with a limit of 3 N m, at 1 kHz.
    fn config() -> Config {
        let mut config = Config { channel_count: 1, confirm_samples: 2, ..Config::default() };
        config.channels[0] = Channel {
            kind: ChannelKind::Transducer,
            scale: Scale { micro_per_count_q16: 10_000 << 16, offset_micro: 0 },
            limit_micro: Some(3_000_000),
            stuck_after_us: Some(100_000),
            ..Channel::UNUSED
        };
        config
    }

    /// The number of the sample at which a fault is found, and the fault. A conversion comes with every twelfth sample.
    fn found(codes: impl Fn(usize) -> Option<i32>) -> Option<(usize, Fault)> {
        let (config, mut watch) = (config(), TransducerWatch::default());
        (0..2000).find_map(|sample| {
            let code = if sample % 12 == 0 { codes(sample / 12) } else { None };
            let fault = watch.check(&config, &config.channels[0], 5, code.unwrap_or(NO_CONVERSION));
            fault.map(|fault| (sample, fault))
        })
    }

    #[test]
    fn one_that_measures_is_well_and_each_failure_is_named() {
        // The noise of a code, and one that is far beyond the limit for a single conversion.
        let noisy = |k: usize| Some((k * 7 % 5) as i32 + if k == 20 { 5000 } else { 0 });
        assert_eq!(found(noisy), None);
        let silent = found(|k| if k < 10 { noisy(k) } else { None });
        assert_eq!(silent, Some((108 + 350, Fault::TransducerSilent { channel: 5, for_us: 350_000 })));
        let saturated = found(|k| if k < 10 { noisy(k) } else { Some(RAILS[1]) });
        assert_eq!(saturated, Some((132, Fault::SensorSaturated { channel: 5, count: RAILS[1] })));
        let (at, fault) = found(|k| if k < 10 { noisy(k) } else { Some(301) }).unwrap();
        // The second conversion, though the samples between have none.
        assert_eq!((at, fault.code()), (132, 5));
        let (at, fault) = found(|k| if k < 10 { noisy(k) } else { Some(77) }).unwrap();
        assert_eq!((at, fault.code()), (120 + 10 * 12, 8));
        assert!(!is_measured(NO_CONVERSION) && !is_measured(RAILS[0]) && is_measured(0));
    }
}
