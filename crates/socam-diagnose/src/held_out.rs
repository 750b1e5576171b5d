//! Held-out recordings: they are opened by the proof, after the last choice.

use std::fmt;
use std::hash::{DefaultHasher, Hasher};

use socam_recording::{Dataset, RecordingError, Selection};

use crate::{error::DiagnoseError, final_choice::FinalChoice};

/// Recordings that are held out. [`diagnose`](fn@crate::diagnose) opens them after the last choice; before, it only compares checksums of
/// those in memory with the training recordings. Files should be checked beforehand by [`refuse_copies`].
///
/// ```
/// use socam_diagnose::HeldOut;
/// use socam_recording::Dataset;
///
/// let held_out = HeldOut::none().with("reversals.mcap", || Dataset::open("reversals.mcap"));
/// assert!(!held_out.is_empty());
/// ```
#[derive(Default)]
pub struct HeldOut<'a> {
    recordings: Vec<Unopened<'a>>,
}

/// A held-out recording before it is opened.
struct Unopened<'a> {
    name: String,
    /// The recording if its caller has already opened it; used for its checksum.
    in_memory: Option<Dataset>,
    open: Box<dyn FnOnce() -> Result<Dataset, String> + Send + 'a>,
}

impl<'a> HeldOut<'a> {
    /// No held-out recordings.
    #[must_use]
    pub fn none() -> Self {
        Self::default()
    }

    /// Held-out recordings that the caller has already opened; they are predicted without any preparation.
    #[must_use]
    pub fn in_memory(recordings: &[Dataset]) -> Self {
        recordings
            .iter()
            .fold(Self::none(), |all, data| all.with_dataset(data.clone(), Ok::<_, std::convert::Infallible>))
    }

    /// Adds a recording that its caller has opened already. `prepare` is called once, after the last choice, and returns what is
    /// predicted, for instance the recording on a regular grid. If it fails, its error is a warning of the diagnosis, and nothing is
    /// proven.
    #[must_use]
    pub fn with_dataset<E: fmt::Display>(
        mut self,
        recording: Dataset,
        prepare: impl FnOnce(Dataset) -> Result<Dataset, E> + Send + 'a,
    ) -> Self {
        let (name, in_memory) = (recording.name().to_owned(), Some(recording.clone()));
        let open = Box::new(move || prepare(recording).map_err(|error| error.to_string()));
        self.recordings.push(Unopened { name, in_memory, open });
        self
    }

    /// Adds a recording that `open` reads. `open` is called once, after the last choice. If it fails, its error is a warning of the
    /// diagnosis, and nothing is proven.
    #[must_use]
    pub fn with<E: fmt::Display>(
        mut self,
        name: impl Into<String>,
        open: impl FnOnce() -> Result<Dataset, E> + Send + 'a,
    ) -> Self {
        let open = Box::new(move || open().map_err(|error| error.to_string()));
        self.recordings.push(Unopened { name: name.into(), in_memory: None, open });
        self
    }

    /// Whether nothing is held out.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.recordings.is_empty()
    }

    /// Locks the recordings until the last choice of a diagnosis that fits `training`.
    ///
    /// # Errors
    /// [`DiagnoseError::SameSamples`] if one that is in memory has the samples of a training recording.
    pub(crate) fn sealed(self, training: &'a [Dataset]) -> Result<Sealed<'a>, DiagnoseError> {
        for recording in &self.recordings {
            if let Some(held_out) = &recording.in_memory
                && let Some(fitted) = same(held_out, training)?
            {
                return Err(DiagnoseError::same_samples(held_out.name(), fitted.name()));
            }
        }
        Ok(Sealed { recordings: self.recordings, training })
    }
}

impl fmt::Debug for HeldOut<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.recordings.iter().map(|recording| &recording.name)).finish()
    }
}

/// Held-out recordings during a diagnosis. Only a [`FinalChoice`] opens them.
pub(crate) struct Sealed<'a> {
    recordings: Vec<Unopened<'a>>,
    /// Training recordings as they were given, before any masking.
    training: &'a [Dataset],
}

impl Sealed<'_> {
    pub(crate) fn is_empty(&self) -> bool {
        self.recordings.is_empty()
    }

    /// Opens the recordings. The error is a sentence: a recording cannot be opened, or has the samples of a training recording.
    pub(crate) fn open(self, _: &FinalChoice) -> Result<Vec<Dataset>, String> {
        let open = |Unopened { name, open, .. }: Unopened<'_>| {
            let data = open().map_err(|error| format!("`{name}` cannot be opened: {error}"))?;
            match same(&data, self.training).map_err(|error| error.to_string())? {
                Some(fitted) => Err(DiagnoseError::same_samples(&name, fitted.name()).to_string()),
                None => Ok(data),
            }
        };
        self.recordings.into_iter().map(open).collect()
    }
}

/// Refuses held-out files that hold samples of a training file, also a copy under another name. Files are compared by length and SHA-256,
/// where the selected spans overlap; no sample is decoded.
///
/// # Errors
/// [`DiagnoseError::SameSamples`], or [`DiagnoseError::Recording`] if a file cannot be read.
pub fn refuse_copies(training: &[Selection], held_out: &[Selection]) -> Result<(), DiagnoseError> {
    for held in held_out {
        for fitted in training {
            if held.shares_samples_with(fitted)? {
                return Err(DiagnoseError::same_samples(&held.name(), &fitted.name()));
            }
        }
    }
    Ok(())
}

/// The first of some recordings that has the channels and the samples of `data`, whatever its name and the time at which it starts.
fn same<'d>(data: &Dataset, others: &'d [Dataset]) -> Result<Option<&'d Dataset>, RecordingError> {
    for other in others {
        let may_be = data.rows() == other.rows() && data.channels() == other.channels();
        if may_be && checksum(data)? == checksum(other)? {
            return Ok(Some(other));
        }
    }
    Ok(None)
}

/// Checksum of a recording's values, row by row, so that it does not depend on how the rows are divided into blocks.
fn checksum(data: &Dataset) -> Result<u64, RecordingError> {
    let mut hash = DefaultHasher::new();
    for block in data.blocks()? {
        let block = block?;
        for row in 0..block.rows() {
            for column in &block.columns {
                hash.write_u64(column.values()[row].to_bits());
            }
        }
    }
    Ok(hash.finish())
}
