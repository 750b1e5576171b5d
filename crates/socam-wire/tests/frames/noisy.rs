//! Ten minutes at 10 kHz over a link on which one byte in a thousand is damaged: what arrives is right, and the rest is counted.

use socam_core::{
    Board, Channel, Command, Config, ConverterSilent, Layout, Ports, Profile, Request, Ring, Sample, Shape,
    State,
};
use socam_wire::{BoardLink, Decoder, Encoder, LinkCounts, MAX_FRAME, ToHost};

use crate::common::{frame, identity, numbered};

const TICKS: u32 = 6_000_000;
const PERIOD_US: u32 = 100;
const CHANNELS: u8 = 4;
const HEARTBEAT_EVERY: u32 = 1000;
/// One byte in this number is damaged.
const DAMAGED: u64 = 1000;

/// Reading of a channel at a tick: every sample differs from the one before and from its neighbours.
fn reading(tick: u32, channel: u32) -> i16 {
    ((tick.wrapping_mul(2_654_435_761) >> 13) ^ channel.wrapping_mul(0x5bd1)) as i16
}

struct Known {
    now_us: u64,
}

impl Ports for Known {
    type Count = i16;

    fn now_us(&mut self) -> u64 {
        self.now_us
    }
    fn read(&mut self, counts: &mut [i16]) -> Result<(), ConverterSilent> {
        let tick = (self.now_us / u64::from(PERIOD_US)) as u32;
        (0..).zip(counts).for_each(|(channel, count)| *count = reading(tick, channel));
        Ok(())
    }
    fn write(&mut self, _: i16) -> Result<(), ConverterSilent> {
        Ok(())
    }
    fn enable(&mut self, _: bool) {}
}

/// A line that flips a bit of a byte, drops it, doubles it, or puts it behind its successor.
struct Line {
    random: u64,
    held: Option<u8>,
    damaged: u64,
    bytes: u64,
}

impl Line {
    fn new(seed: u64) -> Self {
        Self { random: seed, held: None, damaged: 0, bytes: 0 }
    }

    fn random(&mut self) -> u64 {
        self.random ^= self.random << 13;
        self.random ^= self.random >> 7;
        self.random ^= self.random << 17;
        self.random >> 20
    }

    fn pass(&mut self, bytes: &[u8], out: &mut Vec<u8>) {
        for &byte in bytes {
            let random = self.random();
            self.bytes += 1;
            if !random.is_multiple_of(DAMAGED) {
                out.push(byte);
                out.extend(self.held.take());
                continue;
            }
            self.damaged += 1;
            match (random / DAMAGED) % 4 {
                0 => out.push(byte ^ 1 << (random / 4 / DAMAGED % 8)),
                1 => {}
                2 => out.extend([byte, byte]),
                _ => out.extend(self.held.replace(byte)),
            }
        }
    }
}

/// Counts of the samples that arrived and were lost, as the host sees them.
#[derive(Default)]
struct Account {
    arrived: u32,
    lost: u32,
    next_seq: u32,
}

impl Account {
    fn take(&mut self, sample: &Sample) {
        // The stream begins at the first tick.
        assert_eq!(sample.tick, sample.seq + 1);
        for (channel, count) in (0..u32::from(CHANNELS)).zip(sample.counts) {
            assert_eq!(count, i32::from(reading(sample.tick, channel)), "tick {}", sample.tick);
        }
        assert!(sample.seq >= self.next_seq, "a sample came twice");
        self.lost += sample.seq - self.next_seq;
        self.next_seq = sample.seq + 1;
        self.arrived += 1;
    }
}

fn config() -> Config {
    let mut config = Config { sample_period_us: PERIOD_US, ..Config::default() };
    // Readings here are no speeds; what may end the run is the converter's rail, which they do not reach twice.
    config.confirm_samples = 255;
    for channel in &mut config.channels {
        *channel = Channel { saturation_count: Some(i16::MAX), kind: channel.kind, ..Channel::UNUSED };
    }
    config
}

fn profile() -> Profile {
    Profile {
        command: Command::Voltage,
        shape: Shape::Constant { level_micro: 1_000_000 },
        ramp_us: 0,
        limit_micro: 1_000_000,
        slew_micro_s: 10_000_000,
        duration_us: 2 * u64::from(TICKS) * u64::from(PERIOD_US),
    }
}

#[test]
fn ten_minutes_at_10_khz_over_a_bad_link_falsify_nothing() {
    let mut ring = Ring::<i16, 1024>::new();
    let (producer, consumer) = ring.split();
    let mut board = Board::new(Known { now_us: 0 }, producer);
    let mut link = BoardLink::new(identity(), consumer);
    for request in [
        Request::Configure(config()),
        Request::Load(profile()),
        Request::Arm,
        Request::Stream(true),
        Request::Run,
    ] {
        board.handle(request).unwrap();
    }
    let (mut up, mut down) = (Line::new(11), Line::new(12));
    let (mut encoder, mut decoder) = (Encoder::new(), Decoder::<ToHost>::new());
    let (mut account, mut errors) = (Account::default(), LinkCounts::default());
    let (mut out, mut received) = ([0; MAX_FRAME], Vec::new());
    for tick in 1..=TICKS {
        board.ports_mut().now_us = u64::from(tick) * u64::from(PERIOD_US);
        board.tick();
        if tick % HEARTBEAT_EVERY == 0 {
            let mut said = Vec::new();
            up.pass(&frame(&mut encoder, &numbered(tick as u16)), &mut said);
            let mut said = said.as_slice();
            while let Some(len) = link.receive(&mut said, &mut out, |request| board.handle(request)) {
                down.pass(&out[..len], &mut received);
            }
        }
        while let Some(len) = link.samples(Layout::narrow(CHANNELS), 32, &mut out) {
            down.pass(&out[..len], &mut received);
        }
        let mut bytes = received.as_slice();
        while let Some(item) = decoder.next(&mut bytes) {
            match item {
                Ok(ToHost::Samples(batch)) => batch.samples().for_each(|sample| account.take(&sample)),
                Ok(_) => {}
                Err(error) => errors.count(&error),
            }
        }
        received.clear();
    }
    let status = board.status();
    assert_eq!((status.state, status.fault, status.dropped), (State::Running, None, 0));
    // Samples that are missing at the end are known only by their number.
    let unsaid = TICKS - account.next_seq;
    println!(
        "measured: 10 min at 10 kHz, {} of {} bytes damaged: {} samples right, {} lost and counted, {} at the end, {} frames lost",
        up.damaged + down.damaged,
        up.bytes + down.bytes,
        account.arrived,
        account.lost,
        unsaid,
        errors.lost
    );
    assert_eq!(account.arrived + account.lost + unsaid, TICKS);
    assert!(unsaid < 320 && account.lost > TICKS / 10 && account.arrived > TICKS / 2);
    assert!(errors.lost > 10_000 && errors.restarted == 0 && errors.unreadable == 0, "{errors:?}");
}
