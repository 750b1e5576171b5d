//! The frequency response of a recording, as `identify --method frf` estimates it.

use socam_frequency::response::Response;
use socam_model::Model;
use socam_response::{Measured, Settings, between};
use socam_workbench::job::Handle;
use socam_workbench::recording::Recording;

/// The response of one column of a recording over another, the input; columns that the model reads are read as the model reads them.
///
/// # Errors
/// When the recording cannot be read, is too short or not excited, or the job was cancelled; one sentence.
pub(super) fn measured(
    recording: &Recording,
    model: &Model,
    columns: [&str; 2],
    settings: &Settings,
    handle: &Handle,
) -> Result<Measured, String> {
    let data = recording.dataset()?.regular().map_err(|error| error.to_string())?;
    handle.reached(0.3)?;
    between(model, &[data], columns, settings).map_err(|error| error.to_string())
}

/// A response as curves over frequency, Hz.
pub(super) struct Curves {
    /// Magnitude where the 95 % confidence circle leaves out zero, in parts.
    pub(super) magnitude: Vec<Vec<[f64; 2]>>,
    /// Phase, degrees, in the same parts and interrupted where it wraps.
    pub(super) phase: Vec<Vec<[f64; 2]>>,
    /// Coherence at all lines.
    pub(super) coherence: Vec<[f64; 2]>,
    /// Coherence above which a line's response is drawn.
    pub(super) threshold: Vec<[f64; 2]>,
}

pub(super) fn curves(response: &Response) -> Curves {
    let lines = || response.lines.iter().map(|line| (line, line.radius() < line.response.norm()));
    let drawn = |value: &dyn Fn(&socam_frequency::response::Line) -> f64| {
        let points = lines()
            .map(|(line, is_there)| [line.frequency_hz, if is_there { value(line) } else { f64::NAN }]);
        parts(&points.collect::<Vec<_>>())
    };
    let phase = drawn(&|line| line.response.arg().to_degrees());
    Curves {
        magnitude: drawn(&|line| line.response.norm()),
        phase: phase.iter().flat_map(|part| unjoined(part)).collect(),
        coherence: lines().map(|(line, _)| [line.frequency_hz, line.coherence]).collect(),
        threshold: lines()
            .filter_map(|(line, _)| Some([line.frequency_hz, line.threshold_coherence()?]))
            .collect(),
    }
}

/// Ranges without missing values.
fn parts(line: &[[f64; 2]]) -> Vec<Vec<[f64; 2]>> {
    line.split(|point| point[1].is_nan()).filter(|part| !part.is_empty()).map(<[_]>::to_vec).collect()
}

/// A phase in parts that end where it wraps.
pub(super) fn unjoined(phase: &[[f64; 2]]) -> Vec<Vec<[f64; 2]>> {
    phase.chunk_by(|a, b| (a[1] - b[1]).abs() < 180.0).map(<[[f64; 2]]>::to_vec).collect()
}

#[cfg(test)]
mod tests {
    use std::fmt::Write as _;

    use super::*;
    use socam_recording::Dataset;

    fn noise(seed: u64) -> impl Iterator<Item = f64> {
        let mut state = seed;
        std::iter::repeat_with(move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as f64 / f64::from(1_u32 << 31) - 0.5
        })
    }

    /// 20 s of noise as torque and, 3 ms later and 2.5 times as large, as speeds; with noise and a gap.
    fn recording(folder: &std::path::Path) -> String {
        let torque: Vec<f64> = noise(7).take(20_000).collect();
        let mut text = String::from("time_s,motor_torque_Nm,motor_speed_rad_s,load_speed_rad_s\n");
        let sensor = noise(3).zip(noise(5));
        for (k, (motor, load)) in (3..20_000).zip(sensor).filter(|(k, _)| !(9000..9050).contains(k)) {
            let speed = 2.5 * torque[k - 3];
            let time_s = k as f64 * 1e-3;
            writeln!(text, "{time_s},{},{},{}", torque[k], speed + 0.1 * motor, speed + load).unwrap();
        }
        let path = folder.join("run.csv");
        std::fs::write(&path, text).unwrap();
        path.to_string_lossy().into_owned()
    }

    fn read(run: &str) -> Result<Dataset, String> {
        socam_import::open(run).map_err(|error| error.to_string())
    }

    #[test]
    fn the_window_shows_the_response_of_the_command() {
        let folder = tempfile::tempdir().unwrap();
        let run = recording(folder.path());
        let model = Model::builtin("two-mass").unwrap();
        let opened = Recording::open(&run, read, &Handle::default()).unwrap();
        for output in model.outputs() {
            let columns = [model.inputs().next().unwrap().column.as_str(), output.column.as_str()];
            let window =
                measured(&opened, &model, columns, &Settings::default(), &Handle::default()).unwrap();
            // The expected values are those that `identify --method frf` prints.
            let data = socam_import::open(&run).unwrap();
            let command = socam_response::estimate(
                &model,
                &[data],
                std::slice::from_ref(&output.name),
                &Settings::default(),
            )
            .unwrap();
            assert_eq!(window.response, command[0].response, "{}", output.name);
            assert_eq!(window.warnings, command[0].warnings);
        }
    }

    #[test]
    fn a_gain_with_a_delay_has_its_response() {
        let folder = tempfile::tempdir().unwrap();
        let opened = Recording::open(&recording(folder.path()), read, &Handle::default()).unwrap();
        let model = Model::builtin("two-mass").unwrap();
        let columns = ["motor_torque_Nm", "motor_speed_rad_s"];
        let found = measured(&opened, &model, columns, &Settings::default(), &Handle::default()).unwrap();
        let Curves { magnitude, phase, coherence, threshold } = curves(&found.response);
        // What is drawn lies above the threshold.
        let drawn = magnitude.iter().flatten().map(|point| point[0]).collect::<Vec<_>>();
        for ([frequency_hz, own], [_, least]) in coherence.iter().zip(&threshold) {
            assert_eq!(own > least, drawn.contains(frequency_hz), "{own} {least} at {frequency_hz} Hz");
        }
        let at = |line: &[Vec<[f64; 2]>]| {
            *line.iter().flatten().min_by(|a, b| (a[0] - 50.0).abs().total_cmp(&(b[0] - 50.0).abs())).unwrap()
        };
        assert!((at(&magnitude)[1] - 2.5).abs() < 0.2, "{:?}", at(&magnitude));
        let expected = -360.0 * at(&phase)[0] * 3e-3;
        assert!((at(&phase)[1] - expected).abs() < 4.0, "{:?} {expected}", at(&phase));
        assert!(at(&[coherence])[1] > 0.97);
    }

    #[test]
    fn signals_that_have_nothing_to_do_with_each_other_have_hardly_a_response() {
        // Neighbouring lines share samples, so that one pair of signals says little about the share.
        let (mut drawn, mut lines) = (0, 0);
        for seed in (11..51).step_by(4) {
            let columns: Vec<Vec<f64>> =
                [seed, seed + 2].map(|seed| noise(seed).take(9000).collect()).to_vec();
            let time_s: Vec<f64> = (0..9000).map(|n| f64::from(n) * 1e-3).collect();
            let channels =
                ["u", "y"].map(|name| socam_recording::Channel::new(name, socam_recording::Unit::V));
            let data = Dataset::from_columns("r", channels.to_vec(), time_s, columns).unwrap();
            let opened = Recording::of(&data, &Handle::default()).unwrap();
            let model = Model::builtin("two-mass").unwrap();
            let columns = ["u_V", "y_V"];
            let found = measured(&opened, &model, columns, &Settings::default(), &Handle::default()).unwrap();
            drawn += curves(&found.response).magnitude.iter().map(Vec::len).sum::<usize>();
            lines += found.response.lines.len();
        }
        assert!(10 * drawn < lines, "{drawn} of {lines} lines are drawn; one in twenty is expected");
    }
}
