//! Equations of the embedded models against closed forms and finite differences.

use nalgebra::{Complex, DMatrix, DVector};

use crate::Model;

mod channels;
mod errors;
mod mixed;

/// Parameters of the thesis model by name.
fn p(model: &Model, name: &str) -> f64 {
    model.parameters[model.parameter(name).unwrap()].value
}

/// Eq. 3.10 with the sign of its s^3 term corrected (determinant expansion), highest power first.
fn thesis_polynomials(m: &Model, sign_of_s3: f64) -> (Vec<f64>, Vec<f64>) {
    let [k1, k2, k3, k4] = ["k1", "k2", "k3", "k4"].map(|name| p(m, name));
    let [c2, c3, c4, c5] = ["c2", "c3", "c4", "c5"].map(|name| p(m, name));
    let [j2, j3, j4, n] = ["J2", "J3", "J4", "N"].map(|name| p(m, name));
    let n2 = n * n;
    let numerator = [
        sign_of_s3 * c2 * c3 * c4,
        k1 * c3 * c4 + c2 * c3 * k4 + c2 * k2 * c4,
        k1 * c3 * k4 + k1 * k2 * c4 + c2 * k2 * k4,
        k1 * k2 * k4,
    ];
    let je = j2 * n2 + j3;
    // Eq. 3.10c to 3.10i, J2 N^2 + J3 gathered.
    let b = je * c4 * j4 * (c2 + c3);
    let c = je * j4 * (k4 * c2 + c3 * k3 + k2 * c4 + c3 * k4 + c4 * k1 + k3 * c2)
        + je * c4 * c5 * (c3 + c2)
        + c2 * c3 * n2 * c4 * j4;
    let d = je * (k4 * c2 * c5 + k3 * k1 * j4 + c4 * k1 * c5 + k3 * c2 * c4 + k3 * c2 * c5 + k4 * k1 * j4)
        + je * (k2 * k4 * j4 + c3 * k3 * c5 + c3 * k3 * c4 + k2 * k3 * j4 + k2 * c4 * c5 + c3 * k4 * c5)
        + k2 * n2 * c4 * c2 * j4
        + k3 * c4 * c2 * j4
        + c2 * c3 * n2 * (c4 * c5 + k4 * j4 + k3 * j4)
        + k1 * c3 * n2 * c4 * j4
        + c3 * k3 * c4 * j4;
    let e = je * (k4 * k1 * c5 + k3 * k1 * c5 + k3 * c2 * k4 + k3 * k1 * c4 + k2 * k4 * c5)
        + je * (k2 * k3 * c4 + k2 * k3 * c5 + c3 * k3 * k4)
        + k3 * c4 * c2 * c5
        + k3 * c4 * k1 * j4
        + k2 * n2 * c4 * c2 * c5
        + n2 * k4 * c2 * k2 * j4
        + k2 * n2 * c4 * k1 * j4
        + k3 * k4 * c2 * j4
        + n2 * k3 * c2 * k2 * j4
        + k1 * c3 * n2 * (k4 * j4 + k3 * j4 + c4 * c5)
        + k2 * k3 * c4 * j4
        + c3 * k3 * k4 * j4
        + c3 * k3 * c4 * c5
        + c2 * c3 * n2 * (k3 * c4 + k4 * c5 + k3 * c5);
    let f = je * k3 * k4 * (k1 + k2)
        + k2 * k3 * k4 * j4
        + k2 * k3 * c4 * c5
        + k1 * c3 * n2 * (k3 * c4 + k4 * c5 + k3 * c5)
        + n2 * k3 * c2 * k2 * c4
        + c2 * c3 * n2 * k3 * k4
        + n2 * k3 * k1 * k2 * j4
        + k3 * k4 * c2 * c5
        + n2 * k4 * c2 * k2 * c5
        + n2 * k4 * k1 * k2 * j4
        + k3 * c4 * k1 * c5
        + n2 * k3 * c2 * k2 * c5
        + k3 * k4 * k1 * j4
        + k2 * n2 * c4 * k1 * c5
        + c3 * k3 * k4 * c5;
    let g = n2 * k3 * c2 * k2 * k4
        + k2 * k3 * k4 * c5
        + n2 * k3 * k1 * k2 * c4
        + k3 * k4 * k1 * c5
        + k1 * c3 * n2 * k3 * k4
        + n2 * k4 * k1 * k2 * c5
        + n2 * k3 * k1 * k2 * c5;
    let h = k1 * k2 * k3 * k4 * n2;
    (numerator.map(|c| c * k3 * n).to_vec(), vec![b, c, d, e, f, g, h])
}

fn evaluate(polynomial: &[f64], s: Complex<f64>) -> Complex<f64> {
    polynomial.iter().fold(Complex::new(0.0, 0.0), |sum, c| sum * s + *c)
}

fn roots(monic: &[f64]) -> Vec<Complex<f64>> {
    let degree = monic.len() - 1;
    let companion = DMatrix::from_fn(degree, degree, |i, j| match (i, j) {
        (0, j) => -monic[j + 1] / monic[0],
        (i, j) if i == j + 1 => 1.0,
        _ => 0.0,
    });
    companion.complex_eigenvalues().iter().copied().collect()
}

#[test]
fn the_default_model_is_the_thesis_transfer_function_with_the_sign_corrected() {
    let model = Model::builtin("speed-o-cam").unwrap();
    let equations = model.equations(&model.values()).unwrap();
    let (numerator, denominator) = thesis_polynomials(&model, 1.0);
    let (printed, _) = thesis_polynomials(&model, -1.0);
    for hz in [0.0, 0.01, 1.0, 13.0, 20.0, 35.0, 134.9, 500.0, 3000.0] {
        let s = Complex::new(0.3, hz * std::f64::consts::TAU);
        let ours = equations.transfer(0, 0, s).unwrap();
        let thesis = evaluate(&numerator, s) / evaluate(&denominator, s);
        assert!((ours - thesis).norm() <= 1e-9 * thesis.norm(), "{hz} Hz: {ours} against {thesis}");
        let as_printed = evaluate(&printed, s) / evaluate(&denominator, s);
        if hz > 100.0 {
            assert!((ours - as_printed).norm() > 1e-4 * thesis.norm(), "the printed sign at {hz} Hz");
        }
    }
    assert!((equations.transfer(0, 0, Complex::new(0.0, 0.0)).unwrap().re - 0.125).abs() < 1e-12);
}

#[test]
fn an_output_or_input_that_the_model_lacks_has_no_transfer_function_and_no_zeros() {
    let model = Model::builtin("speed-o-cam").unwrap();
    let equations = model.equations(&model.values()).unwrap();
    let (outputs, inputs) = (model.outputs().count(), model.inputs().count());
    for (output, input) in [(outputs, 0), (0, inputs), (usize::MAX, usize::MAX)] {
        assert_eq!(equations.transfer(output, input, Complex::new(0.0, 1.0)), None);
        assert!(equations.zeros(output, input).is_empty());
    }
}

#[test]
fn poles_of_the_experimental_transfer_function_follow_from_its_coefficients() {
    // Thesis, section 4.1.1. Table 4.1 lists the frequencies of the factors; its first row is wrong (erratum 2).
    let mut poles = roots(&[1.0, 2056.0, 1.557e6, 5.165e8, 1.058e11, 1.443e13, 5.608e14]);
    poles.sort_by(|a, b| b.re.total_cmp(&a.re).then(a.im.total_cmp(&b.im)));
    // The denominator is printed to four digits, its factors to more: they agree to 1 in 2000.
    let printed = [
        (-57.25, 0.0),
        (-60.28, -211.73),
        (-60.28, 211.73),
        (-281.30, 0.0),
        (-798.44, -284.51),
        (-798.44, 284.51),
    ];
    for (pole, (re, im)) in poles.iter().zip(printed) {
        let expected = Complex::new(re, im);
        assert!((pole - expected).norm() < 5e-4 * expected.norm(), "{pole} against {expected}");
    }
}

/// Eq. 3.8 of the thesis solved in angles for a unit motor angle: output speed and both torques, each divided by the motor speed.
fn dynamic_stiffness(m: &Model, s: Complex<f64>) -> [Complex<f64>; 3] {
    let v = |name: &str| Complex::new(p(m, name), 0.0);
    let (n, zero) = (v("N"), Complex::new(0.0, 0.0));
    let (z1, z2, z4) = (v("k1") + v("c2") * s, v("k2") + v("c3") * s, v("k4") + v("c4") * s);
    let k3 = v("k3");
    let je = v("J2") + v("J3") / (n * n);
    let matrix = DMatrix::from_row_slice(
        4,
        4,
        &[
            z1 + z2,
            -z2,
            zero,
            zero,
            -z2,
            z2 + k3 / (n * n) + je * s * s,
            -k3 / n,
            zero,
            zero,
            -k3 / n,
            k3 + z4,
            -z4,
            zero,
            zero,
            -z4,
            z4 + v("c5") * s + v("J4") * s * s,
        ],
    );
    let q = matrix.lu().solve(&DVector::from_vec(vec![z1, zero, zero, zero])).unwrap();
    let one = Complex::new(1.0, 0.0);
    [q[3], z1 * (one - q[0]) / s, k3 * (q[1] / n - q[2]) / s]
}

#[test]
fn every_output_of_the_default_model_equals_the_equations_of_motion() {
    let model = Model::builtin("speed-o-cam").unwrap();
    let equations = model.equations(&model.values()).unwrap();
    for hz in [0.5, 7.0, 35.0, 150.0, 1000.0] {
        let s = Complex::new(0.0, hz * std::f64::consts::TAU);
        for (output, expected) in dynamic_stiffness(&model, s).into_iter().enumerate() {
            let ours = equations.transfer(output, 0, s).unwrap();
            assert!(
                (ours - expected).norm() < 1e-8 * expected.norm(),
                "output {output} at {hz} Hz: {ours}, {expected}"
            );
        }
    }
}

#[test]
fn two_mass_drive_has_its_textbook_resonance() {
    let mut model = Model::builtin("two-mass").unwrap();
    for parameter in &mut model.parameters {
        if parameter.name.ends_with("damping") {
            parameter.value = 0.0;
        }
    }
    let equations = model.equations(&model.values()).unwrap();
    let (jm, jl, k) = (p(&model, "motor_inertia"), p(&model, "load_inertia"), p(&model, "stiffness"));
    let expected = (k * (1.0 / jm + 1.0 / jl)).sqrt() / std::f64::consts::TAU;
    let modes = equations.modes();
    assert!((modes.last().unwrap().natural_frequency_hz / expected - 1.0).abs() < 1e-9, "{modes:?}");
    assert_eq!(equations.state_names, ["wind-up of load", "speed of motor", "speed of load"]);
}

/// Compares the derivatives of a model's equations by every parameter with central differences, within this share of the difference or of
/// 1e-5 of what the matrix would change by if it were proportional to the parameter.
pub(crate) fn assert_derivatives_are_differences(model: &Model, tolerance: f64) {
    let values = model.values();
    let all: Vec<usize> = (0..values.len()).collect();
    let (_, derivatives) = model.equations_with_derivatives(&values, &all).unwrap();
    for (index, derivative) in derivatives.iter().enumerate() {
        let step = 1e-6 * values[index].abs().max(1e-9);
        let shifted = |sign: f64| {
            let mut moved = values.clone();
            moved[index] += sign * step;
            model.equations(&moved).unwrap()
        };
        let (up, down) = (shifted(1.0), shifted(-1.0));
        for (matrix, plus, minus) in [
            (&derivative.state, &up.state, &down.state),
            (&derivative.input, &up.input, &down.input),
            (&derivative.force, &up.force, &down.force),
            (&derivative.output, &up.output, &down.output),
            (&derivative.feedthrough, &up.feedthrough, &down.feedthrough),
            (&derivative.port, &up.port, &down.port),
            (&derivative.port_force, &up.port_force, &down.port_force),
            (&derivative.force_output, &up.force_output, &down.force_output),
        ] {
            let difference = (plus - minus) / (2.0 * step);
            let scale = difference.amax().max(1e-5 * plus.amax() / values[index].abs());
            assert!(
                (matrix - &difference).amax() <= tolerance * scale + 1e-12,
                "{}, {}: {matrix} against {difference}",
                model.name,
                model.parameters[index].name
            );
        }
    }
}

#[test]
fn derivatives_agree_with_differences() {
    for (name, _) in crate::BUILTIN {
        assert_derivatives_are_differences(&Model::builtin(name).unwrap(), 1e-5);
    }
}

#[test]
fn the_rigid_ratio_follows_gears_couplings_and_shafts() {
    let bench = Model::builtin("speed-o-cam").unwrap();
    // Through two couplings, the reducer, a third coupling and a rigid shaft.
    assert_eq!(bench.rigid_ratio("motor", "load"), Some(8.0));
    assert_eq!(bench.rigid_ratio("load", "motor"), Some(0.125));
    assert_eq!(bench.rigid_ratio("disk", "load"), Some(1.0));
    assert_eq!(bench.rigid_ratio("motor", "attic"), None);
    assert_eq!(Model::builtin("two-mass").unwrap().rigid_ratio("load", "motor"), Some(1.0));
    // A node that a spring holds to the ground does not turn.
    let anchor =
        "[[springs]]\nname = \"anchor\"\nfrom = \"load\"\nto = \"ground\"\nstiffness = \"k4\"\n\n[[gears]]";
    let anchored = Model::parse(&bench.text.replacen("[[gears]]", anchor, 1)).unwrap();
    assert_eq!(anchored.rigid_ratio("motor", "load"), None);
}

#[test]
fn the_gain_at_a_zero_is_small() {
    let model = Model::builtin("two-mass").unwrap();
    let e = model.equations(&model.values()).unwrap();
    let [k, load] = ["stiffness", "load_inertia"].map(|name| p(&model, name));
    // The zeros are at the natural frequency of the load on the shaft with the motor held.
    let zeros = e.zeros(0, 0);
    let expected = (k / load).sqrt();
    assert_eq!(zeros.len(), 2, "{zeros:?}");
    assert!(zeros.iter().all(|zero| (zero.norm() / expected - 1.0).abs() < 1e-6), "{zeros:?} {expected}");
    for (name, _) in crate::BUILTIN {
        let model = Model::builtin(name).unwrap();
        let e = model.equations(&model.values()).unwrap();
        for output in 0..e.output.nrows() {
            for zero in e.zeros(output, 0) {
                let through = |s| e.transfer(output, 0, s).unwrap().norm();
                assert!(through(zero) < 1e-3 * through(zero * 1.1 + 1e-3), "{name} {output} {zero}");
            }
        }
    }
}
