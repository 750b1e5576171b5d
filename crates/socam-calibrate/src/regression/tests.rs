use super::*;
use nalgebra::{DMatrix, DVector};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

fn line(seed: u64, outliers: usize) -> (DMatrix<f64>, DVector<f64>) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let design = DMatrix::from_fn(20, 2, |i, j| if j == 0 { 1.0 } else { i as f64 });
    let measured = DVector::from_fn(20, |i, _| {
        let noise: f64 = StandardNormal.sample(&mut random);
        3.0 + 0.5 * i as f64 + 0.1 * noise + if i < outliers { 4.0 } else { 0.0 }
    });
    (design, measured)
}

#[test]
fn outliers_are_named_and_do_not_count() {
    let (design, measured) = line(1, 5);
    let fitted = robust(&design, &measured).unwrap();
    assert_eq!(fitted.outliers, [0, 1, 2, 3, 4]);
    assert!((fitted.coefficients[1] - 0.5).abs() < 3.0 * fitted.std(1), "{fitted:?}");
    assert!((0.05..0.2).contains(&fitted.residual_std));
}

#[test]
fn clean_measurements_keep_their_rows_and_intervals_hold() {
    let (mut held, mut whole) = (0, 0);
    for seed in 0..400 {
        let (design, measured) = line(seed, 0);
        let fitted = robust(&design, &measured).unwrap();
        held += i32::from((fitted.coefficients[1] - 0.5).abs() < fitted.quantile() * fitted.std(1));
        whole += i32::from(fitted.outliers.is_empty());
    }
    assert!((364..=392).contains(&held), "{held} of 400");
    assert!(whole > 388, "{whole} of 400");
}

#[test]
fn knowledge_decides_where_the_rows_do_not() {
    let design = DMatrix::from_fn(30, 2, |i, _| i as f64);
    let measured = DVector::from_fn(30, |i, _| 2.0 * i as f64 + 0.01 * if i % 2 == 0 { 1.0 } else { -1.0 });
    assert!(with_knowledge(&design, &measured, &[None, None], 0).is_none());
    let fitted = with_knowledge(&design, &measured, &[Some((1.5, 0.1)), None], 0).unwrap();
    assert!((fitted.coefficients[0] - 1.5).abs() < 1e-6);
    assert!((fitted.coefficients[1] - 0.5).abs() < 1e-3);
    assert!((fitted.std(1) - 0.1).abs() < 1e-3);
    assert!(fitted.std_of(&[1.0, 1.0]) < 1e-3);
}

#[test]
fn a_row_that_decides_alone_is_no_better_than_those_about_it() {
    let mut held = 0;
    for seed in 0..400 {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let design = DMatrix::from_fn(40, 2, |i, j| f64::from(u8::from(j == 0 || i == 20)));
        let measured = DVector::from_fn(40, |_, _| StandardNormal.sample(&mut random));
        let fitted = with_knowledge(&design, &measured, &[None, None], 0).unwrap();
        let degrees = fitted.degrees_of(&[0.0, 1.0]);
        assert!((10.0..30.0).contains(&degrees), "{degrees}");
        held += i32::from(fitted.coefficients[1].abs() < quantile95(degrees) * fitted.std(1));
    }
    assert!((364..=396).contains(&held), "{held} of 400");
}
