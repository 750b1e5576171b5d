{
    // A linear axis for the documentation's examples: its model, and 10 s of it at 1 kHz without noise. It is one expression, so that
    // `include!` gives its value.
    use socam_identify::{Intersample, Predictor, Start};
    use socam_model::Model;
    use socam_recording::{Channel, Dataset, Unit};

    let model = Model::builtin("emps").expect("an embedded model");
    let time_s: Vec<f64> = (0..10_000).map(|k| 1e-3 * f64::from(k)).collect();
    let wave = |hz: f64, time_s: f64| 60.0 * (std::f64::consts::TAU * hz * time_s).sin();
    let force: Vec<f64> = time_s.iter().map(|t| wave(0.5, *t) + wave(2.3, *t)).collect();
    let predictor = Predictor::new(&model, &model.values(), 1e-3)?;
    let still = vec![0.0; predictor.states()];
    let position = predictor.run(&[&force], &[Intersample::Linear], Start::State(&still))?.outputs.remove(0);
    let channels = vec![Channel::new("force", Unit::N), Channel::new("position", Unit::M)];
    (model, [Dataset::from_columns("run", channels, time_s, vec![force, position])?])
}
