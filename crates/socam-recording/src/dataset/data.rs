//! The dataset: description of a recording after it is opened.

use std::sync::Arc;

use super::source::Source;
use crate::Channel;
use crate::clock_time::Epoch;
use crate::format::Format;
use crate::log::contents::LogContents;
use crate::segments::Segment;
use crate::statistics::Statistics;
use crate::warning::{self, Cut, Warning};

/// A recording over time, or the selected part of one.
///
/// Opening it reads the file once, checks every row, and finds segments and statistics. [`Dataset::blocks`] then iterates over the
/// samples any number of times, [`Dataset::blocks_in`] over a part of them, also from several threads at once. Samples are kept in
/// memory up to a limit for all recordings together, else decoded in a temporary file while there is room for one, else read
/// again from the recording's own file on each pass. The three differ only in time.
///
/// All values are SI. Times are those of the recording (a selection does not shift them) and increase strictly.
///
/// ```
/// use socam_recording::{Channel, Dataset, Unit};
///
/// // 3 s at 10 Hz with a gap of 1 s.
/// let time_s: Vec<f64> = (0..30).filter(|k| !(10..20).contains(k)).map(|k| 0.1 * f64::from(k)).collect();
/// let speed = time_s.iter().map(|t| 2.0 * t).collect();
/// let data = Dataset::from_columns("run", vec![Channel::new("speed", Unit::RadPerS)], time_s, vec![speed])?;
/// assert_eq!((data.name(), data.rows(), data.segments().len()), ("run", 20, 2));
/// assert!((data.sample_time_s() - 0.1).abs() < 1e-9);
/// assert_eq!((data.segments()[0].end_row(), data.start_s()), (10, 0.0));
/// assert_eq!(data.channels()[0].column_name(), "speed_rad_s");
/// assert_eq!(data.statistics()[0].count, 20);
/// assert_eq!((data.lost_samples(), data.cut(), data.warnings().len()), (0, None, 0));
/// // Samples in blocks, none of which contains a gap.
/// for block in data.blocks()? {
///     let block = block?;
///     assert_eq!((block.rows(), block.columns[0].missing()), (10, 0));
/// }
/// # Ok::<(), socam_recording::RecordingError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Dataset {
    pub(super) name: String,
    pub(super) format: Format,
    pub(super) channels: Vec<Channel>,
    pub(super) statistics: Vec<Statistics>,
    pub(super) segments: Vec<Segment>,
    pub(super) sample_time_s: f64,
    pub(super) rows: u64,
    /// Rows per sample.
    pub(super) parts: u32,
    /// Whether steps within a segment differ in length.
    pub(super) uneven: bool,
    pub(super) lost_samples: u64,
    pub(super) cut: Option<Cut>,
    pub(super) epoch: Option<Epoch>,
    pub(super) contents: Option<Arc<LogContents>>,
    pub(super) warnings: Vec<Warning>,
    pub(super) source: Source,
}

impl Dataset {
    /// The recording's name in results: the text by which it was opened.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The format it was read from.
    #[must_use]
    pub fn format(&self) -> Format {
        self.format
    }

    /// Channels of the dataset; every block has its columns in this order.
    #[must_use]
    pub fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// Statistics of each channel, in the order of [`Dataset::channels`].
    #[must_use]
    pub fn statistics(&self) -> &[Statistics] {
        &self.statistics
    }

    /// Segments without a gap, in order; a gap lies between each and the next.
    #[must_use]
    pub fn segments(&self) -> &[Segment] {
        &self.segments
    }

    /// Median step of time, s; 0 for a single row.
    #[must_use]
    pub fn sample_time_s(&self) -> f64 {
        self.sample_time_s
    }

    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> u64 {
        self.rows
    }

    /// Rows per recorded sample: more than one where irregular samples were resampled to a finer grid
    /// ([`Dataset::on_regular_grid`]).
    #[must_use]
    pub fn rows_per_sample(&self) -> u32 {
        self.parts
    }

    /// Whether steps within a segment may differ in length: the recording is integrated from stamp to stamp
    /// ([`Dataset::on_its_stamps`]).
    #[must_use]
    pub fn has_uneven_steps(&self) -> bool {
        self.uneven
    }

    /// Time of the first row, s.
    #[must_use]
    pub fn start_s(&self) -> f64 {
        self.segments.first().map_or(0.0, |segment| segment.start_s)
    }

    /// Time of the last row, s.
    #[must_use]
    pub fn end_s(&self) -> f64 {
        self.segments.last().map_or(0.0, |segment| segment.end_s)
    }

    /// Number of samples lost while recording, by jumps of their sequence numbers (MCAP only; of the whole file).
    #[must_use]
    pub fn lost_samples(&self) -> u64 {
        self.lost_samples
    }

    /// Place at which the file was cut off, if it was.
    #[must_use]
    pub fn cut(&self) -> Option<&Cut> {
        self.cut.as_ref()
    }

    /// What the clock that stamped the recording showed at its time 0; `None` where nothing states it.
    #[must_use]
    pub fn epoch(&self) -> Option<Epoch> {
        self.epoch
    }

    /// States what the clock showed at time 0.
    #[must_use]
    pub fn with_epoch(mut self, epoch: Option<Epoch>) -> Self {
        self.epoch = epoch.or(self.epoch);
        self
    }

    /// Contents of an MCAP log apart from samples; `None` for other formats.
    #[must_use]
    pub fn contents(&self) -> Option<&LogContents> {
        self.contents.as_deref()
    }

    /// Renames the dataset in results, where the path from which it was read is not meaningful.
    #[must_use]
    pub fn with_name(mut self, name: impl Into<String>) -> Self {
        self.name = name.into();
        self
    }

    /// Adds warnings of the caller that read the dataset.
    #[must_use]
    pub fn with_warnings(mut self, warnings: impl IntoIterator<Item = Warning>) -> Self {
        self.warnings.extend(warnings);
        self
    }

    /// Warnings from opening: parts that were not read, and parts that are missing.
    #[must_use]
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }

    /// Whether the recording is whole as far as its file shows: not cut off, nothing damaged, no sample lost.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.cut.is_none() && self.lost_samples == 0 && warning::damage(&self.warnings).is_none()
    }
}
