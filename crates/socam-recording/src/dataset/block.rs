//! Rows in memory, as a pass returns them.

/// The values of one channel in a [`Block`], in the channel's unit.
///
/// A missing value is held as NaN. Since readers refuse NaN in files, NaN means "missing" and nothing else; ask
/// [`Column::is_complete`] before using [`Column::values`] as plain numbers.
///
/// ```
/// use socam_recording::{Channel, Dataset, Unit};
///
/// let torque = vec![Channel::new("torque", Unit::Nm)];
/// let data = Dataset::from_columns("run", torque, vec![0.0, 0.1, 0.2], vec![vec![1.0, f64::NAN, 3.0]])?;
/// let column = &data.load(&["torque"])?.columns[0];
/// assert_eq!((column.get(0), column.get(1), column.get(3)), (Some(1.0), None, None));
/// assert_eq!((column.values().len(), column.missing(), column.is_complete()), (3, 1, false));
/// # Ok::<(), socam_recording::RecordingError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    values: Vec<f64>,
    missing: usize,
}

impl Column {
    pub(crate) fn new(values: Vec<f64>) -> Self {
        let missing = values.iter().filter(|value| value.is_nan()).count();
        Self { values, missing }
    }

    /// One number per row; NaN where the value is missing.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The value at a row of the block, `None` where it is missing (or the row does not exist).
    #[must_use]
    pub fn get(&self, row: usize) -> Option<f64> {
        self.values.get(row).copied().filter(|value| !value.is_nan())
    }

    /// Whether every row has a value.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.missing == 0
    }

    /// Number of rows without a value.
    #[must_use]
    pub fn missing(&self) -> usize {
        self.missing
    }
}

/// Some consecutive rows of a dataset, all in one [`Segment`](crate::Segment): no gap lies inside a block.
#[derive(Debug, Clone, PartialEq)]
pub struct Block {
    /// Index in [`Dataset::segments`](crate::Dataset::segments).
    pub segment: usize,
    /// Index of its first row in the dataset, from 0.
    pub first_row: u64,
    /// Times, s, strictly increasing; at least one.
    pub time_s: Vec<f64>,
    /// One column per channel asked for, in that order (all of [`Dataset::channels`](crate::Dataset::channels) for
    /// [`Dataset::blocks`](crate::Dataset::blocks)); each as long as `time_s`.
    pub columns: Vec<Column>,
}

impl Block {
    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.time_s.len()
    }
}

/// All rows of some channels at once. See [`Dataset::load`](crate::Dataset::load).
#[derive(Debug, Clone, PartialEq)]
pub struct Loaded {
    /// Times, s, strictly increasing.
    pub time_s: Vec<f64>,
    /// One column per channel asked for, in that order; each as long as `time_s`.
    pub columns: Vec<Column>,
}
