//! Compares steps with the matrix exponential.

use super::*;
use socam_model::Model;

/// The reference is nalgebra's exponential of the augmented matrix.
#[test]
fn steps_of_all_lengths_are_exponentials() {
    let model = Model::builtin("speed-o-cam").unwrap();
    let mut equations = model.equations(&model.values()).unwrap();
    // A port at the last state, a speed, so that forces are mapped too.
    let n = equations.state.nrows();
    equations.force = DMatrix::from_fn(n, 1, |i, _| if i + 1 == n { 70.0 } else { 0.0 });
    equations.port = DMatrix::from_fn(1, n, |_, j| if j + 1 == n { 1.0 } else { 0.0 });
    equations.port_input = DMatrix::zeros(1, 1);
    equations.port_force = DMatrix::zeros(1, 1);
    let effect = socam_model::effects::find("coulomb_friction").unwrap();
    let (law, place) = (&effect.laws()[0], String::new());
    equations.ports = vec![socam_model::Port { effect, law, place, parameters: vec![0, 1], law_input: 0 }];
    let dimensions = Dimensions { states: n, inputs: 1, ports: 1, free: 0 };
    let step_s = 1e-3;
    let levels = levels(&equations, &[], SampleSteps::Even(step_s)).unwrap();
    for (index, level) in levels.iter().enumerate() {
        let h = step_s * 0.5_f64.powi(index as i32);
        // x' = A x + B u + H f, u' = u1, u1' = u2, f' = f1, f1' = f2, over unit time.
        let size = n + 6;
        let mut generator = DMatrix::zeros(size, size);
        generator.view_mut((0, 0), (n, n)).copy_from(&(&equations.state * h));
        generator.view_mut((0, n), (n, 1)).copy_from(&(&equations.input * h));
        generator.view_mut((0, n + 3), (n, 1)).copy_from(&(&equations.force * h));
        for k in [n, n + 1, n + 3, n + 4] {
            generator[(k, k + 1)] = 1.0;
        }
        let whole = generator.exp();
        // Derivatives at the start of the parabolas through unit values at their nodes.
        let starts = [[1.0, -3.0, 4.0], [0.0, 4.0, -8.0], [0.0, -1.0, 4.0]];
        for i in 0..n {
            let size = whole.row(i).amax();
            let got = |l: usize| level.rows[i * dimensions.width() + l];
            for l in 0..n {
                assert!((got(l) - whole[(i, l)]).abs() < 1e-9 * size, "level {index}: {i} {l}");
            }
            for (l, start) in starts.iter().cycle().take(6).enumerate() {
                let first = if l < 3 { n } else { n + 3 };
                let expected: f64 = start.iter().enumerate().map(|(k, s)| s * whole[(i, first + k)]).sum();
                assert!((got(n + l) - expected).abs() < 1e-9 * size, "level {index}: {i} drive {l}");
            }
        }
        // The port input is a speed state: at the end it equals that state, in the middle the state at the end of a step half as long.
        for l in 0..dimensions.width() {
            assert!(
                (level.rows[(n + 1) * dimensions.width() + l] - level.rows[(n - 1) * dimensions.width() + l])
                    .abs()
                    < 1e-12
            );
            if l < n && index + 1 < levels.len() {
                let further = levels[index + 1].rows[(n - 1) * dimensions.width() + l];
                assert!((level.rows[n * dimensions.width() + l] - further).abs() < 1e-12);
            }
        }
    }
}
