//! An opened recording: its description and its samples.

use std::path::PathBuf;
use std::sync::Arc;

use socam_recording::Dataset;

use crate::about::about;
pub use crate::about::{About, Happening, short};
#[cfg(not(target_arch = "wasm32"))]
use crate::foreign;
use crate::job::Handle;
use socam_samples::Samples;

/// A recording that is open.
#[derive(Debug, Clone)]
pub struct Recording {
    /// Description.
    pub about: About,
    /// Its samples.
    pub samples: Arc<Samples>,
    /// Its file; `None` if it was simulated here or dropped into a browser.
    pub path: Option<PathBuf>,
}

/// Number of values above which a recording gets an index file.
#[cfg(not(target_arch = "wasm32"))]
const MOST_IN_MEMORY: u64 = 16 << 20;

impl Recording {
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
        let samples = Arc::new(Samples::in_memory(time_s, &columns, data.segments().to_vec()));
        Ok(Self { about, samples, path: None })
    }

    /// Opens a file that was given to the page under a name.
    ///
    /// # Errors
    /// When it is no recording; one sentence.
    #[cfg(target_arch = "wasm32")]
    pub fn open(name: &str, handle: &Handle) -> Result<Self, String> {
        let data = Dataset::open(name).map_err(sentence)?;
        Ok(Self { path: Some(name.into()), ..Self::of(&data, handle)? })
    }

    /// Opens `RUN` or `RUN@FROM..TO`. A long recording gets an index file in the user's cache, which makes the next opening fast.
    ///
    /// # Errors
    /// When it is no recording, cannot be read, or opening was cancelled; one sentence.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn open(run: &str, handle: &Handle) -> Result<Self, String> {
        use socam_recording::Selection;
        use socam_samples::index;

        let selection = Selection::parse(run).map_err(sentence)?;
        let whole = selection.span == socam_recording::Span::ALL;
        let path = selection.path.clone();
        let index_path = if whole { index::path_of(&path) } else { None };
        if let Some((about, samples)) = index_path.as_deref().and_then(|path| index::open(path).ok()) {
            let about = About { name: run.into(), ..about };
            return Ok(Self { about, samples: Arc::new(samples), path: Some(path) });
        }
        handle.doing(format!("Reading {}", short(run)));
        let data = foreign::open(&selection)?;
        handle.reached(0.0)?;
        let values = data.rows() * data.channels().len() as u64;
        let index_path = index_path.filter(|_| values > MOST_IN_MEMORY);
        let mut recording = match index_path {
            Some(target) => {
                handle.doing(format!("Indexing {}", short(run)));
                let (about, samples) = indexed(&data, &target, handle)?;
                index::prune();
                Self { about, samples: Arc::new(samples), path: None }
            }
            None => Self::of(&data, handle)?,
        };
        recording.path = Some(path);
        Ok(recording)
    }

    /// The samples in full precision: read again from the file if there is one, else the samples that are drawn.
    ///
    /// # Errors
    /// When its file cannot be read again; one sentence.
    pub fn dataset(&self) -> Result<Dataset, String> {
        let about = &self.about;
        if self.path.is_some() {
            #[cfg(target_arch = "wasm32")]
            return Dataset::open(&about.name).map_err(sentence);
            #[cfg(not(target_arch = "wasm32"))]
            return foreign::open(&socam_recording::Selection::parse(&about.name).map_err(sentence)?);
        }
        let rows = 0..self.samples.rows();
        let columns = (0..about.channels.len()).map(|channel| self.samples.values(channel, rows.clone()));
        let times = self.samples.times(rows.clone());
        Dataset::from_columns(&about.name, about.channels.clone(), times, columns.collect()).map_err(sentence)
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
#[cfg(not(target_arch = "wasm32"))]
pub fn indexed(
    data: &Dataset,
    target: &std::path::Path,
    handle: &Handle,
) -> Result<(About, Samples), String> {
    use socam_samples::index::Writer;

    let about = about(data);
    let middles =
        data.statistics().iter().map(|s| s.min.zip(s.max).map_or(0.0, |(low, high)| 0.5 * (low + high)));
    let full = |error: std::io::Error| {
        format!(
            "cannot write the index {}: {error}; free some room, or set XDG_CACHE_HOME to another disk",
            target.display()
        )
    };
    let mut writer = Writer::create(target, middles.collect()).map_err(full)?;
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
