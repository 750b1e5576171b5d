//! `record` of a device that is not the own board.

use std::collections::BTreeMap;
use std::path::Path;
use std::str::FromStr;

use socam_recording::{MACHINE_KEY, RecordingHeader};
use socam_sources::moteus::Moteus;
use socam_sources::odrive::Odrive;
use socam_sources::text::TextDevice;
use socam_sources::{Device as _, Timeline, dynamixel, feetech};

use super::described::{SourceArgs, described};
use super::drive;
use super::following::Following;
use super::opened::Opened;
use super::source_result::{outcome, tell};
use super::{Args, attachment, now_unix_ns, watch, watched};
use super::{can, foxglove};
use crate::commands::Outcome;
use crate::device::Device;
use crate::device::source::{
    Link, Node, Protocol, SourceAddress, SourcePlan, SourceWriter, Terminal, listen, record,
};
use crate::interrupt::Interrupt;
use crate::output::WrongArguments;

/// What `--device` names.
#[derive(Debug, Clone)]
pub(crate) enum Target {
    Board(Device),
    Source(SourceAddress),
}

impl std::fmt::Display for Target {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Board(board) => board.fmt(f),
            Self::Source(address) => address.fmt(f),
        }
    }
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
            "feetech:",
            "foxglove:",
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
            format!("{error}; or another device: serial:PATH?baud=RATE, text+tcp:HOST:PORT, udp:HOST:PORT, moteus:PATH?id=1, odrive:PATH?axis=0, dynamixel:PATH?id=1,2, feetech:PATH?id=1,2, foxglove:HOST:PORT?topics=/joint_states, slcan:PATH?bitrate=500k, socketcan:can0, odrive+slcan:PATH?bitrate=500k&node=1, canopen+socketcan:can0?node=5")
        })
    }
}

/// The device, which a description makes one of lines of text.
pub(crate) fn of(target: &Target, args: &SourceArgs) -> Result<Target, WrongArguments> {
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
        Some(Following { device, terms }) => {
            let list = args.source.describe.as_deref().filter(|_| has_list(address));
            if list.is_none() || args.source.accept_guesses {
                refuse_description(&args.source)?;
            }
            let description = list.map(socam_recording::read_text).transpose()?;
            (Opened { description, ..Opened::asked(device) }, Some(terms))
        }
        None => {
            let period_ns = i64::from(args.record.period_us()?) * 1000;
            (open(&mut link, &args.source, period_ns, address, &interrupt)?, None)
        }
    };
    let Opened { mut device, timeline, heard, description } = opened;
    let mut header = RecordingHeader::new(device.channels().to_vec());
    header.start_unix_ns = opened_unix_ns;
    let duration_s = args.record.duration_s.filter(|_| commanded.is_none());
    header.planned_duration_s = duration_s;
    header.replace = args.force;
    let serve = args.serve(device.channels(), opened_unix_ns)?;
    header.metadata = metadata(&name, &*device, &timeline);
    header.metadata.extend(args.note.clone().map(|note| ("note".into(), note)));
    header.metadata.extend(args.machine.clone().map(|machine| (MACHINE_KEY.into(), machine)));
    let is_commanded = commanded.is_some();
    if let Some(terms) = commanded {
        terms.describe(&mut header);
    }
    header.attachments.extend(description.into_iter().flat_map(|text| attachment("device.toml", text)));
    header.attachments.extend(attachment("model.toml", socam_job::model_text(&args.bench.model)?));
    let plan = SourcePlan { name, file: SourceWriter::new(path.into(), header), duration_s, serve };
    let watch = watch(args, watched, device.channels(), false)?;
    let report = record(
        &mut link,
        &mut *device,
        timeline,
        plan,
        heard,
        watch,
        &mut Terminal::new(&interrupt, duration_s),
    )?;
    tell(path, &report, is_commanded, args.json)?;
    outcome(path, &report)
}

/// Makes the protocol of a device; a device of text is listened to first.
pub(crate) fn open(
    link: &mut Link,
    args: &SourceArgs,
    period_ns: i64,
    address: &SourceAddress,
    interrupt: &Interrupt,
) -> anyhow::Result<Opened> {
    let name = address.to_string();
    let asked: Box<dyn socam_sources::Device> = match &address.protocol {
        Protocol::Moteus(id) => Box::new(Moteus::new(*id, period_ns)?),
        Protocol::Odrive(axis) => Box::new(Odrive::new(*axis, period_ns)?),
        Protocol::Dynamixel(ids) => Box::new(dynamixel::servos(ids, period_ns)?),
        Protocol::Feetech(ids) => Box::new(feetech::servos(ids, period_ns)?),
        Protocol::Can(node) => {
            if args.accept_guesses || !has_list(address) {
                refuse_description(args)?;
            }
            return can::open(link, args, period_ns, address, *node, interrupt);
        }
        Protocol::Foxglove(topics) => return foxglove::open(link, &name, topics, args, interrupt),
        Protocol::Text => {
            let heard = listen(link, &name, interrupt)?;
            let bounds = link.bounds();
            let found = |take_guesses| heard.probe(bounds, take_guesses);
            let description = described(args, &name, found, |description| heard.check(description, bounds))?;
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
    refuse_description(args)?;
    Ok(Opened::asked(asked))
}

/// Whether a list of objects describes the device.
fn has_list(address: &SourceAddress) -> bool {
    matches!(address.protocol, Protocol::Can(Node::Canopen(_)))
}

fn refuse_description(args: &SourceArgs) -> Result<(), WrongArguments> {
    if args.describe.is_some() || args.accept_guesses {
        let problem = "--describe and --accept-guesses are for devices that send lines of text; a drive states its units, and a DBC those of a bus";
        return Err(WrongArguments(problem.into()));
    }
    Ok(())
}

/// Options that only the own board, or a virtual bench, understands.
pub(super) fn refuse_board_options(args: &Args, address: &SourceAddress) -> Result<(), WrongArguments> {
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

/// What a recording of a device says of it.
pub(crate) fn metadata(
    name: &str,
    device: &dyn socam_sources::Device,
    timeline: &Timeline,
) -> BTreeMap<String, String> {
    BTreeMap::from([
        ("device".to_owned(), name.to_owned()),
        ("device_kind".to_owned(), device.kind()),
        ("lost_samples".to_owned(), format!("counted {}", timeline.counted_by())),
        ("host".to_owned(), env!("CARGO_PKG_VERSION").to_owned()),
    ])
}
