//! Opens a device for the live view. One whose units are not known is shown as plain numbers.

use anyhow::anyhow;
use socam_sources::text::TextDevice;
use socam_sources::{Description, Device as _, SourceError, Timeline};
use socam_workbench::device::{Effort, Offer, Peer, Source, Unstated};

use crate::commands::record::described::SourceArgs;
use crate::commands::record::following;
use crate::commands::record::opened::Opened;
use crate::commands::record::source;
use crate::device::source::{Link, Node, Protocol, SourceAddress, listen};
use crate::interrupt::Interrupt;

/// A device that is ready to be shown.
pub(super) struct Ready {
    pub(super) opened: Opened,
    /// What the window is told of it.
    pub(super) peer: Peer,
    /// What the device does not state, so that it cannot be recorded.
    pub(super) unstated: Option<String>,
}

/// Opens a device as `record` does, but shows plain numbers where the device does not state units and no description does.
pub(super) fn open(
    link: &mut Link,
    address: &SourceAddress,
    args: &SourceArgs,
    period_ns: i64,
) -> anyhow::Result<Ready> {
    let is_described = args.describe.as_ref().is_some_and(|file| file.exists());
    let (opened, unstated) = if address.protocol == Protocol::Text && !is_described && !args.accept_guesses {
        plain(link, &address.to_string())?
    } else {
        (source::open(link, args, period_ns, address, &Interrupt::default())?, None)
    };
    let sentence = unstated.as_ref().map(|unstated| unstated.sentence.clone());
    let source = Source { is_asked: is_asked(&address.protocol), offer: offer(address), unstated };
    Ok(Ready { opened, peer: Peer::Source(source), unstated: sentence })
}

fn is_asked(protocol: &Protocol) -> bool {
    !matches!(protocol, Protocol::Text | Protocol::Foxglove(_) | Protocol::Can(Node::Dbc))
}

/// How a drive is commanded; `None` for devices that take no commands.
fn offer(address: &SourceAddress) -> Option<Offer> {
    let (effort, not_promised) = following::offered(address)?;
    let (effort, limit) = match effort {
        following::Effort::Torque => (Effort::Torque, "0.5Nm"),
        following::Effort::Current => (Effort::Current, "5A"),
    };
    let command = format!(
        "socam-host record --device '{address}' -o run.mcap --profile speeds.toml --limit 30rad/s --limit {limit} --arm"
    );
    Some(Offer { effort, kept: Vec::new(), not_promised, command })
}

/// A device of text by what it sends, with plain numbers where it states no units.
fn plain(link: &mut Link, name: &str) -> anyhow::Result<(Opened, Option<Unstated>)> {
    let heard = listen(link, name, &Interrupt::default())?;
    let named = |error: SourceError| anyhow!("{name}: {error}");
    let found = heard.probe(link.bounds(), false).map_err(named)?;
    let (text, unstated) = match found.description() {
        Ok(_) => (found.text, None),
        Err(error @ SourceError::Unstated { .. }) => {
            let unstated = Unstated { sentence: error.to_string(), description: found.text };
            (found.plain, Some(unstated))
        }
        Err(error) => return Err(named(error)),
    };
    let description = Description::parse(&text).map_err(named)?;
    heard.check(&description, link.bounds())?;
    let device = TextDevice::new(description, link.bounds());
    let timeline = Timeline::new(device.numbering(), device.clock_wrap_s());
    Ok((Opened { device: Box::new(device), timeline, heard, description: Some(text) }, unstated))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drive_says_what_it_does_not_promise_and_a_sensor_takes_no_commands() {
        let of = |text: &str| offer(&text.parse().unwrap());
        let moteus = of("moteus:/dev/ttyACM0?id=3").unwrap();
        assert!(moteus.command.contains("--device 'moteus:/dev/ttyACM0?id=3'"), "{}", moteus.command);
        assert!(moteus.not_promised.iter().any(|sentence| sentence.contains("a weight falls")));
        let odrive = of("odrive:/dev/ttyACM0?axis=1").unwrap();
        assert!(odrive.effort == Effort::Current && odrive.not_promised.len() == 2);
        assert_eq!([of("udp:0.0.0.0:9870"), of("dynamixel:/dev/ttyUSB0")], [None, None]);
    }
}
