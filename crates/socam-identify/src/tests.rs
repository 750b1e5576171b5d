//! Predictions against independent arithmetic, sensitivities against differences, known truth in and truth out.

mod encoder;
mod odd_models;
mod robust;

use socam_model::{BUILTIN, Model};
use socam_recording::{Channel, Dataset, Unit};

use crate::{
    Constraint, Intersample, Noise, NoiseLevels, Options, Problem, StartState, at_minimum,
    comparison::{self, NoiseModel},
    evaluate,
    evaluation::{self, Point, Weights},
    output_error,
    preprocessing::segments,
};

const STEP_S: f64 = 1e-3;

/// A repeatable sequence in [-1, 1) that owes nothing to the library's generators.
struct Lcg(u64);

impl Lcg {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// Nearly Gaussian, standard deviation 1.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.next()).sum::<f64>() / 2.0
    }
}

/// Frequencies and sizes of the tones in the motor's speed, Hz and rad/s.
const TONES: [(f64, f64); 8] =
    [(0.7, 8.0), (2.3, 9.0), (7.1, 6.0), (13.3, 5.0), (19.7, 4.0), (36.1, 4.0), (61.3, 3.0), (88.9, 2.0)];

/// Motor speed: a mean and tones up to 90 Hz.
fn motor_speed(t: f64) -> f64 {
    60.0 + TONES
        .iter()
        .enumerate()
        .map(|(i, (f, a))| a * (std::f64::consts::TAU * f * t + i as f64).sin())
        .sum::<f64>()
}

/// Parameters of the truth: k1, k2, k3, k4, c2, c3, c4, c5, Coulomb torque at the load.
type Truth = [f64; 9];
const TRUTH: Truth = [71.0, 54.4, 52485.0, 110.0, 0.02, 0.02, 0.08, 0.05, 0.0];

/// The thesis' equations 3.7 written out by hand in deflections, integrated by implicit midpoint in 200 parts per
/// sample: other equations, other numerics than the library's.
fn bench(truth: Truth, seconds: f64, noise: f64, seed: u64) -> Dataset {
    let [k1, k2, k3, k4, c2, c3, c4, c5, tc] = truth;
    let (n, j2, j4) = (8.0, 1.2875022e-4 + 4.7784172e-3 / 64.0, 1.4752e-2);
    let rate = |x: &[f64; 6], w: f64| -> [f64; 6] {
        let qc = (k1 * x[0] - k2 * x[1] + c2 * w + c3 * x[4]) / (c2 + c3);
        let e4 = (k3 * x[2] - k4 * x[3]) / c4;
        let friction = tc * (x[5] / 0.05).tanh();
        [
            w - qc,
            qc - x[4],
            x[4] / n - x[5] - e4,
            e4,
            (c3 * (qc - x[4]) + k2 * x[1] - k3 / n * x[2]) / j2,
            (k3 * x[2] - c5 * x[5] - friction) / j4,
        ]
    };
    let w0 = motor_speed(0.0);
    let load = c5 * w0 / n + tc * (w0 / n / 0.05).tanh();
    let mut x = [load / n / k1, load / n / k2, load / k3, load / k4, w0, w0 / n];
    let parts = 200;
    let h = STEP_S / f64::from(parts);
    // Implicit midpoint by Newton with a frozen numerical Jacobian: the system is stiff but nearly linear.
    let jacobian = {
        let base = rate(&x, w0);
        nalgebra::DMatrix::from_fn(6, 6, |i, j| {
            let mut moved = x;
            moved[j] += 1e-6;
            f64::from(i == j) - 0.5 * h * (rate(&moved, w0)[i] - base[i]) / 1e-6
        })
        .lu()
    };
    let rows = (seconds / STEP_S) as usize;
    let mut random = Lcg(seed);
    let mut columns = vec![Vec::new(); 4];
    let mut time = Vec::with_capacity(rows);
    for k in 0..rows {
        let t = k as f64 * STEP_S;
        let w = motor_speed(t);
        let qc = (k1 * x[0] - k2 * x[1] + c2 * w + c3 * x[4]) / (c2 + c3);
        let exact = [w, x[5], k1 * x[0] + c2 * (w - qc), k3 * x[2]];
        time.push(t);
        for ((column, value), level) in columns.iter_mut().zip(exact).zip([0.0, 0.02, 0.01, 0.05]) {
            column.push(value + noise * level * random.normal());
        }
        for part in 0..parts {
            let middle = motor_speed(t + (f64::from(part) + 0.5) * h);
            let mut next = x;
            for _ in 0..4 {
                let half: [f64; 6] = std::array::from_fn(|i| 0.5 * (x[i] + next[i]));
                let sensitivity = rate(&half, middle);
                let mut defect = nalgebra::DVector::from_fn(6, |i, _| next[i] - x[i] - h * sensitivity[i]);
                jacobian.solve_mut(&mut defect);
                next.iter_mut().zip(defect.iter()).for_each(|(next, d)| *next -= d);
            }
            x = next;
        }
    }
    let names = [
        ("motor_speed", Unit::RadPerS),
        ("output_speed", Unit::RadPerS),
        ("torque_in", Unit::Nm),
        ("torque_out", Unit::Nm),
    ];
    let channels = names.map(|(name, unit)| Channel::new(name, unit)).to_vec();
    Dataset::from_columns(format!("bench {seed}"), channels, time, columns).unwrap()
}

fn model(edit: impl Fn(String) -> String) -> Model {
    Model::parse(&edit(BUILTIN[0].1.to_owned())).unwrap()
}

fn with_friction(text: String) -> String {
    let effect = "\n[[effects]]\neffect = \"coulomb_friction\"\nat = \"load_bearing\"\nparameters = { torque = \"Tc\" }\n";
    text.replace("N = {", "Tc = { value = 0.3, unit = \"N m\", bounds = [0, 10] }\nN = {") + effect
}

fn fix(model: &mut Model, settings: &[(&str, f64)]) {
    for (name, value) in settings {
        let index = model.parameter(name).unwrap();
        model.parameters[index].value = *value;
        model.parameters[index].fixed = true;
    }
}

fn set_truth(model: &mut Model, truth: Truth) {
    for (name, value) in ["k1", "k2", "k3", "k4", "c2", "c3", "c4", "c5", "Tc"].iter().zip(truth) {
        if let Some(index) = model.parameter(name) {
            model.parameters[index].value = value;
        }
    }
}

fn emps_data() -> Dataset {
    let time: Vec<f64> = (0..3000).map(|k| k as f64 * STEP_S).collect();
    let force: Vec<f64> = time.iter().map(|t| 60.0 * (4.0 * t).sin() + 25.0 * (23.0 * t).cos()).collect();
    let position: Vec<f64> = time.iter().map(|t| 0.05 * (4.0 * t).sin()).collect();
    let channels = vec![Channel::new("force", Unit::N), Channel::new("position", Unit::M)];
    Dataset::from_columns("axis", channels, time, vec![force, position]).unwrap()
}

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
    // Teeth that knock: what each unknown does to the times at which they meet counts too.
    let loose = linear.with_effect("backlash", "mesh", &[("gap", 2e-3)]).unwrap();
    let error = sensitivity_error(&loose, bench(TRUTH, 0.2, 1.0, 3), StartState::Equilibrium);
    assert!(error < 2e-4, "with play: {error:e}");
    let error = sensitivity_error(&axis, emps_data(), StartState::Free);
    assert!(error < 1e-4, "axis: {error:e}");
}

/// Inverse dynamics reads channels as they were recorded.
#[test]
fn an_effect_at_a_channel_is_no_regression_of_the_force() {
    let axis = Model::builtin("emps")
        .unwrap()
        .with_effect("direction_gain", "force", &[("difference", 0.1)])
        .unwrap();
    let error = crate::inverse_dynamics(&axis, &[emps_data()]).unwrap_err().to_string();
    assert!(error.contains("direction_gain at force") && error.contains("output-error"), "{error}");
}

/// What laws of no strength would answer, on a bench that moves in one way and in three.
#[test]
fn sensitivities_of_silent_laws_agree_with_differences() {
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
    // A friction of nothing sends the same linear drivetrain down the nonlinear path.
    let data = [bench(TRUTH, 1.0, 0.0, 1)];
    let linear = model(|text| text);
    let mut bent = model(with_friction);
    fix(&mut bent, &[("Tc", 0.0)]);
    // Steps of the nonlinear path take a spline for a parabola.
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

#[test]
fn known_truth_comes_back_and_what_is_not_determined_is_said() {
    let data = [bench(TRUTH, 8.0, 1.0, 5), bench(TRUTH, 8.0, 1.0, 6)];
    let model = model(|text| text);
    let result = output_error(&Problem::new(&model, &data, Options::default()).unwrap()).unwrap();
    let estimate = |name: &str| result.parameters.iter().find(|p| p.name == name).unwrap();
    for (name, truth) in [("k4", 110.0), ("c4", 0.08), ("c5", 0.05)] {
        let found = estimate(name);
        let (low, high) = (found.ci95[0].unwrap(), found.ci95[1].unwrap());
        assert!(found.identifiable && low < truth && truth < high, "{name}: {found:?}");
        assert!(high - low < 0.2 * truth, "{name}: {found:?}");
    }
    for name in ["k1", "k2", "k3"] {
        let found = estimate(name);
        assert!(
            !found.identifiable && found.value.is_none() && found.note.starts_with("not determined"),
            "{found:?}"
        );
    }
    let series = result.combinations.iter().find(|c| c.name == "k_series_12").unwrap();
    let truth = 71.0 * 54.4 / (71.0 + 54.4);
    assert!(series.ci95[0].unwrap() < truth && truth < series.ci95[1].unwrap(), "{series:?}");
    assert!((series.value.unwrap() / truth - 1.0).abs() < 1e-3);
    for ((name, fit), noise) in result.fit.channels.iter().zip([0.02, 0.01, 0.05]) {
        // Too good a fit would be as suspicious as a poor one.
        assert!((0.97..1.03).contains(&(fit.rms / noise)), "{name}: {}", fit.rms / noise);
    }
}

#[test]
fn noise_that_a_model_file_gives_an_input_stays() {
    let data = [bench(TRUTH, 4.0, 1.0, 5)];
    let given =
        |text: String| text.replace("[channels.motor_speed]", "[channels.motor_speed]\nnoise_std = 0.004");
    let model = model(given);
    let result = output_error(&Problem::new(&model, &data, Options::default()).unwrap()).unwrap();
    assert_eq!(result.input_noise_std, [("motor_speed".to_owned(), 0.004)]);
}

/// Where a search has ended there is nothing more to be found.
#[test]
fn at_a_minimum_intervals_are_those_of_a_search() {
    let data = [bench(TRUTH, 4.0, 1.0, 5)];
    let mut model = model(|text| text);
    let levels = NoiseLevels { outputs: vec![0.02, 0.01, 0.05], inputs: vec![0.004] };
    let options = Options { starts: 1, noise: Noise::Given(levels.clone()), ..Options::default() };
    let sought = output_error(&Problem::new(&model, &data, options.clone()).unwrap()).unwrap();
    for (parameter, value) in model.parameters.iter_mut().zip(&sought.point) {
        parameter.value = *value;
    }
    let problem = Problem::new(&model, &data, options).unwrap();
    let noise_model = NoiseModel::new(&[&problem], &sought.point, levels).unwrap();
    let at = comparison::measure(&problem, &noise_model, &sought.point).unwrap().unwrap();
    let there = at_minimum(&problem, &noise_model, &at).unwrap();
    assert!(there.converged && there.point == sought.point);
    assert!((there.cost / sought.cost - 1.0).abs() < 1e-6, "{} {}", there.cost, sought.cost);
    for (there, sought) in there.parameters.iter().zip(&sought.parameters) {
        assert_eq!(there.identifiable, sought.identifiable, "{there:?}");
        for (there, sought) in there.std.iter().zip(&sought.std) {
            assert!((there / sought - 1.0).abs() < 1e-2, "{there} {sought}");
        }
    }
}

#[test]
fn friction_comes_back_with_the_rest() {
    let truth = Truth::from([71.0, 54.4, 52485.0, 110.0, 0.02, 0.02, 0.08, 0.05, 0.6]);
    let data = [bench(truth, 6.0, 1.0, 8)];
    let mut model = model(with_friction);
    fix(&mut model, &[("k2", 54.4), ("k3", 52485.0), ("c3", 0.02)]);
    let result = output_error(&Problem::new(&model, &data, Options::default()).unwrap()).unwrap();
    for (name, truth) in [("k1", 71.0), ("k4", 110.0), ("c4", 0.08), ("c5", 0.05), ("Tc", 0.6)] {
        let found = result.parameters.iter().find(|p| p.name == name).unwrap();
        // This motor never reverses: Coulomb friction and damping share a mean torque, and may stay apart only loosely.
        if found.identifiable {
            assert!(found.ci95[0].unwrap() < truth && truth < found.ci95[1].unwrap(), "{found:?}");
        }
    }
    assert!(result.converged);
}

#[test]
fn a_linear_hold_biases_damping_and_a_band_limited_one_does_not() {
    let data = [bench(TRUTH, 4.0, 0.02, 2)];
    let mut model = model(|text| text);
    fix(&mut model, &[("k2", 54.4), ("k3", 52485.0), ("c3", 0.02)]);
    let error = |intersample| {
        let options = Options { intersample: Some(intersample), starts: 1, ..Options::default() };
        let result = output_error(&Problem::new(&model, &data, options).unwrap()).unwrap();
        (result.point[model.parameter("c2").unwrap()] / 0.02 - 1.0).abs()
    };
    let (linear, sharp) = (error(Intersample::Linear), error(Intersample::BandLimited));
    assert!(linear > 0.01 && sharp < 0.3 * linear, "linear {linear}, band-limited {sharp}");
}

#[test]
fn bounds_constraints_and_priors_hold() {
    let data = [bench(TRUTH, 3.0, 1.0, 4)];
    let mut tight = model(|text| {
        text.replace(
            "k4 = { value = 1.92, unit = \"N m/deg\", bounds = [0.01, 100]",
            "k4 = { value = 1.5, unit = \"N m/deg\", bounds = [1, 1.6]",
        )
    });
    fix(&mut tight, &[("k2", 54.4), ("k3", 52485.0), ("c3", 0.02)]);
    let result =
        output_error(&Problem::new(&tight, &data, Options { starts: 1, ..Options::default() }).unwrap())
            .unwrap();
    let k4 = tight.parameter("k4").unwrap();
    assert!((result.point[k4] / tight.parameters[k4].bounds.1 - 1.0).abs() < 1e-6, "{}", result.point[k4]);
    assert!(!result.parameters[k4].identifiable && result.parameters[k4].note.contains("bound"));

    let free = model(|text| text);
    let index = |name: &str| free.parameter(name).unwrap();
    let equal = Constraint { terms: vec![(index("k1"), 1.0), (index("k2"), -1.0)], lower: 0.0, upper: 0.0 };
    let mut start = free.clone();
    start.parameters[index("k2")].value = start.parameters[index("k1")].value;
    let options = Options { starts: 1, constraints: vec![equal], ..Options::default() };
    let result = output_error(&Problem::new(&start, &data, options).unwrap()).unwrap();
    let (k1, k2) = (result.point[index("k1")], result.point[index("k2")]);
    assert!((k1 / k2 - 1.0).abs() < 1e-6, "{k1} {k2}");
    let series = 71.0 * 54.4 / (71.0 + 54.4);
    assert!((0.5 * k1 / series - 1.0).abs() < 1e-2, "{k1}");

    let prior =
        model(|text| text.replace("source = \"identified, table 4.6\"", "prior = { value = 916, std = 20 }"));
    let result =
        output_error(&Problem::new(&prior, &data, Options { starts: 1, ..Options::default() }).unwrap())
            .unwrap();
    let k3 = &result.parameters[index("k3")];
    assert!(k3.identifiable && k3.source == crate::Source::Prior, "{k3:?}");
}

#[test]
fn gaps_and_missing_values_are_survived() {
    let whole = bench(TRUTH, 4.0, 1.0, 9);
    let loaded = whole.load(&["motor_speed", "output_speed", "torque_in", "torque_out"]).unwrap();
    let keep: Vec<usize> = (0..loaded.time_s.len()).filter(|k| !(1500..1600).contains(k)).collect();
    let time = keep.iter().map(|k| loaded.time_s[*k]).collect();
    let mut columns: Vec<Vec<f64>> =
        loaded.columns.iter().map(|c| keep.iter().map(|k| c.values()[*k]).collect()).collect();
    columns[2][200..900].fill(f64::NAN);
    columns[0][3000] = f64::NAN;
    let holed = [Dataset::from_columns("holed", whole.channels().to_vec(), time, columns).unwrap()];
    let mut model = model(|text| text);
    fix(&mut model, &[("k2", 54.4), ("k3", 52485.0), ("c3", 0.02)]);
    let problem = Problem::new(&model, &holed, Options { starts: 1, ..Options::default() }).unwrap();
    assert_eq!(problem.segments.len(), 3);
    let result = output_error(&problem).unwrap();
    let k4 = &result.parameters[model.parameter("k4").unwrap()];
    assert!((k4.value.unwrap() / 110.0 - 1.0).abs() < 0.01, "{k4:?}");
    assert!(result.warnings.iter().any(|w| w.contains("2 gaps")), "{:?}", result.warnings);
}

#[test]
fn the_same_digits_whatever_the_number_of_threads() {
    let data = [bench(TRUTH, 2.0, 1.0, 1), bench(TRUTH, 3.0, 1.0, 2), bench(TRUTH, 0.7, 1.0, 3)];
    let model =
        model(|text| text.replace("at = \"coupling_1\"", "at = \"coupling_1\"\nestimate_offset = true"));
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let options = Options { starts: 2, ..Options::default() };
            let mut problem = Problem::new(&model, &data, options).unwrap();
            problem.segments = segments::segments(&model, &data, 450, &mut Vec::new()).unwrap();
            assert!(problem.segments.len() > 10);
            let mut result = output_error(&problem).unwrap();
            result.cpu_s = 0.0;
            let point: Vec<u64> = result.point.iter().map(|value| value.to_bits()).collect();
            (serde_json::to_string(&result).unwrap(), point)
        })
    };
    let alone = run(1);
    assert_eq!(alone, run(2));
    assert_eq!(alone, run(3));
}

#[test]
fn input_that_cannot_be_used_is_named() {
    let model = model(|text| text);
    let refused =
        |datasets: &[Dataset]| Problem::new(&model, datasets, Options::default()).unwrap_err().to_string();
    assert!(refused(&[]).contains("no recording"));
    assert!(refused(&[bench(TRUTH, 0.01, 0.0, 1)]).contains("10 samples"));
    assert!(
        refused(&[emps_data()]).contains("motor_speed_rad_s")
            || refused(&[emps_data()]).contains("output_speed_rad_s")
    );
    let mut fixed = model.clone();
    fixed.parameters.iter_mut().for_each(|parameter| parameter.fixed = true);
    let data = [bench(TRUTH, 0.1, 0.0, 1)];
    assert!(Problem::new(&fixed, &data, Options::default()).unwrap_err().to_string().contains("fixed"));
    let known = Options {
        noise: Noise::Given(NoiseLevels { outputs: vec![0.02, 0.01, 0.05], inputs: vec![0.0] }),
        starts: 1,
        ..Options::default()
    };
    assert!(output_error(&Problem::new(&model, &data, known).unwrap()).is_ok());
}
