//! Where the objects of a drive are.

/// Where an object is: index and subindex.
pub(super) type Place = (u16, u8);

/// An object as people write it: `606C:00`.
pub(super) fn written((index, sub): Place) -> String {
    format!("{index:04X}:{sub:02X}")
}
