//! The drivers against the frames of the data sheets, on a bus that accepts nothing else.

use embedded_hal_mock::eh1::spi::{Mock, Transaction};
use socam_converters::{Ad5761r, Ads8688, Error, Order};

/// One frame: what is sent and what comes back.
fn frame(sent: &[u8], back: &[u8]) -> [Transaction<u8>; 3] {
    let transfer = Transaction::transfer_in_place(sent.to_vec(), back.to_vec());
    [Transaction::transaction_start(), transfer, Transaction::transaction_end()]
}

fn bus(frames: &[(&[u8], &[u8])]) -> Mock<u8> {
    Mock::new(&frames.iter().flat_map(|(sent, back)| frame(sent, back)).collect::<Vec<_>>())
}

const IDLE: &[u8] = &[0; 6];

#[test]
fn ads8688_is_configured_and_every_register_read_back() {
    // Register address in seven bits, then write (1) or read (0): feature select is 03h, the ranges begin at 05h.
    let mut spi = bus(&[
        (&[0x85, 0, 0, 0, 0, 0], IDLE),
        (&[0x07, 0x03, 0, 0, 0, 0], IDLE),
        (&[0x06, 0, 0, 0, 0, 0], &[0, 0, 0x03, 0, 0, 0]),
        (&[0x0b, 0x00, 0, 0, 0, 0], IDLE),
        (&[0x0a, 0, 0, 0, 0, 0], IDLE),
        (&[0x0d, 0x00, 0, 0, 0, 0], IDLE),
        (&[0x0c, 0, 0, 0, 0, 0], IDLE),
    ]);
    assert_eq!(Ads8688::new(&mut spi, 2).configure(), Ok(()));
    spi.done();
}

#[test]
fn ads8688_that_does_not_keep_a_range_is_refused() {
    let mut spi = bus(&[
        (&[0x85, 0, 0, 0, 0, 0], IDLE),
        (&[0x07, 0x03, 0, 0, 0, 0], IDLE),
        (&[0x06, 0, 0, 0, 0, 0], &[0, 0, 0x03, 0, 0, 0]),
        (&[0x0b, 0x00, 0, 0, 0, 0], IDLE),
        (&[0x0a, 0, 0, 0, 0, 0], &[0, 0, 0x05, 0, 0, 0]),
    ]);
    assert_eq!(Ads8688::new(&mut spi, 2).configure(), Err(Error::NoAnswer));
    spi.done();
}

#[test]
fn ads8688_goes_forth_and_back_and_needs_an_extra_frame_only_at_first() {
    // MAN_Ch_n is C000h + n * 400h. Code 8000h is 0 V, FFFFh the positive and 0000h the negative end.
    let mut spi = bus(&[
        (&[0xc0, 0, 0, 0, 0, 0], &[0xff; 6]),
        (&[0xc4, 0, 0, 0, 0, 0], &[0, 0, 0x80, 0x00, 0x00, 0]),
        (&[0xc8, 0, 0, 0, 0, 0], &[0, 0, 0xff, 0xff, 0x10, 0]),
        (&[0xc8, 0, 0, 0, 0, 0], &[0, 0, 0x00, 0x00, 0x20, 0]),
        (&[0xc4, 0, 0, 0, 0, 0], &[0, 0, 0x80, 0x01, 0x20, 0]),
        (&[0xc0, 0, 0, 0, 0, 0], &[0, 0, 0x7f, 0xff, 0x10, 0]),
        (&[0xc0, 0, 0, 0, 0, 0], &[0, 0, 0x90, 0x00, 0x00, 0]),
    ]);
    let mut input = Ads8688::new(&mut spi, 3);
    let mut counts = [0; 8];
    assert_eq!(input.convert(Order::Forth, &mut counts), Ok(()));
    assert_eq!(counts[..4], [0, i16::MAX, i16::MIN, 0]);
    assert_eq!(input.convert(Order::Back, &mut counts), Ok(()));
    assert_eq!(counts[..4], [0x1000, -1, 1, 0]);
    spi.done();
}

#[test]
fn ads8688_answers_that_are_not_its_own_are_no_values() {
    // A line stuck low or high, another channel's value, another range.
    let answers: [&[u8]; 4] = [&[0; 6], &[0xff; 6], &[0, 0, 0x80, 0, 0x20, 0], &[0, 0, 0x80, 0, 0x12, 0x80]];
    for answer in answers {
        let mut spi = bus(&[
            (&[0xc0, 0, 0, 0, 0, 0], IDLE),
            (&[0xc4, 0, 0, 0, 0, 0], &[0, 0, 0x80, 0x00, 0x00, 0]),
            (&[0xc4, 0, 0, 0, 0, 0], answer),
        ]);
        let mut counts = [0; 8];
        assert_eq!(
            Ads8688::new(&mut spi, 2).convert(Order::Forth, &mut counts),
            Err(Error::NoAnswer),
            "{answer:?}"
        );
        spi.done();
    }
}

#[test]
fn ad5761r_starts_at_midscale_and_is_read_back() {
    let mut spi = bus(&[
        (&[0x0f, 0, 0], &[0; 3]),
        // CV = PV = 01, ETS, IRO, range 000.
        (&[0x04, 0x02, 0x68], &[0; 3]),
        (&[0x0c, 0, 0], &[0; 3]),
        // Above the settings: DB23 to DB21 are anything, the brown-out flag stands.
        (&[0x00, 0, 0], &[0xec, 0x0a, 0x68]),
        (&[0x03, 0x80, 0x00], &[0; 3]),
        (&[0x0b, 0, 0], &[0; 3]),
        (&[0x00, 0, 0], &[0x0b, 0x80, 0x00]),
    ]);
    assert_eq!(Ad5761r::new(&mut spi).configure(), Ok(()));
    spi.done();
}

#[test]
fn ad5761r_writes_offset_binary() {
    for (count, high, low) in
        [(0, 0x80, 0x00), (i16::MAX, 0xff, 0xff), (i16::MIN, 0x00, 0x00), (-1, 0x7f, 0xff)]
    {
        let mut spi = bus(&[
            (&[0x03, high, low], &[0; 3]),
            (&[0x0b, 0, 0], &[0; 3]),
            (&[0x00, 0, 0], &[0x0b, high, low]),
        ]);
        assert_eq!(Ad5761r::new(&mut spi).write(count), Ok(()));
        spi.done();
    }
}

#[test]
fn ad5761r_that_does_not_hold_a_value_is_an_error() {
    let answers: [&[u8]; 4] = [&[0; 3], &[0xff; 3], &[0x0b, 0x80, 0x01], &[0x1b, 0x80, 0x00]];
    for answer in answers {
        let mut spi =
            bus(&[(&[0x03, 0x80, 0x00], &[0; 3]), (&[0x0b, 0, 0], &[0; 3]), (&[0x00, 0, 0], answer)]);
        assert_eq!(Ad5761r::new(&mut spi).write(0), Err(Error::NoAnswer), "{answer:?}");
        spi.done();
    }
}
