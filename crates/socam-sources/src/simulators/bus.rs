//! A simulated CAN bus with one node, behind an adapter that speaks slcan.

use super::SlcanSimulator;

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

/// A node of a bus.
pub trait Node {
    /// Takes a frame at a time since it was switched on, s; returns its answers.
    fn receive(&mut self, time_s: f64, frame: &Frame) -> Vec<Frame>;

    /// Moves on to a time, s; returns what it sends by itself.
    fn advance(&mut self, time_s: f64) -> Vec<Frame>;
}

/// A bus with a node, and an adapter that a host talks to.
#[derive(Debug)]
pub struct BusSimulator<N> {
    /// The adapter.
    pub adapter: SlcanSimulator,
    /// The node.
    pub node: N,
    /// Frames that the host sent.
    pub sent: Vec<Frame>,
}

impl<N: Node> BusSimulator<N> {
    /// A bus with this node, behind a closed adapter without time stamps.
    #[must_use]
    pub fn new(node: N) -> Self {
        Self { adapter: SlcanSimulator::new(false), node, sent: Vec::new() }
    }

    /// Takes bytes of the host at a time, s; returns those of the adapter.
    pub fn receive(&mut self, time_s: f64, bytes: &[u8]) -> Vec<u8> {
        let mut said = self.adapter.receive(bytes);
        let mut frames = self.node.advance(time_s);
        for frame in std::mem::take(&mut self.adapter.sent) {
            frames.extend(self.node.receive(time_s, &frame));
            self.sent.push(frame);
        }
        for frame in frames {
            said.extend(self.adapter.frame(time_s, frame.id, &frame.bytes));
        }
        said
    }
}
