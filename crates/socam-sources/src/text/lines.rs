//! Lines in a stream of bytes.

use crate::device::Chunk;

/// Longest line, bytes.
const LONGEST: usize = 1 << 16;

/// Where lines begin and end.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Bounds {
    /// At their line ends; the stream may begin within one, as on a serial line.
    #[default]
    Ends,
    /// At their line ends; the stream usually begins with one, as over TCP. Its first line is believed only if it holds no number.
    Connected,
    /// There, and at the end of each chunk, as over UDP.
    Chunks,
}

/// Divides a stream into lines. A line whose beginning was not seen is no line.
#[derive(Debug, Default)]
pub(crate) struct Lines {
    bounds: Bounds,
    bytes: Vec<u8>,
    /// Whether the rest of a line that is too long is dropped.
    is_too_long: bool,
    /// Whether the beginning of the present line may have been missed.
    is_headless: bool,
}

impl Lines {
    /// A stream that may begin within a line.
    pub(crate) fn new(bounds: Bounds) -> Self {
        Self { bounds, is_headless: bounds != Bounds::Chunks, ..Self::default() }
    }

    /// Answers of a device, none of which began before it was asked.
    pub(crate) fn answers() -> Self {
        Self::default()
    }

    /// Takes bytes and hands on each line that ends in them, or why it is none.
    pub(crate) fn push(&mut self, chunk: Chunk<'_>, mut take: impl FnMut(Result<&str, &'static str>, i64)) {
        for (index, byte) in chunk.bytes.iter().enumerate() {
            match byte {
                b'\n' | b'\r' => self.end(chunk.arrival_ns(index), &mut take),
                _ if self.bytes.len() < LONGEST => self.bytes.push(*byte),
                _ => self.is_too_long = true,
            }
        }
        if self.bounds == Bounds::Chunks {
            self.end(chunk.until_ns, &mut take);
        }
    }

    fn end(&mut self, arrival_ns: i64, take: &mut impl FnMut(Result<&str, &'static str>, i64)) {
        let (is_headless, is_too_long) = (self.is_headless, self.is_too_long);
        (self.is_headless, self.is_too_long) = (false, false);
        let is_first = is_headless && (self.bounds == Bounds::Ends || holds_number(&self.bytes));
        if !is_first && !self.bytes.is_empty() {
            let text = match std::str::from_utf8(&self.bytes) {
                _ if is_too_long => Err("a line is longer than 65536 bytes"),
                Ok(text) => Ok(text),
                Err(_) => Err("a line is no UTF-8 text"),
            };
            if text.is_err() || text.is_ok_and(|text| !text.trim().is_empty()) {
                take(text, arrival_ns);
            }
        }
        self.bytes.clear();
    }

    /// Drops an unfinished line; returns whether there was one.
    pub(crate) fn interrupt(&mut self) -> bool {
        let was_within = !self.bytes.is_empty() && !self.is_headless;
        self.bytes.clear();
        (self.is_too_long, self.is_headless) = (false, self.bounds != Bounds::Chunks);
        was_within
    }
}

/// Whether a word of a line is a number: the rest of a longer one, where the beginning was not seen.
fn holds_number(line: &[u8]) -> bool {
    let words = line.split(|byte| b" \t,;|:=\"{}[]".contains(byte));
    words.filter_map(|word| std::str::from_utf8(word).ok()).any(|word| word.parse::<f64>().is_ok())
}
