//! The target that every shape computes for each sample.

/// The value of a shape at one sample, before fading and limits.
#[derive(Debug, Clone, Copy)]
pub(super) struct Target {
    pub(super) value_micro: i32,
    pub(super) segment: u16,
    /// The shape has ended by itself.
    pub(super) ended: bool,
}
