//! The answer is as deep as the recordings go, and states what laws of one family share.

mod carriage;

use carriage::Carriage;
use socam_diagnose::document::{Diagnosis, Level};

/// Beside a damping of 25 N s/m.
fn diagnosed(friction: fn(f64) -> f64, noise_m_per_s: f64) -> Diagnosis {
    let resists = |_, speed: f64| 25.0 * speed + friction(speed);
    Carriage { resists: &resists, delay_s: 0.0, offset_m_per_s: 0.0, noise_m_per_s, seed: 77 }.diagnosed()
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
