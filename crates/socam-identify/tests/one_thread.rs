//! No estimator asks faer's setting of the whole process for a number of threads: with that setting disabled, asking panics.

use socam_identify::{
    NoiseLevels, Options, Problem,
    comparison::{NoiseModel, cross_validation::leave_one_out, measure, score_test},
    inverse_dynamics, output_error,
    uncertainty::jackknife,
};

type Outcome = Result<(), Box<dyn std::error::Error>>;

#[test]
fn fits_comparisons_and_intervals_do_not_ask_for_threads() -> Outcome {
    faer::disable_global_parallelism();
    let (model, recordings) = include!("doc/bench.rs");
    let recordings: Vec<_> = (0..8).map(|_| recordings[0].clone()).collect();
    let problem = Problem::new(&model, &recordings, Options::default())?;
    assert!(output_error(&problem)?.parameters.iter().any(|parameter| parameter.value.is_some()));
    let values = model.values();
    let levels = NoiseLevels { outputs: vec![0.07; 2], inputs: vec![0.1] };
    let noise_model = NoiseModel::new(&[&problem], &values, levels)?;
    let at = measure(&problem, &noise_model, &values)?.expect("no overflow");
    assert!(leave_one_out(&problem, &noise_model, &model, &at)?.is_some());
    assert!(jackknife::half_widths(&problem, &noise_model, &model, &at)?.is_some());
    let groups = ["stiffness", "motor_inertia"]
        .map(|name| vec![model.parameter(name).expect("a parameter of the model")]);
    assert!(score_test(&problem, &noise_model, &values, (&model, &at), &[], &groups)?.is_some());
    Ok(())
}

#[test]
fn inverse_dynamics_does_not_ask_for_threads() -> Outcome {
    faer::disable_global_parallelism();
    let (model, recordings) = include!("doc/axis.rs");
    assert!(inverse_dynamics(&model, &recordings)?.parameters.iter().any(|own| own.value.is_some()));
    Ok(())
}
