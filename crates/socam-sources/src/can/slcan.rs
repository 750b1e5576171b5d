//! The serial protocol of CAN adapters (Lawicel, CANable): frames as lines of text that end in a carriage return.
//!
//! Lines of errors and of states of the bus (`e1a`, `sb256256`) are those that Linux reads, in `drivers/net/can/slcan/slcan-core.c`.

use crate::device::Chunk;

/// Longest line: a frame of CAN FD with its time stamp.
const LONGEST: usize = 1 + 8 + 1 + 128 + 8;
/// The time stamps of adapters begin anew after this time, ms.
const WRAP_MS: u32 = 60_000;
/// Rates of the command `S`, bit/s.
const BITRATES: [(u32, u8); 9] = [
    (10_000, b'0'),
    (20_000, b'1'),
    (50_000, b'2'),
    (100_000, b'3'),
    (125_000, b'4'),
    (250_000, b'5'),
    (500_000, b'6'),
    (800_000, b'7'),
    (1_000_000, b'8'),
];
/// Numbers of bytes by their code above 8, of CAN FD.
const FD_LENGTHS: [usize; 7] = [12, 16, 20, 24, 32, 48, 64];
/// What the bits of the flags mean that are worth a word.
const FLAGS: [(u8, &str); 5] = [
    (0x01, "its queue of received frames is full, so that frames were lost"),
    (0x04, "error warning: many frames on the bus are damaged, as with a wrong bit rate"),
    (0x08, "frames were lost (data overrun)"),
    (0x20, "error passive: nearly all frames on the bus are damaged, as with a wrong bit rate"),
    (0x80, "bus error"),
];

/// A frame of the bus.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CanFrame {
    /// Identifier.
    pub id: u32,
    /// Whether the identifier has 29 bits.
    pub is_extended: bool,
    /// Its bytes.
    pub bytes: Vec<u8>,
    /// Time stamp of the adapter.
    pub stamp: Option<Stamp>,
}

/// A time stamp, which begins anew after a while.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stamp {
    /// ms from 0 to 59999, as adapters state them.
    Ms(u32),
    /// us from 0 to 2^32 - 1, as [`super::Gateway`] states those of a socket.
    Us(u32),
}

impl Stamp {
    /// The stamp and the range after which it begins anew, s.
    pub(super) fn seconds(self) -> (f64, f64) {
        match self {
            Self::Ms(ms) => (f64::from(ms) * 1e-3, f64::from(WRAP_MS) * 1e-3),
            Self::Us(us) => (f64::from(us) * 1e-6, 4_294.967_296),
        }
    }
}

/// How a node of a bus deals with errors: what an adapter says of itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum BusState {
    Active,
    Warning,
    Passive,
    Off,
}

/// What an adapter may do on its bus.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Access {
    /// It only listens: it acknowledges no frame and sends none.
    Listen,
    /// It sends frames that it is given, and acknowledges those of others.
    Send,
}

/// What an adapter sent.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Said {
    Frame(CanFrame),
    /// A question for data, which holds none.
    Remote,
    Flags(u8),
    /// The adapter's state on the bus changed to this.
    State(BusState),
    /// Frames that were damaged on the bus, and whether received ones were lost in the adapter.
    Errors {
        damaged: u32,
        is_overrun: bool,
    },
    /// An answer to a command: done, or not.
    Answer(bool),
    /// None of these.
    Damaged,
}

/// The commands that open an adapter: closed, bit rate, time stamps, open. A bus whose bit rate is set elsewhere has none here.
///
/// # Errors
/// The rates that there are, in words.
pub fn opening(bitrate: Option<u32>, access: Access) -> Result<Vec<u8>, String> {
    let mut commands = b"\rC\r".to_vec();
    if let Some(bitrate) = bitrate {
        let Some((_, code)) = BITRATES.iter().find(|(known, _)| *known == bitrate) else {
            return Err(format!(
                "slcan has no bit rate of {bitrate}; expected 10k, 20k, 50k, 100k, 125k, 250k, 500k, 800k or 1M"
            ));
        };
        commands.extend([b'S', *code, b'\r']);
    }
    commands.extend_from_slice(if access == Access::Listen { b"Z1\rL\r" } else { b"Z1\rO\r" });
    Ok(commands)
}

/// The line of a frame without a time stamp, as an adapter is told to send it.
pub(super) fn line(id: u32, is_extended: bool, bytes: &[u8]) -> Vec<u8> {
    let head = if is_extended { format!("T{id:08X}") } else { format!("t{id:03X}") };
    let data: String = bytes.iter().map(|byte| format!("{byte:02X}")).collect();
    format!("{head}{}{data}\r", bytes.len().min(8)).into_bytes()
}

/// The line of a question for the data of an identifier of 11 bits (RTR).
pub(super) fn remote_line(id: u32) -> Vec<u8> {
    format!("r{id:03X}0\r").into_bytes()
}

/// The command that asks for the flags.
pub(super) const ASK_FLAGS: &[u8] = b"F\r";

/// What flags mean, in words; empty if all is well.
pub(super) fn flags_text(flags: u8) -> String {
    let words: Vec<&str> = FLAGS.iter().filter(|(bit, _)| flags & bit != 0).map(|(_, text)| *text).collect();
    words.join("; ")
}

/// Divides a stream into what was said.
#[derive(Debug, Default)]
pub(super) struct Stream {
    line: Vec<u8>,
    is_too_long: bool,
    /// Whether the beginning of the present line was lost.
    is_headless: bool,
}

impl Stream {
    /// Takes bytes and hands on what ends in them, with its time of arrival.
    pub(super) fn push(&mut self, chunk: Chunk<'_>, mut take: impl FnMut(Said, i64)) {
        for (index, byte) in chunk.bytes.iter().enumerate() {
            match byte {
                // A refusal has no line end.
                0x07 => {
                    self.line.clear();
                    (self.is_too_long, self.is_headless) = (false, false);
                    take(Said::Answer(false), chunk.arrival_ns(index));
                }
                b'\r' => {
                    let is_too_long = std::mem::take(&mut self.is_too_long);
                    if !std::mem::take(&mut self.is_headless) {
                        let said = if is_too_long { Said::Damaged } else { said(&self.line) };
                        take(said, chunk.arrival_ns(index));
                    }
                    self.line.clear();
                }
                b'\n' => {}
                _ if self.line.len() < LONGEST => self.line.push(*byte),
                _ => self.is_too_long = true,
            }
        }
    }

    /// Drops an unfinished line, and the next one, which may have begun before; returns whether there was one.
    pub(super) fn interrupt(&mut self) -> bool {
        (self.is_too_long, self.is_headless) = (false, true);
        let was_within = !self.line.is_empty();
        self.line.clear();
        was_within
    }
}

fn said(line: &[u8]) -> Said {
    let Some((kind, rest)) = line.split_first() else { return Said::Answer(true) };
    let (id_digits, is_remote, is_fd) = match kind {
        b't' => (3, false, false),
        b'T' => (8, false, false),
        b'r' => (3, true, false),
        b'R' => (8, true, false),
        b'd' | b'b' => (3, false, true),
        b'D' | b'B' => (8, false, true),
        b'F' => {
            return hex(rest)
                .filter(|_| rest.len() == 2)
                .map_or(Said::Damaged, |flags| Said::Flags(flags as u8));
        }
        b's' => return state(rest).map_or(Said::Damaged, Said::State),
        b'e' => return errors(rest).unwrap_or(Said::Damaged),
        // Answers with text (version, serial number), and to a frame that was sent.
        b'V' | b'v' | b'N' | b'z' | b'Z' => return Said::Answer(true),
        _ => return Said::Damaged,
    };
    frame(rest, id_digits, is_remote, is_fd).unwrap_or(Said::Damaged)
}

fn frame(rest: &[u8], id_digits: usize, is_remote: bool, is_fd: bool) -> Option<Said> {
    let (id, rest) = rest.split_at_checked(id_digits)?;
    let (code, rest) = rest.split_first()?;
    let code = hex(&[*code])? as usize;
    let length = match code {
        0..=8 => code,
        _ if is_fd => *FD_LENGTHS.get(code - 9)?,
        _ => return None,
    };
    let (id, is_extended) = (hex(id)?, id_digits == 8);
    if id > if is_extended { 0x1fff_ffff } else { 0x7ff } {
        return None;
    }
    let (data, stamp) = rest.split_at_checked(if is_remote { 0 } else { 2 * length })?;
    let bytes = data.chunks(2).map(|pair| hex(pair).map(|byte| byte as u8)).collect::<Option<Vec<u8>>>()?;
    let stamp = match stamp.len() {
        0 => None,
        4 => Some(Stamp::Ms(hex(stamp).filter(|ms| *ms < WRAP_MS)?)),
        8 => Some(Stamp::Us(hex(stamp)?)),
        _ => return None,
    };
    Some(if is_remote { Said::Remote } else { Said::Frame(CanFrame { id, is_extended, bytes, stamp }) })
}

/// A state with the counters of errors in received and sent frames, such as `b256256`.
fn state(rest: &[u8]) -> Option<BusState> {
    let (state, counters) = rest.split_first()?;
    if counters.len() != 6 || !counters.iter().all(u8::is_ascii_digit) {
        return None;
    }
    match state {
        b'a' => Some(BusState::Active),
        b'w' => Some(BusState::Warning),
        b'p' => Some(BusState::Passive),
        b'b' => Some(BusState::Off),
        _ => None,
    }
}

/// A number of errors with a letter for each, such as `3bcO`.
fn errors(rest: &[u8]) -> Option<Said> {
    let (count, letters) = rest.split_first()?;
    let is_known = |letter: &u8| b"abBcfosO".contains(letter);
    if usize::from(count.checked_sub(b'0')?) != letters.len()
        || letters.is_empty()
        || !letters.iter().all(is_known)
    {
        return None;
    }
    let lost = letters.iter().filter(|letter| b"oO".contains(letter)).count();
    Some(Said::Errors { damaged: (letters.len() - lost) as u32, is_overrun: letters.contains(&b'o') })
}

/// A number in hexadecimal digits, at most eight.
fn hex(digits: &[u8]) -> Option<u32> {
    let is_hex = (1..=8).contains(&digits.len()) && digits.iter().all(u8::is_ascii_hexdigit);
    let text = std::str::from_utf8(digits).ok().filter(|_| is_hex)?;
    u32::from_str_radix(text, 16).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn heard(bytes: &[u8]) -> Vec<Said> {
        let mut all = Vec::new();
        Stream::default().push(Chunk { bytes, from_ns: 0, until_ns: 1 }, |said, _| all.push(said));
        all
    }

    #[test]
    fn frames_of_all_kinds_are_read() {
        let frame = |id, is_extended, bytes: &[u8], stamp| {
            Said::Frame(CanFrame { id, is_extended, bytes: bytes.to_vec(), stamp })
        };
        assert_eq!(heard(b"t10121122\r"), [frame(0x101, false, &[0x11, 0x22], None)]);
        assert_eq!(
            heard(b"T1ABCDEF01FFEA5F\r"),
            [frame(0x1abc_def0, true, &[0xff], Some(Stamp::Ms(59_999)))]
        );
        assert_eq!(heard(b"t1010FFFFFFFF\r"), [frame(0x101, false, &[], Some(Stamp::Us(u32::MAX)))]);
        assert_eq!(
            heard(&[b"d1019".as_slice(), &[b'0'; 24], b"\r"].concat()),
            [frame(0x101, false, &[0; 12], None)]
        );
        assert_eq!(
            heard(b"r1018\r\rF08\r\x07"),
            [Said::Remote, Said::Answer(true), Said::Flags(8), Said::Answer(false)]
        );
        assert_eq!(
            heard(b"sb256256\re1a\re3bcO\re1o\r"),
            [
                Said::State(BusState::Off),
                Said::Errors { damaged: 1, is_overrun: false },
                Said::Errors { damaged: 2, is_overrun: false },
                Said::Errors { damaged: 0, is_overrun: true },
            ]
        );
        for bad in [
            b"t1012112\r".as_slice(),
            b"t1019\r",
            b"tFFF0\r",
            b"t101211223\r",
            b"t1010EA60\r",
            b"hello\r",
            b"F1\r",
            b"sx000000\r",
            b"sa00000\r",
            b"e2a\r",
            b"e0\r",
            b"e1z\r",
        ] {
            assert_eq!(heard(bad), [Said::Damaged], "{}", String::from_utf8_lossy(bad));
        }
        assert_eq!(heard(&[&[b't'; 1000], b"\r".as_slice()].concat()), [Said::Damaged]);
    }
}
