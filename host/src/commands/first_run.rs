//! `first-run`: signs, counts and winding of a gearmotor that was just wired.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use socam_calibrate::first_run::{FirstRun, Told, Uncertain};
use socam_core::Sample;
use socam_job::{VirtualBench, options};
use socam_recording::{Calibration, ProfileFile};
use socam_wire::{BoardKind, SampleBatch};

use super::Outcome;
use super::record::now_unix_ns;
use crate::device::run::{self, End, Monitor, Plan};
use crate::device::token::TokenArgs;
use crate::device::{self, Device, Pace, front_end};
use crate::interrupt::Interrupt;
use crate::output;

/// First run of a gearmotor board: finds signs, counts per turn and winding, and writes the calibration
///
/// The motor turns slowly to both sides for eight seconds; its output must be free to turn. The encoder's sign comes from the voltage's, its counts
/// per turn from the index at the first digital input, resistance and back-EMF from voltage, current and speed. The limits of speed and current hold;
/// the check of the encoder against the winding, which needs these numbers, begins with the calibration that is written.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  socam-host first-run --device serial -o mine.toml
  socam-host first-run --device serial --volts 6 --counts-per-turn 44 --output-counts-per-turn 2400 -o mine.toml
  socam-host first-run --device sim -o mine.toml                              without a motor
  socam-host record --device serial --calibration mine.toml --profile gearmotor -o run.mcap")]
pub(crate) struct Args {
    /// Calibration to write (.toml), for `record --calibration`
    #[arg(short, long, value_name = "C.toml")]
    output: PathBuf,
    /// Board: serial (the one on USB), serial:PATH, tcp:HOST:PORT, or sim (a virtual one)
    #[arg(long, value_name = "DEVICE")]
    device: Device,
    /// Largest voltage; a third of it is applied too
    #[arg(long, value_name = "V", default_value_t = 4.5, value_parser = volts)]
    volts: f64,
    /// Counts per turn of the motor's encoder, four times its lines [default: measured by its index]
    #[arg(long, value_name = "N", value_parser = counts)]
    counts_per_turn: Option<f64>,
    /// Counts per turn of the output's encoder [default: the calibration's]
    #[arg(long, value_name = "N", value_parser = counts)]
    output_counts_per_turn: Option<f64>,
    /// Calibration file to correct [default: that of the default gearmotor]
    #[arg(long, value_name = "C.toml")]
    calibration: Option<PathBuf>,
    /// Replace an existing calibration
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    token: TokenArgs,
}

/// Time for which each voltage is applied, s, and number of voltages.
const DWELL_S: f64 = 1.5;
const LEVELS: f64 = 5.0;

const PERIOD_US: u32 = 1000;

fn volts(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|volts| (0.5..=24.0).contains(volts)).ok_or("expected 0.5 to 24 V".to_owned())
}

fn counts(text: &str) -> Result<f64, String> {
    let counts = text.parse().ok().filter(|counts| (4.0..=1e7).contains(counts));
    counts.ok_or("expected 4 to 10000000 counts".to_owned())
}

pub(crate) fn run(args: Args) -> anyhow::Result<Outcome> {
    let mut written = output::create_new(&args.output, args.force)?;
    let text = match &args.calibration {
        Some(path) => socam_recording::read_text(path)?,
        None => Calibration::gearmotor_text().to_owned(),
    };
    let calibration = calibration(&text)?;
    let device = args.device.clone().with_token(args.token.read()?);
    let interrupt = Interrupt::listen();
    interrupt.answer(2);
    let bench =
        (device == Device::Sim).then(|| virtual_gearmotor().map(|setup| (setup, Pace::Fast))).transpose()?;
    let mut session = device::open(&device, bench)?;
    let kind = session.identity().front_end.kind;
    if kind != BoardKind::Gearmotor {
        bail!(
            "the board at {device} is of kind `{kind}`; a first run is for a gearmotor board (see docs/gearmotor.md)"
        );
    }
    front_end::check(&calibration, &session.identity().front_end)?;
    let folder = tempfile::tempdir().context("cannot write a temporary file")?;
    let plan = plan(&args, calibration.clone(), folder.path())?;
    let mut gathered = Gathered { samples: Vec::new(), interrupt };
    output::say(format_args!(
        "the motor turns to both sides with up to {} V for {:.0} s",
        args.volts,
        DWELL_S * LEVELS
    ));
    let report = run::observe(&mut session, plan, &mut gathered)?;
    match report.end {
        End::Finished => {}
        End::Stopped => bail!("stopped; no calibration was written"),
        End::Fault(reason) | End::Broken(reason) => bail!("the board ended the first run: {reason}"),
    }
    let told =
        Told { counts_per_turn: args.counts_per_turn, output_counts_per_turn: args.output_counts_per_turn };
    let found = FirstRun::of(&gathered.samples, f64::from(PERIOD_US) * 1e-6, &calibration, told)?;
    written.write_all(found.edit(&text)?.as_bytes())?;
    written.commit()?;
    output::print(&words(&found, &calibration, &args.output))?;
    Ok(Outcome::Done)
}

/// The calibration of the run: the check of encoder and winding needs what is to be found.
fn calibration(text: &str) -> anyhow::Result<Calibration> {
    let calibration = Calibration::parse(text)?;
    if calibration.board != BoardKind::Gearmotor {
        bail!(
            "the calibration is for a board of kind `{}`; expected `board = \"gearmotor\"`",
            calibration.board
        );
    }
    Ok(Calibration { winding: None, ..calibration })
}

fn virtual_gearmotor() -> anyhow::Result<socam_sim::Setup> {
    let bench = VirtualBench { model: "gearmotor".to_owned(), ..options::defaults()? };
    Ok(bench.setup(&bench.load()?, None)?)
}

fn plan(args: &Args, calibration: Calibration, folder: &Path) -> anyhow::Result<Plan> {
    let most = args.volts;
    let third = most / 3.0;
    // Up and down through both thirds; standstill is not among them.
    let profile = ProfileFile::parse(&format!(
        "schema = 'socam.profile/1'\ncommand = 'voltage'\nshape = 'staircase'\nfirst_V = {most}\nstep_V = {}\ncount = 4\ndwell_s = {DWELL_S}\n\
         and_back = true\nlimit_V = {most}\nslew_V_s = 100\nduration_s = {}",
        -2.0 * third,
        DWELL_S * LEVELS
    ))?;
    Ok(Plan {
        profile: profile.profile(PERIOD_US)?,
        calibration,
        period_us: PERIOD_US,
        path: folder.join("first-run.mcap"),
        replace: true,
        metadata: [].into(),
        attachments: Vec::new(),
        start_unix_ns: now_unix_ns(),
    })
}

/// Keeps the samples of a run.
struct Gathered {
    samples: Vec<Sample>,
    interrupt: Interrupt,
}

impl Monitor for Gathered {
    fn stops(&self) -> u32 {
        self.interrupt.count()
    }

    fn samples(&mut self, batch: &SampleBatch) {
        self.samples.extend(batch.samples());
    }
}

fn words(found: &FirstRun, before: &Calibration, path: &Path) -> String {
    let mut text = String::new();
    let mut line = |what: &str, value: String| {
        let _ = writeln!(text, "{what:<22} {value}");
    };
    let side = |counts: f64, told: Option<f64>| match (counts < 0.0, told) {
        (false, _) => "counts with the voltage",
        (true, Some(before)) if before < 0.0 => "counts against the voltage, as the calibration said",
        (true, _) => {
            "counts against the voltage: its wires A and B, or the motor's, are swapped; the calibration corrects it"
        }
    };
    let told = |place: usize| before.channels.get(place).and_then(|channel| channel.counts_per_turn);
    let source = if found.by_index { "by its index" } else { "as given" };
    line(
        "motor's encoder",
        format!(
            "{} counts per turn {source}, {}",
            found.counts_per_turn.abs(),
            side(found.counts_per_turn, told(0))
        ),
    );
    match found.output_counts_per_turn {
        Some(counts) => {
            line("output's encoder", format!("{} counts per turn, {}", counts.abs(), side(counts, told(2))));
        }
        None => line("output's encoder", "does not count: not wired, or broken".to_owned()),
    }
    if let Some(ratio) = found.ratio {
        line("gear", format!("{ratio:.3} turns of the motor for one of the output"));
    }
    let number = |measured: &Uncertain, factor: f64, unit: &str| {
        format!("{:.4} +- {:.4} {unit}", measured.value * factor, 1.96 * measured.std * factor)
    };
    line("resistance", number(&found.resistance_ohm, 1.0, "ohm, with bridge and leads"));
    // Samples a millisecond apart hardly see it: the least squares are biased by more than their uncertainty.
    line("inductance", format!("about {:.1} mH", found.inductance_h.value * 1e3));
    line("back-EMF", number(&found.back_emf_v_s, 1e3, "mV s/rad"));
    let reversed = if found.current_is_reversed {
        "; its sensor is the wrong way round, the calibration corrects it"
    } else {
        ""
    };
    line("current at rest", format!("{}{reversed}", number(&found.current_offset_a, 1e3, "mA")));
    line("written", path.display().to_string());
    text
}
