//! `not_found` is a power: an effect of the size that it states is found by the diagnosis when it is there.

mod carriage;

use carriage::Carriage;
use socam_diagnose::document::{Diagnosis, NotFound};

/// What is concealed in the carriage: id in the catalogue, place, and parameter that measures it.
const CONCEALED: [(&str, &str, &str); 6] = [
    ("coulomb_friction", "guide", "torque"),
    ("quadratic_drag", "guide", "coefficient"),
    ("damping_drift", "guide", "rate"),
    ("constant_load", "carriage", "torque"),
    ("sensor_offset", "speed", "offset"),
    ("sensor_delay", "speed", "delay"),
];
/// Sizes as multiples of the smallest that is stated.
const MULTIPLES: [f64; 3] = [0.5, 1.0, 2.0];
/// Draws of the noise at each size.
const DRAWS: u64 = 3;

fn diagnosed((effect, size): (&str, f64), draw: u64) -> Diagnosis {
    let own = |id: &str| if id == effect { size } else { 0.0 };
    let resists = |t: f64, speed: f64| {
        25.0 * (1.0 + own("damping_drift") * t) * speed
            + own("coulomb_friction") * (speed / 2e-3).clamp(-1.0, 1.0)
            + own("quadratic_drag") * speed * speed.abs()
            + own("constant_load")
    };
    let carriage = Carriage {
        resists: &resists,
        delay_s: own("sensor_delay"),
        offset_m_per_s: own("sensor_offset"),
        noise_m_per_s: 2e-3,
        seed: 1000 * draw + 1,
    };
    carriage.diagnosed()
}

#[test]
fn what_is_said_to_be_detectable_is_found() {
    let nothing = diagnosed(("", 0.0), 0);
    assert!(nothing.findings.is_empty(), "{:?}", nothing.findings);
    let mut found = [0; MULTIPLES.len()];
    for (effect, place, parameter) in CONCEALED {
        let is_it = |own: &&NotFound| own.effect == effect && own.location == place;
        let stated = nothing.not_found.iter().find(is_it).unwrap_or_else(|| panic!("{effect}"));
        assert_eq!(stated.parameter, parameter);
        let smallest = stated.smallest_detectable.unwrap();
        print!("{effect}, from {smallest:.3e} {}:", stated.unit);
        for (index, multiple) in MULTIPLES.into_iter().enumerate() {
            let answers = (1..=DRAWS).map(|draw| diagnosed((effect, multiple * smallest), draw));
            let hits =
                answers.filter(|answer| answer.findings.iter().any(|own| own.location == place)).count();
            print!(" {multiple} times: {hits} of {DRAWS};");
            found[index] += hits;
        }
        println!();
    }
    let all = CONCEALED.len() * DRAWS as usize;
    println!("found at {MULTIPLES:?} times the smallest size: {found:?} of {all}");
    assert!(10 * found[1] >= 7 * all && 10 * found[2] >= 8 * all, "{found:?} of {all}");
}
