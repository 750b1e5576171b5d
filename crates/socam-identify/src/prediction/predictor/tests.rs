use nalgebra::DVector;
use socam_model::{BUILTIN, Model};

use crate::prediction::laws::PortLaw;
use crate::prediction::predictor::*;

/// A model with dry friction at one of its bearings, whose transition may lie within the change of speed of one sample.
fn rubbing(name: &str, place: &str, torque: f64, width: f64) -> Model {
    let (_, text) = BUILTIN.iter().find(|(candidate, _)| *candidate == name).unwrap();
    let parameters = format!(
        "[parameters]\nTc = {{ value = {torque}, unit = \"N m\" }}\nws = {{ value = {width}, unit = \"rad/s\" }}\n"
    );
    let effect = format!(
        "\n[[effects]]\neffect = \"coulomb_friction\"\nat = \"{place}\"\nparameters = {{ torque = \"Tc\", transition_speed = \"ws\" }}\n"
    );
    Model::parse(&(text.replace("[parameters]\n", &parameters) + &effect)).unwrap()
}

/// A speed that changes its sign often.
fn swinging(rows: usize, step_s: f64) -> Vec<f64> {
    (0..rows).map(|k| k as f64 * step_s).map(|t| 8.0 * (40.0 * t).sin() + 5.0 * (97.0 * t).cos()).collect()
}

/// Classical Runge-Kutta from standstill in many small steps: an independent method for the same equations.
fn plain(model: &Model, input: &[f64], step_s: f64, parts: usize) -> Vec<Vec<f64>> {
    let values = model.values();
    let e = model.equations(&values).unwrap();
    let laws = PortLaw::all(&e, &values, &[]);
    let force = |x: &DVector<f64>, u: f64| {
        let speeds = &e.port * x + &e.port_input * DVector::from_element(1, u);
        let at = |p: usize| laws[p].at(&speeds.as_slice()[p..]).torque;
        DVector::from_fn(laws.len(), |p, _| if laws[p].is_first_port() { at(p) } else { 0.0 })
    };
    let rate = |x: &DVector<f64>, u: f64| &e.state * x + e.input.column(0) * u + &e.force * force(x, u);
    let mut x = DVector::zeros(e.state.nrows());
    let mut outputs = vec![Vec::new(); e.output.nrows()];
    let h = step_s / parts as f64;
    for (k, u) in input.iter().enumerate() {
        let y = &e.output * &x + e.feedthrough.column(0) * *u + &e.force_output * force(&x, *u);
        outputs.iter_mut().zip(y.iter()).for_each(|(output, y)| output.push(*y));
        let Some(next) = input.get(k + 1) else { break };
        for part in 0..parts {
            let at = |share: f64| u + (next - u) * (part as f64 + share) / parts as f64;
            let a = rate(&x, at(0.0));
            let b = rate(&(&x + &a * (0.5 * h)), at(0.5));
            let c = rate(&(&x + &b * (0.5 * h)), at(0.5));
            let d = rate(&(&x + &c * h), at(1.0));
            x += (a + (b + c) * 2.0 + d) * (h / 6.0);
        }
    }
    outputs
}

/// Largest difference of any output relative to its range.
fn difference(a: &[Vec<f64>], b: &[Vec<f64>]) -> f64 {
    let each = a.iter().zip(b).map(|(a, b)| {
        let range = b.iter().copied().fold(f64::MIN, f64::max) - b.iter().copied().fold(f64::MAX, f64::min);
        a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / range
    });
    each.fold(0.0, f64::max)
}

#[test]
fn small_explicit_steps_say_the_same() {
    let step_s = 2e-3;
    let model = rubbing("two-mass", "load_bearing", 0.4, 0.05);
    let input = swinging(400, step_s);
    let expected = plain(&model, &input, step_s, 800);
    let run = |tolerance: f64| {
        let predictor = Predictor::new(&model, &model.values(), step_s).unwrap().with_tolerance(tolerance);
        let still = vec![0.0; predictor.states()];
        predictor.run(&[&input], &[Intersample::Linear], Start::State(&still)).unwrap()
    };
    let (usual, fine) = (run(DEFAULT_TOLERANCE), run(1e-12));
    assert!(difference(&usual.outputs, &expected) < 1e-6, "{}", difference(&usual.outputs, &expected));
    assert!(difference(&fine.outputs, &expected) < 1e-9, "{}", difference(&fine.outputs, &expected));
    let (steps, more) = (usual.steps, fine.steps);
    assert!(usual.unresolved == 0 && steps > 420 && more > steps, "{steps} and {more}");
}

/// Compares impacts of a gear with play with its smooth law, integrated in steps far shorter than a contact.
#[test]
fn teeth_meet_and_part_when_they_should() {
    let step_s = 1e-3;
    let model = Model::builtin("speed-o-cam").unwrap();
    let model = model.with_effect("backlash", "mesh", &[("gap", 2e-3)]).unwrap();
    let input = swinging(150, step_s);
    let expected = plain(&model, &input, step_s, 4000);
    let predictor = Predictor::new(&model, &model.values(), step_s).unwrap();
    let still = vec![0.0; predictor.states()];
    let got = predictor.run(&[&input], &[Intersample::Linear], Start::State(&still)).unwrap();
    let error = difference(&got.outputs, &expected);
    assert!(error < 1e-3 && got.steps < 10 * input.len(), "{error} in {} steps", got.steps);
}

/// Five decades of stiffness, and friction that jumps at once.
#[test]
fn stiff_models_and_steep_laws_converge() {
    let step_s = 1e-3;
    for width in [0.05, 1e-4] {
        let model = rubbing("speed-o-cam", "load_bearing", 0.6, width);
        let input = swinging(500, step_s);
        let run = |tolerance: f64| {
            let predictor =
                Predictor::new(&model, &model.values(), step_s).unwrap().with_tolerance(tolerance);
            predictor.run(&[&input], &[Intersample::Linear], Start::Equilibrium).unwrap().outputs
        };
        let error = difference(&run(DEFAULT_TOLERANCE), &run(1e-13));
        assert!(error < 1e-6, "width {width}: {error}");
    }
}

#[test]
fn pieces_make_the_whole() {
    let step_s = 1e-3;
    let model = rubbing("speed-o-cam", "load_bearing", 0.6, 0.05);
    let predictor = Predictor::new(&model, &model.values(), step_s).unwrap();
    let input = swinging(300, step_s);
    let run =
        |input: &[f64], start: Start<'_>| predictor.run(&[input], &[Intersample::Linear], start).unwrap();
    let whole = run(&input, Start::Equilibrium);
    let first = run(&input[..101], Start::Equilibrium);
    let second = run(&input[100..], Start::State(&first.end));
    let joined: Vec<Vec<f64>> =
        (first.outputs.iter().zip(&second.outputs)).map(|(a, b)| [&a[..100], &b[..]].concat()).collect();
    assert!(difference(&joined, &whole.outputs) < 1e-7);
}

/// Within the play of its gear nothing holds the load: at rest it hangs on one flank.
#[test]
fn a_weight_behind_a_backlash_has_a_state_of_rest() {
    let model = Model::builtin("speed-o-cam").unwrap();
    let model = model.with_effect("backlash", "mesh", &[("gap", 2e-3)]).unwrap();
    for weight in [0.5, -0.5] {
        let model = model.with_effect("constant_load", "load", &[("torque", weight)]).unwrap();
        let predictor = Predictor::new(&model, &model.values(), 1e-3).unwrap();
        let outputs =
            predictor.run(&[&[0.0; 50]], &[Intersample::Linear], Start::Equilibrium).unwrap().outputs;
        for (channel, values) in model.outputs().zip(&outputs) {
            let expected = match channel.name.as_str() {
                "output_speed" => 0.0,
                "torque_out" => weight,
                _ => weight / 8.0,
            };
            let off = values.iter().map(|value| (value - expected).abs()).fold(0.0, f64::max);
            assert!(off < 1e-7, "{}: {off}", channel.name);
        }
    }
}

#[test]
fn what_does_not_fit_is_refused() {
    let model = Model::builtin("speed-o-cam").unwrap();
    let values = model.values();
    assert!(Predictor::new(&model, &values, 0.0).is_err());
    let predictor = Predictor::new(&model, &values, 1e-3).unwrap();
    let run = |inputs: &[&[f64]], start: Start<'_>| {
        predictor.run(inputs, &[Intersample::BandLimited], start).map_err(|error| error.to_string())
    };
    assert!(run(&[&[1.0, 2.0]], Start::Equilibrium).is_ok());
    assert!(run(&[&[1.0], &[1.0]], Start::Equilibrium).unwrap_err().starts_with("2 inputs for the 1 of"));
    assert!(run(&[&[]], Start::Equilibrium).unwrap_err().contains("at least one"));
    assert!(run(&[&[1.0]], Start::State(&[0.0])).unwrap_err().contains("start state of 1"));
    assert!(run(&[&[1.0, f64::NAN]], Start::Equilibrium).is_err());
}
