//! `not_found` is a power: an effect of the size that it states is found by the diagnosis when it is there.

use std::error::Error;

use socam_diagnose::document::Diagnosis;
use socam_diagnose::{HeldOut, Options, diagnose};
use socam_model::Model;
use socam_recording::{Channel, Dataset, Unit};

fn bench() -> Result<(Model, [Dataset; 4]), Box<dyn Error>> {
    Ok(include!("doc/axis.rs"))
}

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

/// Three recordings of the carriage with an effect of a size, by Euler steps of 50 us, sampled every 2 ms with a noise of 2 mm/s.
fn recorded((effect, size): (&str, f64), draw: u64) -> Vec<Dataset> {
    let own = |id: &str| if id == effect { size } else { 0.0 };
    let (delay_s, offset) = (own("sensor_delay"), own("sensor_offset"));
    let record = |number: u64| {
        let (mut speed, mut random) = (0.0_f64, 1000 * draw + number + 1);
        let (mut time_s, mut forces, mut course, mut speeds) =
            (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let pace = 1.3 * number as f64;
        let force = |t: f64| 30.0 * ((7.0 + pace) * t).sin() + 20.0 * ((19.0 - pace) * t).sin();
        for k in 0..1200 {
            let t = 0.002 * f64::from(k);
            let mut scatter = 0.0;
            for _ in 0..4 {
                random = random.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
                scatter += (random >> 11) as f64 / 2f64.powi(53) - 0.5;
            }
            time_s.push(t);
            forces.push(force(t));
            let late = (delay_s / 5e-5).round() as usize;
            course.push(speed);
            let delayed = course[(course.len() - 1).saturating_sub(late)];
            speeds.push(delayed + offset + 2e-3 * 3f64.sqrt() * scatter);
            for part in 0..40 {
                let now = t + 5e-5 * f64::from(part);
                let resists = 25.0 * (1.0 + own("damping_drift") * now) * speed
                    + own("coulomb_friction") * (speed / 2e-3).clamp(-1.0, 1.0)
                    + own("quadratic_drag") * speed * speed.abs();
                speed += 5e-5 * (force(now) - resists - own("constant_load")) / 12.0;
                course.push(speed);
            }
        }
        let channels = vec![Channel::new("force", Unit::N), Channel::new("speed", Unit::MPerS)];
        Dataset::from_columns(format!("run {number}"), channels, time_s, vec![forces, speeds]).unwrap()
    };
    (0..3).map(record).collect()
}

fn diagnosed(concealed: (&str, f64), draw: u64) -> Diagnosis {
    let (model, _) = bench().unwrap();
    let recordings = recorded(concealed, draw);
    diagnose(&model, &recordings, HeldOut::none(), &Options::default()).unwrap().diagnosis
}

#[test]
fn what_is_said_to_be_detectable_is_found() {
    let nothing = diagnosed(("", 0.0), 0);
    assert!(nothing.findings.is_empty(), "{:?}", nothing.findings);
    let mut found = [0; MULTIPLES.len()];
    for (effect, place, parameter) in CONCEALED {
        let is_it = |own: &&socam_diagnose::document::NotFound| own.effect == effect && own.location == place;
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
