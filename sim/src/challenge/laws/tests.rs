use super::*;

/// Every law with parameters, borrowed ones included, and points that it may see.
fn all() -> Vec<(&'static Effect, Vec<f64>)> {
    vec![
        (&BRISTLES, vec![0.3, 0.5, 0.7, 2e-3]),
        (&DRAG, vec![3e-3, 0.4]),
        (&DIRECTION, vec![0.2, -0.01]),
        (&HARDENING, vec![900.0, 8e4, 110.0]),
        (&LOSS, vec![0.1]),
        (&CONTACT, vec![2e-3, 5e5, 0.5, 1e6, 100.0]),
        (&SLIDER, vec![12.0, 0.01]),
        (&SLIP, vec![0.8, 71.0]),
        (&outside::EDDY_CURRENT_BRAKE, vec![0.3, 5.0]),
        (&outside::LATE_PAD, vec![0.3, 5.0]),
        (&outside::ANGLE_PLAY, vec![4e-3, 0.4, 1e6, 100.0]),
        (&outside::ANGLE_DRAG, vec![0.3, 1.0]),
        (&outside::LOOSENING, vec![0.3, 5.0, 71.0]),
        (&outside::GAIN_DRIFT, vec![0.02]),
        (&outside::WEARING_IN, vec![0.3, 40.0]),
    ]
}

/// What a sight may be, small and large, on both sides of zero.
fn seen(sight: Sight) -> [f64; 3] {
    match sight {
        Sight::Speed => [-3.0, 0.013, 9.0],
        Sight::Twist => [-2.1e-3, 4e-4, 1.3e-3],
        Sight::TwistRate => [-0.7, 0.02, 1.9],
        Sight::Torque | Sight::Reading | Sight::Change => [-2.0, 0.013, 5.0],
        Sight::Angle => [-70.0, 0.3, 31.0],
        Sight::Time => [1.0, 5.01, 9.0],
        Sight::State => [-6e-4, 1e-4, 5e-3],
    }
}

#[test]
fn slopes_are_exact() {
    for (effect, parameters) in all() {
        for (number, law) in effect.laws().iter().enumerate() {
            let count = law.sights.len();
            for point in 0..3usize.pow(count as u32) {
                let at: Vec<f64> =
                    (0..count).map(|k| seen(law.sights[k])[point / 3usize.pow(k as u32) % 3]).collect();
                let here = (law.answer)(&at, &parameters);
                for k in 0..count {
                    let step = 1e-6 * at[k].abs();
                    let moved = |by: f64| {
                        let mut moved = at.clone();
                        moved[k] += by;
                        (law.answer)(&moved, &parameters).torque
                    };
                    let slope = (moved(step) - moved(-step)) / (2.0 * step);
                    let scale =
                        slope.abs().max(here.slopes[k].abs()).max(here.torque.abs() * 1e-3 / at[k].abs());
                    let error = (slope - here.slopes[k]).abs();
                    assert!(
                        error <= 1e-4 * scale,
                        "{} law {number} at {at:?} by {k}: {slope} {here:?}",
                        effect.id
                    );
                }
            }
        }
    }
}

#[test]
fn sliders_add_up_to_the_catalogues_curve() {
    let (torque, deflection) = (0.4, 0.01);
    let carried = |twist: f64| sliders(torque, deflection).map(|[k, most]| k * twist.min(most)).sum::<f64>();
    for share in [0.2, 0.5, 1.0, 1.8, 3.5] {
        let wanted = torque * (1.0 - f64::exp(-share));
        assert!((carried(share * deflection) / wanted - 1.0).abs() < 1e-9, "{share}");
    }
    assert!(sliders(torque, deflection).all(|[k, _]| k > 0.0));
}
