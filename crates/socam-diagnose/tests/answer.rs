//! The answer is as deep as the recordings go, and states what laws of one family share.

use std::error::Error;

use socam_diagnose::document::{Diagnosis, Level};
use socam_diagnose::{HeldOut, Options, diagnose};
use socam_model::Model;
use socam_recording::{Channel, Dataset, Unit};

fn bench() -> Result<(Model, [Dataset; 4]), Box<dyn Error>> {
    Ok(include!("doc/axis.rs"))
}

/// The carriage of the documentation with a friction (N by m/s) of one's own beside a damping of 25 N s/m, by Euler steps of 50 us,
/// sampled every 2 ms.
fn recorded(friction: fn(f64) -> f64, noise_m_per_s: f64) -> Vec<Dataset> {
    let record = |number: u64| {
        let (mut speed, mut random) = (0.0_f64, 77 + number);
        let (mut time_s, mut forces, mut speeds) = (Vec::new(), Vec::new(), Vec::new());
        let pace = 1.3 * number as f64;
        for k in 0..1200 {
            let t = 0.002 * f64::from(k);
            let force = |t: f64| 30.0 * ((7.0 + pace) * t).sin() + 20.0 * ((19.0 - pace) * t).sin();
            // The sum of four uniform numbers.
            let mut scatter = 0.0;
            for _ in 0..4 {
                random = random.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
                scatter += (random >> 11) as f64 / 2f64.powi(53) - 0.5;
            }
            time_s.push(t);
            forces.push(force(t));
            speeds.push(speed + noise_m_per_s * 3f64.sqrt() * scatter);
            for part in 0..40 {
                speed += 5e-5 * (force(t + 5e-5 * f64::from(part)) - 25.0 * speed - friction(speed)) / 12.0;
            }
        }
        let channels = vec![Channel::new("force", Unit::N), Channel::new("speed", Unit::MPerS)];
        Dataset::from_columns(format!("run {number}"), channels, time_s, vec![forces, speeds]).unwrap()
    };
    (0..3).map(record).collect()
}

fn diagnosed(friction: fn(f64) -> f64, noise_m_per_s: f64) -> Diagnosis {
    let (model, _) = bench().unwrap();
    let recordings = recorded(friction, noise_m_per_s);
    diagnose(&model, &recordings, HeldOut::none(), &Options::default()).unwrap().diagnosis
}

fn plain(speed: f64) -> f64 {
    5.0 * (speed / 2e-3).clamp(-1.0, 1.0)
}

fn falling(speed: f64) -> f64 {
    plain(speed) * (1.0 + 0.6 / (1.0 + (speed / 0.08).powi(2)))
}

fn bent(speed: f64) -> f64 {
    6.0 * std::f64::consts::FRAC_2_PI * (speed / 4e-3).atan() + 3.0 * speed.powi(2) * speed.signum()
}

/// Each friction is written by another formula than the catalogue's. Whatever law the recordings lead to, the drag at three speeds is that of
/// the truth, and the family at the guide is in the answer.
#[test]
fn the_drag_is_right_whatever_the_law_is_called() {
    type Case = (fn(f64) -> f64, f64);
    let frictions: [Case; 4] = [(plain, 2e-3), (falling, 2e-3), (falling, 2e-2), (bent, 2e-3)];
    for (number, (friction, noise)) in frictions.into_iter().enumerate() {
        let answer = diagnosed(friction, noise);
        let finding = answer.findings.iter().find(|finding| !finding.drag.is_empty());
        let finding = finding.unwrap_or_else(|| panic!("friction {number}: {:?}", answer.findings));
        let named = answer.findings.iter().map(|own| format!("{}@{}", own.effect, own.location));
        println!(
            "friction {number}: {:?}, found {:?}",
            answer.answer.iter().map(|own| &own.node).collect::<Vec<_>>(),
            named.collect::<Vec<_>>()
        );
        for drag in &finding.drag {
            let truth = 25.0 * drag.speed + friction(drag.speed);
            let [low, high] = drag.ci95.map(Option::unwrap);
            println!("  {}: {truth:.3} N, {low:.3} to {high:.3}", drag.name());
            assert!((low..=high).contains(&truth), "friction {number}: {truth} N, {drag:?}");
            assert!(high - low < 0.4 * truth, "friction {number}: {drag:?}");
        }
        let is_right = |node: &str| node.ends_with("friction@guide") || node == "machine@guide";
        assert!(
            answer.answer.iter().any(|node| is_right(&node.node)),
            "friction {number}: {:?}",
            answer.answer
        );
        let most = answer
            .answer
            .iter()
            .filter(|node| node.finding == Some(1))
            .map(|node| node.probability)
            .sum::<f64>();
        assert!(most > 0.0 && most <= 1.0 + 1e-9);
    }
}

#[test]
fn nothing_missing_is_a_node_too() {
    let answer = diagnosed(|_| 0.0, 2e-3).answer;
    let nodes: Vec<_> = answer.iter().map(|node| (node.node.as_str(), node.level, node.finding)).collect();
    assert_eq!(nodes, [("none", Level::Side, None)]);
}
