//! The unknowns of the bench.

/// Number of unknowns.
pub const UNKNOWNS: usize = 8;

/// Their names: stiffnesses of coupling 1, coupling 2, roller pins and coupling 3, dampings of the couplings 1 to 3 and of the load
/// shaft.
pub const NAMES: [&str; UNKNOWNS] = ["k1", "k2", "k3", "k4", "c2", "c3", "c4", "c5"];
