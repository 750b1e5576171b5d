//! Profile files: the built-in ones, and complaints about others.

use super::ProfileFile;
use socam_core::scaling::{MotorCalibration, RAD_S_PER_RPM};
use socam_core::{Command, Generator};

#[test]
fn built_in_profiles_suit_the_default_bench_and_survive_writing() {
    for name in ProfileFile::built_in_names() {
        let file = ProfileFile::open(name).unwrap();
        assert!(file.purpose.is_some(), "{name} does not say what it is for");
        assert_eq!(ProfileFile::parse(&file.to_toml()).unwrap(), file, "{name}");
        for period_us in [100, 1000] {
            let profile = file.profile(period_us).unwrap();
            let mut generator = Generator::new(&profile, period_us).unwrap();
            let mut highest = 0;
            loop {
                let sample = generator.step();
                highest = highest.max(sample.value_micro.abs());
                if sample.finished {
                    break;
                }
            }
            let rpm = MotorCalibration::LOADED.speed_rad_s(f64::from(highest) * 1e-6) / RAD_S_PER_RPM;
            // Volts of an H-bridge, not of the default bench's drive.
            let is_bridge = name == "gearmotor";
            assert!(!is_bridge || highest <= 6_000_000, "{name} reaches {highest} uV");
            assert!(is_bridge || rpm < 1300.0, "{name} reaches {rpm} rpm");
            assert!(highest > 500_000, "{name} hardly moves");
        }
    }
}

#[test]
fn multisine_reaches_the_amplitude_that_was_asked_for_and_is_not_slewed() {
    let file = ProfileFile::open("multisine").unwrap();
    let mut generator = Generator::new(&file.profile(1000).unwrap(), 1000).unwrap();
    let steady: Vec<_> = (0..4000).map(|_| generator.step()).skip(1000).collect();
    let peak = steady.iter().map(|sample| (sample.value_micro - 1_200_000).abs()).max();
    assert!((249_950..=250_000).contains(&peak.unwrap()), "{peak:?}");
    assert!(steady.iter().all(|sample| !sample.limited));
}

#[test]
fn speed_profiles_have_their_own_keys() {
    let text = "command = 'speed'\nshape = 'constant'\nlevel_rad_s = 100\nlimit_rad_s = 120\nslew_rad_s2 = 200\nduration_s = 5\n";
    let file = ProfileFile::parse(text).unwrap();
    let profile = file.profile(1000).unwrap();
    assert_eq!(profile.command, Command::SpeedClosedLoop);
    assert_eq!((profile.limit_micro, profile.slew_micro_s), (120_000_000, 200_000_000));
    assert_eq!(ProfileFile::parse(&file.to_toml()).unwrap(), file);
}

#[test]
fn complaints_name_line_key_and_expectation() {
    let complaint = |from: &str, to: &str| {
        let text = ProfileFile::built_in_text("triangle").unwrap().replacen(from, to, 1);
        ProfileFile::parse(&text).and_then(|file| file.profile(1000)).unwrap_err().to_string()
    };
    assert_eq!(
        complaint("amplitude_V", "amplitude_rad_s"),
        "line 5: `amplitude_rad_s` is not a key here; expected one of `schema`, `purpose`, `command`, `shape`, `offset_V`, `amplitude_V`, \
         `period_s`, `ramp_s`, `limit_V`, `slew_V_s`, `duration_s`"
    );
    assert_eq!(
        complaint("period_s = 5\n", ""),
        "line 1: `period_s` is missing; expected a number from 0.00001 to 4000"
    );
    assert_eq!(
        complaint("\"triangle\"", "\"wobble\"").split(';').next(),
        Some("line 4: `shape` is \"wobble\"")
    );
    assert_eq!(complaint("= 1.5", "= nan"), "line 5: `amplitude_V` is nan; expected a number from 0 to 2000");
    assert!(
        complaint("= 1.5", "= 1.9")
            .starts_with("this profile cannot run: the command reaches 1900000 millionths")
    );
    assert!(complaint("= 1.5", "= = 1").starts_with("line 5: "));
    let unknown = ProfileFile::open("wiggle").unwrap_err().to_string();
    assert!(
        unknown
            .starts_with("`wiggle` is neither a file nor a built-in profile; built in are multisine, steps")
    );
}

#[test]
fn torques_are_profiles_for_drives_alone() {
    let text = "command = 'torque'\nshape = 'sine'\namplitude_Nm = 0.2\nfrequency_Hz = 1\nlimit_Nm = 0.3\nslew_Nm_s = 20\nduration_s = 5\n";
    let file = ProfileFile::parse(text).unwrap();
    assert_eq!((file.command, file.limit), (super::ProfileCommand::Torque, 0.3));
    assert_eq!(ProfileFile::parse(&file.to_toml()).unwrap(), file);
    assert!(file.profile(1000).unwrap_err().to_string().contains("only a drive takes"));
    assert_eq!(file.sampled(1000).unwrap().limit_micro, 300_000);
}
