//! An opened recording: its description and its samples.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use socam_recording::{Dataset, Selection};
use socam_samples::{Samples, index};

use crate::about::about;
pub use crate::about::{About, Happening, short};
use crate::job::Handle;

/// Reads `RUN` or `RUN@FROM..TO`; an error is one sentence. Who opens a recording says how: a desktop also reads files of other programs.
pub type Read = fn(&str) -> Result<Dataset, String>;

/// A recording that is open.
#[derive(Debug, Clone)]
pub struct Recording {
    /// Description.
    pub about: About,
    /// Samples of the recording.
    pub samples: Arc<Samples>,
    file: Option<(PathBuf, Read)>,
}

/// Number of values above which a recording gets an index file.
const MOST_IN_MEMORY: u64 = 16 << 20;

impl Recording {
    /// A recording that has no file.
    #[must_use]
    pub fn in_memory(about: About, samples: Samples) -> Self {
        Self { about, samples: Arc::new(samples), file: None }
    }

    /// Loads a dataset into memory.
    ///
    /// # Errors
    /// When its file cannot be read again, as one sentence.
    pub fn of(data: &Dataset, handle: &Handle) -> Result<Self, String> {
        let about = about(data);
        let mut time_s = Vec::with_capacity(data.rows() as usize);
        let mut columns: Vec<Vec<f64>> = vec![Vec::with_capacity(time_s.capacity()); data.channels().len()];
        for block in data.blocks().map_err(sentence)? {
            let block = block.map_err(sentence)?;
            time_s.extend_from_slice(&block.time_s);
            for (column, values) in columns.iter_mut().zip(&block.columns) {
                column.extend_from_slice(values.values());
            }
            handle.reached(time_s.len() as f32 / data.rows().max(1) as f32)?;
        }
        Ok(Self::in_memory(about, Samples::in_memory(time_s, &columns, data.segments().to_vec())))
    }

    /// Opens a recording into memory.
    ///
    /// # Errors
    /// When it is no recording, cannot be read, or opening was cancelled; one sentence.
    pub fn open(run: &str, read: Read, handle: &Handle) -> Result<Self, String> {
        let path = Selection::parse(run).map_err(sentence)?.path;
        Ok(Self { file: Some((path, read)), ..Self::of(&read(run)?, handle)? })
    }

    /// Opens a recording. A long one gets an index file in the user's cache, which makes the next opening fast.
    ///
    /// # Errors
    /// When it is no recording, cannot be read, or opening was cancelled; one sentence.
    pub fn open_indexed(run: &str, read: Read, handle: &Handle) -> Result<Self, String> {
        let selection = Selection::parse(run).map_err(sentence)?;
        let index_path = if selection.is_whole_file() { index::path_of(&selection.path) } else { None };
        let path = selection.path;
        let known = index_path.as_deref().and_then(|path| index::open::<About>(path).ok());
        if let Some((about, samples)) = known {
            let about = About { name: run.into(), ..about };
            return Ok(Self { file: Some((path, read)), ..Self::in_memory(about, samples) });
        }
        handle.doing(format!("Reading {}", short(run)));
        let data = read(run)?;
        handle.reached(0.0)?;
        let values = data.rows() * data.channels().len() as u64;
        let recording = match index_path.filter(|_| values > MOST_IN_MEMORY) {
            Some(target) => {
                handle.doing(format!("Indexing {}", short(run)));
                let (about, samples) = indexed(&data, &target, handle)?;
                index::prune();
                Self::in_memory(about, samples)
            }
            None => Self::of(&data, handle)?,
        };
        Ok(Self { file: Some((path, read)), ..recording })
    }

    /// File of the recording; `None` if it was simulated here.
    #[must_use]
    pub fn path(&self) -> Option<&Path> {
        self.file.as_ref().map(|(path, _)| path.as_path())
    }

    /// The samples in full precision: read again from the file if there is one, else the samples that are drawn.
    ///
    /// # Errors
    /// When its file cannot be read again; one sentence.
    pub fn dataset(&self) -> Result<Dataset, String> {
        let about = &self.about;
        if let Some((_, read)) = &self.file {
            return read(&about.name);
        }
        let rows = 0..self.samples.rows();
        let columns = (0..about.channels.len()).map(|channel| self.samples.values(channel, rows.clone()));
        let times = self.samples.times(rows.clone());
        Dataset::from_columns(&about.name, about.channels.clone(), times, columns.collect()).map_err(sentence)
    }

    /// Whether it has a column of this name.
    #[must_use]
    pub fn has_column(&self, name: &str) -> bool {
        self.about.channels.iter().any(|channel| channel.column_name() == name)
    }

    /// Index of a channel by name.
    #[must_use]
    pub fn channel(&self, name: &str) -> Option<usize> {
        self.about.channels.iter().position(|channel| channel.name == name)
    }
}

/// Builds the index of a long recording.
///
/// # Errors
/// When the disk is full, the recording cannot be read, or it was cancelled; one sentence.
fn indexed(data: &Dataset, target: &Path, handle: &Handle) -> Result<(About, Samples), String> {
    let about = about(data);
    let middles =
        data.statistics().iter().map(|s| s.min.zip(s.max).map_or(0.0, |(low, high)| 0.5 * (low + high)));
    let full = |error: std::io::Error| {
        format!(
            "cannot write the index {}: {error}; free some room, or set XDG_CACHE_HOME to another disk",
            target.display()
        )
    };
    let mut writer = index::Writer::create(target, middles.collect()).map_err(full)?;
    let mut done = 0;
    for block in data.blocks().map_err(sentence)? {
        let block = block.map_err(sentence)?;
        let columns: Vec<&[f64]> = block.columns.iter().map(|column| column.values()).collect();
        writer.push(&block.time_s, &columns).map_err(full)?;
        done += block.rows();
        handle.reached(done as f32 / data.rows().max(1) as f32)?;
    }
    let samples = writer.finish(&about, data.segments()).map_err(full)?;
    Ok((about, samples))
}

fn sentence(error: impl std::fmt::Display) -> String {
    error.to_string()
}
