//! Recordings as the fit reads them: uninterrupted segments with every input present, block by block.

use std::{ops::Range, sync::Arc};

use socam_model::{Channel, ChannelTransform, Model, TransformStart};
use socam_recording::Dataset;

use crate::{IdentifyError, Intersample, prediction::intersample, preprocessing::mask::Mask};

/// Fewest samples worth a start state of its own.
const MIN_ROWS: u64 = 20;

/// Longest segment where start states are free: longer runs are cut, so that one long recording uses all cores. Among so many
/// samples a start state of its own costs nothing.
pub(crate) const PIECE_ROWS: u64 = 250_000;

/// Consecutive rows of a recording at a steady rate, inputs complete.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Segment {
    /// Index of the recording.
    pub(crate) recording: usize,
    pub(crate) first_row: u64,
    pub(crate) rows: u64,
    pub(crate) sample_time_s: f64,
    /// Time of row 0 of the recording, were its rate that of this segment all along, s.
    pub(crate) origin_s: f64,
    /// The uninterrupted rows that it is all or a piece of.
    pub(crate) run: Range<u64>,
    /// What of its recording is not used as measured.
    pub(crate) mask: Arc<Mask>,
}

impl Segment {
    /// Whether nothing comes before it without a gap.
    pub(crate) fn begins_run(&self) -> bool {
        self.first_row == self.run.start
    }

    /// The run in pieces of like length, none longer than `longest`.
    fn pieces(self, longest: u64) -> impl Iterator<Item = Self> {
        let Range { start, end } = self.run;
        let count = (end - start).div_ceil(longest);
        let edge =
            move |piece: u64| start + (end - start) / count * piece + ((end - start) % count).min(piece);
        (0..count).map(move |piece| Self {
            first_row: edge(piece),
            rows: edge(piece + 1) - edge(piece),
            ..self.clone()
        })
    }
}

/// Some rows of a segment in SI.
#[derive(Debug, Default)]
pub(crate) struct Chunk {
    /// One vector per input, as measured.
    pub(crate) inputs: Vec<Vec<f64>>,
    /// Coefficients of its course between samples, from some before the first row to some after the last: see
    /// [`intersample::coefficients`].
    pub(crate) held: Vec<Vec<f64>>,
    /// One vector per output; NaN where missing.
    pub(crate) outputs: Vec<Vec<f64>>,
}

impl Chunk {
    pub(crate) fn rows(&self) -> usize {
        self.inputs.first().map_or(0, Vec::len)
    }
}

/// Finds the segments of all recordings, none longer than `longest`, and checks that each recording can be used.
pub(crate) fn segments(
    model: &Model,
    datasets: &[Dataset],
    longest: u64,
    warnings: &mut Vec<String>,
) -> Result<Vec<Segment>, IdentifyError> {
    let mut all = Vec::new();
    for (recording, dataset) in datasets.iter().enumerate() {
        for channel in model.outputs() {
            dataset.channel_index(&channel.column)?;
        }
        let runs = runs(model, dataset, recording)?;
        let (usable, short): (Vec<Segment>, Vec<Segment>) =
            runs.into_iter().partition(|run| run.rows >= MIN_ROWS);
        if usable.is_empty() {
            let rows = short.iter().map(|run| run.rows).max().unwrap_or(0);
            return Err(IdentifyError::TooShort { recording: dataset.name().into(), rows, needed: MIN_ROWS });
        }
        let gaps = usable.len() + short.len() - 1;
        if gaps > 0 {
            warnings.push(format!(
                "{}: {gaps} {}; each part was given a start state of its own",
                dataset.name(),
                if gaps == 1 { "gap" } else { "gaps" },
            ));
        }
        if !short.is_empty() {
            warnings.push(format!(
                "{}: {} of the parts between gaps have fewer than {MIN_ROWS} samples and were left out, {} samples in all",
                dataset.name(),
                short.len(),
                short.iter().map(|run| run.rows).sum::<u64>(),
            ));
        }
        all.extend(usable.into_iter().flat_map(|run| run.pieces(longest)));
    }
    Ok(all)
}

/// Rows without a gap in time or a missing input.
fn runs(model: &Model, dataset: &Dataset, recording: usize) -> Result<Vec<Segment>, IdentifyError> {
    let inputs = model.inputs().map(|channel| dataset.channel_index(&channel.column));
    let inputs = inputs.collect::<Result<Vec<_>, _>>()?;
    let run = |segment: usize, rows: Range<u64>| Segment {
        recording,
        first_row: rows.start,
        rows: rows.end - rows.start,
        sample_time_s: dataset.segments()[segment].sample_time_s,
        origin_s: {
            let segment = &dataset.segments()[segment];
            segment.start_s - segment.first_row as f64 * segment.sample_time_s
        },
        run: rows,
        mask: Arc::default(),
    };
    if inputs.iter().all(|input| dataset.statistics()[*input].missing == 0) {
        let segments = dataset.segments().iter().enumerate();
        return Ok(segments.map(|(index, s)| run(index, s.first_row..s.end_row())).collect());
    }
    let mut found = Vec::new();
    let mut open: Option<(usize, Range<u64>)> = None;
    for block in dataset.blocks_in(0..dataset.rows(), &inputs)? {
        let block = block?;
        for row in 0..block.rows() {
            let complete = block.columns.iter().all(|column| column.get(row).is_some());
            let at = block.first_row + row as u64;
            match &mut open {
                Some((segment, rows)) if complete && *segment == block.segment => rows.end = at + 1,
                _ => {
                    let next = complete.then_some((block.segment, at..at + 1));
                    found.extend(std::mem::replace(&mut open, next));
                }
            }
        }
    }
    found.extend(open);
    Ok(found.into_iter().map(|(segment, rows)| run(segment, rows)).collect())
}

/// Calls `use_chunk` with the rows of a segment, in order; `intersample` says of each input how it moves between samples.
pub(crate) fn read(
    model: &Model,
    dataset: &Dataset,
    segment: &Segment,
    intersample: &[Intersample],
    mut use_chunk: impl FnMut(&Chunk),
) -> Result<(), IdentifyError> {
    let channels: Vec<&Channel> = model.inputs().chain(model.outputs()).collect();
    let columns = channels.iter().map(|channel| dataset.channel_index(&channel.column));
    let columns = columns.collect::<Result<Vec<_>, _>>()?;
    let inputs = model.inputs().count();
    // A spline or a rate needs the samples before and after; a piece of a run has those of its neighbours.
    let taken = channels.iter().map(|channel| channel.transform.reach()).max().unwrap_or(0);
    let around = intersample.iter().map(|kind| intersample::reach(*kind)).max().unwrap_or(0);
    let reach = (around + taken) as u64;
    let end = segment.first_row + segment.rows;
    let first = segment.run.start.max(segment.first_row.saturating_sub(reach));
    let last = segment.run.end.min(end + reach);
    let mut angles = vec![0.0; channels.len()];
    for (angle, (channel, column)) in angles.iter_mut().zip(channels.iter().zip(&columns)) {
        if channel.transform == ChannelTransform::Integral {
            *angle = turned_before(dataset, *column, first)?;
        }
    }
    // As recorded.
    let mut window = vec![Vec::new(); channels.len()];
    // Row of the recording at which the window starts, and the next to hand over.
    let (mut start, mut next) = (first, segment.first_row);
    for block in dataset.blocks_in(first..last, &columns)? {
        let block = block?;
        let read = block.first_row + block.rows() as u64;
        for (index, (values, column)) in window.iter_mut().zip(&block.columns).enumerate() {
            values.extend_from_slice(column.values());
            let (rows, new) = (block.first_row..read, values.len() - block.rows());
            match index.checked_sub(inputs) {
                None => segment.mask.impute(index, rows, &mut values[new..]),
                Some(output) => segment.mask.leave_out(output, rows, &mut values[new..]),
            }
        }
        let ready = if read == last { end } else { read.saturating_sub(reach).min(end) };
        if ready <= next {
            continue;
        }
        let rows = (next - start) as usize..(ready - start) as usize;
        let time_s = segment.origin_s + start as f64 * segment.sample_time_s;
        let read = channels.iter().zip(&window).zip(&angles);
        let si: Vec<_> = read
            .map(|((channel, values), angle)| {
                channel.read(values, segment.sample_time_s, TransformStart { time_s, angle: *angle })
            })
            .collect();
        let part =
            |columns: &[Vec<f64>]| columns.iter().map(|values| values[rows.clone()].to_vec()).collect();
        let held = |(values, kind): (&Vec<f64>, &Intersample)| {
            intersample::coefficients(values, rows.clone(), *kind)
        };
        use_chunk(&Chunk {
            inputs: part(&si[..inputs]),
            held: si[..inputs].iter().zip(intersample).map(held).collect(),
            outputs: part(&si[inputs..]),
        });
        next = ready;
        let keep = next.saturating_sub(reach).max(start);
        for ((channel, angle), values) in channels.iter().zip(&mut angles).zip(&si) {
            if channel.transform == ChannelTransform::Integral {
                *angle = values[(keep - start) as usize] / channel.scale;
            }
        }
        window.iter_mut().for_each(|values| drop(values.drain(..(keep - start) as usize)));
        start = keep;
    }
    Ok(())
}

/// Integral of a column from the recording's beginning up to a row, as recorded; over gaps in a straight line.
fn turned_before(dataset: &Dataset, column: usize, row: u64) -> Result<f64, IdentifyError> {
    let (mut sum, mut last) = (0.0, None);
    for block in dataset.blocks_in(0..(row + 1).min(dataset.rows()), &[column])? {
        let block = block?;
        let segment = &dataset.segments()[block.segment];
        for (k, value) in block.columns[0].values().iter().enumerate().filter(|(_, value)| !value.is_nan()) {
            let at = block.first_row + k as u64 - segment.first_row;
            let time_s = segment.start_s + at as f64 * segment.sample_time_s;
            sum += last.map_or(0.0, |(before_s, before)| 0.5 * (time_s - before_s) * (before + value));
            last = Some((time_s, *value));
        }
    }
    Ok(sum)
}

#[cfg(test)]
mod tests {
    use socam_model::{ChannelTransform, Role};
    use socam_recording::{Channel, Unit};

    use super::*;

    /// A dataset of the two-mass model's channels whose values tell their rows; some rows are missing, some inputs.
    fn numbered(rows: u64, missing: impl Fn(u64) -> bool, blind: impl Fn(u64) -> bool) -> (Model, Dataset) {
        let model = Model::builtin("speed-o-cam").unwrap();
        let there: Vec<u64> = (0..rows).filter(|row| !missing(*row)).collect();
        let time_s = there.iter().map(|row| *row as f64 / 1000.0).collect();
        let units = [Unit::RadPerS, Unit::RadPerS, Unit::Nm, Unit::Nm];
        let names = ["motor_speed", "output_speed", "torque_in", "torque_out"];
        let channels = names.iter().zip(units).map(|(name, unit)| Channel::new(*name, unit)).collect();
        let value = |row: u64| ((row * row) % 1009) as f64;
        let input = there.iter().map(|row| if blind(*row) { f64::NAN } else { value(*row) }).collect();
        let output = |k: u64| there.iter().map(|row| (row * 4 + k) as f64).collect();
        let columns = vec![input, output(1), output(2), output(3)];
        (model, Dataset::from_columns("numbered", channels, time_s, columns).unwrap())
    }

    #[test]
    fn speeds_and_waves_are_taken_of_an_angle() {
        let text = Model::builtin("two-mass").unwrap().text.replacen(
            "[channels.motor_torque]\nrole = \"input\"\nquantity = \"torque\"\nat = \"motor\"",
            "[channels.drive]\nrole = \"input\"\nquantity = \"speed\"\nat = \"motor\"\ncolumn = \"encoder_rad\"\n\
             take = \"rate\"\nscale = 2\n\
             [channels.wave]\nrole = \"input\"\nquantity = \"torque\"\nat = \"load\"\ncolumn = \"encoder_rad\"\n\
             take = { sin = 0.5 }\n[channels.other]\nrole = \"input\"\nquantity = \"torque\"\nat = \"load\"\n\
             column = \"encoder_rad\"\ntake = { cos = 3 }",
            1,
        );
        let model = Model::parse(&text).unwrap();
        let time_s: Vec<f64> = (0..9000).map(|row| f64::from(row) / 1000.0).collect();
        let angle = |t: f64| 1e4 + 300.0 * t + 0.02 * (200.0 * t).sin();
        let speed = |t: f64| 300.0 + 4.0 * (200.0 * t).cos();
        let names = [("encoder", Unit::Rad), ("motor_speed", Unit::RadPerS), ("load_speed", Unit::RadPerS)];
        let channels = names.iter().map(|(name, unit)| Channel::new(*name, *unit)).collect();
        let zero = vec![0.0; time_s.len()];
        let columns = vec![time_s.iter().map(|t| angle(*t)).collect(), zero.clone(), zero];
        let data = Dataset::from_columns("turning", channels, time_s.clone(), columns).unwrap();
        let pieces = segments(&model, std::slice::from_ref(&data), 2500, &mut Vec::new()).unwrap();
        let mut row = 0;
        for piece in &pieces {
            read(&model, &data, piece, &[Intersample::BandLimited; 3], |chunk| {
                for k in 0..chunk.rows() {
                    let t = time_s[row];
                    let tolerance = if (8..8992).contains(&row) { 1e-5 } else { 0.3 };
                    assert!((chunk.inputs[0][k] - 2.0 * speed(t)).abs() < tolerance, "{row}");
                    assert!((chunk.inputs[1][k] - (0.5 * angle(t)).sin()).abs() < 1e-9);
                    assert!((chunk.inputs[2][k] - (3.0 * angle(t)).cos()).abs() < 1e-9);
                    row += 1;
                }
            })
            .unwrap();
        }
        assert_eq!((row, pieces.len()), (9000, 4));
    }

    fn read_all(
        model: &Model,
        data: &Dataset,
        segments: &[Segment],
        intersample: Intersample,
    ) -> [Vec<f64>; 3] {
        let mut all = [const { Vec::new() }; 3];
        for segment in segments {
            let before = all[0].len();
            read(model, data, segment, &[intersample], |chunk| {
                assert!(chunk.outputs.iter().all(|column| column.len() == chunk.rows()));
                let before = intersample::margin(intersample) + 1;
                assert_eq!(chunk.held[0].len(), chunk.rows() + 2 * before - 1);
                all[0].extend_from_slice(&chunk.inputs[0]);
                all[1].extend_from_slice(&chunk.held[0][before..before + chunk.rows()]);
                all[2].extend_from_slice(&chunk.outputs[1]);
            })
            .unwrap();
            assert_eq!((all[0].len() - before) as u64, segment.rows);
        }
        all
    }

    #[test]
    fn cutting_loses_no_row_and_changes_no_input() {
        let (mut model, data) = numbered(20_000, |row| row == 12_000, |row| row == 15_000 || row == 15_005);
        let one = std::slice::from_ref(&data);
        let all = [
            (ChannelTransform::Value, Intersample::Linear),
            (ChannelTransform::Value, Intersample::BandLimited),
            (ChannelTransform::Rate, Intersample::BandLimited),
        ];
        for (take, intersample) in all {
            let input = model.channels.iter().position(|channel| channel.role == Role::Input).unwrap();
            model.channels[input].transform = take;
            let whole = segments(&model, one, u64::MAX, &mut Vec::new()).unwrap();
            assert_eq!(whole.iter().map(|s| s.rows).collect::<Vec<_>>(), [12_000, 2999, 4994]);
            let expected = read_all(&model, &data, &whole, intersample);
            for longest in [1000, 4096, 4999, 7001, 12_000] {
                let mut warnings = Vec::new();
                let pieces = segments(&model, one, longest, &mut warnings).unwrap();
                let least = |run: &Range<u64>| (run.end - run.start).min(longest / 2);
                assert!(pieces.iter().all(|piece| piece.rows <= longest && piece.rows >= least(&piece.run)));
                assert_eq!(read_all(&model, &data, &pieces, intersample), expected, "{longest}");
                assert!(warnings[0].contains("3 gaps"), "{warnings:?}");
                assert!(warnings[1].contains("1 of the parts"), "{warnings:?}");
                assert!(warnings[1].contains("4 samples"), "{warnings:?}");
                assert_eq!(pieces.iter().filter(|piece| piece.begins_run()).count(), 3);
            }
        }
    }
}
