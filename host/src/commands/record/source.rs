//! `record` of a device that is not the own board.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use socam_monitoring::Monitor;
use socam_recording::{MACHINE_KEY, RecordingHeader};
use socam_sources::dynamixel::Dynamixel;
use socam_sources::moteus::Moteus;
use socam_sources::odrive::Odrive;
use socam_sources::text::{Found, TextDevice};
use socam_sources::{Description, Device as _, SourceError, Timeline};

use super::can;
use super::drive::{self, Armed};
use super::opened::Opened;
use super::source_result::{outcome, tell};
use super::{Args, attachment, now_unix_ns, watched};
use crate::commands::Outcome;
use crate::device::Device;
use crate::device::source::{Link, Listened, Node, Protocol, SourceAddress, SourcePlan, listen, record};
use crate::interrupt::Interrupt;
use crate::live_watch::LiveWatch;
use crate::output::{self, WrongArguments};

/// Options of devices other than the own board.
#[derive(Debug, Clone, clap::Args)]
pub(super) struct SourceArgs {
    /// File that says what a device's lines hold: names, units, clock. If there is none, it is written, with a question mark for all that
    /// the device does not state; complete it and record again. For a drive with CANopen, the list of its objects
    #[arg(long, value_name = "D.toml")]
    describe: Option<PathBuf>,
    /// Take units that names suggest without asking, and leave out signals whose names suggest none
    #[arg(long)]
    accept_guesses: bool,
    /// DBC that says what the frames of a CAN bus hold
    #[arg(long, value_name = "FILE.dbc")]
    dbc: Option<PathBuf>,
}

#[cfg(feature = "formats-can")]
impl SourceArgs {
    /// The DBC of a bus.
    pub(super) fn dbc(&self) -> Option<&Path> {
        self.dbc.as_deref()
    }

    /// The description of a device.
    pub(super) fn description(&self) -> Option<&Path> {
        self.describe.as_deref()
    }
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
        let is_other = [
            "text+",
            "udp:",
            "moteus:",
            "odrive:",
            "dynamixel:",
            "slcan:",
            "socketcan:",
            "canopen+",
            "odrive+",
        ]
        .iter()
        .any(|kind| text.starts_with(kind))
            || text.contains("?baud=");
        if is_other {
            return text.parse().map(Self::Source);
        }
        let board = text.parse().map(Self::Board);
        board.map_err(|error: String| {
            format!("{error}; or another device: serial:PATH?baud=RATE, text+tcp:HOST:PORT, udp:HOST:PORT, moteus:PATH?id=1, odrive:PATH?axis=0, dynamixel:PATH?id=1, slcan:PATH?bitrate=500k, socketcan:can0, odrive+slcan:PATH?bitrate=500k&node=1, canopen+socketcan:can0?node=5")
        })
    }
}

/// The device, which a description makes one of lines of text.
pub(super) fn of(target: &Target, args: &SourceArgs) -> Result<Target, WrongArguments> {
    let Target::Board(board) = target else { return Ok(target.clone()) };
    if args.dbc.is_some() {
        return Err(WrongArguments(format!(
            "--dbc says what the frames of a CAN bus hold, not what {board} sends"
        )));
    }
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
    let armed = drive::armed(args, address)?;
    let mut link = Link::open(&address.place)?;
    let opened_unix_ns = now_unix_ns();
    let (opened, commanded) = match armed {
        Some(Armed { device, profile, limits }) => {
            refuse_description(&args.source)?;
            (Opened::asked(device), Some((profile, limits)))
        }
        None => (open(&mut link, args, address, &interrupt)?, None),
    };
    let Opened { mut device, timeline, heard, description } = opened;
    let channels = device.channels().to_vec();
    let watch = watched.map(|(model, baseline)| {
        let monitor = Monitor::new(&model, &channels, baseline, args.watch.watching.settings())?;
        LiveWatch::start(monitor, channels.len(), false)
    });
    let mut header = RecordingHeader::new(channels);
    let duration_s = args.record.duration_s.filter(|_| commanded.is_none());
    header.planned_duration_s = duration_s;
    header.replace = args.force;
    header.metadata = metadata(args, &name, &*device, &timeline);
    let is_commanded = commanded.is_some();
    if let Some((profile, limits)) = commanded {
        header.planned_duration_s = Some(profile.duration_s + profile.ramp_s);
        header.metadata.insert("profile".into(), args.record.profile.clone().unwrap_or_default());
        header.metadata.insert("limits".into(), limits);
        header.attachments.extend(attachment("profile.toml", profile.to_toml()));
    }
    header.attachments.extend(description.into_iter().flat_map(|text| attachment("device.toml", text)));
    header.attachments.extend(attachment("model.toml", socam_job::model_text(&args.bench.model)?));
    let plan = SourcePlan { name, path: path.into(), opened_unix_ns, header, duration_s };
    let report = record(&mut link, &mut *device, timeline, plan, heard, watch.transpose()?, &interrupt)?;
    tell(path, &report, is_commanded, args.json)?;
    outcome(path, &report)
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
        Protocol::Dynamixel(id) => Box::new(Dynamixel::new(id, period_ns)?),
        Protocol::Can(node) => {
            // A list of objects describes a drive with CANopen.
            if args.source.accept_guesses || !matches!(node, Node::Canopen(_)) {
                refuse_description(&args.source)?;
            }
            return can::open(link, args, address, node, interrupt);
        }
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
    refuse_description(&args.source)?;
    Ok(Opened::asked(asked))
}

fn refuse_description(args: &SourceArgs) -> Result<(), WrongArguments> {
    if args.describe.is_some() || args.accept_guesses {
        let problem = "--describe and --accept-guesses are for devices that send lines of text; a drive states its units, and a DBC those of a bus";
        return Err(WrongArguments(problem.into()));
    }
    Ok(())
}

/// Options that only the own board, or a virtual bench, understands.
fn refuse_board_options(args: &Args, address: &SourceAddress) -> Result<(), WrongArguments> {
    let is_can = address.protocol == Protocol::Can(Node::Dbc);
    if args.source.dbc.is_some() && !is_can {
        return Err(WrongArguments(format!(
            "--dbc says what the frames of a CAN bus hold, not what {address} sends"
        )));
    }
    let given = [
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
