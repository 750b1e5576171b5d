//! Candidates of a model file, and a curve that becomes a law of the corrected one, on a carriage that this file integrates by Euler steps.

use socam_diagnose::{
    HeldOut, Options, diagnose,
    document::{Finding, ProofOutcome},
};
use socam_model::Model;
use socam_recording::{Channel, Dataset, Unit};

const MODEL: &str = r#"
schema = "socam.model/1"
name = "axis"
motion = "translation"

[parameters]
mass = { value = 10, unit = "kg", bounds = [1, 100] }
viscous = { value = 20, unit = "N s/m", bounds = [0, 1000] }
share = { value = 0.1, unit = "1", bounds = [0, 2], prior = { value = 0.3, std = 0.3 } }
width = { value = 1e-3, unit = "m/s", fixed = true }

[[nodes]]
name = "carriage"
inertia = "mass"

[[bearings]]
name = "guide"
at = "carriage"
damping = "viscous"

[[laws]]
name = "clamped"
at = "guide"
formula = "-share*clamp*tanh(speed/width)"
candidate = true

[channels.force]
role = "input"
quantity = "force"
at = "carriage"
[channels.clamp]
role = "input"
quantity = "signal"
at = "carriage"
column = "clamp_N"
[channels.speed]
role = "output"
quantity = "speed"
at = "carriage"
"#;

/// The force that is commanded, N.
fn commanded(pace: f64, t: f64) -> f64 {
    30.0 * ((9.0 + pace) * t).sin() + 20.0 * ((23.0 - pace) * t).sin()
}

fn clamp_force(pace: f64, t: f64) -> f64 {
    15.0 + 12.0 * ((2.3 + pace) * t).sin()
}

const ROWS: u32 = 400;
const SAMPLE_S: f64 = 5e-3;

/// 2 s of a carriage of 12 kg and 25 N s/m with a force `brake` (speed, clamp force, time); `pace` shifts the frequencies of the drive.
fn recording(name: &str, pace: f64, brake: impl Fn(f64, f64, f64) -> f64) -> Dataset {
    let mut speed = 0.0_f64;
    read(name, pace, |t| {
        let before = speed;
        for part in 0..100 {
            let t = t + 5e-5 * f64::from(part);
            speed +=
                5e-5 * (commanded(pace, t) - 25.0 * speed + brake(speed, clamp_force(pace, t), t)) / 12.0;
        }
        before
    })
}

/// A recording whose encoder reads `speed`, called with the time of each sample in turn, and a little noise.
fn read(name: &str, pace: f64, mut speed: impl FnMut(f64) -> f64) -> Dataset {
    let mut noise = 77 + (13.0 * pace) as u64;
    let mut time_s = Vec::new();
    let mut columns = vec![Vec::new(), Vec::new(), Vec::new()];
    for k in 0..ROWS {
        let t = SAMPLE_S * f64::from(k);
        noise = noise.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let read = speed(t) + 2e-3 * ((noise >> 11) as f64 / 2f64.powi(53) - 0.5);
        time_s.push(t);
        let row = [commanded(pace, t), clamp_force(pace, t), read];
        columns.iter_mut().zip(row).for_each(|(column, value)| column.push(value));
    }
    let channels = vec![
        Channel::new("force", Unit::N),
        Channel::new("clamp", Unit::N),
        Channel::new("speed", Unit::MPerS),
    ];
    Dataset::from_columns(name, channels, time_s, columns).unwrap()
}

fn recordings(brake: impl Fn(f64, f64) -> f64 + Copy) -> [Dataset; 4] {
    [("a", 0.0), ("b", 1.5), ("c", 3.0), ("d", 2.0)]
        .map(|(name, pace)| recording(name, pace, |speed, clamp, _| brake(speed, clamp)))
}

#[test]
fn a_candidate_of_the_file_is_found_by_its_name() {
    let model = Model::parse(MODEL).unwrap();
    let all = recordings(|speed, clamp| -0.3 * clamp * (speed / 1e-3).tanh());
    let (training, held_out) = all.split_at(3);
    let options = Options { most_effects: 1, ..Options::default() };
    let answer = diagnose(&model, training, HeldOut::in_memory(held_out), &options).unwrap();
    let found = &answer.diagnosis.findings[0];
    assert_eq!((found.effect.as_str(), found.location.as_str()), ("clamped", "guide"), "{found:?}");
    let share = found.parameters.iter().find(|own| own.name == "share").unwrap();
    assert!((share.value.unwrap() - 0.3).abs() < 0.02, "{share:?}");
    let corrected = Model::parse(&answer.model_toml).unwrap();
    let index = corrected.parameter("guide_clamped_share").unwrap();
    assert!((corrected.parameters[index].value - 0.3).abs() < 0.02);
    assert!(corrected.parameters[corrected.parameter("guide_clamped_width").unwrap()].fixed);
}

/// A drive whose force ends at 31 N with sharp corners.
#[test]
fn a_drive_that_gives_less_than_it_is_told_is_found_with_its_limit() {
    let model = Model::parse(&without_candidate()).unwrap();
    let all = [("a", 0.0), ("b", 1.5), ("c", 3.0), ("d", 2.0)].map(|(name, pace)| {
        recording(name, pace, |_, _, t| commanded(pace, t).clamp(-31.0, 31.0) - commanded(pace, t))
    });
    let (training, held_out) = all.split_at(3);
    let answer = diagnose(&model, training, HeldOut::in_memory(held_out), &Options::default()).unwrap();
    let [found] = &answer.diagnosis.findings[..] else { panic!("{:?}", answer.diagnosis.findings) };
    assert_eq!((found.effect.as_str(), found.location.as_str()), ("drive_limit", "force"));
    assert!(holds(found, "limit", 31.0), "{found:?}");
    assert_eq!(answer.diagnosis.held_out.as_ref().unwrap().outcome, ProofOutcome::Holds);
}

/// The carriage of 12 kg on a frame of 40 kg that swings at 7 Hz; force, guide and encoder stand on the frame. Integrated in coordinates of
/// the ground by Euler steps.
#[test]
fn a_mounting_that_gives_way_is_found_with_its_frequency() {
    let (frame_kg, stiffness, damping) = (40.0, 77_377.0, 90.0);
    let recorded = |(name, pace): (&str, f64)| {
        let (mut carriage, mut frame, mut displaced) = (0.0_f64, 0.0_f64, 0.0_f64);
        read(name, pace, |t| {
            let before = carriage - frame;
            for part in 0..500 {
                let between = commanded(pace, t + 1e-5 * f64::from(part)) - 25.0 * (carriage - frame);
                carriage += 1e-5 * between / 12.0;
                frame += 1e-5 * (-between - stiffness * displaced - damping * frame) / frame_kg;
                displaced += 1e-5 * frame;
            }
            before
        })
    };
    let model = Model::parse(&without_candidate()).unwrap();
    let all = [("a", 0.0), ("b", 5.0), ("c", 11.0), ("d", 8.0)].map(recorded);
    let (training, held_out) = all.split_at(3);
    let answer = diagnose(&model, training, HeldOut::in_memory(held_out), &Options::default()).unwrap();
    let [found] = &answer.diagnosis.findings[..] else { panic!("{:?}", answer.diagnosis.findings) };
    assert_eq!((found.effect.as_str(), found.location.as_str()), ("mounting_compliance", "carriage"));
    assert!(holds(found, "frequency", 7.0) && holds(found, "stiffness", stiffness), "{found:?}");
    assert_eq!(answer.diagnosis.held_out.as_ref().unwrap().outcome, ProofOutcome::Holds);
}

/// The model with a law that is always zero in the place of its candidate.
fn without_candidate() -> String {
    MODEL.replace("candidate = true\n", "").replace("-share*clamp*tanh(speed/width)", "0*share*clamp")
}

/// The diagnosis of a carriage with a `brake` (speed, time) that the catalogue lacks.
fn of(brake: impl Fn(f64, f64) -> f64 + Copy) -> (Finding, Model) {
    let model = Model::parse(&without_candidate()).unwrap();
    let all = [("a", 0.0), ("b", 1.5), ("c", 3.0), ("d", 2.0)]
        .map(|(name, pace)| recording(name, pace, |speed, _, t| brake(speed, t)));
    let (training, held_out) = all.split_at(3);
    let answer = diagnose(&model, training, HeldOut::in_memory(held_out), &Options::default()).unwrap();
    let found = answer.diagnosis.findings.iter().find(|finding| finding.curve.is_some());
    let found = found.unwrap_or_else(|| panic!("{:?}", answer.diagnosis.findings)).clone();
    assert!(answer.model_toml.contains("source = \"diagnosis\""));
    assert_eq!(answer.diagnosis.held_out.as_ref().unwrap().outcome, ProofOutcome::Holds);
    (found, Model::parse(&answer.model_toml).unwrap())
}

/// Whether the interval of a parameter holds its true value. Prints both, for docs/diagnosis-measured.md.
fn holds(found: &Finding, name: &str, truth: f64) -> bool {
    let own = found.parameters.iter().find(|own| own.name == name).unwrap_or_else(|| panic!("{found:?}"));
    let ([Some(low), Some(high)], Some(value)) = (own.ci95, own.value) else { panic!("{own:?}") };
    println!("{}: {name} {value:.4} [{low:.4}, {high:.4}], truth {truth}", found.equation);
    low < truth && truth < high && high - low < 0.5 * truth
}

#[test]
fn a_hump_of_drag_is_found_as_a_formula() {
    let hump = |speed: f64| 12.0 * (-((speed.abs() - 0.25) / 0.07).powi(2)).exp();
    let (found, corrected) = of(move |speed, _| -hump(speed) * (speed / 0.02).tanh());
    assert!(found.equation.ends_with("*exp(-((abs(speed) - peak)/spread)^2)"), "{}", found.equation);
    assert!(found.sentence.contains("corrected model file holds it as a law"), "{}", found.sentence);
    assert!(holds(&found, "peak", 0.25) && holds(&found, "spread", 0.07), "{:?}", found.parameters);
    // The curve is a rival, and far worse.
    assert!(
        found.formulas[0].formula == "curve" && found.formulas[0].less[0] > 100.0,
        "{:?}",
        found.formulas
    );
    let law = corrected.effects.iter().find(|used| used.effect.id == "unexplained").unwrap();
    assert_eq!(law.place, found.location);
    assert_eq!(law.effect.laws()[0].formula, found.equation);
}

#[test]
fn a_brake_that_fades_is_found_as_a_formula() {
    let (found, corrected) = of(|speed, t| -9.0 * (-t / 0.8).exp() * (speed / 2e-3).tanh());
    assert_eq!(found.equation, "-a*exp(-time/fall)*tanh(speed/transition)", "{found:?}");
    assert!(holds(&found, "a", 9.0) && holds(&found, "fall", 0.8), "{:?}", found.parameters);
    assert!(corrected.effects.iter().any(|used| used.effect.id == "unexplained"));
}

#[test]
fn a_curve_without_a_formula_stays_a_curve() {
    // Drag that steps up twice in one direction and once in the other.
    let steps = |v: f64| {
        let step = |at: f64| 1.0 + ((v.abs() - at) / 0.008).tanh();
        if v > 0.0 { 3.0 * step(0.07) + 5.0 * step(0.2) } else { 6.0 * step(0.14) }
    };
    let (found, corrected) = of(move |speed, _| -steps(speed) * (speed / 0.02).tanh());
    assert_eq!((found.equation.as_str(), found.formulas.len()), ("", 0), "{found:?}");
    assert!(found.sentence.contains("no formula that was tried follows it"), "{}", found.sentence);
    let law = corrected.effects.iter().find(|used| used.effect.id == "unexplained").unwrap();
    assert!(law.parameters.len() >= 8, "{}", law.parameters.len());
}
