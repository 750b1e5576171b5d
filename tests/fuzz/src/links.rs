//! Both ends of the link.

use std::fmt::Debug;

use crc::{CRC_32_ISCSI, Crc};
use serde::Serialize;
use serde::de::DeserializeOwned;
use socam_core::{Generator, Request, Ring};
use socam_wire::{BoardLink, Decoder, Encoder, MAX_FRAME, SCHEMA_VERSION, ToBoard, ToHost};

use crate::{Input, seeds};

/// Bytes of a frame before its message (version, its complement, number) and after it (checksum).
const HEAD: usize = 6;
const TAIL: usize = 4;
const CHECKSUM: Crc<u32> = Crc::<u32>::new(&CRC_32_ISCSI);
/// Sample time of the board that profiles are loaded into, us, and how many of its ticks they are run for.
const SAMPLE_PERIOD_US: u32 = 1000;
const TICKS: u32 = 50;

/// The frames of `bytes` with the version and the checksum that make them valid, so that changes reach the messages.
fn sealed(bytes: &[u8]) -> Vec<u8> {
    let mut all = vec![0];
    for piece in bytes.split(|byte| *byte == 0).filter(|piece| !piece.is_empty()) {
        let mut raw = piece.to_vec();
        let Ok(length @ (HEAD..)) = cobs::decode_in_place(&mut raw) else { continue };
        raw.truncate(length.saturating_sub(TAIL).max(HEAD));
        raw[..2].copy_from_slice(&[SCHEMA_VERSION, !SCHEMA_VERSION]);
        raw.extend(CHECKSUM.checksum(&raw).to_le_bytes());
        let mut encoded = vec![0; raw.len() + raw.len() / 254 + 2];
        if let Ok(length) = cobs::try_encode(&raw, &mut encoded) {
            all.extend_from_slice(&encoded[..length]);
            all.push(0);
        }
    }
    all
}

fn messages<M: DeserializeOwned>(bytes: &[u8], size: usize) -> Vec<M> {
    let mut decoder = Decoder::<M>::new();
    let mut all = Vec::new();
    for mut piece in bytes.chunks(size.max(1)) {
        all.extend(std::iter::from_fn(|| decoder.next(&mut piece)).flatten());
    }
    all
}

/// Messages do not depend on how the bytes arrive, and each one that is received can be sent. Gives how many arrived.
fn received<M: DeserializeOwned + Serialize + PartialEq + Debug>(bytes: &[u8]) -> usize {
    let whole = messages::<M>(bytes, bytes.len());
    assert_eq!(whole, messages(bytes, 7), "messages of whole and of divided bytes");
    for message in &whole {
        let mut frame = [0; MAX_FRAME];
        let length =
            Encoder::new().encode(message, &mut frame).expect("a received message fits into a frame");
        assert_eq!(messages::<M>(&frame[..length], MAX_FRAME).first(), Some(message), "a message sent again");
    }
    whole.len()
}

/// What the host reads.
pub(crate) fn host_link(input: Input<'_>) -> bool {
    received::<ToHost>(input.bytes) + received::<ToHost>(&sealed(input.bytes)) > 0
}

/// What the board reads: it answers each message once, and no configuration or profile that it checks overflows.
pub(crate) fn board_link(input: Input<'_>) -> bool {
    let sealed = sealed(input.bytes);
    for bytes in [input.bytes, &sealed] {
        let whole = requests(bytes, bytes.len());
        assert_eq!(whole, requests(bytes, 5), "requests of whole and of divided bytes");
        whole.iter().for_each(check);
    }
    received::<ToBoard>(input.bytes) + received::<ToBoard>(&sealed) > 0
}

/// What a board is asked, in order.
fn requests(bytes: &[u8], size: usize) -> Vec<Request> {
    let mut ring = Ring::<i16, 16>::new();
    let (_, samples) = ring.split();
    let mut link = BoardLink::new(seeds::identity(), samples);
    let mut out = [0; MAX_FRAME];
    let mut all = Vec::new();
    for mut piece in bytes.chunks(size.max(1)) {
        let mut asked = Vec::new();
        while let Some(length) = link.receive(&mut piece, &mut out, |request| {
            asked.push(request);
            Ok(())
        }) {
            let mut frame = &out[..length];
            let answer = Decoder::<ToHost>::new().next(&mut frame);
            assert!(matches!(answer, Some(Ok(ToHost::Hello(_) | ToHost::Answer { .. }))), "{answer:?}");
        }
        all.append(&mut asked);
    }
    all
}

/// What the board computes of a request before it obeys. A profile that it accepts stays within its own limit.
fn check(request: &Request) {
    match request {
        Request::Configure(config) => drop(config.check()),
        Request::Load(profile) => {
            let Ok(mut generator) = Generator::new(profile, SAMPLE_PERIOD_US) else { return };
            for _ in 0..TICKS {
                let setpoint = generator.step();
                assert!(setpoint.value_micro.abs() <= profile.limit_micro, "{setpoint:?} of {profile:?}");
            }
        }
        _ => {}
    }
}
