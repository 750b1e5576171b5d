//! `record`: run a profile on a bench and record it.

mod can;
pub(crate) mod described;
mod drive;
pub(crate) mod following;
mod foxglove;
pub(crate) mod opened;
mod result;
mod several;
pub(crate) mod source;
pub(crate) mod source_result;
pub(crate) mod summary;

use std::fmt::Write;
use std::path::PathBuf;
use std::time::{SystemTime, UNIX_EPOCH};

use socam_job::{Record, VirtualBench};
use socam_model::Model;
use socam_monitoring::{Baseline, Monitor};
use socam_recording::{Attachment, Calibration, Channel, MACHINE_KEY, ProfileFile};

use super::Outcome;
use crate::alarms::WatchArgs;
use crate::device::run::{self, End, Plan, Report};
use crate::device::token::TokenArgs;
use crate::device::{self, Device, Pace, Session, front_end};
use crate::interrupt::Interrupt;
use crate::live_watch::LiveWatch;
use crate::output::{self, WrongArguments};
use crate::serve::{Serve, ServeAddress};
use described::SourceArgs;
use drive::DriveArgs;
pub(crate) use result::{outcome, tell};
use source::Target;

/// Run a profile on the bench and record it
///
/// A moteus, or an ODrive by USB or CAN, follows the profile within --limit once --arm is given, and is only asked otherwise.
///
/// Ctrl-C ramps the bench down, a second Ctrl-C stops it at once; the samples recorded until then are kept. A third one ends the program
/// without waiting for the board, whose watchdog stops the bench then. With --force, an older recording is replaced when the first second of
/// the new one is in its file, and not before: if the run does not start, the old recording stays as it was. Until then the new one is
/// called RUN.mcap.XXXXXX.part; what a kill leaves under that name is read by `info` and `recover`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  socam-host record --list-profiles
  socam-host record --device serial:/dev/ttyACM0 --profile multisine -o run.mcap
  socam-host record --device serial:/dev/ttyACM0 --profile mine.toml --duration 30s --calibration bench.toml -o run.mcap
  socam-host record --device serial --profile multisine -o run.mcap --watch bench.toml --baseline healthy.mcap
  socam-host record --device sim --profile steps -o run.mcap                 without a bench
  socam-host record --device serial:/dev/ttyACM0?baud=115200 -o run.mcap     lines of text of any microcontroller
  socam-host record --device udp:0.0.0.0:9870 -o run.mcap --describe arm.toml --duration 60s
  socam-host record --device slcan:/dev/ttyACM0?bitrate=500k -o run.mcap --dbc motor.dbc --duration 60s
  socam-host record --device canopen+socketcan:can0?node=5 -o run.mcap --describe axis.toml --rate 100 --duration 60s
  socam-host record --device feetech:/dev/ttyACM0?id=1,2,3,4,5,6 -o arm.mcap --rate 100
  socam-host record --device foxglove:robot:8765?topics=/joint_states -o run.mcap --describe joints.toml --serve 8765
  socam-host record --device moteus:/dev/ttyACM0?id=1 -o run.mcap --profile speeds.toml --limit 30rad/s --limit 0.5Nm --arm")]
pub(crate) struct Args {
    /// Log to write (.mcap)
    #[arg(short, long, value_name = "RUN.mcap", required_unless_present = "list_profiles")]
    output: Option<PathBuf>,
    /// Board: serial (the one on USB), serial:PATH, tcp:HOST:PORT, or sim (a virtual one). Lines of text of another device:
    /// serial:PATH?baud=RATE, text+tcp:HOST:PORT, udp:HOST:PORT. Topics of a Foxglove WebSocket server, such as a bridge of ROS 2:
    /// foxglove:HOST:PORT?topics=/joint_states. Drives, asked or, with --arm, commanded: moteus:PATH?id=1 (an
    /// fdcanusb), odrive:PATH?axis=0 (USB). Servos of one bus, only asked: dynamixel:PATH?id=1,2&baud=57600,
    /// feetech:PATH?id=1,2&baud=1000000. A CAN bus with --dbc, only listened to: slcan:PATH?bitrate=500k,
    /// socketcan:can0. On a bus, an ODrive, asked or commanded: odrive+slcan:PATH?bitrate=500k&node=1, odrive+socketcan:can0?node=1; a drive
    /// with CANopen, only read, by a list of its objects in --describe: canopen+socketcan:can0?node=5. Given several times, devices that
    /// are listened to or asked go into one recording
    #[arg(long, value_name = "DEVICE", required_unless_present = "list_profiles")]
    device: Vec<Target>,
    #[command(flatten)]
    source: SourceArgs,
    #[command(flatten)]
    drive: DriveArgs,
    #[command(flatten)]
    record: Record,
    /// Calibration file of the bench (`template calibration` prints one) [default: that of the default bench]
    #[arg(long, value_name = "C.toml")]
    calibration: Option<PathBuf>,
    /// Note to store in the recording
    #[arg(long, value_name = "TEXT")]
    note: Option<String>,
    /// Serial number of the machine to store in the recording; `fleet` reads it
    #[arg(long, value_name = "SERIAL")]
    machine: Option<String>,
    /// Replace an existing recording
    #[arg(long)]
    force: bool,
    /// List the built-in profiles with their purpose
    #[arg(long)]
    list_profiles: bool,
    /// Run the virtual board in real time, not as fast as possible
    #[arg(long)]
    realtime: bool,
    #[command(flatten)]
    token: TokenArgs,
    /// Watch the run against this model: alarms are printed and recorded as events
    #[arg(long = "watch", value_name = "MODEL")]
    watched: Option<String>,
    #[command(flatten)]
    watch: WatchArgs,
    /// Publish the samples while they are recorded, as a Foxglove WebSocket server at this address of this computer: HOST:PORT, or a port of
    /// its loopback. Clients that are too slow lack samples; the recording does not
    #[arg(long, value_name = "ADDRESS")]
    serve: Option<ServeAddress>,
    #[command(flatten)]
    bench: VirtualBench,
    /// Print one JSON document instead of text
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(args: Args) -> anyhow::Result<Outcome> {
    if args.list_profiles {
        output::print(&profiles()?)?;
        return Ok(Outcome::Done);
    }
    let (Some(path), [device, more @ ..]) = (&args.output, &args.device[..]) else {
        return Err(WrongArguments("record needs --output and --device".into()).into());
    };
    check_output(path, args.force)?;
    if !more.is_empty() {
        return several::run(&args, path);
    }
    let device = match source::of(device, &args.source)? {
        Target::Source(address) => return source::run(&args, path, &address),
        Target::Board(board) => &board.with_token(args.token.read()?),
    };
    args.drive.refuse_for(device)?;
    let calibration = args.calibration.as_deref().map(Calibration::open).transpose()?;
    if *device != Device::Sim && args.bench.describes_a_bench() {
        return Err(WrongArguments(format!(
            "--set, --hide and --no-noise change a virtual bench, not {device}"
        ))
        .into());
    }
    let mut plan = plan(&args.record, path.clone())?;
    plan.replace = args.force;
    plan.start_unix_ns = now_unix_ns();
    let setup = (*device == Device::Sim)
        .then(|| args.bench.setup(&args.bench.load()?, calibration.clone()))
        .transpose()?;
    plan.metadata.insert("device".into(), device.to_string());
    plan.metadata.extend(args.note.clone().map(|note| ("note".into(), note)));
    plan.metadata.extend(args.machine.clone().map(|machine| (MACHINE_KEY.into(), machine)));
    plan.attachments.extend(attachment("model.toml", socam_job::model_text(&args.bench.model)?));
    // The baseline is computed before the board is opened: it takes seconds, in which nothing is exchanged with the board.
    let watched = watched(&args)?;
    let pace = if args.realtime { Pace::RealTime } else { Pace::Fast };
    let rate_hz = args.record.rate_hz;
    let interrupt = Interrupt::listen();
    // First interrupt: ramp down. Second: stop at once. Third: the process ends, and the board's watchdog stops the bench.
    interrupt.answer(2);
    let bench = setup.as_ref().map(|setup| (setup.clone(), pace));
    let mut session = device::open(device, bench)?;
    let text = args.calibration.as_deref().map(socam_recording::read_text).transpose()?;
    calibrate(&mut plan, &session, setup.map(|setup| setup.calibration).or(calibration), text)?;
    let channels = run::Columns::of(&plan.calibration).channels;
    let watch = watch(&args, watched, &channels, session.is_patient())?;
    let serve = args.serve(&channels, plan.start_unix_ns)?;
    let report = run::record_watched(&mut session, plan, &interrupt, watch, serve)?;
    tell(path, &report, rate_hz, args.json)?;
    tell_early_end(&args.record, &report);
    outcome(path, &report)
}

impl Args {
    /// The server of the recording, if one is wanted, of a recording that begins at a time of day, ns since 1970.
    fn serve(&self, channels: &[Channel], start_unix_ns: u64) -> anyhow::Result<Option<Serve>> {
        let Some(address) = self.serve else { return Ok(None) };
        let device = self.device.first().map(ToString::to_string).unwrap_or_default();
        let mut serve = Serve::start(address, channels, &format!("socam-host record --device {device}"))?;
        serve.begin(start_unix_ns);
        Ok(Some(serve))
    }
}

/// The model and the baseline of the monitoring, if it is requested.
fn watched(args: &Args) -> anyhow::Result<Option<(Model, Option<Baseline>)>> {
    let Some(name) = &args.watched else {
        if args.watch.is_set() {
            return Err(WrongArguments(
                "--baseline, --window, --block and --learn belong to a watch: name its model with --watch"
                    .into(),
            )
            .into());
        }
        return Ok(None);
    };
    let model = socam_job::load_model(name)?;
    let baseline = args.watch.baseline(&model)?;
    Ok(Some((model, baseline)))
}

/// Starts the monitoring of samples of these channels, if it is requested. `is_patient`: whether the run waits for it.
fn watch(
    args: &Args,
    watched: Option<(Model, Option<Baseline>)>,
    channels: &[Channel],
    is_patient: bool,
) -> anyhow::Result<Option<LiveWatch>> {
    let Some((model, baseline)) = watched else { return Ok(None) };
    let monitor = Monitor::new(&model, channels, baseline, args.watch.watching.settings())?;
    LiveWatch::start(monitor, channels.len(), is_patient).map(Some)
}

/// Sets the calibration of a plan: the given one, or that of the virtual bench, or the default one for the board's converters; and
/// attaches its text, if there is one.
fn calibrate(
    plan: &mut Plan,
    session: &Session,
    given: Option<Calibration>,
    text: Option<String>,
) -> anyhow::Result<()> {
    let front_end = &session.identity().front_end;
    let (default_text, default) = front_end::default_calibration(front_end)?;
    plan.calibration = given.unwrap_or_else(|| default.clone());
    front_end::check(&plan.calibration, front_end)?;
    let text = text.or((plan.calibration == default).then_some(default_text));
    plan.attachments.extend(text.into_iter().flat_map(|text| attachment("calibration.toml", text)));
    Ok(())
}

/// Warns if a profile ended before the requested duration.
fn tell_early_end(record: &Record, report: &Report) {
    let (Some(asked_s), End::Finished) = (record.duration_s, &report.end) else { return };
    if report.duration_s < 0.95 * asked_s {
        let profile = record.profile.as_deref().unwrap_or_default();
        output::warn(format_args!(
            "the profile `{profile}` came to its own end after {:.1} s, before --duration {asked_s} s",
            report.duration_s
        ));
    }
}

/// The profile for a board, with its text; everything else is filled in by the caller.
pub(crate) fn plan(record: &Record, path: PathBuf) -> anyhow::Result<Plan> {
    let period_us = record.period_us()?;
    let file = record.load()?;
    let name = record.profile.clone().unwrap_or_default();
    Ok(Plan {
        profile: file.profile(period_us)?,
        calibration: Calibration::default(),
        period_us,
        path,
        replace: true,
        metadata: [("profile".to_owned(), name)].into(),
        attachments: attachment("profile.toml", file.to_toml()).to_vec(),
        start_unix_ns: 0,
    })
}

pub(crate) fn attachment(name: &str, text: impl Into<String>) -> [Attachment; 1] {
    [Attachment { name: name.into(), media_type: "application/toml".into(), data: text.into().into_bytes() }]
}

/// Checks the output path before anything moves.
fn check_output(path: &std::path::Path, replace: bool) -> anyhow::Result<()> {
    if path.extension().is_none_or(|extension| extension != "mcap") {
        let path = path.display();
        return Err(WrongArguments(format!(
            "`{path}`: a recording is written as .mcap; `export` makes other formats of it"
        ))
        .into());
    }
    if path.exists() && !replace {
        anyhow::bail!("`{}` exists already; choose another name, or --force to replace it", path.display());
    }
    Ok(())
}

pub(crate) fn now_unix_ns() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    u64::try_from(since.as_nanos()).unwrap_or(u64::MAX)
}

fn profiles() -> anyhow::Result<String> {
    let mut text = String::new();
    for name in ProfileFile::built_in_names() {
        let purpose = ProfileFile::open(name)?.purpose.unwrap_or_default();
        writeln!(text, "{name:10} {purpose}")?;
    }
    Ok(text)
}
