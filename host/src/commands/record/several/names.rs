//! Names of devices and of their channels in a recording of several.

use socam_recording::Channel;

use super::attended::Ready;
use crate::device::source::{Place, Protocol, SourceAddress};

/// A short name of each device, of letters and digits, that no other one has: `moteus1`, `udp`, `serial`, `serial2`.
pub(super) fn labels(addresses: &[SourceAddress]) -> Vec<String> {
    let mut labels: Vec<String> = Vec::new();
    for address in addresses {
        let name = match (&address.protocol, &address.place) {
            (Protocol::Text, Place::Serial(..)) => "serial".to_owned(),
            (Protocol::Text, Place::Tcp(_)) => "tcp".to_owned(),
            (Protocol::Text, Place::Udp(_)) => "udp".to_owned(),
            // `moteus:/dev/ttyACM0?id=1`: its kind and its number.
            _ => {
                let text = address.to_string();
                let kind = text.split([':', '+']).next().unwrap_or("device");
                let number: String = text.rsplit(['?', '&']).find_map(number).unwrap_or_default();
                format!("{kind}{number}")
            }
        };
        let numbered = (2..).map(|number| format!("{name}_{number}"));
        let free = std::iter::once(name.clone()).chain(numbered).find(|name| !labels.contains(name));
        labels.push(free.unwrap_or(name));
    }
    labels
}

/// The number of a drive: of `id=1` or `axis=0`.
fn number(option: &str) -> Option<String> {
    let value = ["id=", "axis=", "node="].iter().find_map(|key| option.strip_prefix(key))?;
    Some(value.replace(',', "_"))
}

/// Channels of all devices in their order; those whose name two devices have are prefixed by their device.
pub(super) fn channels(labels: &[String], ready: &[Ready], order: &[usize]) -> Vec<Channel> {
    let devices_with = |name: &str| {
        let has = |device: &&Ready| device.channels.iter().any(|channel| channel.name == name);
        ready.iter().filter(has).count()
    };
    let mut channels: Vec<Channel> = Vec::new();
    for device in order {
        for channel in &ready[*device].channels {
            let name = if devices_with(&channel.name) > 1 {
                format!("{}_{}", labels[*device], channel.name)
            } else {
                channel.name.clone()
            };
            channels.push(Channel::new(name, channel.unit));
        }
    }
    channels
}

#[cfg(test)]
mod tests {
    use socam_recording::Unit;

    use super::*;

    #[test]
    fn channels_of_the_same_name_are_told_apart_by_their_device() {
        let address = |text: &str| text.parse::<SourceAddress>().unwrap();
        let addresses = [
            "moteus:/dev/ttyACM0?id=3",
            "udp:0.0.0.0:9870",
            "udp:0.0.0.0:9871",
            "dynamixel:/dev/ttyUSB0?id=7&baud=57600",
            "feetech:/dev/ttyUSB1?id=1,2&baud=1000000",
            "odrive+socketcan:can0?node=4",
        ];
        let labels = labels(&addresses.map(address));
        assert_eq!(labels, ["moteus3", "udp", "udp_2", "dynamixel7", "feetech1_2", "odrive4"]);
        let of = |names: &[&str]| Ready {
            kind: String::new(),
            channels: names.iter().map(|name| Channel::new(*name, Unit::RadPerS)).collect(),
            counted_by: String::new(),
            description: None,
        };
        let ready = [of(&["speed", "torque"]), of(&["speed", "load_speed"])];
        let names: Vec<String> =
            channels(&labels[..2], &ready, &[1, 0]).into_iter().map(|channel| channel.name).collect();
        assert_eq!(names, ["udp_speed", "load_speed", "moteus3_speed", "torque"]);
    }
}
