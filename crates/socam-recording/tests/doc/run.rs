{
    // The recording of the documentation's examples: a speed and a torque, 1 s at 1 kHz. It is one expression, so that `include!` gives its
    // value.
    use socam_recording::{Channel, Dataset, Unit};

    let time_s: Vec<f64> = (0..1000).map(|k| 1e-3 * f64::from(k)).collect();
    let wave = |hz: f64| time_s.iter().map(|t| (std::f64::consts::TAU * hz * t).sin()).collect::<Vec<f64>>();
    let channels = vec![Channel::new("motor_speed", Unit::RadPerS), Channel::new("torque", Unit::Nm)];
    let columns = vec![wave(2.0), wave(5.0)];
    Dataset::from_columns("run", channels, time_s, columns)?
}
