//! `record` of a device that is not the own board.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use serde::Serialize;
use socam_monitoring::Monitor;
use socam_recording::{MACHINE_KEY, RecordingHeader};
use socam_sources::moteus::Moteus;
use socam_sources::odrive::Odrive;
use socam_sources::text::{Found, TextDevice};
use socam_sources::{ClockMap, Description, Device as _, SourceError, Timeline};

use super::{Args, attachment, now_unix_ns, watched};
use crate::commands::Outcome;
use crate::device::Device;
use crate::device::source::{
    Link, Listened, Protocol, SourceAddress, SourceEnd, SourcePlan, SourceReport, listen, record,
};
use crate::interrupt::Interrupt;
use crate::live_watch::LiveWatch;
use crate::output::{self, WrongArguments};

/// Drift of a device's clock beyond which a warning says so; crystals stay below a tenth of it.
const DRIFT: f64 = 1e-3;

/// Options of devices other than the own board.
#[derive(Debug, Clone, clap::Args)]
pub(super) struct SourceArgs {
    /// File that says what a device's lines hold: names, units, clock. If there is none, it is written, with a question mark for all that
    /// the device does not state; complete it and record again
    #[arg(long, value_name = "D.toml")]
    describe: Option<PathBuf>,
    /// Take units that names suggest without asking, and leave out signals whose names suggest none
    #[arg(long)]
    accept_guesses: bool,
}

/// What `--device` names.
#[derive(Debug, Clone)]
pub(super) enum Target {
    Board(Device),
    Source(SourceAddress),
}

impl FromStr for Target {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let is_other = ["text+", "udp:", "moteus:", "odrive:"].iter().any(|kind| text.starts_with(kind))
            || text.contains("?baud=");
        if is_other {
            return text.parse().map(Self::Source);
        }
        let board = text.parse().map(Self::Board);
        board.map_err(|error: String| {
            format!("{error}; or another device: serial:PATH?baud=RATE, text+tcp:HOST:PORT, udp:HOST:PORT, moteus:PATH?id=1, odrive:PATH?axis=0")
        })
    }
}

/// The device, which a description makes one of lines of text.
pub(super) fn of(target: &Target, args: &SourceArgs) -> Result<Target, WrongArguments> {
    let Target::Board(board) = target else { return Ok(target.clone()) };
    if args.describe.is_none() && !args.accept_guesses {
        return Ok(target.clone());
    }
    let source = SourceAddress::in_place_of(board);
    source.map(Target::Source).ok_or_else(|| {
        WrongArguments(format!(
            "--describe and --accept-guesses are for devices that send lines of text, not for {board}"
        ))
    })
}

/// Records a source.
pub(super) fn run(args: &Args, path: &Path, address: &SourceAddress) -> anyhow::Result<Outcome> {
    refuse_board_options(args, address)?;
    let watched = watched(args)?;
    let interrupt = Interrupt::listen();
    interrupt.answer(2);
    let name = address.to_string();
    let mut link = Link::open(&address.place)?;
    let opened_unix_ns = now_unix_ns();
    let Opened { mut device, timeline, heard, description } = open(&mut link, args, address, &interrupt)?;
    let channels = device.channels().to_vec();
    let watch = watched.map(|(model, baseline)| {
        let monitor = Monitor::new(&model, &channels, baseline, args.watch.watching.settings())?;
        LiveWatch::start(monitor, channels.len(), false)
    });
    let mut header = RecordingHeader::new(channels);
    header.planned_duration_s = args.record.duration_s;
    header.replace = args.force;
    header.metadata = metadata(args, &name, &*device, &timeline);
    header.attachments.extend(description.into_iter().flat_map(|text| attachment("device.toml", text)));
    header.attachments.extend(attachment("model.toml", socam_job::model_text(&args.bench.model)?));
    let plan =
        SourcePlan { name, path: path.into(), opened_unix_ns, header, duration_s: args.record.duration_s };
    let report = record(&mut link, &mut *device, timeline, plan, heard, watch.transpose()?, &interrupt)?;
    tell(path, &report, args.json)?;
    outcome(path, &report)
}

/// A device that is ready to be recorded.
struct Opened {
    device: Box<dyn socam_sources::Device>,
    timeline: Timeline,
    heard: Listened,
    /// Text of its description, if it has one.
    description: Option<String>,
}

/// Makes the protocol of a device; a device of text is listened to first.
fn open(
    link: &mut Link,
    args: &Args,
    address: &SourceAddress,
    interrupt: &Interrupt,
) -> anyhow::Result<Opened> {
    let name = address.to_string();
    let period_ns = i64::from(args.record.period_us()?) * 1000;
    let asked: Box<dyn socam_sources::Device> = match address.protocol {
        Protocol::Moteus(id) => Box::new(Moteus::new(id, period_ns)?),
        Protocol::Odrive(axis) => Box::new(Odrive::new(axis, period_ns)?),
        Protocol::Text => {
            let heard = listen(link, &name, interrupt)?;
            let description = description(&heard, link, &args.source, &name)?;
            let device = TextDevice::new(description.read, link.bounds());
            let timeline = Timeline::new(device.numbering(), device.clock_wrap_s());
            return Ok(Opened {
                device: Box::new(device),
                timeline,
                heard,
                description: Some(description.text),
            });
        }
    };
    if args.source.describe.is_some() || args.source.accept_guesses {
        let problem = "--describe and --accept-guesses are for devices that send lines of text; a drive states its units";
        return Err(WrongArguments(problem.into()).into());
    }
    let timeline = Timeline::new(asked.numbering(), None);
    Ok(Opened { device: asked, timeline, heard: Listened(Vec::new()), description: None })
}

/// Options that only the own board, or a virtual bench, understands.
fn refuse_board_options(args: &Args, address: &SourceAddress) -> Result<(), WrongArguments> {
    let given = [
        ("--profile", args.record.profile.is_some()),
        ("--calibration", args.calibration.is_some()),
        ("--realtime", args.realtime),
        ("--set, --hide and --no-noise", args.bench.describes_a_bench()),
    ];
    match given.into_iter().find(|(_, is_given)| *is_given) {
        Some((option, _)) => Err(WrongArguments(format!(
            "{option} commands a board or a virtual bench; {address} is only listened to, so leave it out"
        ))),
        None => Ok(()),
    }
}

/// A description with its text.
struct Described {
    read: Description,
    text: String,
}

/// The description of a file, or of what was heard; a file that is missing is written.
fn description(heard: &Listened, link: &Link, args: &SourceArgs, name: &str) -> anyhow::Result<Described> {
    let bounds = link.bounds();
    if let Some(file) = args.describe.as_deref().filter(|file| file.exists()) {
        let read = Description::open(file)?;
        heard.check(&read, bounds)?;
        return Ok(Described { read, text: socam_recording::read_text(file)? });
    }
    let found = heard.probe(bounds, args.accept_guesses);
    let found = found.map_err(|error| anyhow::anyhow!("{name}: {error}"))?;
    let read = found.description();
    if let Some(file) = &args.describe {
        output::write_whole(file, &found.text)?;
        output::say(format_args!("wrote `{}`", file.display()));
    }
    match read {
        Ok(read) => {
            heard.check(&read, bounds)?;
            say_found(&found);
            Ok(Described { read, text: found.text })
        }
        Err(error @ SourceError::Unstated { .. }) => {
            let todo = match &args.describe {
                Some(file) => format!("replace each \"?\" in `{}`, and record again", file.display()),
                None => "name a file by --describe D.toml, which is written for you to complete, or take the likeliest by --accept-guesses"
                    .to_owned(),
            };
            anyhow::bail!("{name}: {error}: {todo}")
        }
        Err(error) => anyhow::bail!("{name}: {error}"),
    }
}

fn say_found(found: &Found) {
    for assumed in &found.assumed {
        output::warn(format_args!("not stated by the device: {assumed}"));
    }
}

fn metadata(
    args: &Args,
    name: &str,
    device: &dyn socam_sources::Device,
    timeline: &Timeline,
) -> BTreeMap<String, String> {
    let mut metadata = BTreeMap::from([
        ("device".to_owned(), name.to_owned()),
        ("device_kind".to_owned(), device.kind()),
        ("lost_samples".to_owned(), format!("counted {}", timeline.counted_by())),
        ("host".to_owned(), env!("CARGO_PKG_VERSION").to_owned()),
    ]);
    metadata.extend(args.note.clone().map(|note| ("note".into(), note)));
    metadata.extend(args.machine.clone().map(|machine| (MACHINE_KEY.into(), machine)));
    metadata
}

#[derive(Serialize)]
struct Document<'a> {
    schema: &'static str,
    recording: String,
    samples: u64,
    lost: u64,
    missed: u64,
    overflowed: u64,
    refused: u64,
    repeated: u64,
    late: u64,
    damaged: u64,
    clock_jumps: u64,
    interruptions: u64,
    strangers: u64,
    bytes: u64,
    duration_s: f64,
    end: &'static str,
    reason: Option<&'a str>,
    lost_counted: &'a str,
    clock: Option<Clock>,
    arrival_spread_s: f64,
}

/// The device's clock against the host's.
#[derive(Serialize)]
struct Clock {
    drift_1: f64,
    uncertainty_s: f64,
    latest_s: f64,
    compared_s: f64,
}

impl From<ClockMap> for Clock {
    fn from(map: ClockMap) -> Self {
        Self {
            drift_1: map.drift,
            uncertainty_s: map.uncertainty_s,
            latest_s: map.latest_s,
            compared_s: map.over_s,
        }
    }
}

fn tell(path: &Path, report: &SourceReport, json: bool) -> anyhow::Result<()> {
    let (end, reason) = match &report.end {
        SourceEnd::Finished => ("finished", None),
        SourceEnd::Stopped => ("stopped", None),
        SourceEnd::Gone(reason) => ("link broken", Some(reason.as_str())),
    };
    let (summary, counts) = (&report.summary, &report.counts);
    if let Some(map) = report.clock.filter(|map| map.drift.abs() > DRIFT) {
        output::warn(format_args!(
            "the device's clock ran {:+.2} % against this computer's, more than a crystal does: speeds by it are wrong by as much, unless this computer's clock is",
            100.0 * map.drift
        ));
    }
    if json {
        return output::print_json(&Document {
            schema: "socam.run/1",
            recording: path.display().to_string(),
            samples: summary.written,
            lost: summary.lost,
            missed: summary.missed,
            overflowed: summary.overflowed,
            refused: summary.refused,
            repeated: counts.repeated,
            late: counts.late,
            damaged: counts.damaged,
            clock_jumps: counts.jumps,
            interruptions: report.interruptions,
            strangers: report.strangers,
            bytes: summary.bytes,
            duration_s: report.duration_s,
            end,
            reason,
            lost_counted: &report.counted_by,
            clock: report.clock.map(Clock::from),
            arrival_spread_s: report.arrival_spread_s,
        });
    }
    output::print(&text(path, report))
}

/// The result in words: `run.mcap: 5000 samples over 5.000 s, none lost (counted by ...); 2 damaged messages`.
fn text(path: &Path, report: &SourceReport) -> String {
    let (summary, counts) = (&report.summary, &report.counts);
    let lost = if summary.lost == 0 { "none lost".to_owned() } else { format!("{} lost", summary.lost) };
    let mut text = format!(
        "{}: {} samples over {:.3} s, {lost} (counted {})",
        path.display(),
        summary.written,
        report.duration_s,
        report.counted_by
    );
    for (count, what) in [
        (counts.damaged, "damaged messages"),
        (counts.repeated, "repeated"),
        (counts.late, "late ones left out"),
        (counts.jumps, "jumps of the device's clock"),
        (report.interruptions, "interruptions of the link"),
        (report.strangers, "packets of other senders left out"),
    ] {
        if count > 0 {
            text.push_str(&format!(", {count} {what}"));
        }
    }
    if report.end == SourceEnd::Stopped {
        text.push_str(", stopped by the operator");
    }
    let clock = match &report.clock {
        Some(map) => format!(
            "times by the device's clock, which ran {:+.1} ppm against this computer's within {:.3} ms over {:.1} s",
            map.drift * 1e6,
            map.uncertainty_s * 1e3,
            map.over_s
        ),
        None if report.arrival_spread_s > 0.0 => {
            format!("times are those of arrival, within {:.1} ms", report.arrival_spread_s * 1e3)
        }
        None => "the clocks were compared for too short a time to say more".to_owned(),
    };
    text.push_str(&format!("\n{clock}\n"));
    text
}

fn outcome(path: &Path, report: &SourceReport) -> anyhow::Result<Outcome> {
    match &report.end {
        SourceEnd::Gone(reason) => {
            anyhow::bail!("{reason} (what was recorded until then is in {})", path.display())
        }
        _ if report.summary.lost > 0 => Ok(Outcome::LostSamples),
        _ => Ok(Outcome::Done),
    }
}
