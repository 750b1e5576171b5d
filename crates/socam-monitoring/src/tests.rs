//! Alarms after known changes of a two-mass bench, which the fast predictor simulates with noise.

use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use socam_identify::{Predictor, Start};
use socam_model::{Intersample, Model};
use socam_recording::{Channel, Dataset, Unit};

use std::sync::Arc;

use crate::{
    Alarm, Baseline, BlockSignals, Event, Judgement, Monitor, MonitorError, Overlay, Phase, Settings,
    Symptom, Verdict,
};

const STEP_S: f64 = 2e-3;
const NOISE_RAD_S: f64 = 0.05;

fn model() -> Model {
    Model::builtin("two-mass").unwrap()
}

fn channels() -> Vec<Channel> {
    let units = [("motor_torque", Unit::Nm), ("motor_speed", Unit::RadPerS), ("load_speed", Unit::RadPerS)];
    units.map(|(name, unit)| Channel::new(name, unit)).to_vec()
}

fn normal(random: &mut ChaCha8Rng) -> f64 {
    Distribution::<f64>::sample(&StandardNormal, random)
}

/// Recording of the bench over `duration_s` seconds; from the time `change.0`, s, the stiffness is multiplied by `change.1`.
fn bench(seed: u64, duration_s: f64, change: (f64, f64)) -> Dataset {
    let model = model();
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let rows = (duration_s / STEP_S) as usize;
    let mut smooth = 0.0;
    let torque: Vec<f64> = (0..rows)
        .map(|_| {
            smooth += 0.2 * (normal(&mut random) - smooth);
            smooth
        })
        .collect();
    let before = model.values();
    let mut after = before.clone();
    after[model.parameter("stiffness").unwrap()] *= change.1;
    let at = ((change.0 / STEP_S) as usize).clamp(1, rows - 1);
    let run = |values: &[f64], torque: &[f64], start: &[f64]| {
        let predictor = Predictor::new(&model, values, STEP_S).unwrap();
        predictor.run(&[torque], &[Intersample::Linear], Start::State(start)).unwrap()
    };
    let first = run(&before, &torque[..at], &[0.0; 3]);
    // The second run begins with the last sample of the first.
    let second = run(&after, &torque[at - 1..], &first.end);
    let outputs = first.outputs.iter().zip(&second.outputs).map(|(first, second)| {
        let all = first.iter().chain(&second[1..]);
        all.map(|value| value + NOISE_RAD_S * normal(&mut random)).collect::<Vec<f64>>()
    });
    let outputs: Vec<Vec<f64>> = outputs.collect();
    let time_s = (0..rows).map(|k| STEP_S * k as f64).collect();
    Dataset::from_columns("run", channels(), time_s, [vec![torque], outputs].concat()).unwrap()
}

fn baseline(settings: &Settings) -> Baseline {
    Baseline::of(&model(), &[bench(1, 60.0, (0.0, 1.0))], settings).unwrap()
}

fn watched(data: &Dataset, settings: Settings) -> (Vec<Event>, Monitor) {
    let mut monitor = Monitor::new(&model(), &channels(), Some(baseline(&settings)), settings).unwrap();
    let mut events = monitor.push_all(data).unwrap();
    events.extend(monitor.finish().unwrap());
    (events, monitor)
}

fn alarms(events: &[Event]) -> Vec<&Alarm> {
    let all = events.iter().map(|event| if let Event::Alarm(alarm) = event { Some(alarm) } else { None });
    all.flatten().collect()
}

#[test]
fn a_healthy_bench_raises_no_alarm() {
    let (events, monitor) = watched(&bench(2, 120.0, (0.0, 1.0)), Settings::default());
    assert_eq!(events, []);
    let overlay = monitor.overlay();
    assert_eq!((overlay.phase, overlay.not_judged), (Phase::Watching, 0));
    assert_eq!(overlay.judgement(), Judgement::AsUsual);
    let at_rest =
        |block: &Arc<BlockSignals>| Arc::new(BlockSignals { tests: Vec::new(), ..(**block).clone() });
    let resting = Overlay { blocks: overlay.blocks.iter().map(at_rest).collect(), ..overlay.clone() };
    assert_eq!(resting.judgement(), Judgement::NotJudgedNow);
    // The window bounds memory.
    assert_eq!(overlay.blocks.len(), 20);
    let block = &overlay.blocks[7];
    assert_eq!((block.measured.len(), block.model[1].len(), block.innovations[0].len()), (2, 250, 250));
    let power = block.innovations.iter().flatten().map(|v| v * v).sum::<f64>() / 500.0;
    assert!((power - 1.0).abs() < 0.3, "{power}");
    assert!(block.tests.len() == overlay.statistics.len() && block.tests.iter().all(|test| *test < 1.0));
}

#[test]
fn a_softer_shaft_is_seen_in_seconds_and_named() {
    let (events, monitor) = watched(&bench(3, 90.0, (60.0, 0.97)), Settings::default());
    let found = alarms(&events);
    assert_eq!(found.len(), 1, "{events:?}");
    assert!((60.0..66.0).contains(&found[0].time_s), "{found:?}");
    assert!((found[0].onset_s - 60.0).abs() < 1.5, "{found:?}");
    let Some(Event::Named(named)) = events.last() else { panic!("{events:?}") };
    let naming = named.naming.as_ref().unwrap();
    assert_ne!(naming.verdict, Verdict::Unnamed, "{naming:?}");
    let stiffness = naming.causes.iter().find(|cause| cause.location == "stiffness");
    let stiffness = stiffness.unwrap_or_else(|| panic!("{naming:?}"));
    let truth = 0.97 * model().values()[model().parameter("stiffness").unwrap()];
    assert!((stiffness.amplitude[0].1 / truth - 1.0).abs() < 0.03, "{naming:?} {truth}");
    assert_eq!(naming.causes[0].location, "stiffness", "{naming:?}");
    assert_eq!(monitor.overlay().phase, Phase::Alarmed);
    assert_eq!(monitor.overlay().alarms, std::slice::from_ref(named));
}

#[test]
fn a_change_that_passes_ends_its_alarm_and_the_next_one_is_a_new_alarm() {
    let soft = bench(4, 60.0, (0.0, 0.9));
    let well = bench(5, 60.0, (0.0, 1.0));
    let settings = Settings { learn_s: 60.0, ..Settings::default() };
    let mut monitor = Monitor::new(&model(), &channels(), None, settings).unwrap();
    let mut events = Vec::new();
    // Times go back between the recordings, which is a gap.
    for data in [&well, &soft, &bench(6, 60.0, (0.0, 1.0)), &soft] {
        events.extend(monitor.push_all(data).unwrap());
    }
    let numbers: Vec<usize> = alarms(&events).iter().map(|alarm| alarm.number).collect();
    assert_eq!(numbers, [1, 2], "{events:?}");
    assert!(matches!(events[0], Event::Learned(_)));
    assert!(events.iter().any(|event| matches!(event, Event::Returned { number: 1, .. })), "{events:?}");
}

#[test]
fn gaps_missing_readings_and_single_shocks_raise_no_alarm() {
    let loaded = bench(7, 60.0, (0.0, 1.0)).load_all().unwrap();
    let mut monitor =
        Monitor::new(&model(), &channels(), Some(baseline(&Settings::default())), Settings::default())
            .unwrap();
    let mut events = Vec::new();
    for (row, time_s) in loaded.time_s.iter().enumerate() {
        let mut values: Vec<f64> = loaded.columns.iter().map(|column| column.values()[row]).collect();
        match row {
            3000..3700 => continue,
            8000..8400 => values[2] = f64::NAN,
            12_000..12_300 => values[0] = f64::NAN,
            20_000..20_010 => values[1] += 5.0,
            _ => {}
        }
        events.extend(monitor.push(*time_s, &values).unwrap());
    }
    assert_eq!(events, []);
    assert!((1..=3).contains(&monitor.overlay().not_judged), "{}", monitor.overlay().not_judged);
}

#[test]
fn what_the_baseline_never_saw_is_not_judged() {
    let loaded = bench(8, 20.0, (0.0, 1.0)).load_all().unwrap();
    let columns = loaded.columns.iter().map(|column| column.values().iter().map(|v| 3.0 * v).collect());
    let louder = Dataset::from_columns("louder", channels(), loaded.time_s, columns.collect()).unwrap();
    let (events, monitor) = watched(&louder, Settings::default());
    assert_eq!((events, monitor.overlay().not_judged), (Vec::new(), 40));
    assert_eq!(monitor.overlay().judgement(), Judgement::NotJudged);
}

#[test]
fn each_slip_is_named() {
    let few = &channels()[..2];
    let refused = |channels: &[Channel], settings: Settings| {
        Monitor::new(&model(), channels, None, settings).map(drop).unwrap_err().to_string()
    };
    assert!(refused(few, Settings::default()).contains("reads load_speed_rad_s, which is not among"));
    let no_rate = Settings { false_alarms_per_hour: 0.0, ..Settings::default() };
    assert!(refused(&channels(), no_rate).contains("false alarms per hour cannot be 0"));
    let short = Baseline::of(&model(), &[bench(1, 3.0, (0.0, 1.0))], &Settings::default());
    assert!(matches!(short, Err(MonitorError::TooShort { usable: 6, .. })), "{short:?}");
}

#[test]
fn every_statistic_is_of_a_channel_or_a_free_parameter() {
    let baseline = baseline(&Settings::default());
    let monitor = Monitor::new(&model(), &channels(), Some(baseline), Settings::default()).unwrap();
    let statistics = monitor.overlay().statistics;
    let parameters = model().parameters.iter().filter(|parameter| !parameter.fixed).count();
    assert_eq!(statistics.len(), 4 + parameters);
    assert_eq!(statistics[3], Symptom::Power("load_speed".into()));
}
