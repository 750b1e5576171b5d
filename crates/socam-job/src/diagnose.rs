//! Missing physics of a model, from recordings over time or from tables of steady states.

use std::path::Path;
use std::sync::{Mutex, PoisonError};

use serde::{Deserialize, Serialize};
use socam_diagnose::{Answer, Diagnosis, Evidence, HeldOut, SteadyOptions};
use socam_identify::{Budget, ProgressMonitor};
use socam_model::Model;
use socam_recording::{Dataset, Format, Steady, detect};

use crate::error::{JobError, Result};
use crate::grid::Grid;
use crate::inputs::{HELD_OUT_ALONE, refuse_fitted, refuse_shared, selections};
use crate::model::ModelSettings;
use crate::notation;
use crate::options::Settings;
use crate::rules::{Start, check_false_alarm_rate};

/// Settings of a diagnosis
#[derive(Debug, Clone, PartialEq, clap::Args, Serialize, Deserialize)]
pub struct Diagnose {
    /// The model.
    #[command(flatten)]
    #[serde(flatten)]
    pub model: ModelSettings,
    /// False alarm rate, 0 to 1: share of complete models for which something may be found
    #[arg(long, value_name = "P", default_value_t = 0.01)]
    pub false_alarm_rate: f64,
    /// For steady states: relative standard deviation of repeated readings at one operating point [default: 0.002]
    #[arg(long, value_name = "SHARE")]
    pub repeatability: Option<f64>,
    /// Start state of each recording
    #[arg(long, value_enum, default_value = "free")]
    #[serde(with = "notation::choice")]
    pub start: Start,
    /// Materiality, a fraction of a channel's standard deviation: findings that change every prediction by less are listed but do not count
    /// as missing physics
    #[arg(long, value_name = "SHARE", default_value_t = 0.001)]
    pub tolerance: f64,
    /// Greatest number of effects to add
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u8).range(1..=6))]
    pub most: u8,
    /// Tell of this effect why it is no finding: how far it came in the search, and what the corrected model gains or loses with it, fitted to
    /// its end; may be repeated
    #[arg(long, value_name = "EFFECT@PLACE")]
    #[serde(deserialize_with = "notation::texts")]
    pub why: Vec<String>,
    /// Seed of the random start values
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Time within which the diagnosis shall end, as in 60s or 10min (0: no end). The search gets three quarters of it, and what was found by
    /// then is the answer, marked as unfinished
    #[arg(long = "budget", value_name = "TIME", default_value = "600", value_parser = notation::budget, allow_hyphen_values = true)]
    pub budget_s: f64,
}

/// Share of the budget that belongs to the search. Intervals, validation and pictures take the rest.
const SEARCH_SHARE: f64 = 0.75;

impl Settings for Diagnose {
    const COMMAND: &'static [&'static str] = &["diagnose"];

    fn validate(&self) -> Result<()> {
        check_false_alarm_rate(self.false_alarm_rate)?;
        if !(self.tolerance.is_finite() && self.tolerance >= 0.0) {
            let problem = format!(" {}: expected a number of 0 or more", self.tolerance);
            return Err(JobError::value("tolerance", "--tolerance", problem));
        }
        match self.repeatability {
            Some(share) if !(share > 0.0 && share < 0.5) => {
                let problem = format!(" {share}: expected a share between 0 and 0.5");
                Err(JobError::value("repeatability", "--repeatability", problem))
            }
            _ => Ok(()),
        }
    }
}

/// The result of a diagnosis.
#[derive(Debug)]
pub struct Diagnosed {
    /// The document, the data of its plots, and the corrected model's text.
    pub answer: Answer,
    /// The model that was diagnosed.
    pub model: Model,
    /// Held-out recordings, which were opened after the last choice.
    pub held_out: Vec<Dataset>,
}

/// A held-out recording. It is read after the last choice.
pub enum HeldOutRecording {
    /// A file, or a part of one: `RUN@FROM..TO` in seconds.
    File(String),
    /// A recording that its caller has opened already.
    Open(Dataset),
    /// Name of a recording, and a function by which the caller opens it.
    Unopened(String, OpenRecording),
}

/// Opens a recording; the error is one sentence.
pub type OpenRecording = Box<dyn FnOnce() -> std::result::Result<Dataset, String> + Send>;

impl std::fmt::Debug for HeldOutRecording {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::File(name) | Self::Unopened(name, _) => f.write_str(name),
            Self::Open(data) => f.write_str(data.name()),
        }
    }
}

impl Diagnosed {
    /// The document `socam.diagnosis/1`.
    #[must_use]
    pub fn document(&self) -> &Diagnosis {
        &self.answer.diagnosis
    }
}

impl Diagnose {
    /// Whether the files are tables of steady states. No sample of a held-out recording is read.
    ///
    /// # Errors
    /// When samples are named twice, tables and recordings are mixed, an option belongs to the other kind, or a held-out recording is a
    /// copy of a fitted one or cannot be opened (only its first bytes are read).
    pub fn are_tables(&self, runs: &[String], holdout: &[String]) -> Result<bool> {
        let all = || runs.iter().chain(holdout);
        let tables = all().filter(|run| matches!(detect(Path::new(run)), Ok(Format::SteadyStates))).count();
        let refused = |message: &str| Err(JobError::Inputs(message.into()));
        if tables == 0 {
            self.refuse_repeatability()?;
        }
        if tables > 0 && tables < all().count() {
            return refused(
                "tables of steady states and recordings over time are diagnosed apart: run it twice",
            );
        }
        if tables > 0 && !holdout.is_empty() {
            return refused(
                "recordings over time are held out; of steady states each point is left out in turn",
            );
        }
        if tables > 0 {
            refuse_shared(all(), HELD_OUT_ALONE)?;
        } else {
            selections(holdout)?.iter().try_for_each(socam_import::probe)?;
            refuse_fitted(runs, holdout)?;
        }
        Ok(tables > 0)
    }

    fn refuse_repeatability(&self) -> Result<()> {
        let problem = " is for tables of steady states; noise of recordings over time is found from them";
        match self.repeatability {
            Some(_) => Err(JobError::value("repeatability", "--repeatability", problem)),
            None => Ok(()),
        }
    }

    /// Diagnoses a model by recordings on the grid [`Fit`](crate::Grid::Fit). Held-out recordings are opened likewise when they are
    /// opened.
    ///
    /// # Errors
    /// When recordings and model do not go together, or the caller cancels.
    pub fn run(
        &self,
        model: Model,
        training: &[Dataset],
        held_out: Vec<HeldOutRecording>,
        progress: ProgressMonitor,
    ) -> Result<Diagnosed> {
        self.refuse_repeatability()?;
        let why = self.asked_for(&model)?;
        let opened = Mutex::new(Vec::new());
        let keep = |data: Dataset| {
            opened.lock().unwrap_or_else(PoisonError::into_inner).push(data.clone());
            data
        };
        let held_out = held_out.into_iter().fold(HeldOut::none(), |all, recording| match recording {
            HeldOutRecording::File(run) => all.with(run.clone(), move || Grid::Fit.open(&run).map(keep)),
            HeldOutRecording::Open(data) => {
                all.with_dataset(data, move |data| Grid::Fit.apply(data).map(keep))
            }
            HeldOutRecording::Unopened(name, open) => all.with(name, move || {
                open().and_then(|data| Grid::Fit.apply(data).map(keep).map_err(|error| error.to_string()))
            }),
        });
        let progress = progress.within(Budget::seconds(self.budget_s, SEARCH_SHARE));
        let options = socam_diagnose::Options { why, ..self.options(progress) };
        let answer = socam_diagnose::diagnose(&model, training, held_out, &options)?;
        let held_out = opened.into_inner().unwrap_or_else(PoisonError::into_inner);
        Ok(Diagnosed { answer, model, held_out })
    }

    /// Diagnoses a model by tables of steady states.
    ///
    /// # Errors
    /// When tables and model do not go together, or an option is for recordings over time.
    pub fn run_steady(&self, model: Model, tables: &[Steady]) -> Result<Diagnosed> {
        if let Some(asked) = self.why.first() {
            let problem =
                format!(" {asked}: of steady states all candidates are fitted, and none is left out");
            return Err(JobError::value("why", "--why", problem));
        }
        let repeatability = self.repeatability.unwrap_or(SteadyOptions::default().repeatability);
        let options = SteadyOptions { false_alarm_rate: self.false_alarm_rate, repeatability };
        let (diagnosis, model_toml) = socam_diagnose::diagnose_steady(&model, tables, options)?;
        let answer = Answer { diagnosis, evidence: Evidence::default(), model_toml };
        Ok(Diagnosed { answer, model, held_out: Vec::new() })
    }

    /// Effects and places of `--why`.
    fn asked_for(&self, model: &Model) -> Result<Vec<(String, String)>> {
        let one = |text: &String| {
            let wrong = |problem: String| JobError::value("why", "--why", format!(" {text}: {problem}"));
            let Some((id, place)) = text.split_once('@') else {
                return Err(wrong("expected EFFECT@PLACE, as in coulomb_friction@motor_bearing".into()));
            };
            // An effect that acts on inputs by another law is listed twice.
            let own = || model.screened().filter(|effect| effect.id == id);
            if own().next().is_none() {
                let mut known: Vec<&str> = model.screened().map(|effect| effect.id).collect();
                known.dedup();
                return Err(wrong(format!("there is no effect `{id}`; expected {}", known.join(", "))));
            }
            let places: Vec<String> = own().flat_map(|effect| effect.places_in(model)).collect();
            if places.iter().any(|known| known == place) {
                return Ok((id.to_owned(), place.to_owned()));
            }
            Err(wrong(match places.as_slice() {
                [] => format!("`{id}` has no place in {}", model.name),
                places => {
                    format!("`{id}` is no candidate at `{place}`; its places are {}", places.join(", "))
                }
            }))
        };
        self.why.iter().map(one).collect()
    }

    /// The settings in the form of the library.
    #[must_use]
    pub fn options(&self, progress: ProgressMonitor) -> socam_diagnose::Options {
        socam_diagnose::Options {
            false_alarm_rate: self.false_alarm_rate,
            most_effects: self.most.into(),
            tolerance: self.tolerance,
            seed: self.seed,
            start_state: self.start.state(),
            progress,
            ..socam_diagnose::Options::default()
        }
    }
}
