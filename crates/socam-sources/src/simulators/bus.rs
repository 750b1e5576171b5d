//! A simulated CAN bus with one node, behind an adapter that speaks slcan.

use super::SlcanSimulator;
use super::frame::Frame;

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
