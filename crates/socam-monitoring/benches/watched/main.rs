//! Measures the false alarm rate of the monitoring and its delay after changes in mid-run, on random virtual benches that differ from their
//! model and have partly coloured noise.
//!
//! `cargo bench -p socam-monitoring --bench watched -- --hours 10 --seed 101 --seeds 5` prints both tables.

mod bench;

use bench::{Bench, Change};
use clap::Parser;
use rayon::prelude::*;
use socam_monitoring::{Alarm, Baseline, Event, Monitor, Settings, Verdict};

#[derive(Debug, Parser)]
struct Args {
    /// Simulated hours of healthy benches; 0 leaves them out
    #[arg(long, default_value_t = 10.0)]
    hours: f64,
    /// Length of a run of a healthy bench, min
    #[arg(long, default_value_t = 15.0)]
    minutes: f64,
    /// Stated rate of false alarms, 1/h
    #[arg(long, default_value_t = 0.5)]
    rate: f64,
    /// Length of the baseline, s
    #[arg(long, default_value_t = 120.0)]
    baseline_s: f64,
    /// Benches of each effect and size; 0 leaves them out
    #[arg(long, default_value_t = 5)]
    seeds: u64,
    /// Another number, other benches
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// One line for each alarm
    #[arg(long)]
    list: bool,
    /// Cargo says so to every benchmark
    #[arg(long, hide = true)]
    bench: bool,
}

/// Time of the change, and of the run after it, s.
const BEGINS_S: f64 = 15.0;
const AFTER_S: f64 = 30.0;
/// Alarms this much before the change, s, are false: the time of the change counts from the enabling of the drive.
const TOLERANCE_S: f64 = 0.6;

/// Name, place, what is right, and four sizes.
struct Scenario {
    effect: &'static str,
    place: &'static str,
    sizes: [f64; 4],
    change: fn(f64) -> Change,
}

const SCENARIOS: [Scenario; 5] = [
    Scenario {
        effect: "coulomb_friction",
        place: "load_bearing",
        sizes: [0.003, 0.01, 0.03, 0.1],
        change: |size| Change::Effect(format!("coulomb_friction@load_bearing:torque={size}")),
    },
    Scenario {
        effect: "parameter",
        place: "k4",
        sizes: [0.99, 0.97, 0.9, 0.7],
        change: |size| Change::Parameter("k4", size),
    },
    Scenario {
        effect: "sensor_gain",
        place: "torque_out",
        sizes: [0.998, 0.995, 0.98, 0.95],
        change: |size| Change::Effect(format!("sensor_gain@torque_out:gain={size}")),
    },
    Scenario {
        effect: "gravity_unbalance",
        place: "load",
        sizes: [0.003, 0.01, 0.03, 0.1],
        change: |size| Change::Effect(format!("gravity_unbalance@load:torque={size},phase=1")),
    },
    Scenario {
        effect: "parameter",
        place: "c5",
        sizes: [1.05, 1.2, 2.0, 4.0],
        change: |size| Change::Parameter("c5", size),
    },
];

fn main() {
    let args = Args::parse();
    if args.hours > 0.0 {
        healthy(&args);
    }
    if args.seeds > 0 {
        println!(
            "\neffect at place, size: seen of all, delay s (median, largest), right / rival / wrong / unnamed, false"
        );
        SCENARIOS.iter().for_each(|kind| changed(&args, kind));
    }
}

fn watched(
    args: &Args,
    bench: &Bench,
    run_s: f64,
    change: Option<(&Change, f64)>,
) -> Result<Vec<Alarm>, String> {
    let settings = Settings { false_alarms_per_hour: args.rate, ..Settings::default() };
    let healthy = bench.record(1, args.baseline_s, None)?;
    let told = |error: socam_monitoring::MonitorError| error.to_string();
    let baseline = Baseline::of(&bench.model, &[healthy], &settings).map_err(told)?;
    let data = bench.record(2, run_s, change)?;
    let mut monitor = Monitor::new(&bench.model, data.channels(), Some(baseline), settings).map_err(told)?;
    let mut events = monitor.push_all(&data).map_err(told)?;
    events.extend(monitor.finish().map_err(told)?);
    let mut alarms: Vec<Alarm> = Vec::new();
    for event in events {
        match event {
            Event::Alarm(alarm) => alarms.push(alarm),
            Event::Named(alarm) => {
                alarms.iter_mut().filter(|a| a.number == alarm.number).for_each(|a| *a = alarm.clone())
            }
            Event::Learned(_) | Event::Returned { .. } => {}
        }
    }
    Ok(alarms)
}

/// Alarms per hour of healthy benches.
fn healthy(args: &Args) {
    let benches = (60.0 * args.hours / args.minutes).ceil() as u64;
    let each: Vec<Result<Vec<Alarm>, String>> = (0..benches)
        .into_par_iter()
        .map(|number| watched(args, &Bench::new(args.seed, number), 60.0 * args.minutes, None))
        .collect();
    for (number, found) in each.iter().enumerate() {
        match found {
            Err(error) => println!("bench {number}: {error}"),
            Ok(alarms) if args.list => alarms.iter().for_each(|alarm| {
                println!(
                    "bench {number}: {:.1} s {:?} {:+.2} sigma from {:.1} s",
                    alarm.time_s, alarm.symptom, alarm.size_sigma, alarm.onset_s
                );
            }),
            Ok(_) => {}
        }
    }
    let alarms: usize = each.iter().flatten().map(Vec::len).sum();
    let hours = each.iter().flatten().count() as f64 * args.minutes / 60.0;
    println!(
        "{alarms} alarms in {hours:.1} h of {benches} healthy benches: {:.2} per hour, stated {}",
        alarms as f64 / hours,
        args.rate
    );
}

/// Delay and naming over the sizes of a kind.
fn changed(args: &Args, kind: &Scenario) {
    for (index, size) in kind.sizes.iter().enumerate() {
        let change = (kind.change)(*size);
        let each: Vec<_> = (0..args.seeds)
            .into_par_iter()
            .map(|number| {
                let bench = Bench::new(args.seed, 1000 + 100 * index as u64 + number);
                watched(args, &bench, BEGINS_S + AFTER_S, Some((&change, BEGINS_S)))
            })
            .collect();
        let mut tally = [0_usize; 6];
        let mut delays: Vec<f64> = Vec::new();
        for found in &each {
            let alarms = match found {
                Ok(alarms) => alarms,
                Err(error) => {
                    println!("{} at {} {size}: {error}", kind.effect, kind.place);
                    continue;
                }
            };
            tally[5] += alarms.iter().filter(|alarm| alarm.time_s < BEGINS_S - TOLERANCE_S).count();
            let Some(alarm) = alarms.iter().find(|alarm| alarm.time_s >= BEGINS_S - TOLERANCE_S) else {
                continue;
            };
            tally[0] += 1;
            delays.push(alarm.time_s - BEGINS_S);
            tally[judged(kind, alarm)] += 1;
            if args.list {
                println!("  {alarm:?}");
            }
        }
        delays.sort_by(f64::total_cmp);
        let [seen, right, rival, wrong, unnamed, false_alarms] = tally;
        println!(
            "{} at {} {size}: {seen} of {}, {:.1} {:.1}, {right} / {rival} / {wrong} / {unnamed}, {false_alarms}",
            kind.effect,
            kind.place,
            each.len(),
            delays.get(delays.len() / 2).copied().unwrap_or(f64::NAN),
            delays.last().copied().unwrap_or(f64::NAN),
        );
    }
}

/// Index in the tally: 1 first of all causes, 2 listed behind another, 3 not listed, 4 no cause was named.
fn judged(kind: &Scenario, alarm: &Alarm) -> usize {
    let Some(naming) = alarm.naming.as_ref().filter(|naming| naming.verdict != Verdict::Unnamed) else {
        return 4;
    };
    let place =
        naming.causes.iter().position(|cause| cause.effect == kind.effect && cause.location == kind.place);
    match place {
        Some(0) => 1,
        Some(_) => 2,
        None => 3,
    }
}
