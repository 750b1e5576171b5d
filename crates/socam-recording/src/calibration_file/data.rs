//! A calibration: its values and their defaults.

use socam_core::BoardKind;
use socam_core::scaling::{Converter, MotorCalibration, RAD_S_PER_RPM, Sensor};

use crate::{Channel, Unit};

/// The name of the recorded command.
pub(super) const COMMAND: &str = "command";

/// A bench's calibration, all in SI.
///
/// ```
/// use socam_recording::{Calibration, Unit};
///
/// let bench = Calibration::parse(Calibration::default_text())?;
/// let channels = bench.recorded_channels();
/// assert_eq!((channels[0].name.as_str(), channels[0].unit), ("command", Unit::V));
/// // Counts of a 16-bit converter to V, rad/s and N m.
/// let counts = vec![0; bench.channels.len()];
/// let sample: Vec<f64> = bench.values(16384, &counts).collect();
/// assert_eq!(sample.len(), channels.len());
/// assert!((sample[0] - 5.0).abs() < 0.01);
/// assert!(bench.config(1000).is_ok());
/// assert!(Calibration::open("absent.toml".as_ref()).is_err());
/// # Ok::<(), socam_recording::SettingsError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Calibration {
    /// Kind of board that it is for.
    pub board: BoardKind,
    /// The input converter.
    pub input: Converter,
    /// The output converter.
    pub output: Converter,
    /// Largest magnitude ever commanded, V.
    pub clamp_v: f64,
    /// Speed over command voltage.
    pub motor: MotorCalibration,
    /// Standard uncertainty of the motor's calibration, where measured.
    pub motor_std: Option<MotorStd>,
    /// Closed-loop speed control.
    pub speed_control: SpeedGains,
    /// Limits that end a run.
    pub safety: Safety,
    /// The motor's winding, where its board compares it with its encoder.
    pub winding: Option<Winding>,
    /// The input channels, in the board's order.
    pub channels: Vec<CalibratedChannel>,
}

/// Standard uncertainties of [`MotorCalibration`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotorStd {
    /// rpm per V.
    pub rpm_per_volt: f64,
    /// rpm.
    pub offset_rpm: f64,
}

/// Gains of the closed speed loop.
#[derive(Debug, Clone, PartialEq)]
pub struct SpeedGains {
    /// Name of the channel that measures the motor's speed.
    pub tachometer: String,
    /// V per rad/s.
    pub proportional: f64,
    /// V per rad.
    pub integral_per_s: f64,
}

/// Limits that end a run, apart from the channels' own limits.
#[derive(Debug, Clone, PartialEq)]
pub struct Safety {
    /// Longest time without a message of the host, s.
    pub host_timeout_s: f64,
    /// Consecutive samples beyond a limit that end a run.
    pub confirm_samples: u8,
    /// Command from which the bench should move, V.
    pub moving_v: f64,
    /// Longest time of a missing signal while the bench should move, s.
    pub missing_s: f64,
}

/// The winding of a gearmotor, with which its board checks encoder, shaft and supply.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Winding {
    /// Resistance of winding, bridge and leads, ohm.
    pub resistance_ohm: f64,
    /// V s/rad, of the shaft that the first encoder is on.
    pub back_emf_v_s: f64,
    /// Longest time for which encoder and winding may contradict each other, s.
    pub contradiction_s: f64,
    /// Lowest voltage of the supply, V.
    pub lowest_supply_v: f64,
}

/// One input channel. Values are in the SI unit of `channel`.
#[derive(Debug, Clone, PartialEq)]
pub struct CalibratedChannel {
    /// Name and SI unit.
    pub channel: Channel,
    /// Volts over SI; counts over SI where the channel is a transducer's; nothing where it is an encoder's.
    pub sensor: Sensor,
    /// Whether it is a torque transducer with a converter of its own, slower than sampling: most samples have no value of it.
    pub is_transducer: bool,
    /// Counts per turn of the encoder that the channel is of, negative where it counts backwards.
    pub counts_per_turn: Option<f64>,
    /// Largest allowed magnitude.
    pub limit: Option<f64>,
    /// Longest time of one repeated count while the bench moves, s.
    pub stuck_s: Option<f64>,
    /// Magnitude below which the signal counts as missing.
    pub missing_below: Option<f64>,
    /// Standard uncertainty of the sensitivity, relative, where measured.
    pub gain_std: Option<f64>,
    /// Standard uncertainty of the sensor's zero, where measured.
    pub offset_std: Option<f64>,
}

impl Default for Calibration {
    fn default() -> Self {
        let channel = |name: &str, unit, sensor, limit, missing_below| CalibratedChannel {
            channel: Channel::new(name, unit),
            sensor,
            is_transducer: false,
            counts_per_turn: None,
            limit: Some(limit),
            stuck_s: Some(0.025),
            missing_below,
            gain_std: None,
            offset_std: None,
        };
        let krpm = 1000.0 * RAD_S_PER_RPM;
        Self {
            board: BoardKind::Analog,
            input: Converter::DEFAULT,
            output: Converter::DEFAULT,
            clamp_v: 4.99,
            motor: MotorCalibration::LOADED,
            motor_std: None,
            speed_control: SpeedGains {
                tachometer: "motor_speed".to_owned(),
                proportional: 0.005,
                integral_per_s: 0.1,
            },
            safety: Safety { host_timeout_s: 0.5, confirm_samples: 1, moving_v: 0.5, missing_s: 0.5 },
            winding: None,
            channels: vec![
                channel("motor_speed", Unit::RadPerS, Sensor::MOTOR_SPEED, 1.425 * krpm, Some(0.01 * krpm)),
                channel(
                    "output_speed",
                    Unit::RadPerS,
                    Sensor::OUTPUT_SPEED,
                    0.195_937_5 * krpm,
                    Some(0.001_25 * krpm),
                ),
                channel("torque_in", Unit::Nm, Sensor::TORQUE_IN, 4.8, None),
                channel("torque_out", Unit::Nm, Sensor::TORQUE_OUT, 38.0, None),
            ],
        }
    }
}
