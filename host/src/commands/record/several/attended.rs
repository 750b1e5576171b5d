//! The thread of a device.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use socam_recording::Channel;
use socam_sources::Counts;

use crate::commands::record::described::SourceArgs;
use crate::commands::record::opened::Opened;
use crate::commands::record::source::open;
use crate::device::source::{Got, Link, Listener, SourceAddress};
use crate::interrupt::Interrupt;

/// Longest time for which a device may be gone or silent.
const GONE: Duration = Duration::from_secs(10);

/// What a thread tells of its device.
pub(super) enum Message {
    /// It was opened.
    Ready(Ready),
    /// It was heard; times of arrival are those since the recorder began.
    Got(Got),
    /// It is gone, or was never there.
    Gone(String),
}

/// A device that was opened.
#[derive(Debug, Clone)]
pub(super) struct Ready {
    pub(super) kind: String,
    pub(super) channels: Vec<Channel>,
    pub(super) counted_by: String,
    /// Text of its description, if it has one.
    pub(super) description: Option<String>,
}

/// A device after its recording.
#[derive(Debug, Clone)]
pub(super) struct Attended {
    pub(super) address: String,
    pub(super) rows: u64,
    /// Rows that did not arrive, as far as that is noticed.
    pub(super) lost: u64,
    pub(super) counts: Counts,
    pub(super) interruptions: u64,
    /// Packets of other senders, which were left out.
    pub(super) strangers: u64,
    pub(super) counted_by: String,
    /// Largest spread of times of arrival that rows took their times from, s.
    pub(super) arrival_spread_s: f64,
}

/// Opens a device, and attends to it until the recording is over; `None` if it could not be opened. `begin`: when the recorder began.
pub(super) fn attend(
    address: &SourceAddress,
    args: &SourceArgs,
    period_ns: i64,
    begin: Instant,
    is_over: &AtomicBool,
    tell: impl Fn(Message),
) -> Option<Attended> {
    let opened = || -> anyhow::Result<(Listener, Vec<Got>, i64)> {
        let mut link = Link::open(&address.place)?;
        // The link's clock begins later than the recorder's.
        let since_ns = i64::try_from(begin.elapsed().as_nanos()).unwrap_or(i64::MAX) - link.now_ns();
        let Opened { device, timeline, heard, description } =
            open(&mut link, args, period_ns, address, &Interrupt::default())?;
        let (kind, channels) = (device.kind(), device.channels().to_vec());
        tell(Message::Ready(Ready { kind, channels, counted_by: timeline.counted_by(), description }));
        let mut listener = Listener::new(link, device, timeline, address.to_string());
        let got = listener.begin(&heard);
        Ok((listener, got, since_ns))
    };
    let (mut listener, mut got, since_ns) = match opened() {
        Ok(opened) => opened,
        Err(error) => {
            tell(Message::Gone(format!("{error:#}")));
            return None;
        }
    };
    let (mut rows, mut lost, mut last) = (0, 0, None);
    let mut heard = Instant::now();
    loop {
        for mut one in got {
            if let Got::Rows(own) = &mut one {
                heard = Instant::now();
                for row in own {
                    row.arrival_ns += since_ns;
                    rows += 1;
                    lost += last.map_or(0, |last: u64| row.sequence.saturating_sub(last + 1));
                    last = Some(row.sequence);
                }
            }
            tell(Message::Got(one));
        }
        if is_over.load(Ordering::Relaxed) {
            break;
        }
        got = match listener.turn() {
            Ok(got) => got,
            Err(error) => {
                tell(Message::Gone(format!("{address}: {error}")));
                break;
            }
        };
        if heard.elapsed() > GONE {
            let reason = listener.away.clone().unwrap_or_else(|| format!("{address} sends no rows any more"));
            tell(Message::Gone(reason));
            break;
        }
    }
    Some(Attended {
        address: address.to_string(),
        rows,
        lost,
        counts: listener.timeline.counts(),
        interruptions: listener.interruptions,
        strangers: listener.strangers(),
        counted_by: listener.timeline.counted_by(),
        arrival_spread_s: listener.timeline.arrival_spread_s(),
    })
}
