//! Windings and differentials against closed forms.

use nalgebra::{Complex, Matrix2, Vector2};

use super::{assert_derivatives_are_differences, p};
use crate::Model;

const WRIST: &str = include_str!("../../../tests/wrist.toml");

#[test]
fn windings_and_differentials_follow_lagrange_and_kirchhoff() {
    let model = Model::parse(WRIST).unwrap();
    assert_eq!(model.warnings(), Vec::<String>::new());
    assert_derivatives_are_differences(&model, 1e-5);
    let [motor, roll, pitch] = ["J_motor", "J_roll", "J_pitch"].map(|name| p(&model, name));
    let [plus, minus, r, l] = ["plus", "minus", "R", "L"].map(|name| p(&model, name));
    let [kt, ke, c] = ["kt", "ke", "c_motor"].map(|name| p(&model, name));
    let equations = model.equations(&model.values()).unwrap();
    for hz in [0.5, 20.0, 400.0] {
        let s = Complex::new(0.0, hz * std::f64::consts::TAU);
        // Kinetic energy: rotors, roll = plus (left + right), pitch = plus left + minus right.
        let mass = Matrix2::new(
            motor + plus * plus * (roll + pitch),
            plus * plus * roll + plus * minus * pitch,
            plus * plus * roll + plus * minus * pitch,
            motor + plus * plus * roll + minus * minus * pitch,
        );
        let z = [Complex::from(r), r + s * l];
        let emf = [kt, ke];
        let impedance = Matrix2::from_fn(|i, j| {
            let own = if i == 0 { Complex::from(c) } else { Complex::ZERO };
            s * mass[(i, j)] + if i == j { own + kt * emf[i] / z[i] } else { Complex::ZERO }
        });
        for (input, volts) in [Vector2::new(1.0, 0.0), Vector2::new(0.0, 1.0)].into_iter().enumerate() {
            let torque = Vector2::from_fn(|i, _| kt * volts[i] / z[i]);
            let speed = impedance.lu().solve(&torque).unwrap();
            let current = [0, 1].map(|i| (volts[i] - emf[i] * speed[i]) / z[i]);
            let expected = [current[0], current[1], speed[0], plus * speed[0] + minus * speed[1]];
            for (output, expected) in expected.into_iter().enumerate() {
                let ours = equations.transfer(output, input, s).unwrap();
                assert!(
                    (ours - expected).norm() < 1e-9 * expected.norm(),
                    "{output} {input} {hz} Hz: {ours} {expected}"
                );
            }
        }
    }
}

#[test]
fn a_differential_that_cannot_move_and_a_quantity_at_the_wrong_place_are_refused() {
    let refused = |from: &str, to: &str| {
        assert!(WRIST.contains(from), "{from}");
        Model::parse(&WRIST.replacen(from, to, 1)).unwrap_err().to_string()
    };
    let loop_of_three = "from = [\"left\", \"roll\"]\nto = \"left\"";
    let found = refused("from = [\"left\", \"right\"]\nto = \"roll\"", loop_of_three);
    assert!(found.contains("line 30: roll_mix closes a rigid loop"), "{found}");
    let found =
        refused("quantity = \"voltage\"\nat = \"left_winding\"", "quantity = \"voltage\"\nat = \"left\"");
    assert!(found.contains("must be at one of the [[motors]]"), "{found}");
    let prescribed = "quantity = \"speed\"\nat = \"roll\"";
    let found = refused("quantity = \"voltage\"\nat = \"left_winding\"", prescribed);
    assert!(found.contains("which a differential moves"), "{found}");
    let speed = "quantity = \"speed\"\nat = \"left\"";
    let found = refused("quantity = \"voltage\"\nat = \"left_winding\"", speed);
    assert!(found.contains("roll_mix, pitch_mix couples the inertia"), "{found}");
    let found = refused("factors = [\"plus\", \"minus\"]", "factors = [\"plus\", \"kt\"]");
    assert!(found.contains("kt"), "{found}");
}
