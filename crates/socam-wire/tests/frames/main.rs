//! Messages as frames, the pinned bytes of the wire, and a host at a board.

mod common;
mod damage;
mod noisy;

use common::{decode, frame, identity, numbered};
use proptest::prelude::*;
use socam_core::{
    Board, Command, Config, ConfigError, ConverterSilent, Fault, Flags, Layout, Lines, Ports, Profile,
    ProfileError, Refusal, Request, Ring, Sample, Shape, State,
};
use socam_wire::{
    BATCH_SAMPLES, BoardLink, BoardStatus, Decoder, Encoder, LinkCounts, LinkError, MAX_FRAME,
    SCHEMA_VERSION, ToBoard, ToHost,
};

#[test]
fn every_request_and_answer_arrives_as_it_was_sent() {
    let profile = Profile {
        command: Command::SpeedClosedLoop,
        shape: Shape::Multisine {
            offset_micro: i32::MIN,
            line_micro: i32::MAX,
            period_us: u32::MAX,
            lines: Lines::Odd,
            first_line: u16::MAX,
            last_line: u16::MAX,
            seed: u32::MAX,
        },
        ramp_us: u32::MAX,
        limit_micro: i32::MIN,
        slew_micro_s: u32::MAX,
        duration_us: u64::MAX,
    };
    let mut largest = Config { sample_period_us: u32::MAX, channel_count: 8, ..Config::default() };
    largest.channels = [largest.channels[0]; 8];
    for channel in &mut largest.channels {
        channel.scale.micro_per_count_q16 = i64::MIN;
        channel.scale.offset_micro = i32::MIN;
        channel.limit_micro = Some(i32::MIN);
        channel.stuck_after_us = Some(u32::MAX);
    }
    let requests = [
        Request::Configure(largest),
        Request::Load(profile),
        Request::Arm,
        Request::Run,
        Request::Stop,
        Request::EmergencyStop,
        Request::ClearFault,
        Request::Stream(true),
    ];
    let (mut encoder, mut decoder) = (Encoder::new(), Decoder::new());
    for request in requests {
        let message = ToBoard::Request { number: 7, request };
        assert_eq!(decode(&mut decoder, &frame(&mut encoder, &message)), [Ok(message)]);
    }

    let fault = Fault::OverTorque { channel: 7, value_micro: i32::MIN, limit_micro: i32::MAX };
    let refusals = [
        Ok(()),
        Err(Refusal::NoProfile),
        Err(Refusal::Faulted(fault)),
        Err(Refusal::WrongState { state: State::Running, needs: State::Idle }),
        Err(Refusal::Profile(ProfileError::OverLimit { peak_micro: i64::MIN, limit_micro: 1 })),
        Err(Refusal::Config(ConfigError::Channel(3))),
    ];
    let (mut encoder, mut decoder) = (Encoder::new(), Decoder::new());
    for result in refusals {
        let message = ToHost::Answer { number: u16::MAX, result };
        assert_eq!(decode(&mut decoder, &frame(&mut encoder, &message)), [Ok(message)]);
    }
}

/// The bytes are a contract with every board out there: if this fails, raise `SCHEMA_VERSION`, then pin the new bytes.
#[test]
fn the_bytes_of_every_kind_of_message_are_pinned() {
    let board = Board::new(Still(0), Ring::<i16, 4>::new().split().0).status();
    let status = BoardStatus { board, link: LinkCounts::default() };
    let mut ring = Ring::<i32, 4>::new();
    let (mut producer, consumer) = ring.split();
    producer.push(&Sample { tick: 1, seq: 2, counts: [3; 8], setpoint_micro: -4, ..Sample::default() });
    let mut out = [0; MAX_FRAME];
    let samples =
        BoardLink::new(identity(), consumer).samples(Layout::try_from([2, 1]).unwrap(), 1, &mut out).unwrap();
    let to_board = [
        ToBoard::Hello,
        ToBoard::Request { number: 1, request: Request::Configure(Config::default()) },
        ToBoard::Request { number: 2, request: Request::Stream(false) },
    ];
    let to_host = [
        ToHost::Hello(identity()),
        ToHost::Answer { number: 3, result: Err(Refusal::NoProfile) },
        ToHost::Status(status),
    ];
    let mut encoder = Encoder::new();
    let mut bytes: Vec<_> = to_board.iter().flat_map(|message| frame(&mut encoder, message)).collect();
    bytes.extend(to_host.iter().flat_map(|message| frame(&mut encoder, message)));
    bytes.extend_from_slice(&out[..samples]);
    let hash = bytes
        .iter()
        .fold(0xcbf2_9ce4_8422_2325u64, |hash, &byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3));
    assert_eq!((SCHEMA_VERSION, bytes.len(), hash), (6, 358, 9_064_662_102_012_868_647));
}

#[test]
fn another_version_is_told_in_words_whatever_its_frames_look_like() {
    let mut decoder = Decoder::<ToHost>::new();
    let foreign = SCHEMA_VERSION + 1;
    let mut bytes = vec![0, 6, foreign, !foreign, 1, 2, 3, 0];
    bytes.extend(frame(&mut Encoder::new(), &ToHost::Hello(identity())));
    let items = decode(&mut decoder, &bytes);
    assert_eq!(items, [Err(LinkError::ForeignVersion { theirs: foreign }), Ok(ToHost::Hello(identity()))]);
    let words = items[0].as_ref().unwrap_err().to_string();
    assert!(words.contains("version 7 of the messages, this one speaks version 6"), "{words}");

    // A board answers a foreign host all the same: its frame shows its version.
    let mut ring = Ring::<i16, 4>::new();
    let mut link = BoardLink::new(identity(), ring.split().1);
    let mut out = [0; MAX_FRAME];
    let len = link.receive(&mut bytes.as_slice(), &mut out, |_| Ok(())).unwrap();
    assert_eq!(decode(&mut Decoder::new(), &out[..len]), [Ok(ToHost::Hello(identity()))]);
}

#[test]
fn a_restarted_peer_is_understood_again_even_if_its_first_frames_were_lost() {
    let mut decoder = Decoder::new();
    let mut encoder = Encoder::new();
    for number in 0..50 {
        assert_eq!(decode(&mut decoder, &frame(&mut encoder, &numbered(number))), [Ok(numbered(number))]);
    }
    let mut fresh = Encoder::new();
    assert_eq!(
        decode(&mut decoder, &frame(&mut fresh, &ToBoard::Hello)),
        [Err(LinkError::Restarted), Ok(ToBoard::Hello)]
    );

    let mut decoder = Decoder::new();
    for _ in 0..50 {
        decode::<ToBoard>(&mut decoder, &frame(&mut encoder, &ToBoard::Hello));
    }
    let mut fresh = Encoder::new();
    frame(&mut fresh, &ToBoard::Hello);
    let items: Vec<_> =
        (1..6).flat_map(|number| decode(&mut decoder, &frame(&mut fresh, &numbered(number)))).collect();
    assert_eq!(items[3..], [Err(LinkError::Restarted), Ok(numbered(4)), Ok(numbered(5))]);
}

fn any_sample() -> impl Strategy<Value = Sample> {
    (any::<[i32; 8]>(), any::<i16>(), any::<i32>(), any::<u8>()).prop_map(
        |(counts, output_count, setpoint_micro, flags)| Sample {
            counts,
            output_count,
            setpoint_micro,
            flags: Flags(flags),
            ..Sample::default()
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, failure_persistence: None, ..ProptestConfig::default() })]

    /// The host receives all samples of the ring unchanged, also after dropped samples and missed ticks.
    #[test]
    fn samples_travel_in_batches_without_change(
        mut samples in prop::collection::vec((any_sample(), 0..40u32, 0..60u16), 1..200),
        layout in (1..=8u8, any::<u8>()).prop_map(|(channels, wide)| Layout::try_from([channels, wide & (0xff >> (8 - channels))]).unwrap()),
    ) {
        let mut ring = Ring::<i32, 256>::new();
        let (mut producer, consumer) = ring.split();
        let (mut seq, mut tick, mut segment) = (u32::MAX - 20, 0u32, 0u16);
        for (sample, tick_jump, segment_jump) in &mut samples {
            tick += 1 + tick_jump.saturating_sub(37);
            segment += segment_jump.saturating_sub(57);
            (sample.seq, sample.tick, sample.segment) = (seq, tick, segment);
            sample.counts[usize::from(layout.channels())..].fill(0);
            for (channel, count) in sample.counts.iter_mut().enumerate().filter(|(channel, _)| !layout.is_wide(*channel)) {
                *count = if channel % 2 == 0 { *count >> 16 } else { (*count).clamp(-32_768, 32_767) };
            }
            seq = seq.wrapping_add(1 + u32::from(*tick_jump == 39));
            producer.push(sample);
        }
        let mut link = BoardLink::new(identity(), consumer);
        let (mut decoder, mut out) = (Decoder::new(), [0; MAX_FRAME]);
        let (mut arrived, mut sizes) = (Vec::new(), Vec::new());
        while let Some(len) = link.samples(layout, 1, &mut out) {
            let items = decode(&mut decoder, &out[..len]);
            let [Ok(ToHost::Samples(batch))] = items.as_slice() else { panic!("{items:?}") };
            sizes.push(batch.len());
            arrived.extend(batch.samples());
        }
        let sent: Vec<_> = samples.iter().map(|(sample, ..)| *sample).collect();
        prop_assert_eq!(arrived, sent);
        prop_assert!(sizes.iter().all(|&size| size <= BATCH_SAMPLES));
    }
}

/// 10 kHz with 6 channels must stay inside the 220 kB/s that a full-speed USB link was seen to carry.
#[test]
fn ten_kilohertz_of_six_channels_fit_through_usb() {
    let mut ring = Ring::<i16, 64>::new();
    let (mut producer, consumer) = ring.split();
    for seq in 0..32 {
        producer.push(&Sample { tick: seq, seq, counts: [-1; 8], setpoint_micro: -1, ..Sample::default() });
    }
    let len =
        BoardLink::new(identity(), consumer).samples(Layout::narrow(6), 32, &mut [0; MAX_FRAME]).unwrap();
    assert!(len * 10_000 / 32 < 210_000, "{} bytes per second", len * 10_000 / 32);
}

#[derive(Debug)]
struct Still(u64);

impl Ports for Still {
    type Count = i16;

    fn now_us(&mut self) -> u64 {
        self.0
    }
    fn read(&mut self, _: &mut [i16]) -> Result<(), ConverterSilent> {
        Ok(())
    }
    fn write(&mut self, _: i16) -> Result<(), ConverterSilent> {
        Ok(())
    }
    fn enable(&mut self, _: bool) {}
}

#[test]
fn a_host_talks_to_a_board() {
    let mut ring = Ring::<i16, 64>::new();
    let (producer, consumer) = ring.split();
    let mut board = Board::new(Still(0), producer);
    let mut link = BoardLink::new(identity(), consumer);
    let (mut encoder, mut decoder, mut out) = (Encoder::new(), Decoder::<ToHost>::new(), [0; MAX_FRAME]);

    let mut asked = frame(&mut encoder, &ToBoard::Hello);
    for (number, request) in (1..).zip([Request::Stream(true), Request::Run]) {
        asked.extend(frame(&mut encoder, &ToBoard::Request { number, request }));
    }
    let (mut bytes, mut answers) = (asked.as_slice(), Vec::new());
    while let Some(len) = link.receive(&mut bytes, &mut out, |request| board.handle(request)) {
        answers.extend(decode(&mut decoder, &out[..len]));
    }
    let refusal = Refusal::WrongState { state: State::Idle, needs: State::Armed };
    assert_eq!(
        answers,
        [
            Ok(ToHost::Hello(identity())),
            Ok(ToHost::Answer { number: 1, result: Ok(()) }),
            Ok(ToHost::Answer { number: 2, result: Err(refusal) }),
        ]
    );

    for _ in 0..3 {
        board.ports_mut().0 += 1000;
        board.tick();
    }
    let len = link.samples(board.layout(), 1, &mut out).unwrap();
    let [Ok(ToHost::Samples(batch))] = decode(&mut decoder, &out[..len])[..] else { panic!() };
    assert_eq!(batch.samples().map(|s| s.seq).collect::<Vec<_>>(), [0, 1, 2]);
    assert_eq!(link.samples(Layout::narrow(4), 1, &mut out), None);

    let len = link.status(board.status(), &mut out).unwrap();
    let [Ok(ToHost::Status(status))] = decode(&mut decoder, &out[..len])[..] else { panic!() };
    assert_eq!((status.board, status.link.total()), (board.status(), 0));
}
