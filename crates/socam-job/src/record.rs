//! The run on a bench: the part of a recording's settings that needs no device.

use serde::{Deserialize, Serialize};
use socam_recording::ProfileFile;

use crate::error::{JobError, Result};
use crate::notation::seconds;
use crate::options::Settings;

/// Longest run, s: the board's counter of ticks wraps after 59 h at the highest rate.
const LONGEST_RUN_S: f64 = 24.0 * 3600.0;

/// Profile, duration and sampling rate
#[derive(Debug, Clone, PartialEq, clap::Args, Serialize, Deserialize)]
pub struct Record {
    /// Profile: a file (`template profile` prints one) or a built-in one (`record --list-profiles`)
    #[arg(long, value_name = "FILE|NAME")]
    pub profile: Option<String>,
    /// Time until the command is back at 0, as in 10s, 1.5min or 500ms [default: the profile's duration]
    #[arg(long = "duration", value_name = "TIME", value_parser = seconds, allow_hyphen_values = true)]
    pub duration_s: Option<f64>,
    /// Sampling rate, Hz
    #[arg(long = "rate", value_name = "HZ", default_value_t = 1000.0, allow_hyphen_values = true)]
    pub rate_hz: f64,
}

impl Settings for Record {
    const COMMAND: &'static [&'static str] = &["record"];

    fn validate(&self) -> Result<()> {
        self.period_us().map(drop)
    }
}

impl Record {
    /// The profile, of the wanted duration.
    ///
    /// # Errors
    /// When none is named, it cannot be read, or it cannot last so long.
    pub fn load(&self) -> Result<ProfileFile> {
        let Some(name) = &self.profile else {
            return Err(JobError::Inputs(
                "--profile is missing; `record --list-profiles` names the built-in ones".into(),
            ));
        };
        self.lasting(ProfileFile::open(name)?)
    }

    /// A profile with the wanted duration.
    ///
    /// # Errors
    /// When it cannot last so long.
    pub fn lasting(&self, mut file: ProfileFile) -> Result<ProfileFile> {
        let name = self.profile.as_deref().unwrap_or("as given");
        if let Some(duration_s) = self.duration_s {
            let lasting = file.lasting(duration_s);
            file = lasting.map_err(|error| {
                JobError::value("duration_s", "--duration", format!(", profile `{name}`: {error}"))
            })?;
        }
        if file.duration_s > LONGEST_RUN_S {
            return Err(JobError::Inputs(format!(
                "the profile `{name}` would last {:.1} h; a run lasts at most {} h: record longer jobs in several runs",
                file.duration_s / 3600.0,
                LONGEST_RUN_S / 3600.0
            )));
        }
        Ok(file)
    }

    /// The sampling period, us.
    ///
    /// # Errors
    /// When no board samples at this rate.
    pub fn period_us(&self) -> Result<u32> {
        let wrong = |problem: String| Err(JobError::value("rate_hz", "--rate", problem));
        let (rate_hz, period_us) = (self.rate_hz, 1e6 / self.rate_hz);
        if !(50.0..=1e6).contains(&period_us) {
            return wrong(format!(" is {rate_hz:?} Hz; a board samples at 1 to 20000 Hz"));
        }
        if (period_us - period_us.round()).abs() > 1e-9 * period_us {
            return wrong(format!(
                " is {rate_hz} Hz; a board samples every whole number of microseconds, as in 1000, 2000, 5000 or 10000 Hz"
            ));
        }
        Ok(period_us.round() as u32)
    }
}
