use nalgebra::{Complex, DMatrix, DVector};

use super::*;
use crate::rational::Point;

const BENCH: Bench = Bench { cam_shaft: 1.287_502_2e-4, disk: 4.778_417_2e-3, load: 1.4752e-2, ratio: 8.0 };
const TRUTH: [f64; UNKNOWNS] = [69.3, 53.9, 52_485.0, 134.0, 0.02, 0.035, 0.11, 0.042];

/// Solution of the four equations of motion at one s, the load's angle per motor angle.
fn by_matrices(at: &[f64; UNKNOWNS], s: Complex<f64>) -> Complex<f64> {
    let [k1, k2, k3, k4, c2, c3, c4, c5] = *at;
    let n = BENCH.ratio;
    let m = DMatrix::from_diagonal(&DVector::from_vec(vec![
        0.0,
        BENCH.cam_shaft + BENCH.disk / (n * n),
        0.0,
        BENCH.load,
    ]));
    #[rustfmt::skip]
    let c = DMatrix::from_row_slice(4, 4, &[
        c2 + c3, -c3, 0.0, 0.0,
        -c3, c3, 0.0, 0.0,
        0.0, 0.0, c4, -c4,
        0.0, 0.0, -c4, c4 + c5,
    ]);
    #[rustfmt::skip]
    let k = DMatrix::from_row_slice(4, 4, &[
        k1 + k2, -k2, 0.0, 0.0,
        -k2, k2 + k3 / (n * n), -k3 / n, 0.0,
        0.0, -k3 / n, k3 + k4, -k4,
        0.0, 0.0, -k4, k4,
    ]);
    let pencil = m.map(Complex::from) * (s * s) + c.map(Complex::from) * s + k.map(Complex::from);
    let drive =
        DVector::from_vec(vec![s * c2 + k1, Complex::default(), Complex::default(), Complex::default()]);
    pencil.lu().solve(&drive).unwrap()[3]
}

#[test]
fn the_transfer_function_is_that_of_the_equations_of_motion() {
    for s in [Complex::new(0.0, 10.0), Complex::new(-3.0, 200.0), Complex::new(50.0, 3000.0)] {
        let (found, exact) = (BENCH.transfer(&TRUTH).at(s), by_matrices(&TRUTH, s));
        assert!((found - exact).norm() < 1e-9 * exact.norm(), "{found} {exact}");
    }
    assert!((BENCH.transfer(&TRUTH).final_value() - 0.125).abs() < 1e-12);
}

#[test]
fn slopes_are_those_of_differences() {
    let equations = BENCH.equations(&BENCH.transfer(&TRUTH));
    let at = TRUTH.map(|value| 1.2 * value);
    let exact = equations.slopes(&at);
    for i in 0..UNKNOWNS {
        let moved = |share: f64| {
            let mut there = at;
            there[i] *= 1.0 + share;
            equations.errors(&there)
        };
        let (up, down) = (moved(1e-5), moved(-1e-5));
        for row in 0..equations.count() {
            let difference = (up[row] - down[row]) / (2e-5 * at[i]);
            assert!(
                (difference - exact[row][i]).abs() < 1e-6 * (difference.abs() + 1e-3 / at[i]),
                "{row} {i}"
            );
        }
    }
}

/// The determined combinations, however far the start is.
#[test]
fn an_exact_transfer_function_gives_the_determined_combinations_back() {
    let exact = BENCH.transfer(&TRUTH);
    let equations = BENCH.equations(&exact);
    for factors in
        [[1.3; UNKNOWNS], [0.5, 1.6, 2.0, 0.7, 3.0, 0.4, 1.5, 0.6], [2.0, 0.6, 0.5, 1.5, 0.3, 2.0, 0.5, 2.0]]
    {
        let start = std::array::from_fn(|i| TRUTH[i] * factors[i]);
        let phi = equations.errors(&start);
        for weights in [
            phi.iter().map(|error| 1.0 / (error * error)).collect::<Vec<f64>>(),
            phi.iter().map(|error| 1.0 / error.abs()).collect(),
        ] {
            let found = solve(&equations, &weights, &start);
            for (found, truth) in combinations(&found.at).iter().zip(combinations(&TRUTH)) {
                assert!((found.value / truth.value - 1.0).abs() < 1e-6, "{found:?} {truth:?}");
            }
            assert!(found.converged && found.cost < 1e-20, "{found:?}");
            assert_eq!(found.gradient_check, None);
        }
    }
}

#[test]
fn a_direct_fit_says_what_the_response_does_not_determine() {
    let points: Vec<Point> = (0..120)
        .map(|i| {
            let frequency_hz = 0.5 * 200_f64.powf(f64::from(i) / 119.0);
            let output = by_matrices(&TRUTH, Complex::new(0.0, std::f64::consts::TAU * frequency_hz));
            Point {
                frequency_hz,
                input: Complex::new(1.0, 0.0),
                output,
                std: 1e-3 * output.norm(),
                freedom: f64::INFINITY,
            }
        })
        .collect();
    let found = direct(&BENCH, &points, &TRUTH.map(|value| 1.3 * value));
    let off = |value: f64, truth: f64, std: f64| (value / truth - 1.0).abs() / std;
    let series = combinations(&found.at)[0].value;
    assert!(off(series, combinations(&TRUTH)[0].value, found.series_relative_std) < 1.0, "{found:?}");
    assert!(off(found.at[3], TRUTH[3], found.relative_std[3]) < 1.0 && found.misfit < 0.1, "{found:?}");
    // The series stiffness is determined; either coupling alone and the pins are not.
    assert!(
        found.series_relative_std < 0.05 && found.relative_std[2] > 0.5 && found.relative_std[0] > 0.5,
        "{found:?}"
    );
}
