//! Listens to a device before anything is recorded, to find out what it sends.

use std::time::Duration;

use anyhow::bail;
use socam_sources::text::{Bounds, Found, TextDevice, probe};
use socam_sources::{Description, Device, Heard};

use super::link::{Arrived, Link};
use crate::interrupt::Interrupt;

/// Time for which a device is listened to, once it sends.
const LISTEN_NS: i64 = 1_500_000_000;
/// Longest time until it sends.
const SILENT_AFTER: Duration = Duration::from_secs(8);
/// Most bytes that are kept meanwhile.
const MOST_BYTES: usize = 1 << 23;
/// Speed of the device's clock against this computer's that is believed; other units are a thousand times faster.
const CLOCK_RATIO: std::ops::Range<f64> = 0.5..2.0;
/// Shortest time over which the clocks are compared, ns.
const COMPARE_NS: i64 = 500_000_000;

/// What was heard; it becomes the beginning of the recording.
pub(crate) struct Listened(pub(crate) Vec<Arrived>);

/// Listens for one and a half seconds.
pub(crate) fn listen(link: &mut Link, name: &str, interrupt: &Interrupt) -> anyhow::Result<Listened> {
    let mut heard: Vec<Arrived> = Vec::new();
    let (mut first_ns, mut bytes) = (None, 0);
    while first_ns.is_none_or(|first_ns| link.now_ns() - first_ns < LISTEN_NS) && bytes < MOST_BYTES {
        if interrupt.count() > 0 {
            bail!("stopped before the first sample");
        }
        match link.read() {
            Ok(Some(arrived)) => {
                first_ns.get_or_insert(link.now_ns());
                bytes += arrived.bytes.len();
                heard.push(arrived);
            }
            Ok(None) if first_ns.is_none() && link.now_ns() > SILENT_AFTER.as_nanos() as i64 => {
                bail!(
                    "{name} says nothing (waited {} s): is it the right address, does the device run, and does no other program hold it?",
                    SILENT_AFTER.as_secs()
                );
            }
            Ok(None) => {}
            Err(error) => bail!("the link to {name} broke before the first sample: {error}"),
        }
    }
    Ok(Listened(heard))
}

impl Listened {
    /// The bytes as a device takes them.
    #[cfg(feature = "formats-can")]
    pub(crate) fn chunks(&self) -> Vec<socam_sources::Chunk<'_>> {
        self.0.iter().map(Arrived::chunk).collect()
    }

    /// What the device sends, as far as it states it.
    pub(crate) fn probe(&self, bounds: Bounds, take_guesses: bool) -> socam_sources::Result<Found> {
        let chunks: Vec<_> = self.0.iter().map(Arrived::chunk).collect();
        probe(&chunks, bounds, take_guesses)
    }

    /// Checks a description against what was heard: there are rows, and the device's clock has the stated unit.
    pub(crate) fn check(&self, description: &Description, bounds: Bounds) -> anyhow::Result<()> {
        let mut device = TextDevice::new(description.clone(), bounds);
        let mut heard = Vec::new();
        self.0.iter().for_each(|arrived| device.receive(arrived.chunk(), &mut heard));
        let rows: Vec<_> = heard
            .iter()
            .filter_map(|heard| if let Heard::Row(row) = heard { Some(row) } else { None })
            .collect();
        let problem =
            heard.iter().find_map(|heard| if let Heard::Damaged(why) = heard { Some(*why) } else { None });
        let (Some(first), Some(last)) = (rows.first(), rows.last()) else {
            let bytes: usize = self.0.iter().map(|arrived| arrived.bytes.len()).sum();
            bail!(
                "none of the {bytes} bytes that arrived make a row of the description ({}): is it that of this device, and is the baud rate right?",
                problem.unwrap_or("no line has its names")
            );
        };
        let host_ns = last.arrival_ns - first.arrival_ns;
        if let (Some(first_s), Some(last_s)) = (first.device_s, last.device_s)
            && host_ns >= COMPARE_NS
            && last_s > first_s
        {
            let ratio = (last_s - first_s) / (host_ns as f64 * 1e-9);
            if !CLOCK_RATIO.contains(&ratio) {
                let ratio = socam_findings::words::rough(ratio);
                let clock = description.clock.as_ref().map_or("", |clock| clock.signal.as_str());
                bail!(
                    "the device's clock `{clock}` runs {ratio} times as fast as this computer's: correct its unit in the description"
                );
            }
        }
        Ok(())
    }
}
