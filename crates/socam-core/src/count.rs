//! What a board's channels are counted in.

use core::fmt;

use crate::ring::Stored;

/// A reading of a channel. The type is the board's, so that a board without encoders neither stores nor compares more than its
/// converters give.
pub trait Count: Stored + Default + Eq + fmt::Debug + Into<i32> {
    /// Whether some channels may be wide: of 32 bits, for an encoder.
    const MAY_BE_WIDE: bool;
}

/// Converters only.
impl Count for i16 {
    const MAY_BE_WIDE: bool = false;
}

/// Converters and encoders.
impl Count for i32 {
    const MAY_BE_WIDE: bool = true;
}
