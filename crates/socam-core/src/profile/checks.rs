//! Checks of a profile's times and frequencies, and of what a board allows.

use super::error::{ProfileError, ProfileKey};
use super::shape::{Command, Profile};
use crate::ceilings::Ceilings;

impl Profile {
    /// Whether a board with these ceilings can run this.
    pub(crate) fn check_below(&self, ceilings: &Ceilings) -> Result<(), ProfileError> {
        if self.duration_us.saturating_add(self.ramp_us.into()) > ceilings.run_us {
            return Err(ProfileError::DurationCeiling { ceiling_us: ceilings.run_us });
        }
        if self.command != Command::Voltage && self.limit_micro > ceilings.speed_urad_s {
            return Err(ProfileError::SpeedCeiling { ceiling_urad_s: ceilings.speed_urad_s });
        }
        Ok(())
    }
}

/// `time_us` as a whole number of samples, at least `at_least`.
pub(super) fn whole_samples(
    key: ProfileKey,
    time_us: u32,
    sample_period_us: u32,
    at_least: u32,
) -> Result<u32, ProfileError> {
    let error = ProfileError::NotWholeSamples { key, time_us, sample_period_us, at_least };
    let samples = time_us.checked_div(sample_period_us).ok_or(error)?;
    let is_whole = samples.wrapping_mul(sample_period_us) == time_us;
    if is_whole && samples >= at_least { Ok(samples) } else { Err(error) }
}

/// Whether a sine of this frequency can be sampled at this period.
pub(super) fn check_frequency(frequency_uhz: u64, sample_period_us: u32) -> Result<(), ProfileError> {
    let half_turns_e12 = frequency_uhz.saturating_mul(u64::from(sample_period_us)).saturating_mul(2);
    if frequency_uhz > 0 && half_turns_e12 < 1_000_000_000_000 {
        Ok(())
    } else {
        Err(ProfileError::Frequency { frequency_uhz })
    }
}
