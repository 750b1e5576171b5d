//! Missing physics of a model, from recordings over time or from tables of steady states.

use std::path::Path;

use serde::{Deserialize, Serialize};
use socam_diagnose::{Answer, Diagnosis, Evidence, SteadyOptions};
use socam_identify::ProgressMonitor;
use socam_model::Model;
use socam_recording::{Dataset, Format, Steady, detect};

use crate::error::{JobError, Result};
use crate::inputs::refuse_shared;
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
    /// Seed of the random start values
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
}

impl Settings for Diagnose {
    const COMMAND: &'static [&'static str] = &["diagnose"];

    fn validate(&self) -> Result<()> {
        check_false_alarm_rate(self.false_alarm_rate)?;
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
}

impl Diagnosed {
    /// The document `socam.diagnosis/1`.
    #[must_use]
    pub fn document(&self) -> &Diagnosis {
        &self.answer.diagnosis
    }
}

impl Diagnose {
    /// Whether the files are tables of steady states.
    ///
    /// # Errors
    /// When samples are named twice, tables and recordings are mixed, or an option is of the other kind.
    pub fn are_tables(&self, runs: &[String], holdout: &[String]) -> Result<bool> {
        let all = || runs.iter().chain(holdout);
        refuse_shared(all(), "what is held out must not be fitted, and nothing counts double")?;
        let tables =
            all().filter(|run| matches!(detect(Path::new(run)), Ok(Format::SteadyStates))).count();
        let refused = |message: &str| Err(JobError::Inputs(message.into()));
        if tables == 0 && self.repeatability.is_some() {
            return refused(
                "--repeatability is for tables of steady states; noise of recordings over time is found from them",
            );
        }
        if tables > 0 && tables < all().count() {
            return refused(
                "tables of steady states and recordings over time are diagnosed apart: run it twice",
            );
        }
        if tables > 0 && !holdout.is_empty() {
            return refused(
                "--holdout is for recordings over time; of steady states each point is left out in turn",
            );
        }
        Ok(tables > 0)
    }

    /// Diagnoses a model by recordings on the grid [`Diagnosis`](crate::Grid::Diagnosis).
    ///
    /// # Errors
    /// When recordings and model do not go together, or the caller cancels.
    pub fn run(
        &self,
        model: Model,
        training: &[Dataset],
        holdout: &[Dataset],
        progress: ProgressMonitor,
    ) -> Result<Diagnosed> {
        let options = self.options(progress);
        let answer = socam_diagnose::diagnose(&model, training, holdout, &options)?;
        Ok(Diagnosed { answer, model })
    }

    /// Diagnoses a model by tables of steady states.
    ///
    /// # Errors
    /// When tables and model do not go together.
    pub fn run_steady(&self, model: Model, tables: &[Steady]) -> Result<Diagnosed> {
        let usual = SteadyOptions::default();
        let options = SteadyOptions {
            false_alarm_rate: self.false_alarm_rate,
            repeatability: self.repeatability.unwrap_or(usual.repeatability),
            ..usual
        };
        let (diagnosis, model_toml) = socam_diagnose::diagnose_steady(&model, tables, options)?;
        Ok(Diagnosed { answer: Answer { diagnosis, evidence: Evidence::default(), model_toml }, model })
    }

    /// The settings as the library takes them.
    #[must_use]
    pub fn options(&self, progress: ProgressMonitor) -> socam_diagnose::Options {
        socam_diagnose::Options {
            false_alarm_rate: self.false_alarm_rate,
            most_effects: self.most.into(),
            tolerance: self.tolerance,
            seed: self.seed,
            start_state: self.start.state(),
            watch: progress,
            ..socam_diagnose::Options::default()
        }
    }
}
