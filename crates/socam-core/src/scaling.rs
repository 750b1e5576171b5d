//! Conversions between counts, volts and SI, and the constants of the default bench.
//!
//! Only this module uses floating point; a board's tick works with integers such as [`Scale`].

use core::f64::consts::TAU;

use crate::fixed;

/// rad/s in one revolution per minute.
pub const RAD_S_PER_RPM: f64 = TAU / 60.0;

/// A bipolar converter (either way) of -`full_scale_v` to +`full_scale_v`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Converter {
    /// Resolution; counts run from -2^(bits-1) to 2^(bits-1) - 1.
    pub bits: u8,
    /// Voltage at 2^(bits-1) counts.
    pub full_scale_v: f64,
}

impl Converter {
    /// The default bench's converters: 16 bit, +-10 V. (The thesis' card had 12 bit at the same range.)
    pub const DEFAULT: Self = Self { bits: 16, full_scale_v: 10.0 };

    /// Voltage of one count.
    pub fn volts_per_count(&self) -> f64 {
        self.full_scale_v / f64::from(1u32 << self.bits.clamp(1, 16).saturating_sub(1))
    }

    /// The highest count.
    pub fn highest_count(&self) -> i16 {
        i16::MAX >> 16u8.saturating_sub(self.bits.clamp(2, 16))
    }

    /// The voltage of a count.
    pub fn volts(&self, count: i16) -> f64 {
        f64::from(count) * self.volts_per_count()
    }

    /// The count nearest to `volts`, saturated like the converter itself.
    pub fn count(&self, volts: f64) -> i16 {
        let highest = self.highest_count();
        (round(volts / self.volts_per_count()) as i16).clamp(!highest, highest)
    }
}

/// A sensor's voltage over its measured quantity: `volts = offset_v + volts_per_unit * value`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensor {
    /// Sensitivity, in volt per SI unit of the channel (rad/s, N m, V, A).
    pub volts_per_unit: f64,
    /// Voltage at the value 0.
    pub offset_v: f64,
}

impl Sensor {
    /// Input tachometer: 6.9 V/krpm (thesis, Table 2.7). It reaches 10 V at 1449 rpm.
    pub const MOTOR_SPEED: Self = Self { volts_per_unit: 6.9e-3 / RAD_S_PER_RPM, offset_v: 0.0 };
    /// Output tachometer: 19.3 V/krpm (thesis, Table 2.7).
    pub const OUTPUT_SPEED: Self = Self { volts_per_unit: 19.3e-3 / RAD_S_PER_RPM, offset_v: 0.0 };
    /// Input torque sensor: +-5 N m over +-10 V. **Not the thesis' figure**: its 2.45 mV/N m would put 2 N m into one count of
    /// its card, and 2.44 V/N m would leave the range at 4.1 N m. Chosen to hold the largest torques of the output side / 8.
    pub const TORQUE_IN: Self = Self { volts_per_unit: 2.0, offset_v: 0.0 };
    /// Output torque sensor: +-40 N m over +-10 V, eight times the thesis' largest mean torque of 4.9 N m. Chosen, as above.
    pub const TORQUE_OUT: Self = Self { volts_per_unit: 0.25, offset_v: 0.0 };

    /// The value at `volts`, in the channel's SI unit.
    pub fn value(&self, volts: f64) -> f64 {
        (volts - self.offset_v) / self.volts_per_unit
    }

    /// The voltage at which the sensor reports `value`.
    pub fn volts(&self, value: f64) -> f64 {
        self.offset_v + self.volts_per_unit * value
    }

    /// The integer form for this sensor on `converter`; saturates at a sensitivity of 0.
    pub fn scale(&self, converter: &Converter) -> Scale {
        let micro_per_count = converter.volts_per_count() / self.volts_per_unit * 1e6;
        Scale {
            micro_per_count_q16: round(micro_per_count * 65536.0) as i64,
            offset_micro: round(self.value(0.0) * 1e6) as i32,
        }
    }
}

/// The motor's steady speed as a line in its command voltage, for forward motion: `rpm = rpm_per_volt * V + offset_rpm`.
/// Backward motion mirrors it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotorCalibration {
    /// Slope.
    pub rpm_per_volt: f64,
    /// Speed of the line at 0 V; negative with friction.
    pub offset_rpm: f64,
}

impl MotorCalibration {
    /// Motor line with mechanism and load (thesis, eq. 2.1).
    pub const LOADED: Self = Self { rpm_per_volt: 721.8443, offset_rpm: -12.4679 };
    /// Printed as without load (thesis, eq. 2.2). It gives less speed for a voltage than with load: the captions are
    /// probably swapped.
    pub const UNLOADED: Self = Self { rpm_per_volt: 709.3619, offset_rpm: -56.0805 };

    /// Steady speed at `volts`; 0 inside the dead band.
    pub fn speed_rad_s(&self, volts: f64) -> f64 {
        let forward = |v: f64| (self.rpm_per_volt * v + self.offset_rpm).max(0.0) * RAD_S_PER_RPM;
        if volts < 0.0 { -forward(-volts) } else { forward(volts) }
    }

    /// Voltage that holds `speed_rad_s`; 0 V for standstill.
    pub fn volts(&self, speed_rad_s: f64) -> f64 {
        let forward = |speed: f64| (speed / RAD_S_PER_RPM - self.offset_rpm) / self.rpm_per_volt;
        if speed_rad_s == 0.0 {
            0.0
        } else if speed_rad_s < 0.0 {
            -forward(-speed_rad_s)
        } else {
            forward(speed_rad_s)
        }
    }

    /// The integer form for the board.
    pub fn line(&self) -> MotorLine {
        MotorLine {
            uv_per_urad_s_q32: round(TWO_POW_32 / (self.rpm_per_volt * RAD_S_PER_RPM)) as i64,
            offset_uv: round(-self.offset_rpm / self.rpm_per_volt * 1e6) as i32,
        }
    }
}

/// The motor's calibration in integers: `voltage = speed * slope + sign(speed) * offset`, and 0 V for standstill.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MotorLine {
    /// uV per urad/s, in 1/2^32.
    pub uv_per_urad_s_q32: i64,
    /// Voltage that just overcomes friction.
    pub offset_uv: i32,
}

impl MotorLine {
    /// The voltage that holds `speed_urad_s`, saturated.
    pub fn voltage_uv(&self, speed_urad_s: i32) -> i32 {
        let voltage_uv = fixed::scale(speed_urad_s, self.uv_per_urad_s_q32, 32);
        voltage_uv.saturating_add(self.offset_uv.saturating_mul(speed_urad_s.signum()))
    }
}

/// A channel's integer conversion: `value_micro = offset_micro + counts * micro_per_count_q16 / 2^16`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Scale {
    /// Millionths of the channel's SI unit per count, in 1/65536.
    pub micro_per_count_q16: i64,
    /// Value at 0 counts, in millionths of the channel's SI unit.
    pub offset_micro: i32,
}

impl Scale {
    /// The value at `count`, in millionths of the channel's SI unit, saturated.
    pub fn value_micro(&self, count: i32) -> i32 {
        fixed::scale(count, self.micro_per_count_q16, 16).saturating_add(self.offset_micro)
    }
}

const TWO_POW_32: f64 = 4_294_967_296.0;

/// Counts per microvolt of a converter, in 1/2^32, as in [`crate::Output`].
pub fn counts_per_uv_q32(converter: &Converter) -> i64 {
    round(TWO_POW_32 / (converter.volts_per_count() * 1e6)) as i64
}

/// `value` in millionths, rounded and saturated.
pub fn micro(value: f64) -> i32 {
    round(value * 1e6) as i32
}

/// Rounds to the nearest integer, halves away from zero; `core` has no `f64::round`.
fn round(x: f64) -> f64 {
    // From 2^52 on every f64 is an integer.
    if x.abs() < 4_503_599_627_370_496.0 { (x + 0.5f64.copysign(x)) as i64 as f64 } else { x }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn default_bench_matches_the_thesis() {
        // 1000 rpm: 6.9 V on the tachometer, 22609 counts.
        let converter = Converter::DEFAULT;
        let count = converter.count(6.9);
        let scale = Sensor::MOTOR_SPEED.scale(&converter);
        assert!((f64::from(scale.value_micro(count.into())) * 1e-6 - 1000.0 * RAD_S_PER_RPM).abs() < 3e-3);
        // Eq. 2.1 at 1.88 V, the program's default offset: 1344.6 rpm.
        let speed = MotorCalibration::LOADED.speed_rad_s(1.88);
        assert!((speed / RAD_S_PER_RPM - 1344.599).abs() < 1e-2);
        assert!((MotorCalibration::LOADED.volts(speed) - 1.88).abs() < 1e-12);
        assert!((MotorCalibration::LOADED.volts(-speed) + 1.88).abs() < 1e-12);
    }

    #[test]
    fn converters_saturate_at_their_ends() {
        let twelve_bit = Converter { bits: 12, full_scale_v: 10.0 };
        assert_eq!((twelve_bit.count(11.0), twelve_bit.count(-11.0)), (2047, -2048));
        assert_eq!(twelve_bit.volts(1), 0.0048828125);
        assert_eq!((Converter::DEFAULT.count(99.0), Converter::DEFAULT.count(-99.0)), (32767, -32768));
        assert_eq!(Converter::DEFAULT.count(f64::NAN), 0);
    }

    #[test]
    fn integer_scale_agrees_with_floating_point_over_the_whole_range() {
        let sensor = Sensor { volts_per_unit: -0.37, offset_v: 0.123 };
        let scale = sensor.scale(&Converter::DEFAULT);
        for count in i16::MIN..=i16::MAX {
            let exact = sensor.value(Converter::DEFAULT.volts(count)) * 1e6;
            assert!((f64::from(scale.value_micro(count.into())) - exact).abs() < 1.8, "count {count}");
        }
    }
}
