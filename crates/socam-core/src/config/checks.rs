//! What a configuration must be, so that a board can run with it.

use super::{Channel, ChannelKind, Config, ConfigError, SpeedControl};
use crate::ceilings::Ceilings;
use crate::count::Count;
use crate::layout::MAX_CHANNELS;
use crate::ports::Ports;

impl Config {
    /// Whether a board can run with this.
    pub fn check(&self) -> Result<(), ConfigError> {
        if !(50..=1_000_000).contains(&self.sample_period_us) {
            return Err(ConfigError::SamplePeriod(self.sample_period_us));
        }
        if !(1..=MAX_CHANNELS).contains(&usize::from(self.channel_count)) {
            return Err(ConfigError::ChannelCount(self.channel_count));
        }
        for (i, channel) in (0u8..).zip(self.used_channels()) {
            if !channel.is_sound() {
                return Err(ConfigError::Channel(i));
            }
        }
        let output = &self.output;
        // Up to 2^30: a full scale of 131 mV at 16 bits.
        if output.clamp_uv <= 0
            || !(1..=1 << 30).contains(&output.counts_per_uv_q32)
            || output.count(output.clamp_uv) == i16::MAX
        {
            return Err(ConfigError::Output);
        }
        if !self.speed.is_sound(self.sample_period_us)
            || self.tachometer().is_none_or(|channel| !channel.kind.is_speed())
        {
            return Err(ConfigError::SpeedControl);
        }
        if !(10_000..=10_000_000).contains(&self.host_timeout_us) {
            return Err(ConfigError::HostTimeout(self.host_timeout_us));
        }
        if self.confirm_samples == 0 || self.moving_uv < 0 {
            return Err(ConfigError::Watch);
        }
        if self.motor.is_some_and(|motor| !motor.is_sound(self.channel_count)) {
            return Err(ConfigError::Motor);
        }
        if !self.used_channels().iter().any(Channel::is_watched) {
            return Err(ConfigError::NoLimits);
        }
        Ok(())
    }

    /// Whether a board with this hardware can run with this.
    pub(crate) fn check_for<P: Ports>(&self) -> Result<(), ConfigError> {
        self.check()?;
        if !P::Count::MAY_BE_WIDE
            && let Some((i, _)) =
                (0u8..).zip(self.used_channels()).find(|(_, channel)| channel.kind.is_wide())
        {
            return Err(ConfigError::NoEncoder(i));
        }
        let elsewhere = |(i, channel): &(u8, &Channel)| {
            channel.kind == ChannelKind::Transducer && Some(*i) != P::TRANSDUCER
        };
        if let Some((i, _)) = (0u8..).zip(self.used_channels()).find(elsewhere) {
            return Err(ConfigError::NoTransducer(i));
        }
        if self.motor.is_some() && !P::WATCHES_MOTOR {
            return Err(ConfigError::NoMotor);
        }
        let Ceilings { output_uv: ceiling_uv, .. } = P::CEILINGS;
        let (shortest_us, longest_us) = (P::CEILINGS.shortest_period_us, P::CEILINGS.longest_period_us);
        if !(shortest_us..=longest_us).contains(&self.sample_period_us) {
            return Err(ConfigError::PeriodCeiling { shortest_us, longest_us });
        }
        if self.output.clamp_uv > ceiling_uv {
            return Err(ConfigError::ClampCeiling { ceiling_uv });
        }
        Ok(())
    }
}

impl Channel {
    /// Whether any of its readings can end a run.
    fn is_watched(&self) -> bool {
        self.limit_micro.is_some()
            || self.saturation_count.is_some()
            || self.stuck_after_us.is_some()
            || self.missing_below_micro.is_some()
    }

    fn is_sound(&self) -> bool {
        let gain = self.scale.micro_per_count_q16.unsigned_abs();
        // Full scale, which a converter of fewer bits reaches in fewer counts, must stay inside i32: 2^31 micro, in 1/2^16.
        let full_scale_count = self.saturation_count.map_or(1 << 15, |rail| u64::from(rail.unsigned_abs()));
        let fits = if self.kind.is_wide() {
            // A value may saturate, the product with any count may not.
            gain <= 1 << 30
        } else {
            gain.checked_mul(full_scale_count).is_some_and(|full_scale| full_scale <= 1 << 47)
        };
        gain != 0
            && fits
            && self.limit_micro.is_none_or(|limit| limit > 0)
            && self.saturation_count.is_none_or(|count| count > 0)
            && self.missing_below_micro.is_none_or(|below| below >= 0)
    }
}

impl SpeedControl {
    /// The gains must keep a product with any speed inside i64; the integral one acts per sample.
    fn is_sound(&self, sample_period_us: u32) -> bool {
        [self.motor.uv_per_urad_s_q32, self.proportional_q32, self.integral_per_sample_q32(sample_period_us)]
            .into_iter()
            .all(|gain| (0..=1 << 31).contains(&gain))
    }
}
