//! A frame on a simulated CAN bus.

/// A frame with an identifier of 11 bits.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Frame {
    /// Identifier.
    pub id: u32,
    /// Whether it asks for data and holds none.
    pub is_remote: bool,
    /// Its bytes.
    pub bytes: Vec<u8>,
}

impl Frame {
    /// A frame with data.
    #[must_use]
    pub fn data(id: u32, bytes: &[u8]) -> Self {
        Self { id, is_remote: false, bytes: bytes.to_vec() }
    }

    /// The frame of a line that sends one.
    pub(super) fn of(line: &str) -> Option<Self> {
        let id = u32::from_str_radix(line.get(1..4)?, 16).ok()?;
        let is_remote = line.starts_with('r');
        let digits = line.get(5..)?.as_bytes();
        let byte = |pair: &[u8]| u8::from_str_radix(std::str::from_utf8(pair).ok()?, 16).ok();
        let bytes = digits.chunks(2).map(byte).collect::<Option<Vec<u8>>>()?;
        let length: usize = line.get(4..5)?.parse().ok()?;
        (is_remote || bytes.len() == length).then_some(Self { id, is_remote, bytes })
    }
}
