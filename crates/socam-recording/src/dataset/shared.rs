//! All samples of a dataset in memory that is shared, for views by other languages.

use std::sync::Arc;

use super::data::Dataset;
use super::keep::Memory;
use super::source::Source;
use crate::error::Result;
use crate::table::Table;

/// All rows of all channels, not copied where the dataset keeps them in memory. A clone shares them.
#[derive(Debug, Clone)]
pub struct Shared(Arc<Memory>);

impl Shared {
    /// Times, s, strictly increasing.
    #[must_use]
    pub fn time_s(&self) -> &[f64] {
        &self.0.table.time_s
    }

    /// Values of a channel by its index, NaN where they are missing; `None` where there is no such channel.
    #[must_use]
    pub fn values(&self, channel: usize) -> Option<&[f64]> {
        self.0.table.columns.get(channel).map(Vec::as_slice)
    }
}

impl Dataset {
    /// All samples in memory: those that the dataset holds where it keeps them there, else read once.
    ///
    /// ```
    /// # let data = include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/doc/run.rs"));
    /// let (all, again) = (data.shared()?, data.shared()?);
    /// assert_eq!(all.time_s().len() as u64, data.rows());
    /// assert!(std::ptr::eq(all.values(1).unwrap(), again.values(1).unwrap()));
    /// # Ok::<(), socam_recording::RecordingError>(())
    /// ```
    ///
    /// # Errors
    /// The errors of [`Dataset::blocks`].
    pub fn shared(&self) -> Result<Shared> {
        if let Source::Memory(memory) = &self.source {
            return Ok(Shared(memory.clone()));
        }
        let mut table = Table::with_columns(self.channels.len());
        for block in self.blocks()? {
            let block = block?;
            table.time_s.extend(&block.time_s);
            for (all, column) in table.columns.iter_mut().zip(&block.columns) {
                all.extend_from_slice(column.values());
            }
        }
        Ok(Shared(Arc::new(Memory::existing(table))))
    }
}
