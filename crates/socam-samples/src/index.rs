//! The index file of a long recording: decoded samples and the lowest levels of their pyramids. It is built once, in the user's cache;
//! opening it again reads a few bytes per block, not the samples.

use std::fs::File;
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use socam_recording::Segment;

pub use super::cache::{path_of, prune};
use super::groups::{GROUP, Groups, MAGIC};
use super::moments::Moments;
use super::pyramid::{self, BASE, Extremes, MOMENTS_BASE, Pyramid};
use super::stored::{Samples, Store};

/// The metadata at the end of the file.
#[derive(Serialize, Deserialize)]
struct Tail<T> {
    about: T,
    rows: usize,
    middles: Vec<f64>,
    /// First row, rows, start, end, sample time and jitter.
    segments: Vec<(u64, u64, f64, f64, f64, f64)>,
}

/// An index file under construction. If it is dropped before [`Writer::finish`], the file is removed.
pub struct Writer {
    file: BufWriter<tempfile::NamedTempFile>,
    path: PathBuf,
    middles: Vec<f64>,
    rows: usize,
    time_s: Vec<f64>,
    columns: Vec<Vec<f32>>,
    blocks: Vec<Vec<Extremes>>,
    moments: Vec<Vec<Moments>>,
    knots: Vec<f64>,
}

impl Writer {
    /// Begins an index at `path` and makes its folder; `middles` are the middles of the channels' ranges.
    ///
    /// # Errors
    /// When the file cannot be written there.
    pub fn create(path: &Path, middles: Vec<f64>) -> io::Result<Self> {
        let folder = path.parent().unwrap_or(Path::new("."));
        std::fs::create_dir_all(folder)?;
        let file = BufWriter::with_capacity(1 << 20, tempfile::NamedTempFile::new_in(folder)?);
        let columns = middles.len();
        Ok(Self {
            file,
            path: path.into(),
            rows: 0,
            time_s: Vec::with_capacity(GROUP),
            columns: vec![Vec::with_capacity(GROUP); columns],
            blocks: vec![Vec::new(); columns],
            moments: vec![Vec::new(); columns],
            knots: Vec::new(),
            middles,
        })
    }

    /// Appends rows: times in s, and a value for each in every column (NaN if missing).
    ///
    /// # Errors
    /// When the disk is full.
    pub fn push(&mut self, time_s: &[f64], columns: &[&[f64]]) -> io::Result<()> {
        let mut next = 0;
        while next < time_s.len() {
            let to = time_s.len().min(next + GROUP - self.time_s.len());
            self.time_s.extend_from_slice(&time_s[next..to]);
            for ((own, theirs), middle) in self.columns.iter_mut().zip(columns).zip(&self.middles) {
                own.extend(theirs[next..to].iter().map(|value| (value - middle) as f32));
            }
            if self.time_s.len() == GROUP {
                self.write_group()?;
            }
            next = to;
        }
        Ok(())
    }

    fn write_group(&mut self) -> io::Result<()> {
        self.rows += self.time_s.len();
        self.knots.extend(self.time_s.iter().step_by(BASE));
        for (column, blocks) in self.columns.iter().zip(&mut self.blocks) {
            blocks.extend(column.chunks(BASE).map(pyramid::of));
        }
        for (column, moments) in self.columns.iter().zip(&mut self.moments) {
            moments.extend(column.chunks(MOMENTS_BASE).map(Moments::of));
        }
        self.time_s.resize(GROUP, f64::NAN);
        write_f64(&mut self.file, &self.time_s)?;
        self.time_s.clear();
        for column in &mut self.columns {
            column.resize(GROUP, f32::NAN);
            write_f32(&mut self.file, column)?;
            column.clear();
        }
        Ok(())
    }

    /// Writes the last group and the metadata, and moves the file to its path. `about` describes the recording; [`open`] returns it.
    ///
    /// # Errors
    /// When the disk is full.
    pub fn finish<T: Serialize>(mut self, about: &T, segments: &[Segment]) -> io::Result<Samples> {
        if !self.time_s.is_empty() {
            self.write_group()?;
        }
        let numbers_at = self.file.seek(SeekFrom::End(0))?;
        write_f64(&mut self.file, &self.knots)?;
        for blocks in &self.blocks {
            write_f32(&mut self.file, blocks.as_flattened())?;
        }
        for moments in &self.moments {
            let numbers: Vec<f64> =
                moments.iter().flat_map(|own| [own.count, own.mean, own.squares]).collect();
            write_f64(&mut self.file, &numbers)?;
        }
        let tail = Tail {
            about,
            rows: self.rows,
            middles: self.middles.clone(),
            segments: segments.iter().map(plain).collect(),
        };
        let text = serde_json::to_vec(&tail)?;
        self.file.write_all(&text)?;
        self.file.write_all(&(text.len() as u64).to_le_bytes())?;
        self.file.write_all(&numbers_at.to_le_bytes())?;
        self.file.write_all(&MAGIC)?;
        let file = self.file.into_inner().map_err(io::IntoInnerError::into_error)?;
        let file = file.persist(&self.path)?;
        Ok(Samples {
            rows: self.rows,
            store: Store::File(Groups::new(file, self.middles.len())),
            middles: self.middles,
            pyramids: self.blocks.into_iter().map(Pyramid::new).collect(),
            moments: self.moments.into_iter().map(Pyramid::new).collect(),
            knots: self.knots,
            segments: segments.to_vec(),
        })
    }
}

/// Opens an index that was built before: the description of its recording, and its samples.
///
/// # Errors
/// When the file does not exist or is not a complete index.
pub fn open<T: DeserializeOwned>(path: &Path) -> io::Result<(T, Samples)> {
    let mut file = File::open(path)?;
    let length = file.seek(SeekFrom::End(-24))?;
    let mut ends = [[0; 8]; 3];
    file.read_exact(ends.as_flattened_mut())?;
    let foreign = || io::Error::from(io::ErrorKind::InvalidData);
    let [text_bytes, numbers_at] = [u64::from_le_bytes(ends[0]), u64::from_le_bytes(ends[1])];
    let text_at = length.checked_sub(text_bytes).filter(|at| ends[2] == MAGIC && *at >= numbers_at);
    let text_at = text_at.ok_or_else(foreign)?;
    file.seek(SeekFrom::Start(numbers_at))?;
    let mut numbers = vec![0; (text_at - numbers_at) as usize];
    file.read_exact(&mut numbers)?;
    let mut text = vec![0; text_bytes as usize];
    file.read_exact(&mut text)?;
    let tail: Tail<T> = serde_json::from_slice(&text)?;
    let blocks = tail.rows.div_ceil(BASE);
    let columns = tail.middles.len();
    let of_moments = 24 * tail.rows.div_ceil(MOMENTS_BASE);
    if numbers.len() != 8 * blocks * (1 + columns) + of_moments * columns {
        return Err(foreign());
    }
    let (knots, rest) = numbers.split_at(8 * blocks);
    let (rest, moments) = rest.split_at(8 * blocks * columns);
    let knots = knots.as_chunks().0.iter().map(|number| f64::from_le_bytes(*number)).collect();
    let pyramids = rest.chunks_exact((8 * blocks).max(1)).map(|column| {
        let pairs = column.as_chunks::<8>().0.iter();
        Pyramid::new(
            pairs
                .map(|[a, b, c, d, e, f, g, h]| {
                    [f32::from_le_bytes([*a, *b, *c, *d]), f32::from_le_bytes([*e, *f, *g, *h])]
                })
                .collect(),
        )
    });
    let moments = moments.chunks_exact(of_moments.max(1)).map(|column| {
        let numbers: Vec<f64> = column.as_chunks().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect();
        let whole = numbers.as_chunks::<3>().0.iter();
        Pyramid::new(
            whole
                .map(|[count, mean, squares]| Moments { count: *count, mean: *mean, squares: *squares })
                .collect(),
        )
    });
    let samples = Samples {
        rows: tail.rows,
        pyramids: pyramids.collect(),
        moments: moments.collect(),
        knots,
        middles: tail.middles,
        segments: tail.segments.into_iter().map(segment).collect(),
        store: Store::File(Groups::new(file, columns)),
    };
    Ok((tail.about, samples))
}

fn plain(segment: &Segment) -> (u64, u64, f64, f64, f64, f64) {
    let Segment { first_row, rows, start_s, end_s, sample_time_s, jitter_s } = *segment;
    (first_row, rows, start_s, end_s, sample_time_s, jitter_s)
}

fn segment(plain: (u64, u64, f64, f64, f64, f64)) -> Segment {
    let (first_row, rows, start_s, end_s, sample_time_s, jitter_s) = plain;
    Segment { first_row, rows, start_s, end_s, sample_time_s, jitter_s }
}

fn write_f64(out: &mut impl Write, values: &[f64]) -> io::Result<()> {
    let mut bytes = Vec::with_capacity(8 * values.len());
    bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    out.write_all(&bytes)
}

fn write_f32(out: &mut impl Write, values: &[f32]) -> io::Result<()> {
    let mut bytes = Vec::with_capacity(4 * values.len());
    bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    out.write_all(&bytes)
}

#[cfg(test)]
mod tests;
