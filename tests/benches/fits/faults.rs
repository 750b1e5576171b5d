//! What goes wrong between a sensor and its recording.

use serde::Serialize;
use socam_recording::Dataset;
use socam_tests::Draw;

use crate::rig::Flaws;

/// What a failed read leaves in the recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Reading {
    Zero,
    LastValue,
    FullScale,
}

/// Isolated failed reads of one channel.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Failed {
    pub(crate) channel: String,
    pub(crate) reading: Reading,
    /// Share of the samples.
    pub(crate) share: f64,
}

impl Failed {
    pub(crate) fn draw(channel: &str, draw: &mut Draw) -> Self {
        let reading = [Reading::Zero, Reading::LastValue, Reading::FullScale][draw.whole(0, 2) as usize];
        Self { channel: channel.into(), reading, share: draw.between(0.005, 0.02) }
    }

    fn apply(&self, values: &mut [f64], draw: &mut Draw) {
        let full_scale = 1.25 * values.iter().map(|value| value.abs()).fold(0.0, f64::max);
        for row in 1..values.len() {
            if draw.chance(self.share) {
                values[row] = match self.reading {
                    Reading::Zero => 0.0,
                    Reading::LastValue => values[row - 1],
                    Reading::FullScale => full_scale,
                };
            }
        }
    }
}

/// Times and values of a recording.
type Columns = (Vec<f64>, Vec<Vec<f64>>);

/// A recording whose columns, in the order of its channels, are changed.
pub(crate) fn changed(data: &Dataset, change: impl FnOnce(&mut Columns)) -> Result<Dataset, String> {
    let loaded = data.load_all().map_err(|error| error.to_string())?;
    let columns = loaded.columns.iter().map(|column| column.values().to_vec()).collect();
    let mut all = (loaded.time_s, columns);
    change(&mut all);
    let changed = Dataset::from_columns(data.name(), data.channels().to_vec(), all.0, all.1);
    changed.map_err(|error| error.to_string())
}

/// The recording with the speed of an encoder as drives compute it: the last two angles' difference over the sample time, which is half a
/// sample late.
pub(crate) fn with_difference(
    data: &Dataset,
    (angle, speed): &(String, String),
    rate_hz: f64,
) -> Result<Dataset, String> {
    let [angle, speed] = [column(data, angle)?, column(data, speed)?];
    changed(data, |(_, columns)| {
        let angles = columns[angle].clone();
        for (row, pair) in angles.windows(2).enumerate() {
            columns[speed][row + 1] = (pair[1] - pair[0]) * rate_hz;
        }
        columns[speed][0] = columns[speed][1];
    })
}

/// The recording with all flaws but the jitter of its stamps, which the simulation adds.
pub(crate) fn flawed(data: &Dataset, flaws: &Flaws, seed: u64) -> Result<Dataset, String> {
    let failed =
        flaws.failed.as_ref().map(|own| Ok::<_, String>((own, column(data, &own.channel)?))).transpose()?;
    let turned = flaws.wrong_sign.as_ref().map(|name| column(data, name)).transpose()?;
    let draw = &mut Draw::new(seed, 1);
    changed(data, |(time_s, columns)| {
        if let Some((failed, column)) = failed {
            failed.apply(&mut columns[column], draw);
        }
        if let Some(column) = turned {
            columns[column].iter_mut().for_each(|value| *value = -*value);
        }
        let first = (flaws.cut_s / data.sample_time_s()) as usize;
        time_s.drain(..first);
        columns.iter_mut().for_each(|column| drop(column.drain(..first)));
    })
}

fn column(data: &Dataset, channel: &str) -> Result<usize, String> {
    let of = |index: &usize| data.channels()[*index].name == channel;
    (0..data.channels().len()).find(of).ok_or_else(|| format!("{} has no channel {channel}", data.name()))
}
