//! Predictions against independent arithmetic, sensitivities against differences.

use super::*;

/// Worst disagreement between analytic and difference sensitivities of the cost, relative to the largest.
fn sensitivity_error(model: &Model, dataset: Dataset, start_state: StartState) -> f64 {
    let datasets = [dataset];
    let problem = Problem::new(model, &datasets, Options { start_state, ..Options::default() }).unwrap();
    let values = model.values();
    let point = Point { nuisance: evaluation::first_nuisance(&problem, &values).unwrap(), values };
    let size = |value: f64| if value == 0.0 { 0.1 } else { value.abs() };
    let scales = problem.free.iter().map(|index| size(point.values[*index])).collect();
    let weights = Weights::white(vec![0.1; problem.outputs()], scales);
    let cost = |point: &Point| -> f64 {
        let results = evaluation::run(&problem, point, &weights).unwrap().unwrap();
        results.iter().flat_map(|r| &r.channels).map(|c| c.residual_squares / 0.01).sum()
    };
    let results = evaluation::run(&problem, &point, &weights).unwrap().unwrap();
    let r = &results[0].factor;
    let last = r.ncols() - 1;
    let analytic = |column: usize| 2.0 * (0..=last).map(|i| r[(i, column)] * r[(i, last)]).sum::<f64>();
    let nuisance = point.nuisance[0].len();
    let mut pairs = Vec::new();
    for (j, index) in problem.free.iter().enumerate() {
        let eps = 1e-5;
        let moved = |sign: f64| {
            let mut moved = point.clone();
            moved.values[*index] += sign * eps * weights.scales[j];
            cost(&moved)
        };
        pairs.push((analytic(nuisance + j), (moved(1.0) - moved(-1.0)) / (2.0 * eps)));
    }
    for i in 0..nuisance {
        let eps = 1e-5 * point.nuisance[0][i].abs().max(1e-3);
        let moved = |sign: f64| {
            let mut moved = point.clone();
            moved.nuisance[0][i] += sign * eps;
            cost(&moved)
        };
        let size = point.nuisance[0][i].abs().max(1e-3);
        pairs.push((analytic(i) * size, (moved(1.0) - moved(-1.0)) / (2.0 * eps) * size));
    }
    let largest = pairs.iter().map(|(a, _)| a.abs()).fold(0.0, f64::max);
    pairs.iter().map(|(a, b)| (a - b).abs() / largest).fold(0.0, f64::max)
}

#[test]
fn sensitivities_agree_with_differences() {
    let linear = model(|text| text);
    let bent = model(with_friction);
    let axis = Model::builtin("emps").unwrap();
    for start in [StartState::Free, StartState::Equilibrium] {
        let data = || bench(TRUTH, 0.5, 1.0, 3);
        let error = sensitivity_error(&linear, data(), start);
        assert!(error < 1e-6, "linear, {start:?}: {error:e}");
        let error = sensitivity_error(&bent, data(), start);
        assert!(error < 1e-5, "with friction, {start:?}: {error:e}");
    }
    // Sensitivities include the changes of the times at which teeth meet and part.
    let loose = linear.with_effect("backlash", "mesh", &[("gap", 2e-3)]).unwrap();
    let error = sensitivity_error(&loose, bench(TRUTH, 0.2, 1.0, 3), StartState::Equilibrium);
    assert!(error < 2e-4, "with play: {error:e}");
    let error = sensitivity_error(&axis, emps_data(), StartState::Free);
    assert!(error < 1e-4, "axis: {error:e}");
}

/// Zero-amplitude laws, on a bench with one mode and on one with three (play).
#[test]
fn sensitivities_of_inactive_laws_agree_with_differences() {
    let inactive = |mut model: Model| {
        for (effect, place, values) in [
            ("coulomb_friction", "cam_bearing", &[("torque", 0.0)][..]),
            ("stiffness_hardening", "coupling_1", &[("cubic", 0.0)]),
            ("gravity_unbalance", "load", &[("torque", 0.0), ("phase", 0.3)]),
            ("sensor_hum", "torque_out", &[("amplitude", 0.0), ("frequency", 50.0), ("phase", 0.2)]),
            ("mesh_loss", "mesh", &[("fraction", 0.0)]),
            ("sensor_ripple", "output_speed", &[("amplitude", 0.0), ("order", 2.0), ("phase", 0.2)]),
        ] {
            model = model.with_effect(effect, place, values).unwrap();
        }
        model
    };
    let data = || bench(TRUTH, 0.3, 1.0, 3);
    for start in [StartState::Free, StartState::Equilibrium] {
        let error = sensitivity_error(&inactive(model(with_friction)), data(), start);
        assert!(error < 1e-5, "{start:?}: {error:e}");
    }
    let loose = model(|text| text).with_effect("backlash", "mesh", &[("gap", 2e-3)]).unwrap();
    let error = sensitivity_error(&inactive(loose), data(), StartState::Equilibrium);
    assert!(error < 2e-4, "with play: {error:e}");
}

#[test]
fn modes_and_dense_steps_predict_the_same() {
    // With a friction torque of zero the same linear drivetrain is integrated instead of diagonalised.
    let data = [bench(TRUTH, 1.0, 0.0, 1)];
    let linear = model(|text| text);
    let mut bent = model(with_friction);
    fix(&mut bent, &[("Tc", 0.0)]);
    // The integrator approximates the spline of a band-limited input by parabolas.
    for (intersample, tolerance) in
        [(Intersample::Hold, 1e-6), (Intersample::Linear, 1e-6), (Intersample::BandLimited, 1e-2)]
    {
        let options = Options { intersample: Some(intersample), ..Options::default() };
        let fit = |model: &Model| {
            evaluate(&Problem::new(model, &data, options.clone()).unwrap(), &model.values()).unwrap()
        };
        for ((name, a), (_, b)) in fit(&linear).channels.iter().zip(&fit(&bent).channels) {
            assert!((a.rms / b.rms - 1.0).abs() < tolerance, "{name}: {} against {}", a.rms, b.rms);
        }
    }
}

#[test]
fn an_exact_bench_is_predicted_to_a_thousandth_of_its_noise() {
    for tc in [0.0, 0.6] {
        let truth = Truth::from([71.0, 54.4, 52485.0, 110.0, 0.02, 0.02, 0.08, 0.05, tc]);
        let data = [bench(truth, 2.0, 0.0, 1)];
        let mut model = model(with_friction);
        set_truth(&mut model, truth);
        let fit =
            evaluate(&Problem::new(&model, &data, Options::default()).unwrap(), &model.values()).unwrap();
        for ((name, fit), noise) in fit.channels.iter().zip([0.02, 0.01, 0.05]) {
            assert!(fit.rms < 0.05 * noise, "{name} at Tc = {tc}: {}", fit.rms);
        }
    }
}
