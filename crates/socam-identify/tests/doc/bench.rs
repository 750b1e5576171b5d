{
    // The bench of the documentation's examples: a model, and 2 s of it at 500 Hz with noise of 0.07 rad/s (RMS) in both speeds. It is one
    // expression, so that `include!` gives its value.
    use socam_identify::{Intersample, Predictor, Start};
    use socam_model::Model;
    use socam_recording::{Channel, Dataset, Unit};

    let model = Model::builtin("two-mass").expect("an embedded model");
    let torque: Vec<f64> = (0..1000).map(|k| f64::from(k * k % 101) / 50.0 - 1.0).collect();
    let predictor = Predictor::new(&model, &model.values(), 2e-3)?;
    let simulated = predictor.run(&[&torque], &[Intersample::Linear], Start::Equilibrium)?;
    let noisy = |(output, signal): (usize, &Vec<f64>)| {
        let noise = |k: usize| 0.1 * (1.7 * (k * k) as f64 + output as f64 * k as f64).sin();
        signal.iter().enumerate().map(|(k, value)| value + noise(k)).collect::<Vec<f64>>()
    };
    let outputs: Vec<Vec<f64>> = simulated.outputs.iter().enumerate().map(noisy).collect();
    let units = [("motor_torque", Unit::Nm), ("motor_speed", Unit::RadPerS), ("load_speed", Unit::RadPerS)];
    let channels = units.map(|(name, unit)| Channel::new(name, unit)).to_vec();
    let time_s = (0..1000).map(|k| 2e-3 * f64::from(k)).collect();
    let columns = [vec![torque], outputs].concat();
    (model, [Dataset::from_columns("run", channels, time_s, columns)?])
}
