//! An opened recording: what is said of it, and its samples.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use socam_recording::{Channel, Dataset};

use crate::job::Handle;
use crate::samples::Samples;

/// What is said of a recording besides its samples.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct About {
    /// The name that it was opened by.
    pub name: String,
    /// Its channels, in the order of its columns.
    pub channels: Vec<Channel>,
    /// What happened during it.
    pub events: Vec<Happening>,
    /// Operator's notes, versions and such, by name.
    pub facts: Vec<(String, String)>,
    /// What was left aside on opening.
    pub warnings: Vec<String>,
    /// Median step of time, s.
    pub sample_time_s: f64,
    /// Samples that never reached it.
    pub lost_samples: u64,
}

/// Something that happened during a recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Happening {
    /// When, s.
    pub time_s: f64,
    /// What kind: `phase`, `stop`, `fault`, `start`, `note`.
    pub kind: String,
    /// In words.
    pub text: String,
}

/// A recording that is open.
#[derive(Debug, Clone)]
pub struct Recording {
    /// What is said of it.
    pub about: About,
    /// Its samples.
    pub samples: Arc<Samples>,
    /// Where it came from; `None` for one that was made or dropped into a browser.
    pub path: Option<PathBuf>,
}

/// Values beyond which a recording gets an index on the disk.
#[cfg(not(target_arch = "wasm32"))]
const MOST_IN_MEMORY: u64 = 16 << 20;

impl Recording {
    /// A recording of what a dataset holds.
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

    /// Opens what was handed over to the page under a name.
    ///
    /// # Errors
    /// When it is no recording; one sentence.
    #[cfg(target_arch = "wasm32")]
    pub fn open(name: &str, handle: &Handle) -> Result<Self, String> {
        let data = Dataset::open(name).map_err(sentence)?;
        Ok(Self { path: Some(name.into()), ..Self::of(&data, handle)? })
    }

    /// Opens `RUN` or `RUN@FROM..TO`. A long one gets an index in the user's cache, from which it opens at once the next time.
    ///
    /// # Errors
    /// When it is no recording, cannot be read, or opening was cancelled; one sentence.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn open(run: &str, handle: &Handle) -> Result<Self, String> {
        use crate::samples::index;
        use socam_recording::Selection;

        let selection = Selection::parse(run).map_err(sentence)?;
        let whole = selection.span == socam_recording::Span::ALL;
        let path = selection.path.clone();
        let index_path = if whole { index::path_of(&path) } else { None };
        if let Some((about, samples)) = index_path.as_deref().and_then(|path| index::open(path).ok()) {
            let about = About { name: run.into(), ..about };
            return Ok(Self { about, samples: Arc::new(samples), path: Some(path) });
        }
        handle.doing(format!("Reading {}", short(run)));
        let data = Dataset::open_selection(&selection).map_err(sentence)?;
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

    /// Its samples for whoever computes with them. One that came from a file is read again, so that no digit is lost; one that was
    /// made here is what is drawn.
    ///
    /// # Errors
    /// When its file cannot be read again; one sentence.
    pub fn dataset(&self) -> Result<Dataset, String> {
        let about = &self.about;
        if self.path.is_some() {
            return Dataset::open(&about.name).map_err(sentence);
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
pub fn indexed(data: &Dataset, target: &Path, handle: &Handle) -> Result<(About, Samples), String> {
    use crate::samples::index::Writer;

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

fn about(data: &Dataset) -> About {
    let contents = data.contents();
    let events = contents.map_or(&[][..], |contents| &contents.events);
    let happening = |event: &socam_recording::Event| Happening {
        time_s: event.device_time_ns as f64 * 1e-9,
        kind: event.kind.clone(),
        text: event.text.clone(),
    };
    let (from_s, to_s) = (data.start_s(), data.end_s());
    let events =
        events.iter().map(happening).filter(|event| event.time_s >= from_s && event.time_s <= to_s + 1.0);
    let facts = contents.map(|contents| contents.metadata.clone()).unwrap_or_default();
    About {
        name: data.name().to_owned(),
        channels: data.channels().to_vec(),
        events: events.collect(),
        facts: facts.into_iter().collect(),
        warnings: data.warnings().iter().map(ToString::to_string).collect(),
        sample_time_s: data.sample_time_s(),
        lost_samples: data.lost_samples(),
    }
}

/// The last part of a path: what fits a legend.
#[must_use]
pub fn short(name: &str) -> &str {
    let path = name.rsplit(['/', '\\']).next().unwrap_or(name);
    if path.is_empty() { name } else { path }
}

fn sentence(error: impl std::fmt::Display) -> String {
    error.to_string()
}

/// Writes a recording as `.csv` in SI, or as the `.m` of the thesis' program, as the name says.
///
/// # Errors
/// When the name ends in something else, the recording cannot be read again, or the stream cannot be written; one sentence.
pub fn write(recording: &Recording, name: &Path, out: &mut impl std::io::Write) -> Result<(), String> {
    let extension = name.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    match extension.as_str() {
        "csv" => socam_recording::write_csv(&recording.dataset()?, out, name).map_err(sentence),
        "m" => {
            let text = legacy(recording)?;
            out.write_all(text.as_bytes())
                .map_err(|error| format!("cannot write {}: {error}", name.display()))
        }
        _ => Err(format!("{}: a recording is saved as .csv or .m", name.display())),
    }
}

/// Rows that the thesis' program could hold, and that its readers expect.
const LEGACY_ROWS: usize = 10_000;

/// The log as the thesis' program wrote it: settings, then five columns in volts, the command last. Speeds are turned back into
/// volts of their tachometers, torques stay what they are only if they are in volts.
fn legacy(recording: &Recording) -> Result<String, String> {
    use socam_core::scaling::Sensor;
    use std::fmt::Write;

    let rows = recording.samples.rows();
    if rows > LEGACY_ROWS || recording.samples.segments().len() != 1 {
        return Err(format!(
            "a .m log holds at most {LEGACY_ROWS} rows without a gap, and this recording has {rows}; open a part of it as RUN@FROM..TO, or save it as .csv"
        ));
    }
    let column = |name: &str, sensor: Option<Sensor>| -> Result<Vec<f64>, String> {
        let channel = recording.channel(name).ok_or_else(|| {
            format!("a .m log needs the channel `{name}`, which this recording lacks; save it as .csv")
        })?;
        let values = recording.samples.values(channel, 0..rows);
        Ok(match sensor {
            Some(sensor) => {
                values.iter().map(|value| value * sensor.volts_per_unit + sensor.offset_v).collect()
            }
            None => values,
        })
    };
    let volts = |name: &str, sensor: Sensor| {
        let index = recording.channel(name);
        let in_volts =
            index.is_some_and(|index| recording.about.channels[index].unit == socam_recording::Unit::V);
        column(name, (!in_volts).then_some(sensor))
    };
    let columns = [
        volts("motor_speed", Sensor::MOTOR_SPEED)?,
        volts("output_speed", Sensor::OUTPUT_SPEED)?,
        volts("torque_in", Sensor::TORQUE_IN)?,
        volts("torque_out", Sensor::TORQUE_OUT)?,
        column("command", None)?,
    ];
    let mut text = format!("samprate={};\ndata=[\n", recording.about.sample_time_s);
    for row in 0..rows {
        let values = columns.iter().map(|column| column[row]);
        if let Some(missing) = values.clone().find(|value| !value.is_finite()) {
            return Err(format!(
                "row {row} has a missing value ({missing}), which a .m log cannot hold; save it as .csv"
            ));
        }
        let texts: Vec<String> = values.map(|value| format!("{value:.6}")).collect();
        let _ = writeln!(text, "{}", texts.join(" "));
    }
    text.push_str("];\n");
    Ok(text)
}
