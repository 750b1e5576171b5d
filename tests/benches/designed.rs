//! Does a designed experiment beat the thesis' five steps of equal length? Random benches: five steps are recorded and identified; from
//! the model that this gives the next experiment is designed, recorded with noise, and identified alone. Benches that turn faster on the
//! five steps than the board allows have nothing to be compared with; others are drawn instead.
//!
//! `cargo bench -p socam-tests --bench designed -- --benches 20` prints the table.

use clap::Parser;
use socam_design::{Limits, Rig, sharpest};
use socam_identify::{Identification, Options, Problem, Source, output_error};
use socam_model::Model;
use socam_recording::{Calibration, Dataset, ProfileCommand, ProfileFile, Waveform};
use socam_sim::{Override, Setup, SimError, Truth};
use socam_tests::Draw;

#[derive(Debug, Parser)]
struct Args {
    /// Benches to compare
    #[arg(long, default_value_t = 20)]
    benches: u64,
    /// Another number, other benches
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Length of each recording, s
    #[arg(long, default_value_t = 10.0)]
    duration: f64,
    /// Cargo says so to every benchmark
    #[arg(long, hide = true)]
    bench: bool,
}

/// Stiffnesses and dampings lie within this factor of the model file's, either way.
const SPREAD: f64 = 2.0;
/// 600 to 1400 rpm, as in section 4.1.1, by the motor's calibration.
const FIRST_V: f64 = 0.848;
const STEP_V: f64 = 0.277;
const LIMIT_V: f64 = 1.97;
const SLEW_V_S: f64 = 500.0;
/// So many times as many benches as are compared may be ended by the board.
const MOST_ENDED: u64 = 3;

struct Outcome {
    profile: String,
    /// Name and relative half-width by the steps, and by the proposal where it determines it.
    widths: Vec<(String, f64, Option<f64>)>,
}

impl Outcome {
    /// Widest of what the steps determined, by the steps and by the proposal; what that does not determine counts as 1.
    fn widest(&self) -> (f64, f64) {
        let most = |widths: &mut dyn Iterator<Item = f64>| widths.fold(0.0, f64::max);
        (
            most(&mut self.widths.iter().map(|w| w.1)),
            most(&mut self.widths.iter().map(|w| w.2.unwrap_or(1.0))),
        )
    }
}

fn relative(result: &Identification) -> Vec<(String, f64)> {
    let half = |ends: [Option<f64>; 2], value: Option<f64>| Some(0.5 * (ends[1]? - ends[0]?) / value?.abs());
    let parameters = result.parameters.iter().filter(|p| p.source != Source::Fixed);
    let first = parameters.filter_map(|p| Some((p.name.clone(), half(p.ci95, p.value)?)));
    first
        .chain(result.combinations.iter().filter_map(|c| Some((c.name.clone(), half(c.ci95, c.value)?))))
        .collect()
}

fn identify(model: &Model, data: &Dataset) -> Result<Identification, String> {
    let problem =
        Problem::new(model, std::slice::from_ref(data), Options::default()).map_err(|e| e.to_string())?;
    output_error(&problem).map_err(|e| e.to_string())
}

/// `None` where the board ends the five steps: the drawn bench turns faster on them than the board allows.
fn bench(args: &Args, number: u64) -> Result<Option<Outcome>, String> {
    let text = |error: &dyn std::fmt::Display| error.to_string();
    let mut draw = Draw::new(args.seed, number);
    let mut model = Model::builtin("speed-o-cam").ok_or("no default model")?;
    let free = model.parameters.iter().filter(|parameter| !parameter.fixed);
    let overrides: Vec<Override> =
        free.map(|p| Override { name: p.name.clone(), value: p.value * draw.factor(SPREAD) }).collect();
    let truth = Truth::new(&model, &overrides, &[]).map_err(|e| text(&e))?;
    let calibration = Calibration::default();
    let bench = Setup::new(truth, calibration.clone(), number);
    let dwell_s = args.duration / 5.0;
    let steps = ProfileFile {
        purpose: None,
        command: ProfileCommand::Voltage,
        waveform: Waveform::Staircase { first: FIRST_V, step: STEP_V, count: 5, dwell_s, and_back: false },
        ramp_s: 0.0,
        limit: LIMIT_V,
        slew: SLEW_V_S,
        duration_s: args.duration,
    };
    let record = |profile: &ProfileFile, seed: u64| {
        let waveform = profile.profile(1000).map_err(|e| text(&e))?;
        match (Setup { seed, ..bench.clone() }.record("run", &waveform, 1000)) {
            Ok(run) => Ok(Some(run)),
            Err(SimError::Fault { .. }) => Ok(None),
            Err(error) => Err(text(&error)),
        }
    };
    let Some(by_steps) = record(&steps, 2 * number + 1)? else { return Ok(None) };
    let by_steps = identify(&model, &by_steps)?;
    // What the steps found is where the design starts from.
    model.parameters.iter_mut().zip(&by_steps.point).for_each(|(parameter, value)| parameter.value = *value);
    let limits = Limits { voltage: LIMIT_V, slew_v_s: SLEW_V_S, duration_s: args.duration, one_way: false };
    let believed = Truth::new(&model, &[], &[]).map_err(|e| text(&e))?;
    let rig = Rig::new(Setup::new(believed, calibration, 0), limits).map_err(|e| text(&e))?;
    let design = sharpest(&model, &rig, &[], &|_| ()).map_err(|e| text(&e))?;
    // A proposal that the board ends determines nothing.
    let by_design = match record(&design.best.profile, 2 * number + 2)? {
        Some(run) => relative(&identify(&model, &run)?),
        None => Vec::new(),
    };
    let of = |name: &str| by_design.iter().find(|(other, _)| other == name).map(|(_, width)| *width);
    let widths = relative(&by_steps)
        .into_iter()
        .map(|(name, width)| (of(&name), name, width))
        .map(|(new, name, old)| (name, old, new));
    Ok(Some(Outcome { profile: format!("{:?}", design.best.profile.waveform), widths: widths.collect() }))
}

fn main() -> Result<(), String> {
    let args = Args::parse();
    let (mut halved, mut compared, mut ended) = (0, 0, 0);
    println!("widest 95 % interval of what the five steps determine, +- % of the value");
    println!("{:>5} {:>10} {:>10} {:>7}", "bench", "steps", "proposed", "ratio");
    for number in 0.. {
        if compared == args.benches {
            break;
        }
        let Some(outcome) = bench(&args, number)? else {
            println!("{number:>5} {:>10}", "ended by the board");
            ended += 1;
            if ended > MOST_ENDED * args.benches {
                return Err(format!(
                    "the board ended the five steps on {ended} benches: they are drawn too wild"
                ));
            }
            continue;
        };
        compared += 1;
        let (before, after) = outcome.widest();
        halved += u64::from(after <= 0.5 * before);
        let short = outcome.profile.split('{').next().unwrap_or_default().trim().to_lowercase();
        println!(
            "{number:>5} {:>10.3} {:>10.3} {:>7.3}  {short}",
            100.0 * before,
            100.0 * after,
            after / before
        );
        if after > 0.5 * before {
            println!("      {} {:?}", outcome.profile, outcome.widths);
        }
    }
    println!(
        "halved or better on {halved} of {compared} benches; the board ended the five steps on {ended} more"
    );
    Ok(())
}
