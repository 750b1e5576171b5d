//! Answers on a belt rig that this file integrates exactly by itself: inputs between their samples, irregular time stamps, noise that
//! is known, and parameters that are nearly zero.

use socam_identify::{Identification, Intersample, Options, Problem, StartState, output_error};
use socam_model::Model;
use socam_recording::{Channel, Dataset, Unit};

const STEP_S: f64 = 2e-3;
const TRUTH: [(&str, f64); 6] = [
    ("motor_inertia", 1.2e-3),
    ("load_inertia", 5e-3),
    ("stiffness", 90.0),
    ("shaft_damping", 0.05),
    ("motor_damping", 5e-3),
    ("load_damping", 1.1e-2),
];

/// [motor speed, load speed, twist, torque, sensitivity of the torque].
type State = [f64; 5];

fn derivative(x: &State) -> State {
    let [j1, j2, k, c, d1, d2] = TRUTH.map(|(_, value)| value);
    let belt = k * x[2] + c * (x[0] - x[1]);
    [(x[3] - belt - d1 * x[0]) / j1, (belt - d2 * x[1]) / j2, x[0] - x[1], x[4], 0.0]
}

/// The motion over a sample by the exponential's series, in parts so short that it ends within rounding.
fn step(mut x: State, step_s: f64) -> State {
    const PARTS: usize = 16;
    for _ in 0..PARTS {
        let (mut term, mut sum) = (x, x);
        for n in 1..16 {
            term = derivative(&term).map(|rate| rate * step_s / (PARTS * n) as f64);
            sum.iter_mut().zip(term).for_each(|(sum, term)| *sum += term);
        }
        x = sum;
    }
    x
}

/// Uniform in -1..1, by a congruential generator.
fn draw(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// A drive that gives a new torque at every sample, and ramps to it or holds it; time stamps lie within half of `jitter` mean steps of
/// even ones, and a share of the samples is `lost`.
fn recording(seed: u64, kind: Intersample, jitter: f64, lost: f64) -> Dataset {
    let rows = 4000;
    let mut random = seed;
    let mut stamps = seed + 1000;
    let mut time_s = Vec::new();
    let mut next_s = 0.0;
    let (mut slow, mut slower) = (0.0, 0.0);
    let torque: Vec<f64> = (0..rows)
        .map(|_| {
            slow = 0.9 * slow + draw(&mut random);
            slower = 0.7 * slower + 0.3 * slow;
            // With lost samples the torque is smoother: a rough torque cannot be reconstructed where samples are lost.
            if lost > 0.0 { 2.0 * slower } else { slow }
        })
        .collect();
    let mut x = [0.0; 5];
    let mut columns = vec![Vec::new(); 3];
    for k in 0..rows {
        let normal = (0..12).map(|_| draw(&mut random)).sum::<f64>() / 2.0;
        let other = (0..12).map(|_| draw(&mut random)).sum::<f64>() / 2.0;
        let now_s = next_s;
        next_s = STEP_S * ((k + 1) as f64 + 0.5 * jitter * draw(&mut stamps));
        if k == 0 || 0.5 * (draw(&mut stamps) + 1.0) >= lost {
            time_s.push(now_s);
            columns[0].push(torque[k]);
            columns[1].push(x[0] + 0.1 * normal);
            columns[2].push(x[1] + 0.1 * other);
        }
        let next = torque[(k + 1).min(rows - 1)];
        x[3] = torque[k];
        x[4] = if kind == Intersample::Hold { 0.0 } else { (next - torque[k]) / (next_s - now_s) };
        x = step(x, next_s - now_s);
    }
    let names = [("motor_torque", Unit::Nm), ("motor_speed", Unit::RadPerS), ("load_speed", Unit::RadPerS)];
    let channels = names.map(|(name, unit)| Channel::new(name, unit)).to_vec();
    Dataset::from_columns(format!("belt {seed}"), channels, time_s, columns).unwrap()
}

fn identify(model: &Model, kind: Intersample) -> Identification {
    let datasets: Vec<Dataset> = (1..=3).map(|seed| recording(seed, kind, 0.0, 0.0)).collect();
    let options = Options { starts: 1, try_other_intersamples: true, ..Options::default() };
    output_error(&Problem::new(model, &datasets, options).unwrap()).unwrap()
}

fn model(between: &str) -> Model {
    let text = Model::builtin("two-mass").unwrap().text;
    let input = "role = \"input\"\n";
    Model::parse(&text.replacen(input, &format!("{input}{between}"), 1)).unwrap()
}

/// Largest error of an estimate, in half-widths of its interval; infinite if one is not determined.
fn worst(result: &Identification) -> f64 {
    let off = TRUTH.iter().map(|(name, truth)| {
        let estimate = result.parameters.iter().find(|estimate| estimate.name == *name).unwrap();
        let [Some(from), Some(to)] = estimate.ci95 else { return f64::INFINITY };
        (2.0 * truth - from - to).abs() / (to - from)
    });
    off.fold(0.0, f64::max)
}

#[test]
fn a_torque_that_a_drive_ramps_is_linear_by_default() {
    let ramped = identify(&model(""), Intersample::Linear);
    assert!(worst(&ramped) < 1.5, "{:?}", ramped.parameters);
    assert_eq!(ramped.warnings, [""; 0]);
    let smoothed = identify(&model("between = \"band-limited\"\n"), Intersample::Linear);
    assert!(worst(&smoothed) > 2.0, "{:?}", smoothed.parameters);
    let told = |warning: &String| warning.contains("but linear fits the recordings better");
    assert!(smoothed.warnings.iter().any(told), "{:?}", smoothed.warnings);
}

#[test]
fn a_torque_that_a_drive_holds_is_told_from_one_that_it_ramps() {
    let held = identify(&model("between = \"hold\"\n"), Intersample::Hold);
    assert!(worst(&held) < 1.5, "{:?}", held.parameters);
    assert_eq!(held.warnings, [""; 0]);
    let found = identify(&model(""), Intersample::Hold);
    assert!(worst(&found) < 1.5, "{:?}", found.parameters);
    assert_eq!(found.between[0].1.kind, Intersample::Hold);
    for wrong in ["linear", "band-limited"] {
        let taken = identify(&model(&format!("between = \"{wrong}\"\n")), Intersample::Hold);
        assert!(worst(&taken) > 2.0, "{:?}", taken.parameters);
        let told = taken.warnings.iter().find(|warning| warning.contains("fits the recordings better"));
        assert!(told.is_some(), "{:?}", taken.warnings);
    }
}

/// Three recordings whose stamps jitter by 30 %, integrated from stamp to stamp.
fn jittered(kind: Intersample, lost: f64) -> Vec<Dataset> {
    let raw = (1..=3).map(|seed| recording(seed, kind, 0.6, lost));
    let all: Vec<Dataset> = raw.map(|data| data.on_its_stamps().unwrap()).collect();
    // Steps of more than four median steps, where several samples in a row were lost, are gaps.
    assert!(all.iter().all(|data| data.steps().unwrap().are_irregular() && data.segments().len() <= 4));
    all
}

#[test]
fn irregular_time_stamps_lose_no_accuracy() {
    for kind in [Intersample::Linear, Intersample::Hold] {
        let datasets = jittered(kind, 0.0);
        let options = Options { starts: 1, ..Options::default() };
        let found = output_error(&Problem::new(&model(""), &datasets, options.clone()).unwrap()).unwrap();
        assert!(worst(&found) < 1.5, "{:?}", found.parameters);
        assert_eq!(found.between[0].1.kind, kind);
        // The same by the integrator, which a force law needs.
        let rubbing = model("").with_effect("coulomb_friction", "load_bearing", &[("torque", 0.3)]).unwrap();
        let found = output_error(&Problem::new(&rubbing, &datasets, options).unwrap()).unwrap();
        let torque = found.parameters.iter().find(|estimate| estimate.name.ends_with("torque")).unwrap();
        assert!(torque.value.unwrap().abs() < 0.02, "{torque:?}");
        assert!(worst(&found) < 1.5, "{:?}", found.parameters);
    }
}

/// The torque beside a lost sample is unknown. Its error exceeds what the intervals account for.
#[test]
fn lost_samples_cost_little_accuracy() {
    let datasets = jittered(Intersample::Linear, 0.05);
    let options = Options { starts: 1, ..Options::default() };
    let found = output_error(&Problem::new(&model(""), &datasets, options).unwrap()).unwrap();
    for (name, truth) in &TRUTH[..3] {
        let estimate = found.parameters.iter().find(|estimate| estimate.name == *name).unwrap();
        assert!((estimate.value.unwrap() / truth - 1.0).abs() < 5e-3, "{estimate:?}");
    }
}

fn fit(model: &Model) -> Identification {
    let data = [recording(1, Intersample::Linear, 0.0, 0.0)];
    output_error(&Problem::new(model, &data, Options { starts: 1, ..Options::default() }).unwrap()).unwrap()
}

#[test]
fn noise_that_is_known_of_every_channel_is_taken() {
    let mut known = model("");
    let levels = [1e-3, 0.1, 0.1];
    known.channels.iter_mut().zip(levels).for_each(|(channel, std)| channel.noise_std = Some(std));
    let result = fit(&known);
    assert!(result.converged && worst(&result) < 1.5, "{:?}", result.parameters);
    assert!(result.fit.channels.iter().all(|(_, fit)| fit.noise_std == 0.1), "{:?}", result.fit);
    assert_eq!(result.input_noise_std, [("motor_torque".to_owned(), 1e-3)]);
}

#[test]
fn a_friction_that_is_not_there_is_determined() {
    let rubbing = model("").with_effect("coulomb_friction", "load_bearing", &[("torque", 0.5)]).unwrap();
    let result = fit(&rubbing);
    let torque = result.parameters.iter().find(|estimate| estimate.name.ends_with("torque")).unwrap();
    assert!(torque.identifiable && torque.value.unwrap().abs() < 0.02, "{torque:?}");
    assert!(torque.note.contains("nearly zero"), "{torque:?}");
}

#[test]
fn a_model_that_explains_nothing_is_said_to() {
    let mut wrong = model("");
    for (name, value) in [("stiffness", 2.0), ("load_inertia", 0.05)] {
        let index = wrong.parameter(name).unwrap();
        (wrong.parameters[index].value, wrong.parameters[index].fixed) = (value, true);
    }
    let result = fit(&wrong);
    let told = |warning: &String| warning.starts_with("the model does not explain these recordings");
    assert!(result.warnings.iter().any(told), "{:?} {:?}", result.warnings, result.fit);
    assert_eq!(result.advice, [""; 0]);
}

#[test]
fn a_start_at_rest_needs_a_state_of_rest() {
    let axis = Model::builtin("emps").unwrap();
    let time_s: Vec<f64> = (0..200).map(|k| 1e-3 * f64::from(k)).collect();
    let channels = vec![Channel::new("force", Unit::N), Channel::new("position", Unit::M)];
    let columns = vec![time_s.clone(), time_s.clone()];
    let data = [Dataset::from_columns("axis", channels, time_s, columns).unwrap()];
    let options = Options { start_state: StartState::Equilibrium, ..Options::default() };
    let refused = Problem::new(&axis, &data, options).unwrap_err().to_string();
    assert!(
        refused.contains("no state of rest") && refused.contains("let the start state be fitted"),
        "{refused}"
    );
}
