//! A direct-current motor against its own encoder: the voltage that the winding does not take is the motor's speed, whatever the
//! encoder says.

use crate::config::Config;
use crate::{Count, Fault, MAX_CHANNELS, fixed};

/// Consecutive samples of each contradiction.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct MotorCheck {
    after_samples: u32,
    low: u8,
    stalled: u32,
    silent: u32,
    reversed: u32,
}

/// What a motor does, in uV: the voltage at it, the part that its speed takes by the winding, and that by the encoder.
#[derive(Debug, Clone, Copy)]
struct Voltages {
    applied: u32,
    emf: i32,
    by_encoder: i32,
}

impl MotorCheck {
    pub(crate) fn new(config: &Config) -> Self {
        let after_us = config.motor.map_or(0, |motor| motor.after_us);
        Self { after_samples: fixed::whole_samples(after_us, config.sample_period_us), ..Self::default() }
    }

    /// Checks one set of readings; returns the fault found.
    pub(crate) fn check<C: Count>(&mut self, config: &Config, counts: &[C; MAX_CHANNELS]) -> Option<Fault> {
        let value_micro = |channel| config.value_micro(channel, counts);
        let motor = config.motor.as_ref()?;
        let supply_uv = value_micro(motor.supply);
        self.low = if supply_uv < motor.lowest_supply_uv { self.low.saturating_add(1) } else { 0 };
        if self.low >= config.confirm_samples {
            let lowest_uv = motor.lowest_supply_uv;
            return Some(Fault::SupplyLow { channel: motor.supply, supply_uv, lowest_uv });
        }
        let (current, speed) = (value_micro(motor.current), value_micro(motor.speed));
        let applied = value_micro(motor.voltage);
        let drop_uv = fixed::scale(current, motor.resistance_q16.into(), 16);
        let voltages = Voltages {
            applied: applied.unsigned_abs(),
            emf: applied.saturating_sub(drop_uv),
            by_encoder: fixed::scale(speed, motor.back_emf_q24.into(), 24),
        };
        self.contradiction(&voltages, config.moving_uv.unsigned_abs())?;
        let output_uv = applied;
        Some(if self.stalled >= self.after_samples {
            Fault::Stalled { channel: motor.current, current_ua: current, output_uv }
        } else {
            let expected =
                (i64::from(voltages.emf) << 24).checked_div(motor.back_emf_q24.into()).unwrap_or(0);
            let (channel, expected_micro) = (motor.speed, fixed::saturate(expected));
            if self.reversed >= self.after_samples {
                Fault::EncoderReversed { channel, value_micro: speed, expected_micro }
            } else {
                Fault::EncoderSilent { channel, value_micro: speed, expected_micro }
            }
        })
    }

    /// Counts contradictions; returns whether one has lasted too long.
    ///
    /// Margins are wide, so that a winding that is known to 25 % raises no false alarm: an encoder is silent where it shows less than a
    /// quarter of the speed, and a motor is stalled where its winding takes more than half of the voltage.
    fn contradiction(&mut self, voltages: &Voltages, moving_uv: u32) -> Option<()> {
        let Voltages { applied, emf, by_encoder } = *voltages;
        let (speed_uv, encoder_uv) = (emf.unsigned_abs(), by_encoder.unsigned_abs());
        let turns = speed_uv >= moving_uv / 2 && speed_uv >= applied / 2;
        let is_opposite = encoder_uv >= speed_uv / 4 && (emf < 0) != (by_encoder < 0);
        let after = self.after_samples;
        let lasts = |count: &mut u32, holds: bool| {
            *count = if holds { count.saturating_add(1) } else { 0 };
            *count >= after
        };
        let is_reversed = lasts(&mut self.reversed, speed_uv >= moving_uv / 2 && is_opposite);
        let is_silent = lasts(&mut self.silent, turns && encoder_uv < speed_uv / 4);
        let rests = applied >= moving_uv && encoder_uv < applied / 16;
        let is_stalled = lasts(&mut self.stalled, rests && speed_uv < applied / 2);
        (is_reversed || is_silent || is_stalled).then_some(())
    }
}
