//! Signals of a running bus, frame by frame.

use std::path::Path;

use super::database::{Database, EXTENDED, Frame, Set};
use crate::error::Result;

/// What the frames of a running bus hold, by a DBC.
pub struct CanSignals(Database);

/// Signals that stand in a frame under the same conditions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct CanSet {
    /// The identifier, with the highest bit where it has 29 bits.
    id: u32,
    index: usize,
}

impl CanSignals {
    /// Reads a DBC.
    ///
    /// # Errors
    /// When it cannot be read, or is none.
    pub fn open(path: &Path) -> Result<Self> {
        Database::open(path).map(Self)
    }

    /// The sets whose signals are in a frame; none of a frame that the DBC does not describe.
    #[must_use]
    pub fn sets(&self, id: u32, is_extended: bool, bytes: &[u8]) -> Vec<CanSet> {
        let id = id | if is_extended { EXTENDED } else { 0 };
        let Some(frame) = self.0.frames.get(&id) else { return Vec::new() };
        let held = |(index, set): (usize, &Set)| frame.holds(set, bytes).then_some(CanSet { id, index });
        frame.sets.iter().enumerate().filter_map(held).collect()
    }

    fn find(&self, set: CanSet) -> Option<(&Frame, &Set)> {
        let frame = self.0.frames.get(&set.id)?;
        Some((frame, frame.sets.get(set.index)?))
    }

    /// Name of the frame of a set, with the values of its multiplexers.
    #[must_use]
    pub fn name(&self, set: CanSet) -> &str {
        self.find(set).map_or("", |(_, set)| &set.name)
    }

    /// Names and units of the signals of a set, as the DBC has them.
    #[must_use]
    pub fn signals(&self, set: CanSet) -> Vec<(&str, &str)> {
        let Some((frame, set)) = self.find(set) else { return Vec::new() };
        set.signals.iter().map(|index| &frame.signals[*index]).map(|one| (&*one.name, &*one.unit)).collect()
    }

    /// Values of the signals of a set in a frame, NaN where the frame is too short.
    #[must_use]
    pub fn values(&self, set: CanSet, bytes: &[u8]) -> Vec<f64> {
        let Some((frame, set)) = self.find(set) else { return Vec::new() };
        let value = |index: &usize| frame.signals[*index].value(bytes).unwrap_or(f64::NAN);
        set.signals.iter().map(value).collect()
    }
}
