use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
use rand_distr::{Distribution, Normal};

use super::*;
use crate::response::Line;
use nalgebra::Complex;

/// The thesis' transfer function, section 4.1.1.
fn thesis() -> TransferFunction {
    TransferFunction {
        numerator: vec![7.022e13, 1.239e12, 8.027e9, -1.685e7, -16360.0, -72.47],
        denominator: vec![5.608e14, 1.443e13, 1.058e11, 5.165e8, 1.557e6, 2056.0, 1.0],
    }
}

fn points(of: &TransferFunction, relative: f64, seed: u64) -> Vec<Point> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let normal = Normal::new(0.0, 0.5_f64.sqrt()).unwrap();
    (0..250)
        .map(|i| {
            let frequency_hz = 0.3 * 1000_f64.powf(f64::from(i) / 249.0);
            let exact = of.response(frequency_hz);
            let std = relative * exact.norm();
            let error = Complex::new(normal.sample(&mut random), normal.sample(&mut random)) * std;
            Point {
                frequency_hz,
                input: Complex::new(1.0, 0.0),
                output: exact + error,
                std: std.max(1e-12),
                freedom: f64::INFINITY,
            }
        })
        .collect()
}

#[test]
fn an_exact_response_gives_its_transfer_function_back() {
    let orders = Orders { numerator: 5, denominator: 6 };
    let fit = fit(&points(&thesis(), 0.0, 1), orders, false).unwrap();
    let pairs = fit.transfer.numerator.iter().chain(&fit.transfer.denominator);
    for (found, exact) in pairs.zip(thesis().numerator.iter().chain(&thesis().denominator)) {
        assert!((found / exact - 1.0).abs() < 1e-6, "{found} {exact}");
    }
    assert!(fit.converged && (fit.transfer.final_value() - 0.125_213_98).abs() < 1e-8);
}

#[test]
fn deviations_are_as_large_as_said_and_the_orders_are_advised() {
    let resonance = TransferFunction { numerator: vec![5e4, 30.0], denominator: vec![4e4, 20.0, 1.0] };
    let orders = Orders { numerator: 1, denominator: 2 };
    let mut squares = [0.0; 5];
    for seed in 0..60 {
        let fit = fit(&points(&resonance, 0.02, seed), orders, false).unwrap();
        let mode = fit.modes[0];
        squares[0] += ((mode.mode.natural_frequency_hz - 200.0 / std::f64::consts::TAU)
            / mode.frequency_std_hz)
            .powi(2);
        squares[1] += ((mode.mode.damping_ratio - 0.05) / mode.damping_std).powi(2);
        squares[2] += ((fit.transfer.final_value() - 1.25) / fit.final_value_std).powi(2);
        // The frequency is on the flank of the resonance.
        let ratio = fit.transfer.response(35.0) / resonance.response(35.0);
        let [magnitude, phase] = fit.response_std(35.0);
        squares[3] += (ratio.norm().ln() / magnitude).powi(2);
        squares[4] += (ratio.arg() / phase).powi(2);
    }
    // The mean of 60 squares of unit normals.
    assert!(squares.iter().all(|sum| (0.5..=1.6).contains(&(sum / 60.0))), "{squares:?}");
    let advised = advise(&points(&resonance, 0.02, 7), 4, false);
    assert_eq!(advised[0].orders, orders);
}

#[test]
fn deviations_are_as_large_as_said_where_noise_is_known_from_little() {
    let resonance = TransferFunction { numerator: vec![5e4, 30.0], denominator: vec![4e4, 20.0, 1.0] };
    let orders = Orders { numerator: 1, denominator: 2 };
    let freedom = 5;
    let count = 400;
    let normal = Normal::new(0.0, 0.5_f64.sqrt()).unwrap();
    let mut squares = 0.0;
    for seed in 0..count {
        let mut random = ChaCha8Rng::seed_from_u64(1000 + seed);
        let mut share = || {
            let one = |random: &mut ChaCha8Rng| normal.sample(random).powi(2) + normal.sample(random).powi(2);
            (0..freedom).map(|_| one(&mut random)).sum::<f64>() / f64::from(freedom)
        };
        let seen: Vec<Point> = points(&resonance, 0.02, seed)
            .iter()
            .map(|point| {
                Point::from(&Line {
                    frequency_hz: point.frequency_hz,
                    response: point.output,
                    variance: point.std.powi(2) * share(),
                    freedom: f64::from(freedom),
                    width_hz: 0.0,
                    coherence: 1.0,
                })
            })
            .collect();
        let fit = fit(&seen, orders, false).unwrap();
        squares += ((fit.transfer.final_value() - 1.25) / fit.final_value_std).powi(2);
    }
    // Were the noise taken as known, it would be 4/3.
    let mean = squares / count as f64;
    assert!((0.83..1.17).contains(&mean), "{mean}");
}

#[test]
fn a_stable_fit_has_stable_poles_and_is_as_good_as_there_is() {
    let mut unstable =
        points(&TransferFunction { numerator: vec![1e4], denominator: vec![1e4, -10.0, 1.0] }, 0.0, 1);
    unstable.iter_mut().for_each(|point| point.std = 0.01);
    let orders = Orders { numerator: 1, denominator: 2 };
    let free = fit(&unstable, orders, false).unwrap();
    assert!(free.transfer.poles().iter().all(|pole| pole.re > 0.0) && free.misfit < 1e-6);
    let held = fit(&unstable, orders, true).unwrap();
    assert!(held.transfer.poles().iter().all(|pole| pole.re < 0.0) && held.misfit > 1.0);
    let same = fit(&points(&thesis(), 0.01, 2), Orders { numerator: 5, denominator: 6 }, true).unwrap();
    assert!((0.6..1.5).contains(&same.misfit), "{}", same.misfit);
    assert!(fit(&unstable, Orders { numerator: 3, denominator: 2 }, false).is_err());
}

#[test]
fn too_many_orders_say_of_the_response_what_enough_say() {
    let resonance = TransferFunction { numerator: vec![5e4, 30.0], denominator: vec![4e4, 20.0, 1.0] };
    let noisy = points(&resonance, 0.02, 3);
    let enough = fit(&noisy, Orders { numerator: 1, denominator: 2 }, false).unwrap();
    let too_many = fit(&noisy, Orders { numerator: 2, denominator: 4 }, false).unwrap();
    let stds = [enough.response_std(35.0), too_many.response_std(35.0)];
    for (few, many) in stds[0].iter().zip(stds[1]) {
        assert!((*few..5.0 * few).contains(&many), "{stds:?}");
    }
    // Rivals only widen.
    let advised = advise(&noisy, 4, false);
    let [alone, among] = [advised[0].response_std(35.0), response_std_among(&advised, 35.0)];
    assert!(among.iter().zip(alone).all(|(among, alone)| *among >= 0.8 * alone), "{alone:?} {among:?}");
}
