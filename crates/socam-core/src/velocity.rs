//! The speed controller: feed-forward by the motor's calibration plus PI.

use crate::config::SpeedControl;
use crate::fixed;

/// Feed-forward plus PI with anti-windup: the integral stops while the output is at its clamp and the error would increase it, and it
/// never exceeds the clamp.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct SpeedLoop {
    /// Integral, uV in 1/2^16: fine enough for the smallest error.
    integral_uv_q16: i64,
    integral_per_sample_q32: i64,
}

impl SpeedLoop {
    pub(crate) fn new(control: &SpeedControl, sample_period_us: u32) -> Self {
        Self {
            integral_uv_q16: 0,
            integral_per_sample_q32: control.integral_per_sample_q32(sample_period_us),
        }
    }

    /// The voltage for this sample.
    pub(crate) fn step(
        &mut self,
        control: &SpeedControl,
        target_urad_s: i32,
        measured_urad_s: i32,
        clamp_uv: i32,
    ) -> i32 {
        let error = target_urad_s.saturating_sub(measured_urad_s);
        let proportional_uv = fixed::scale(error, control.proportional_q32, 32);
        let direct_uv = control.motor.voltage_uv(target_urad_s).saturating_add(proportional_uv);
        let voltage_uv = direct_uv.saturating_add(fixed::saturate(self.integral_uv_q16 >> 16));
        let winds_up =
            (voltage_uv >= clamp_uv && error > 0) || (voltage_uv <= clamp_uv.saturating_neg() && error < 0);
        if !winds_up {
            let increment_q16 = i64::from(error).wrapping_mul(self.integral_per_sample_q32) >> 16;
            let bound_q16 = i64::from(clamp_uv).wrapping_shl(16);
            self.integral_uv_q16 = self
                .integral_uv_q16
                .saturating_add(increment_q16)
                .max(bound_q16.saturating_neg())
                .min(bound_q16);
        }
        voltage_uv
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Config;
    use crate::scaling::MotorCalibration;

    #[test]
    fn open_loop_is_eq_2_1_both_ways() {
        let line = MotorCalibration::LOADED.line();
        for rpm in [-1300.0, -10.0, 0.0, 10.0, 600.0, 1300.0] {
            let speed = rpm * crate::scaling::RAD_S_PER_RPM;
            let exact = MotorCalibration::LOADED.volts(speed);
            let got = f64::from(line.voltage_uv((speed * 1e6) as i32)) * 1e-6;
            assert!((got - exact).abs() < 2e-6, "{rpm} rpm: {got} V instead of {exact} V");
        }
    }

    /// A first-order motor, 15 % slower than calibrated, 80 ms time constant.
    fn run(loops: &mut SpeedLoop, config: &Config, speed: &mut f64, target: f64, samples: usize) -> f64 {
        let mut highest = f64::MIN;
        for _ in 0..samples {
            let uv = loops.step(
                &config.speed,
                (target * 1e6) as i32,
                (*speed * 1e6) as i32,
                config.output.clamp_uv,
            );
            let volts = f64::from(uv.clamp(-config.output.clamp_uv, config.output.clamp_uv)) * 1e-6;
            let steady = 0.85 * MotorCalibration::LOADED.speed_rad_s(volts);
            *speed += (steady - *speed) * 0.001 / 0.08;
            highest = highest.max(*speed);
        }
        highest
    }

    #[test]
    fn closed_loop_removes_what_the_calibration_gets_wrong() {
        let config = Config::default();
        let mut loops = SpeedLoop::new(&config.speed, config.sample_period_us);
        let mut speed = 0.0;
        run(&mut loops, &config, &mut speed, 100.0, 3000);
        assert!((speed - 100.0).abs() < 0.01, "settled at {speed} rad/s");
    }

    #[test]
    fn a_target_out_of_reach_does_not_wind_up() {
        let config = Config::default();
        let mut loops = SpeedLoop::new(&config.speed, config.sample_period_us);
        let mut speed = 0.0;
        run(&mut loops, &config, &mut speed, 2000.0, 20_000);
        run(&mut loops, &config, &mut speed, 50.0, 1500);
        assert!((speed - 50.0).abs() < 1.0, "still at {speed} rad/s 1.5 s after the target came back");
    }
}
