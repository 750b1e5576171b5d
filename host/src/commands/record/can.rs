//! `record` of a CAN bus: what its frames hold is said by a DBC, and found by listening.

#[cfg(feature = "formats-can")]
use crate::device::source::{Bus, Place};
use crate::device::source::{Link, Node, SourceAddress};
use crate::interrupt::Interrupt;
use crate::output::WrongArguments;

use super::described::SourceArgs;
use super::opened::Opened;

/// Opens what is recorded of a bus.
#[cfg(feature = "formats-can")]
pub(super) fn open(
    link: &mut Link,
    args: &SourceArgs,
    period_ns: i64,
    address: &SourceAddress,
    node: Node,
    interrupt: &Interrupt,
) -> anyhow::Result<Opened> {
    match node {
        Node::Dbc => listened(link, &address.to_string(), bus(address)?, args, interrupt),
        Node::Odrive(node) => Ok(Opened::asked(Box::new(odrive(address, node, period_ns)?))),
        Node::Canopen(node) => canopen(args, address, node, period_ns),
    }
}

/// Opens the adapter to listen only, and finds which frames the bus has.
#[cfg(feature = "formats-can")]
fn listened(
    link: &mut Link,
    name: &str,
    bus: &Bus,
    args: &SourceArgs,
    interrupt: &Interrupt,
) -> anyhow::Result<Opened> {
    use std::sync::Arc;

    use socam_import::CanSignals;
    use socam_sources::can::{Access, CanBus, survey};
    use socam_sources::{Device, Timeline};

    use crate::device::source::listen;
    use crate::output;

    let Some(dbc) = args.dbc.as_deref() else {
        let problem = format!("{name}: what the frames hold is not known: name a DBC {}", args.by_dbc());
        return Err(WrongArguments(problem).into());
    };
    let signals = Arc::new(CanSignals::open(dbc)?);
    let opening = opening(name, bus, Access::Listen)?;
    link.send(&opening)?;
    let heard = listen(link, name, interrupt)?;
    let found = survey(&heard.chunks(), signals).map_err(|error| anyhow::anyhow!("{name}: {error}"))?;
    found.notes.iter().for_each(output::warn);
    output::say(format_args!("{name}: {}; values of other frames are interpolated, or missing", found.rows));
    let device = CanBus::new(found, opening);
    let timeline = Timeline::new(device.numbering(), None);
    Ok(Opened { device: Box::new(device), timeline, heard, description: None })
}

/// The ODrive of a number on a bus, asked at an interval.
#[cfg(feature = "formats-can")]
pub(super) fn odrive(
    address: &SourceAddress,
    node: u8,
    period_ns: i64,
) -> anyhow::Result<socam_sources::can::odrive::OdriveCan> {
    use socam_sources::can::{Access, odrive::OdriveCan};

    let opening = opening(&address.to_string(), bus(address)?, Access::Send)?;
    Ok(OdriveCan::new(node, period_ns, opening)?)
}

/// The drive of a number on a bus, by the list of its objects.
#[cfg(feature = "formats-can")]
fn canopen(args: &SourceArgs, address: &SourceAddress, node: u8, period_ns: i64) -> anyhow::Result<Opened> {
    use socam_sources::can::Access;
    use socam_sources::can::canopen::{Canopen, Objects};

    let Some(list) = args.describe.as_deref() else {
        return Err(without_list(address, args.by_description()).into());
    };
    let opening = opening(&address.to_string(), bus(address)?, Access::Send)?;
    let device = Canopen::new(node, Objects::open(list)?, period_ns, opening)?;
    let text = socam_recording::read_text(list)?;
    Ok(Opened { description: Some(text), ..Opened::asked(Box::new(device)) })
}

/// The same drive to be commanded, which its list must allow.
#[cfg(feature = "formats-can")]
pub(super) fn commanded(
    address: &SourceAddress,
    list: Option<&std::path::Path>,
    node: u8,
    period_ns: i64,
) -> anyhow::Result<socam_sources::can::canopen::CanopenDrive> {
    use socam_sources::can::Access;
    use socam_sources::can::canopen::{CanopenDrive, Objects};

    let Some(list) = list else {
        return Err(without_list(address, "by --describe FILE").into());
    };
    let opening = opening(&address.to_string(), bus(address)?, Access::Send)?;
    let drive = CanopenDrive::new(node, Objects::open(list)?, period_ns, opening);
    drive.map_err(|error| anyhow::anyhow!("`{}`: {error}", list.display()))
}

#[cfg(feature = "formats-can")]
fn without_list(address: &SourceAddress, how: &str) -> WrongArguments {
    WrongArguments(format!(
        "{address}: which objects are recorded is not known: name a list of them {how}, as docs/devices.md explains it"
    ))
}

/// The bus of an address.
#[cfg(feature = "formats-can")]
fn bus(address: &SourceAddress) -> anyhow::Result<&Bus> {
    match &address.place {
        Place::Bus(bus) => Ok(bus),
        _ => anyhow::bail!("{address} is no CAN bus"),
    }
}

/// The commands that open the adapter of a bus.
#[cfg(feature = "formats-can")]
pub(super) fn opening(
    name: &str,
    bus: &Bus,
    access: socam_sources::can::Access,
) -> Result<Vec<u8>, WrongArguments> {
    let bitrate = if let Bus::Slcan(_, rate) = bus { Some(*rate) } else { None };
    socam_sources::can::opening(bitrate, access)
        .map_err(|problem| WrongArguments(format!("{name}: {problem}")))
}

/// A program without CAN.
#[cfg(not(feature = "formats-can"))]
pub(super) fn open(
    _: &mut Link,
    _: &SourceArgs,
    _: i64,
    address: &SourceAddress,
    _: Node,
    _: &Interrupt,
) -> anyhow::Result<Opened> {
    let problem = format!("{address}: this program was built without `formats-can`, which reads a CAN bus");
    Err(WrongArguments(problem).into())
}
