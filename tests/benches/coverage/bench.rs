//! From a case to its recordings, by simulation or out of a folder of earlier ones.

use std::path::{Path, PathBuf};

use socam_recording::{Channel, Dataset};
use socam_sim::{Override, Setup, SimError, Truth, calibration_for};

use crate::case::{Case, Run, soften};

/// Sampling period of all recordings.
const PERIOD_US: u32 = 1000;

/// A run that drives a sensor to its limit is made again so much weaker, at most so many times.
const SOFTER: f64 = 0.6;
const ATTEMPTS: usize = 8;

/// Raised by whoever changes what the simulation of a case yields: recordings of another number are not used again.
const CACHE_VERSION: u32 = 2;

/// How recordings are made.
#[derive(Debug, Clone)]
pub(crate) struct Bench {
    /// The board runs so many times as fast as it is recorded.
    pub(crate) oversample: u32,
    /// Where recordings are kept.
    pub(crate) cache: Option<PathBuf>,
}

impl Bench {
    /// All recordings of a case.
    pub(crate) fn record(&self, case: &Case) -> Result<Vec<Dataset>, String> {
        let setup = setup(case)?;
        let one = |(index, run): (usize, &Run)| {
            let setup = Setup { seed: run.seed, ..setup.clone() };
            self.one(case, &setup, run, &format!("run {index}: {}", run.name))
        };
        case.runs.iter().enumerate().map(one).collect()
    }

    fn one(&self, case: &Case, setup: &Setup, run: &Run, name: &str) -> Result<Dataset, String> {
        let path = self.cache.as_ref().map(|folder| {
            let Case { family, truth, noise, gains, .. } = case;
            let what = format!(
                "{CACHE_VERSION} {} {family:?} {truth:?} {noise:?} {gains:?} {run:?}",
                self.oversample
            );
            folder.join(format!("{:016x}.f64", fingerprint(&what)))
        });
        if let Some(known) = path.as_deref().and_then(|path| read(path, name)) {
            return Ok(known);
        }
        let data = self.simulate(setup, run, name).map_err(|error| format!("{name}: {error}"))?;
        if let Some(path) = path {
            write(&path, &data).map_err(|error| format!("{}: {error}", path.display()))?;
        }
        Ok(data)
    }

    fn simulate(&self, setup: &Setup, run: &Run, name: &str) -> Result<Dataset, String> {
        let mut profile = run.profile.clone();
        let period_us = PERIOD_US / self.oversample;
        let mut last = String::new();
        for _ in 0..ATTEMPTS {
            let waveform = profile.profile(period_us).map_err(|error| error.to_string())?;
            match setup.record(name, &waveform, period_us) {
                Ok(data) => return thinned(data, self.oversample as usize),
                Err(error @ SimError::Fault { .. }) => last = error.to_string(),
                Err(error) => return Err(error.to_string()),
            }
            soften(&mut profile, SOFTER);
        }
        Err(last)
    }
}

fn setup(case: &Case) -> Result<Setup, String> {
    let overrides: Vec<Override> =
        case.truth.iter().map(|(name, value)| Override { name: name.clone(), value: *value }).collect();
    let truth = Truth::new(&case.family.plant()?, &overrides, &[]).map_err(|error| error.to_string())?;
    let mut calibration = calibration_for(&truth.model);
    (calibration.speed_control.proportional, calibration.speed_control.integral_per_s) = case.gains;
    Ok(Setup { noise_std: case.noise.clone(), ..Setup::new(truth, calibration, 0) })
}

/// Every `keep`-th sample.
fn thinned(data: Dataset, keep: usize) -> Result<Dataset, String> {
    if keep == 1 {
        return Ok(data);
    }
    let mut columns = columns(&data)?;
    columns.iter_mut().for_each(|column| *column = column.iter().step_by(keep).copied().collect());
    let time_s = columns.remove(0);
    Dataset::from_columns(data.name(), data.channels().to_vec(), time_s, columns)
        .map_err(|error| error.to_string())
}

/// Times and all channels.
fn columns(data: &Dataset) -> Result<Vec<Vec<f64>>, String> {
    let loaded = data.load_all().map_err(|error| error.to_string())?;
    let values = loaded.columns.iter().map(|column| column.values().to_vec());
    Ok(std::iter::once(loaded.time_s).chain(values).collect())
}

/// The same on every machine (FNV-1a).
fn fingerprint(text: &str) -> u64 {
    text.bytes()
        .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

/// Names of all columns in one line, then every value of each, bit for bit.
fn write(path: &Path, data: &Dataset) -> Result<(), String> {
    let names: Vec<String> = data.channels().iter().map(Channel::column_name).collect();
    let mut bytes = format!("{}\n", names.join(" ")).into_bytes();
    bytes.extend(columns(data)?.iter().flatten().flat_map(|value| value.to_le_bytes()));
    // Another run may be at the same recording: only whole files get the name.
    let part = path.with_extension(format!("{}.part", std::process::id()));
    let written = std::fs::create_dir_all(path.parent().unwrap_or(path))
        .and_then(|()| std::fs::write(&part, bytes))
        .and_then(|()| std::fs::rename(&part, path));
    written.map_err(|error| error.to_string())
}

/// `None` where there is no such recording, or not one that can be used.
fn read(path: &Path, name: &str) -> Option<Dataset> {
    let bytes = std::fs::read(path).ok()?;
    let end = bytes.iter().position(|byte| *byte == b'\n')?;
    let names = std::str::from_utf8(&bytes[..end]).ok()?;
    let channels: Vec<Channel> = names.split(' ').map(Channel::from_column_name).collect::<Option<_>>()?;
    let (values, rest) = bytes[end + 1..].as_chunks::<8>();
    let rows = values.len() / (channels.len() + 1);
    if !rest.is_empty() || rows == 0 || values.len() % (channels.len() + 1) != 0 {
        return None;
    }
    let column = |values: &[[u8; 8]]| values.iter().map(|value| f64::from_le_bytes(*value)).collect();
    let mut columns: Vec<Vec<f64>> = values.chunks_exact(rows).map(column).collect();
    let time_s = columns.remove(0);
    Dataset::from_columns(name, channels, time_s, columns).ok()
}
