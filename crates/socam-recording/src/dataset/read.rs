//! Reads a dataset's samples: in blocks, or all at once.

use std::ops::Range;

use super::block::{Column, Loaded};
use super::blocks::Blocks;
use super::data::Dataset;
use crate::Channel;
use crate::error::{RecordingError, Result};

impl Dataset {
    /// Index of a channel, by its name (`motor_speed`) or, where two share it, by its column's name (`motor_speed_rad_s`).
    ///
    /// ```
    /// # let data = include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/doc/run.rs"));
    /// assert_eq!(data.channel_index("torque")?, 1);
    /// assert_eq!(data.channel_index("torque_Nm")?, 1);
    /// assert!(data.channel_index("force").is_err());
    /// # Ok::<(), socam_recording::RecordingError>(())
    /// ```
    ///
    /// # Errors
    /// When there is none of this name, or several.
    pub fn channel_index(&self, name: &str) -> Result<usize> {
        let by_column = self.channels.iter().position(|channel| channel.column_name() == name);
        let mut by_name = (0..self.channels.len()).filter(|&i| self.channels[i].name == name);
        match (by_column, by_name.next(), by_name.next()) {
            (Some(index), _, _) | (None, Some(index), None) => Ok(index),
            _ => Err(RecordingError::NoSuchChannel {
                recording: self.name.clone(),
                channel: name.into(),
                available: self.channels.iter().map(Channel::column_name).collect::<Vec<_>>().join(", "),
            }),
        }
    }

    /// A new pass over all rows, in blocks of at most a few thousand rows; may be called any number of times.
    ///
    /// # Errors
    /// When the file can no longer be opened; each block can fail in the same way.
    pub fn blocks(&self) -> Result<Blocks<'_>> {
        let all: Vec<usize> = (0..self.channels.len()).collect();
        self.blocks_in(0..self.rows, &all)
    }

    /// A pass over some rows and some channels (by index, in this order). Rows before them are not read, and every pass has its own
    /// handle of the file.
    ///
    /// ```
    /// # let data = include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/doc/run.rs"));
    /// let mut largest = 0.0_f64;
    /// for block in data.blocks_in(100..200, &[1])? {
    ///     largest = block?.columns[0].values().iter().fold(largest, |most, value| most.max(value.abs()));
    /// }
    /// assert!((largest - 1.0).abs() < 1e-3);
    /// # Ok::<(), socam_recording::RecordingError>(())
    /// ```
    ///
    /// # Errors
    /// The errors of [`Dataset::blocks`].
    ///
    /// # Panics
    /// When there is no such channel.
    pub fn blocks_in(&self, rows: Range<u64>, channels: &[usize]) -> Result<Blocks<'_>> {
        if let Some(channel) = channels.iter().find(|channel| **channel >= self.channels.len()) {
            panic!("channel {channel} of {}", self.channels.len());
        }
        Blocks::new(&self.source, &self.name, &self.segments, rows, channels.to_vec())
    }

    /// All rows of the named channels, in memory. Suits short recordings; a method that works on one block at a time
    /// should use [`Dataset::blocks`].
    ///
    /// ```
    /// # let data = include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/doc/run.rs"));
    /// let loaded = data.load(&["torque", "motor_speed"])?;
    /// assert_eq!((loaded.time_s.len(), loaded.columns.len()), (1000, 2));
    /// assert!(loaded.columns[0].is_complete());
    /// # Ok::<(), socam_recording::RecordingError>(())
    /// ```
    ///
    /// # Errors
    /// When a channel does not exist or the file cannot be read again.
    pub fn load(&self, channels: &[&str]) -> Result<Loaded> {
        let indices = channels.iter().map(|name| self.channel_index(name)).collect::<Result<Vec<_>>>()?;
        self.load_channels(0..self.rows, &indices)
    }

    /// All rows of all channels, in memory, in the order of [`Dataset::channels`].
    ///
    /// ```
    /// # let data = include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/doc/run.rs"));
    /// assert_eq!(data.load_all()?.columns.len(), data.channels().len());
    /// # Ok::<(), socam_recording::RecordingError>(())
    /// ```
    ///
    /// # Errors
    /// When the file cannot be read again.
    pub fn load_all(&self) -> Result<Loaded> {
        self.load_rows(0..self.rows)
    }

    /// These rows of all channels, in memory, in the order of [`Dataset::channels`].
    ///
    /// ```
    /// # let data = include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/doc/run.rs"));
    /// let loaded = data.load_rows(0..100)?;
    /// assert_eq!((loaded.time_s.len(), loaded.columns.len()), (100, data.channels().len()));
    /// # Ok::<(), socam_recording::RecordingError>(())
    /// ```
    ///
    /// # Errors
    /// When the file cannot be read again.
    pub fn load_rows(&self, rows: Range<u64>) -> Result<Loaded> {
        self.load_channels(rows, &(0..self.channels.len()).collect::<Vec<_>>())
    }

    fn load_channels(&self, rows: Range<u64>, indices: &[usize]) -> Result<Loaded> {
        let mut time_s = Vec::new();
        let mut columns = vec![Vec::new(); indices.len()];
        for block in self.blocks_in(rows, indices)? {
            let block = block?;
            time_s.extend_from_slice(&block.time_s);
            for (column, values) in columns.iter_mut().zip(&block.columns) {
                column.extend_from_slice(values.values());
            }
        }
        Ok(Loaded { time_s, columns: columns.into_iter().map(Column::new).collect() })
    }
}
