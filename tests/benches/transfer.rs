//! How near do transfer functions come to the bench's own, and do their intervals hold it? The default bench with the noise of its
//! sensors, recorded in memory (a seed gives other noise than `simulate` makes of it) and fitted as `identify --method etf` does.
//!
//! `cargo bench -p socam-tests --bench transfer -- --seeds 100` prints the table.

use clap::Parser;
use rayon::prelude::*;
use socam_frequency::{
    Complex,
    rational::{Fit, Orders, Point, advise, fit, response_std_among},
    response::{Line, Options, Signals, apart, estimate},
};
use socam_model::{Channel, Equations, Model};
use socam_recording::{Dataset, ProfileFile};
use socam_sim::{Setup, Truth, calibration_for};

#[derive(Debug, Parser)]
struct Args {
    /// Recordings of each kind, of the seeds 1 to this
    #[arg(long, default_value_t = 100)]
    seeds: u64,
    /// One line for each recording
    #[arg(long)]
    list: bool,
    /// Cargo says so to every benchmark
    #[arg(long, hide = true)]
    bench: bool,
}

/// Profile, length, and orders where they are not advised.
const KINDS: [(&str, f64, Option<Orders>); 6] = [
    ("multisine", 16.0, None),
    ("multisine", 40.0, None),
    ("multisine", 80.0, None),
    ("prbs", 20.0, None),
    ("chirp", 20.0, None),
    // Those of the bench itself.
    ("multisine", 16.0, Some(Orders { numerator: 3, denominator: 6 })),
];
const PERIOD_US: u32 = 1000;
const BAND_HZ: [f64; 2] = [0.1, 100.0];
const OUTPUT: &str = "output_speed";
/// Highest order that is tried for advice.
const HIGHEST: usize = 6;
/// What is asked of lines of so much coherence.
const GOOD: f64 = 0.9;
const DECIBEL: f64 = 0.2;
const DEGREES: f64 = 1.5;
/// 95 % of a normal distribution, in standard deviations.
const NORMAL: f64 = 1.96;

/// One recording's transfer function beside the bench's.
struct Judged {
    orders: Orders,
    misfit: f64,
    worst_db: f64,
    worst_deg: f64,
    /// Share of lines at which the intervals of magnitude and phase hold the bench's, %.
    held: [f64; 2],
}

impl Judged {
    fn new(fits: &[Fit], lines: &[Line], bench: &Bench) -> Result<Self, String> {
        let best = fits.first().ok_or("no transfer function fits")?;
        let mut judged =
            Self { orders: best.orders, misfit: best.misfit, worst_db: 0.0, worst_deg: 0.0, held: [0.0; 2] };
        for line in lines {
            let ratio = best.transfer.response(line.frequency_hz) / bench.response(line.frequency_hz)?;
            let off = [ratio.norm().ln().abs(), ratio.arg().abs()];
            let std = response_std_among(fits, line.frequency_hz);
            (0..2).filter(|i| off[*i] <= NORMAL * std[*i]).for_each(|i| judged.held[i] += 1.0);
            if line.coherence > GOOD {
                judged.worst_db = judged.worst_db.max(20.0 * ratio.norm().log10().abs());
                judged.worst_deg = judged.worst_deg.max(ratio.arg().to_degrees().abs());
            }
        }
        judged.held = judged.held.map(|count| 100.0 * count / lines.len() as f64);
        Ok(judged)
    }

    fn meets(&self) -> bool {
        self.worst_db <= DECIBEL && self.worst_deg <= DEGREES
    }
}

struct Bench {
    model: Model,
    equations: Equations,
    output: usize,
}

impl Bench {
    fn new() -> Result<Self, String> {
        let model = Model::builtin("speed-o-cam").ok_or("no default model")?;
        let equations = model.equations(&model.values()).map_err(|error| error.to_string())?;
        let output = model.outputs().position(|channel| channel.name == OUTPUT).ok_or("no such output")?;
        Ok(Self { model, equations, output })
    }

    fn response(&self, frequency_hz: f64) -> Result<Complex<f64>, String> {
        let s = Complex::new(0.0, std::f64::consts::TAU * frequency_hz);
        self.equations.transfer(self.output, 0, s).ok_or_else(|| "the model has no response".to_owned())
    }

    fn record(&self, name: &str, duration_s: f64, seed: u64) -> Result<Dataset, String> {
        let truth = Truth::new(&self.model, &[], &[]).map_err(|error| error.to_string())?;
        let calibration = calibration_for(&truth.model);
        let mut profile = ProfileFile::open(name).map_err(|error| error.to_string())?;
        // As `simulate --duration` has it: the profile fades out after its own duration.
        profile.duration_s = duration_s - profile.ramp_s;
        let waveform = profile.profile(PERIOD_US).map_err(|error| error.to_string())?;
        Setup::new(truth, calibration, seed)
            .record(name, &waveform, PERIOD_US)
            .map_err(|error| error.to_string())
    }

    fn lines(&self, data: &Dataset) -> Result<Vec<Line>, String> {
        let input = self.model.inputs().next().ok_or("the model has no input")?;
        let output = self.model.outputs().nth(self.output).ok_or("no such output")?;
        let loaded =
            data.load(&[&input.column, &output.column, "command_V"]).map_err(|error| error.to_string())?;
        let sample_time_s = 1e-6 * f64::from(PERIOD_US);
        let si = |channel: &Channel, index: usize| {
            channel.read(loaded.columns[index].values(), sample_time_s, Default::default())
        };
        let (input, output) = (si(input, 0), si(output, 1));
        let reference = Some(loaded.columns[2].values());
        let signals = Signals { input: &input, output: &output, reference, sample_time_s };
        let options = Options { band_hz: BAND_HZ, period_s: None };
        let response = estimate(&[signals], &options).map_err(|error| error.to_string())?;
        Ok(apart(&response.lines))
    }

    fn judge(
        &self,
        name: &str,
        duration_s: f64,
        orders: Option<Orders>,
        seed: u64,
    ) -> Result<Judged, String> {
        let lines = self.lines(&self.record(name, duration_s, seed)?)?;
        let points: Vec<Point> = lines.iter().map(Point::from).collect();
        let fits = match orders {
            Some(orders) => vec![fit(&points, orders, false).map_err(|error| error.to_string())?],
            None => advise(&points, HIGHEST, false),
        };
        Judged::new(&fits, &lines, self)
    }
}

/// Mean, and the standard deviation of it: lines of one recording err together, recordings do not.
fn mean(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (mean, (squares / (count * (count - 1.0).max(1.0))).sqrt())
}

fn main() -> Result<(), String> {
    let args = Args::parse();
    let bench = Bench::new()?;
    println!(
        "{OUTPUT}, up to {} Hz; worst where coherence > {GOOD}, met: {DECIBEL} dB and {DEGREES} degrees; 95 % intervals, mean over \
         recordings +- its standard deviation",
        BAND_HZ[1]
    );
    let head = ["recording", "worst dB", "degrees", "met", "magnitude held", "phase held", "misfit"];
    let [recording, db, degrees, met, magnitude, phase, misfit] = head;
    println!("{recording:<22} {db:>8} {degrees:>8} {met:>10} {magnitude:>16} {phase:>16} {misfit:>7}");
    for (name, duration_s, orders) in KINDS {
        let all: Vec<Judged> = (1..=args.seeds)
            .into_par_iter()
            .map(|seed| bench.judge(name, duration_s, orders, seed))
            .collect::<Result<_, String>>()?;
        if args.list {
            for (seed, judged) in (1..).zip(&all) {
                let Judged { orders, misfit, worst_db, worst_deg, held: [magnitude, phase] } = judged;
                println!(
                    "  seed {seed}: order {orders}, misfit {misfit:.2}, {worst_db:.3} dB, {worst_deg:.2} degrees, held {magnitude:.1} % and {phase:.1} %"
                );
            }
        }
        let worst = |of: fn(&Judged) -> f64| all.iter().map(of).fold(0.0, f64::max);
        let over = |of: &dyn Fn(&Judged) -> f64| mean(&all.iter().map(of).collect::<Vec<_>>());
        let [magnitude, phase] = [0, 1].map(|i| over(&|judged| judged.held[i]));
        let orders = orders.map_or_else(String::new, |orders| format!(", {orders}"));
        println!(
            "{:<22} {:>8.2} {:>8.2} {:>10} {:>16} {:>16} {:>7.3}",
            format!("{name}, {duration_s} s{orders}"),
            worst(|judged| judged.worst_db),
            worst(|judged| judged.worst_deg),
            format!("{} of {}", all.iter().filter(|judged| judged.meets()).count(), all.len()),
            format!("{:.1} +- {:.1} %", magnitude.0, magnitude.1),
            format!("{:.1} +- {:.1} %", phase.0, phase.1),
            over(&|judged| judged.misfit).0,
        );
    }
    Ok(())
}
