use super::*;

#[test]
fn default_is_sound_and_each_slip_is_named() {
    assert_eq!(Config::default().check(), Ok(()));
    let check = |change: fn(&mut Config)| {
        let mut config = Config::default();
        change(&mut config);
        config.check().map_err(|e| std::string::ToString::to_string(&e))
    };
    assert!(check(|c| c.sample_period_us = 0).unwrap_err().starts_with("sample period is 0 us"));
    assert!(check(|c| c.channel_count = 9).unwrap_err().starts_with("9 channels"));
    assert!(check(|c| c.channels[2].scale.micro_per_count_q16 = 0).unwrap_err().starts_with("channel 2"));
    assert!(check(|c| c.output.clamp_uv = 11_000_000).unwrap_err().contains("exceeds the converter"));
    assert!(check(|c| c.speed.tachometer = 2).unwrap_err().contains("tachometer"));
    assert!(check(|c| c.host_timeout_us = 0).unwrap_err().starts_with("host timeout"));
    assert!(check(|c| c.confirm_samples = 0).is_err());
    let unwatched = |c: &mut Config| {
        for channel in &mut c.channels {
            let Channel { kind, scale, .. } = *channel;
            *channel = Channel { kind, scale, ..Channel::UNUSED };
        }
    };
    assert!(check(unwatched).unwrap_err().starts_with("no channel has a limit"));
}

#[test]
fn converters_of_fewer_bits_have_larger_counts() {
    let twelve_bit = Converter { bits: 12, full_scale_v: 10.0 };
    let mut config = Config::default();
    config.channels[0].scale = Sensor::MOTOR_SPEED.scale(&twelve_bit);
    config.channels[0].saturation_count = Some(twelve_bit.highest_count());
    assert_eq!(config.check(), Ok(()));
    // 2047 counts of this are 2500 units: more than an i32 holds in millionths.
    config.channels[0].scale.micro_per_count_q16 *= 17;
    assert_eq!(config.check(), Err(ConfigError::Channel(0)));
}

#[test]
fn full_clamp_is_the_thesis_limit() {
    let output = Config::default().output;
    assert_eq!(output.count(output.clamp_uv), 16351);
    assert_eq!(output.count(-output.clamp_uv), -16351);
    assert_eq!(output.count(0), 0);
}
