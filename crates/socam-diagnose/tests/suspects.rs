//! What a fit says of effects that its model leaves out, on a motor with dry friction.

use socam_diagnose::suspects;
use socam_identify::{Identification, Options, Problem, output_error};
use socam_model::Model;
use socam_recording::Dataset;

mod motor;
use motor::{TRUTH, recording, sized};

fn model() -> Model {
    sized([1.0; 3])
}

fn fitted(data: &[Dataset]) -> Identification {
    output_error(&Problem::new(&model(), data, Options::default()).unwrap()).unwrap()
}

/// Whether the interval of a parameter holds its true value; `None` without an interval.
fn holds(found: &Identification, index: usize) -> Option<bool> {
    let [low, high] = found.parameters[index].ci95;
    Some((low?..=high?).contains(&TRUTH[index]))
}

#[test]
fn intervals_hold_what_missing_friction_does_to_the_damping() {
    for seed in 1..4 {
        let data = [recording(seed, 0.2)];
        let mut found = fitted(&data);
        assert_eq!(holds(&found, 1), Some(false), "without the allowance: {:?}", found.parameters);
        let suspected = suspects(&model(), &data, &found, &Options::default()).unwrap();
        let friction = suspected.iter().find(|one| one.effect == "coulomb_friction").expect("suspected");
        let (_, damping) = friction.moves.iter().find(|(name, _)| name == "damping").unwrap();
        let error = damping.to - TRUTH[1];
        assert!(error.abs() < 0.35 * (damping.to - damping.from).abs(), "{damping:?}, off by {error}");
        found.allow_for(&model(), suspected);
        assert_ne!(holds(&found, 0), Some(false), "{:?}", found.parameters);
        assert_ne!(holds(&found, 1), Some(false), "{:?}", found.parameters);
        assert!(found.warnings.last().unwrap().contains("looks most like"), "{:?}", found.warnings);
    }
}

/// Friction of a thousandth of the torque is hidden by the noise of a sample, and moves the damping out of its interval.
#[test]
fn intervals_hold_what_friction_below_the_noise_does() {
    let (mut moved, mut held) = (0, 0);
    for seed in 11..21 {
        let data = [recording(seed, 2e-3)];
        let mut found = fitted(&data);
        assert!(found.explains(), "{:?}", found.verdict);
        moved += usize::from(holds(&found, 1) == Some(false));
        let suspected = suspects(&model(), &data, &found, &Options::default()).unwrap();
        found.allow_for(&model(), suspected);
        held += usize::from(holds(&found, 1) != Some(false));
    }
    assert!(moved >= 5 && held >= 9, "{moved} moved, {held} held of 10");
}

#[test]
fn a_complete_model_is_not_suspected() {
    let data = [recording(7, 0.0)];
    let suspected = suspects(&model(), &data, &fitted(&data), &Options::default()).unwrap();
    assert!(suspected.is_empty(), "{suspected:?}");
}
