//! An opened recording: its description and its samples.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use socam_recording::{Dataset, Selection, Span, named_part, without_part};
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
    file: Option<Arc<(PathBuf, Read)>>,
    /// The span of [`Recording::dataset`] where there is no file from which it is read by its name.
    span: Option<[f64; 2]>,
}

/// Number of values above which a recording gets an index file.
const MOST_IN_MEMORY: u64 = 16 << 20;

impl Recording {
    /// A recording that has no file.
    #[must_use]
    pub fn in_memory(about: About, samples: Samples) -> Self {
        Self { about, samples: Arc::new(samples), file: None, span: None }
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
        Ok(Self { file: Some(Arc::new((path, read))), ..Self::of(&read(run)?, handle)? })
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
            return Ok(Self { file: Some(Arc::new((path, read))), ..Self::in_memory(about, samples) });
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
        Ok(Self { file: Some(Arc::new((path, read))), ..recording })
    }

    /// File of the recording; `None` if it was simulated here.
    #[must_use]
    pub fn path(&self) -> Option<&Path> {
        self.file.as_ref().map(|file| file.0.as_path())
    }

    /// The samples in full precision: read again from the file if there is one, else the samples that are drawn.
    ///
    /// # Errors
    /// When its file cannot be read again; one sentence.
    pub fn dataset(&self) -> Result<Dataset, String> {
        let about = &self.about;
        if let Some(file) = &self.file {
            return (file.1)(&about.name);
        }
        let rows = match self.span {
            Some([from, to]) => self.samples.row_at(from)..self.samples.row_at(to),
            None => 0..self.samples.rows(),
        };
        let columns = (0..about.channels.len()).map(|channel| self.samples.values(channel, rows.clone()));
        let times = self.samples.times(rows.clone());
        Dataset::from_columns(&about.name, about.channels.clone(), times, columns.collect()).map_err(sentence)
    }

    /// The part of it between two of its own times, s, to the microsecond, whose name has the part (`RUN@FROM..TO`): what
    /// [`dataset`](Self::dataset) reads. Its description and [`samples`](Self::samples) stay those of the whole recording.
    ///
    /// # Errors
    /// When it has fewer than two samples there; one sentence.
    pub fn part(&self, range_s: [f64; 2]) -> Result<Self, String> {
        let [from, to] = range_s.map(|time| (1e6 * time).round() / 1e6);
        let [first, last] = self.samples.span_s().unwrap_or([0.0, 0.0]);
        let rows = self.samples.row_at(from)..self.samples.row_at(to);
        if rows.len() < 2 {
            let name = short(&self.about.name);
            return Err(format!(
                "{name} has no samples between {from} s and {to} s: choose another range, or leave it out."
            ));
        }
        if from <= first && to > last {
            return Ok(self.clone());
        }
        // An open end of a part that is open already would be that of the whole file.
        let is_part = without_part(&self.about.name) != self.about.name;
        let end_s = (1e6 * (last + 0.5 * self.about.sample_time_s)).ceil() / 1e6;
        let from_s = match from > first {
            true => from,
            false if is_part => (1e6 * first).floor() / 1e6,
            false => f64::NEG_INFINITY,
        };
        let to_s = match to > last {
            true if is_part => end_s,
            true => f64::INFINITY,
            false => to,
        };
        let mut part = self.clone();
        part.about.name = named_part(&self.about.name, Span { from_s, to_s });
        part.span = Some([from.max(first), to]);
        Ok(part)
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

#[cfg(test)]
mod tests {
    use super::*;

    fn read(run: &str) -> Result<Dataset, String> {
        Dataset::open(run).map_err(sentence)
    }

    /// The part is the one that a command with the same name reads, of a file and in memory.
    #[test]
    fn a_part_is_what_its_name_says() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("run.csv");
        let rows: String = (0..1000).map(|row| format!("{},{row}\n", f64::from(row) * 0.01)).collect();
        std::fs::write(&path, format!("t_s,speed_rad_s\n{rows}")).unwrap();
        let run = path.display().to_string();
        let recording = Recording::open(&run, read, &Handle::default()).unwrap();
        let named = |recording: &Recording, range_s: [f64; 2]| {
            let part = recording.part(range_s).unwrap();
            let data = part.dataset().unwrap();
            (part.about.name.replace(&run, "run"), data.start_s(), data.end_s())
        };
        assert_eq!(named(&recording, [2.0, 7.500_000_2]), ("run@2..7.5".into(), 2.0, 7.49));
        assert_eq!(named(&recording, [-1.0, 3.0]), ("run@..3".into(), 0.0, 2.99));
        assert_eq!(named(&recording, [3.0, 99.0]), ("run@3..".into(), 3.0, 9.99));
        assert_eq!(named(&recording, [-1.0, 99.0]), ("run".into(), 0.0, 9.99));
        let why = recording.part([20.0, 30.0]).unwrap_err();
        assert!(why.contains("run.csv has no samples between 20 s and 30 s"), "{why}");
        // A part of a part stays within it.
        let part = Recording::open(&format!("{run}@2..8"), read, &Handle::default()).unwrap();
        assert_eq!(named(&part, [1.0, 3.0]), ("run@2..3".into(), 2.0, 2.99));
        assert_eq!(named(&part, [4.0, 99.0]), ("run@4..7.995".into(), 4.0, 7.99));
        let in_memory = Recording::of(&read(&run).unwrap(), &Handle::default()).unwrap();
        assert_eq!(named(&in_memory, [2.0, 7.5]), ("run@2..7.5".into(), 2.0, 7.49));
    }
}
