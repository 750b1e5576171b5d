//! A proposal as a profile file and as the document `socam.design/1`.

use serde::Serialize;
use socam_recording::{ProfileFile, Waveform};

use crate::{Design, Limits, Width};

/// Version of [`Document`]'s JSON form.
pub const SCHEMA: &str = "socam.design/1";

/// A proposal, as `design --json` prints it.
#[derive(Debug, Clone, Serialize)]
pub struct Document<'a> {
    schema: &'static str,
    goal: &'static str,
    profile: String,
    tells_apart: Option<[String; 2]>,
    distance: Option<f64>,
    widths: &'a [Width],
    reference: Option<&'a [Width]>,
    tried: usize,
}

impl<'a> Document<'a> {
    /// Document of a design: the text of its profile, the names of two models that it distinguishes, and the widths of a profile
    /// for comparison.
    #[must_use]
    pub fn new(
        design: &'a Design,
        profile: String,
        tells_apart: Option<[String; 2]>,
        reference: Option<&'a [Width]>,
    ) -> Self {
        Self {
            schema: SCHEMA,
            goal: if tells_apart.is_some() { "tell_apart" } else { "sharpest" },
            profile,
            tells_apart,
            distance: design.best.distance,
            widths: &design.best.widths,
            reference,
            tried: design.tried,
        }
    }
}

impl Design {
    /// The best profile, its numbers rounded, with its purpose: to tell two models apart by their names, or to sharpen one.
    #[must_use]
    pub fn profile(&self, model: &str, tells_apart: Option<&[String; 2]>) -> ProfileFile {
        let purpose = match tells_apart {
            Some([a, b]) => format!("to tell {a} from {b}"),
            None => format!("to make the widest interval of {model} narrowest"),
        };
        rounded(ProfileFile { purpose: Some(purpose), ..self.best.profile.clone() })
    }
}

/// The profile of the thesis, to compare with: five speeds of equal duration, up to the largest command.
#[must_use]
pub fn five_steps(limits: &Limits) -> ProfileFile {
    let highest = limits.voltage;
    let first = 0.43 * highest;
    let dwell_s = (limits.duration_s / 5.0 * 1e3).floor() * 1e-3;
    ProfileFile {
        purpose: None,
        command: socam_recording::ProfileCommand::Voltage,
        waveform: Waveform::Staircase {
            first,
            step: 0.25 * (0.98 * highest - first),
            count: 5,
            dwell_s,
            and_back: false,
        },
        ramp_s: 0.0,
        limit: highest,
        slew: limits.slew_v_s,
        duration_s: limits.duration_s,
    }
}

/// Rounds the numbers of a profile.
fn rounded(mut profile: ProfileFile) -> ProfileFile {
    let round = |value: &mut f64, digits: f64| *value = (*value * digits).floor() / digits;
    match &mut profile.waveform {
        Waveform::Multisine { offset, amplitude, from_hz, to_hz, .. }
        | Waveform::Chirp { offset, amplitude, from_hz, to_hz, .. } => {
            [offset, amplitude].into_iter().for_each(|value| round(value, 1e4));
            [from_hz, to_hz].into_iter().for_each(|value| round(value, 1e2));
        }
        Waveform::Prbs { offset, amplitude, .. } => {
            [offset, amplitude].into_iter().for_each(|value| round(value, 1e4))
        }
        Waveform::Staircase { first, step, .. } => {
            [first, step].into_iter().for_each(|value| round(value, 1e4))
        }
        _ => {}
    }
    round(&mut profile.duration_s, 1e3);
    profile
}
