//! `record` of a CAN bus: what its frames hold is said by a DBC, and found by listening.

use std::path::Path;

use crate::device::source::{Bus, Link};
use crate::interrupt::Interrupt;
use crate::output::WrongArguments;

use super::opened::Opened;

/// Opens the adapter to listen only, and finds which frames the bus has.
#[cfg(feature = "formats-can")]
pub(super) fn open(
    link: &mut Link,
    name: &str,
    bus: &Bus,
    dbc: Option<&Path>,
    interrupt: &Interrupt,
) -> anyhow::Result<Opened> {
    use std::sync::Arc;

    use socam_import::CanSignals;
    use socam_sources::can::{Access, CanBus, survey};
    use socam_sources::{Device, Timeline};

    use crate::device::source::listen;
    use crate::output;

    let Some(dbc) = dbc else {
        let problem = format!("{name}: what the frames hold is not known: name a DBC by --dbc FILE");
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

/// A program without a reader of DBC.
#[cfg(not(feature = "formats-can"))]
pub(super) fn open(
    _: &mut Link,
    name: &str,
    _: &Bus,
    _: Option<&Path>,
    _: &Interrupt,
) -> anyhow::Result<Opened> {
    let problem = format!("{name}: this program was built without `formats-can`, which reads a CAN bus");
    Err(WrongArguments(problem).into())
}
