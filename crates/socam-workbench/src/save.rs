//! Files that are written: a recording as `.csv` or `.m`, and anything that is small.

use std::path::Path;

use crate::job::{CANCELLED, Handle};
use crate::recording::Recording;

/// Writes a file atomically; an existing file is never replaced.
///
/// # Errors
/// When there is such a file already, or it cannot be written; one sentence.
pub fn write_new(path: &Path, bytes: &[u8]) -> Result<(), String> {
    use std::io::Write;

    if path.exists() {
        return Err(format!("{} exists already; choose another name", path.display()));
    }
    let write = || -> socam_recording::Result<std::io::Result<()>> {
        let mut file = socam_recording::OutputFile::create(path)?;
        if let Err(error) = file.write_all(bytes) {
            return Ok(Err(error));
        }
        file.commit().map(Ok)
    };
    match write() {
        Ok(Ok(())) => Ok(()),
        Ok(Err(error)) => Err(format!("cannot write {}: {error}", path.display())),
        Err(error) => Err(error.to_string()),
    }
}

/// Writes a recording into a new file, whose ending `.csv` or `.m` selects the format.
///
/// # Errors
/// When there is such a file already, it cannot be written, or it was cancelled; nothing is left then.
pub fn save(recording: &Recording, path: &Path, handle: &Handle) -> Result<(), String> {
    if path.exists() {
        return Err(format!("{} exists already; choose another name", path.display()));
    }
    let mut file = socam_recording::OutputFile::create(path).map_err(|error| error.to_string())?;
    let written = write(recording, path, &mut Cancellable { out: &mut file, handle });
    if handle.is_cancelled() {
        return Err(CANCELLED.into());
    }
    written?;
    file.commit().map_err(|error| error.to_string())
}

/// A writer that fails once the job is cancelled.
struct Cancellable<'a, W> {
    out: W,
    handle: &'a Handle,
}

impl<W: std::io::Write> std::io::Write for Cancellable<'_, W> {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        if self.handle.is_cancelled() {
            return Err(std::io::Error::other(CANCELLED));
        }
        self.out.write(bytes)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.out.flush()
    }
}

/// Writes a recording as `.csv` in SI, or as `.m` of the thesis' program, by the extension of the name.
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

/// Greatest number of rows of the thesis' program.
const LEGACY_ROWS: usize = 10_000;

/// The log in the format of the thesis' program: settings, then five columns in V, the command last. Channels in SI are converted to
/// volts of their sensors.
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

fn sentence(error: impl std::fmt::Display) -> String {
    error.to_string()
}
