//! Frames through links that damage, lose, repeat and reorder them.

use proptest::prelude::*;
use socam_wire::{Decoder, Encoder, ToHost};

use crate::common::{decode, frame, identity, numbered};

/// An error of a link.
#[derive(Debug, Clone)]
enum Damage {
    FlipBit(usize, u8),
    Remove(usize, usize),
    Insert(usize, Vec<u8>),
    Overwrite(usize, Vec<u8>),
    LoseFrame(usize),
    RepeatFrame(usize),
    MoveFrame(usize, usize),
}

fn any_damage() -> impl Strategy<Value = Damage> {
    let bytes = || prop::collection::vec(any::<u8>(), 1..40);
    let at = any::<usize>;
    prop_oneof![
        4 => (at(), 0..8u8).prop_map(|(at, bit)| Damage::FlipBit(at, bit)),
        2 => (at(), 1..60usize).prop_map(|(at, len)| Damage::Remove(at, len)),
        2 => (at(), bytes()).prop_map(|(at, bytes)| Damage::Insert(at, bytes)),
        2 => (at(), bytes()).prop_map(|(at, bytes)| Damage::Overwrite(at, bytes)),
        1 => at().prop_map(Damage::LoseFrame),
        1 => at().prop_map(Damage::RepeatFrame),
        1 => (at(), at()).prop_map(|(from, to)| Damage::MoveFrame(from, to)),
    ]
}

fn apply(damages: &[Damage], mut frames: Vec<Vec<u8>>) -> Vec<u8> {
    for damage in damages {
        let count = frames.len().max(1);
        match *damage {
            Damage::LoseFrame(at) if !frames.is_empty() => drop(frames.remove(at % count)),
            Damage::RepeatFrame(at) if !frames.is_empty() => {
                frames.insert(at % count, frames[at % count].clone())
            }
            Damage::MoveFrame(from, to) if !frames.is_empty() => {
                let frame = frames.remove(from % count);
                frames.insert(to % count, frame);
            }
            _ => {}
        }
    }
    let mut bytes = frames.concat();
    for damage in damages {
        let size = bytes.len().max(1);
        match damage {
            Damage::FlipBit(at, bit) if !bytes.is_empty() => bytes[at % size] ^= 1 << bit,
            Damage::Remove(at, len) if !bytes.is_empty() => {
                drop(bytes.drain(at % size..(at % size + len).min(bytes.len())));
            }
            Damage::Insert(at, extra) => drop(bytes.splice(at % size..at % size, extra.iter().copied())),
            Damage::Overwrite(at, with) => {
                for (place, byte) in bytes.iter_mut().skip(at % size).zip(with) {
                    *place = *byte;
                }
            }
            _ => {}
        }
    }
    bytes
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, failure_persistence: None, ..ProptestConfig::default() })]

    /// The messages received are those sent, or an error is reported; no message is invented; the first whole frame after an error
    /// is decoded.
    #[test]
    fn no_damage_passes_unseen(
        count in 1..12u16,
        damages in prop::collection::vec(any_damage(), 0..4),
        piece in 1..200usize,
    ) {
        let mut encoder = Encoder::new();
        let opening = frame(&mut encoder, &numbered(0));
        let sent: Vec<_> = (1..=count).map(numbered).collect();
        let frames: Vec<_> = sent.iter().map(|message| frame(&mut encoder, message)).collect();
        let closing = frame(&mut encoder, &numbered(count + 1));

        let mut decoder = Decoder::new();
        prop_assert_eq!(decode(&mut decoder, &opening), [Ok(numbered(0))]);
        let stream = [apply(&damages, frames), closing].concat();
        let items: Vec<_> = stream.chunks(piece).flat_map(|bytes| decode(&mut decoder, bytes)).collect();

        prop_assert_eq!(items.last(), Some(&Ok(numbered(count + 1))));
        let errors = items.iter().filter(|item| item.is_err()).count();
        let arrived: Vec<_> = items.into_iter().flatten().take_while(|m| *m != numbered(count + 1)).collect();
        prop_assert!(arrived == sent || errors > 0);
        prop_assert!(arrived.iter().all(|message| sent.contains(message)), "a message was made up");
        prop_assert!(arrived.windows(2).all(|pair| pair[0] != pair[1]), "a message arrived twice");
    }

    #[test]
    fn noise_is_survived_and_yields_no_message(noise in prop::collection::vec(any::<u8>(), 0..3000)) {
        let mut decoder = Decoder::<ToHost>::new();
        prop_assert!(decode(&mut decoder, &noise).iter().all(Result::is_err));
        let hello = ToHost::Hello(identity());
        let last = decode(&mut decoder, &frame(&mut Encoder::new(), &hello)).pop();
        prop_assert_eq!(last, Some(Ok(hello)));
    }
}
