//! Predictions against independent arithmetic, sensitivities against differences, known truth in and truth out.

mod encoder;
mod odd_models;
mod predictions;
mod problems;
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

/// A repeatable sequence in [-1, 1), independent of the library's generators.
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

/// The thesis' equations 3.7 written out by hand in deflections, integrated by implicit midpoint in 200 parts per sample: neither the
/// equations nor the method are the library's.
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
    assert_eq!(result.input_noise_std, [("motor_speed".to_owned(), 0.0)], "the recorded speed is exact");
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

/// Intervals at an optimum, without refitting, are those of the fit that ended there.
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
        // This motor never reverses: Coulomb friction and damping both contribute to the mean torque, and may be poorly
        // distinguished.
        if found.identifiable {
            assert!(found.ci95[0].unwrap() < truth && truth < found.ci95[1].unwrap(), "{found:?}");
        }
    }
    assert!(result.converged);
}
