//! Calibration files: the default one, and complaints about others.

use super::Calibration;
use crate::Channel;
use socam_core::scaling::RAD_S_PER_RPM;
use socam_core::{ChannelKind, Config, transducer};

#[test]
fn the_default_file_is_the_default_bench() {
    let read = Calibration::parse(Calibration::default_text()).unwrap();
    assert_eq!(read.config(1000).unwrap(), Config::default());
    assert_eq!(Calibration::default().config(1000).unwrap(), Config::default());
    let names: Vec<_> = read.recorded_channels().iter().map(Channel::column_name).collect();
    assert_eq!(
        names,
        ["command_V", "motor_speed_rad_s", "output_speed_rad_s", "torque_in_Nm", "torque_out_Nm"]
    );
    let sample: Vec<_> = read.values(16384, &[22609, 0, 1638, -32768]).collect();
    let expected = [5.0, 1000.0 * RAD_S_PER_RPM, 0.0, 0.25, -40.0];
    assert!(sample.iter().zip(expected).all(|(a, b)| (a - b).abs() < 5e-3), "{sample:?}");
}

#[test]
fn converters_of_twelve_bits_run_too() {
    let mut calibration = Calibration::default();
    calibration.input.bits = 12;
    calibration.output.bits = 12;
    let config = calibration.config(1000).unwrap();
    assert_eq!(config.output.count(config.output.clamp_uv), 1022);
    calibration.clamp_v = 10.0;
    assert!(calibration.config(1000).is_err());
}

#[test]
fn complaints_name_line_key_and_expectation() {
    let complaint = |from: &str, to: &str| {
        let text = Calibration::default_text().replacen(from, to, 1);
        Calibration::parse(&text).and_then(|calibration| calibration.config(1000)).unwrap_err().to_string()
    };
    assert_eq!(
        complaint("bits = 16 ", "bits = 24 "),
        "line 6: `bits` is 24; expected a whole number from 8 to 16"
    );
    assert_eq!(
        complaint("limit = 4.8", "limits = 4.8"),
        "line 52: `limits` is not a key here; expected one of `name`, `unit`, `volts_per_unit`, `offset_V`, `limit`, \
         `stuck_s`, `missing_below`, `volts_per_unit_std`, `offset_V_std`"
    );
    assert_eq!(
        complaint("\"torque_out\"", "\"torque_in\"").split(';').next(),
        Some("line 55: a channel named `torque_in` exists already")
    );
    assert!(
        complaint("\"krpm\"", "\"mph\"").starts_with("line 31: `unit` is \"mph\"; expected \"rad/s\" or")
    );
    assert!(
        complaint("calibration/1", "calibration/2").contains("this version reads \"socam.calibration/1\"")
    );
    assert!(
        complaint("tachometer = \"motor_speed\"", "tachometer = \"torque_in\"")
            .contains("no channel in rad/s")
    );
    assert!(complaint("clamp_V = 4.99", "clamp_V = 12").contains("the clamp exceeds the converter"));
}

#[test]
fn a_transducer_is_in_place_of_the_supplys_current_and_has_values_of_its_conversions_only() {
    let text = Calibration::gearmotor_torque_text();
    let calibration = Calibration::parse(&text).unwrap();
    let names: Vec<_> = calibration.recorded_channels().iter().map(Channel::column_name).collect();
    assert_eq!(names[5..], ["motor_current_A", "output_torque_Nm", "supply_V", "motor_voltage_V"]);
    let config = calibration.config(1000).unwrap();
    assert!(config.channels[5].kind == ChannelKind::Transducer && config.layout().is_wide(5));
    let torque = |count: i32| calibration.values(0, &[0, 0, 0, 0, 0, count, 0, 0]).nth(6).unwrap();
    assert!((torque(2_147_484) - 1.0).abs() < 1e-9);
    // The board's integers agree, in millionths of a newton metre.
    assert!((config.channels[5].scale.value_micro(-3_000_000) + 1_396_983).abs() <= 25);
    for count in [transducer::NO_CONVERSION, transducer::RAILS[0], transducer::RAILS[1]] {
        assert!(torque(count).is_nan());
    }
    let complaint =
        |from: &str, to: &str| Calibration::parse(&text.replacen(from, to, 1)).unwrap_err().to_string();
    assert!(complaint("\"N m\"", "\"A\"").contains("a torque transducer (N m) with `counts_per_unit`"));
    assert!(complaint("= 2147484 ", "= 20 ").contains("less than 100 per N m"));
}
