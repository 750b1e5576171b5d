//! A rig identified as a user would, beside its truth.

use cpu_time::ThreadTime;
use serde::Serialize;
use socam_identify::{Explained, Identification, Options, Suspect};
use socam_job::Grid;
use socam_model::Model;

use crate::minimum::{self, Costs};
use crate::misfit;
use crate::rig::{Driven, Flaws, Rig, kinds};

/// Excess over an interval, in widths of it, beyond which a parameter was moved: scatter alone exceeds an interval by half a half-width
/// in three of a thousand cases.
const MOVED: f64 = 0.25;

/// A free parameter, SI.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Parameter {
    pub(crate) name: String,
    pub(crate) truth: f64,
    pub(crate) start: f64,
    /// Where the fit ended, determined or not.
    pub(crate) point: f64,
    pub(crate) std: Option<f64>,
    /// `None` where the parameter is not determined.
    pub(crate) ci95: Option<[f64; 2]>,
}

impl Parameter {
    /// Whether the interval, widened on either side by a share of its width, holds the true value.
    pub(crate) fn holds(&self, widened: f64) -> Option<bool> {
        let [low, high] = self.ci95?;
        let more = widened * (high - low);
        Some((low - more..=high + more).contains(&self.truth))
    }

    /// Half of the interval over the estimate.
    pub(crate) fn half_width(&self) -> Option<f64> {
        self.ci95.map(|[low, high]| 0.5 * (high - low) / self.point.abs())
    }
}

/// What came of a rig.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Trial {
    pub(crate) case: u64,
    pub(crate) family: String,
    pub(crate) driven: Driven,
    pub(crate) recordings: usize,
    pub(crate) flaws: Flaws,
    /// Residual in units of noise at which the background aimed, its size and its kinds.
    pub(crate) aim: f64,
    pub(crate) background_size: f64,
    pub(crate) background: Vec<&'static str>,
    pub(crate) fit: Option<Fit>,
    /// Why there is no fit.
    pub(crate) error: Option<String>,
    /// Processor time of the fit, s.
    pub(crate) cpu_s: f64,
}

/// What a fit said.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Fit {
    /// Residual of the output that is left furthest beyond its noise, in units of that noise.
    pub(crate) misfit: f64,
    pub(crate) explained: Option<Explained>,
    /// The same by the fit's own verdict, whose noise is estimated.
    pub(crate) times_noise: Option<f64>,
    pub(crate) converged: bool,
    pub(crate) intersample: Option<&'static str>,
    pub(crate) intersample_is_true: bool,
    /// Channel that was said to have the wrong sign.
    pub(crate) sign: Option<String>,
    pub(crate) costs: Costs,
    pub(crate) parameters: Vec<Parameter>,
    pub(crate) suspects: Vec<Suspect>,
    pub(crate) warnings: Vec<String>,
}

impl Trial {
    pub(crate) fn run(rig: Rig) -> Result<Self, String> {
        let (base, truth) = rig.models()?;
        let data = Grid::Fit.apply_all(rig.recordings()?).map_err(|error| error.to_string())?;
        let clock = ThreadTime::now();
        // As `identify` does.
        let options = Options { try_other_intersamples: true, ..Options::default() };
        let found = socam_job::fitted(&base, &data, &options);
        let cpu_s = clock.elapsed().as_secs_f64();
        let found = found.map_err(|error| error.to_string());
        let (fit, error) = match found {
            Ok(found) => {
                let costs = minimum::costs((&base, &truth), &data, &found)?;
                (Some(Fit::new(&rig, (&base, &truth), found, costs)), None)
            }
            Err(error) => (None, Some(error)),
        };
        Ok(Self {
            case: rig.number,
            recordings: rig.case.training,
            background: kinds(&rig.case.background),
            family: rig.case.machine.family,
            driven: rig.driven,
            flaws: rig.flaws,
            aim: rig.aim,
            background_size: rig.scale,
            fit,
            error,
            cpu_s,
        })
    }

    /// Whether the truth has nothing that the model lacks, and the recordings have no flaw.
    pub(crate) fn is_plain(&self) -> bool {
        self.background.is_empty() && self.flaws.names().is_empty()
    }

    /// Whether the verdict warns although there is nothing to warn of; `None` where there is something.
    pub(crate) fn is_false_warning(&self) -> Option<bool> {
        let fit = self.fit.as_ref().filter(|_| self.is_plain())?;
        Some(fit.explained != Some(Explained::Yes))
    }

    /// Whether the verdict warns of nothing although a background or a flaw moved a parameter out of its interval; `None` where none was
    /// moved. To begin in motion is nothing to warn of: start states are fitted.
    pub(crate) fn is_missing_warning(&self) -> Option<bool> {
        let flaws = Flaws { cut_s: 0.0, ..self.flaws.clone() };
        let is_flawed = !self.background.is_empty() || !flaws.names().is_empty();
        let fit = self.fit.as_ref().filter(|_| is_flawed && flaws.wrong_sign.is_none())?;
        let is_moved = fit.parameters.iter().any(|parameter| parameter.holds(MOVED) == Some(false));
        is_moved.then_some(fit.explained == Some(Explained::Yes))
    }

    /// Whether the channel of the wrong sign was named; `None` where there is none.
    pub(crate) fn is_sign_named(&self) -> Option<bool> {
        let wrong = self.flaws.wrong_sign.as_ref()?;
        Some(self.fit.as_ref().is_some_and(|fit| fit.sign.as_ref() == Some(wrong)))
    }

    /// What the rig is, in words.
    pub(crate) fn words(&self) -> String {
        let driven = format!("{:?}", self.driven).to_lowercase();
        let parts = [vec![self.family.as_str(), &driven], self.flaws.names(), self.background.clone()];
        format!("case {}: {}", self.case, parts.concat().join(", "))
    }

    /// One line about the case.
    pub(crate) fn line(&self) -> String {
        let Some(fit) = &self.fit else {
            return format!("{}: {}", self.words(), self.error.as_deref().unwrap_or_default());
        };
        let held: Vec<bool> = fit.parameters.iter().filter_map(|parameter| parameter.holds(0.0)).collect();
        let explained = fit.explained.map_or_else(String::new, |explained| format!("{explained:?}"));
        format!(
            "{}; misfit {:.2} (aim {}), {explained}; {} of {} intervals hold of {} parameters; cost {:.6e}, {:.2e} above the best; {:.1} s",
            self.words(),
            fit.misfit,
            self.aim,
            held.iter().filter(|held| **held).count(),
            held.len(),
            fit.parameters.len(),
            fit.costs.own,
            fit.costs.above(),
            self.cpu_s
        )
    }
}

impl Fit {
    fn new(rig: &Rig, (base, truth): (&Model, &Model), found: Identification, costs: Costs) -> Self {
        let rms = found.fit.channels.iter().map(|(_, fit)| fit.rms);
        let kind = found.between.first().map(|(_, between)| between.kind);
        Self {
            misfit: misfit::worst(rms, &rig.noise),
            explained: found.verdict.as_ref().map(|verdict| verdict.explained),
            times_noise: found.verdict.as_ref().and_then(|verdict| verdict.times_noise),
            converged: found.converged,
            intersample: kind.map(|kind| kind.name()),
            intersample_is_true: kind == Some(rig.intersample()),
            sign: found.warnings.iter().find_map(|warning| of_wrong_sign(warning)),
            costs,
            parameters: parameters((base, truth), &found),
            suspects: found.suspects,
            warnings: found.warnings,
        }
    }
}

/// The channel that a warning says to have the wrong sign.
fn of_wrong_sign(warning: &str) -> Option<String> {
    let (channel, rest) = warning.strip_prefix('`')?.split_once('`')?;
    rest.starts_with(" has the wrong sign").then(|| channel.to_owned())
}

fn parameters((base, truth): (&Model, &Model), found: &Identification) -> Vec<Parameter> {
    let all = base.parameters.iter().zip(&truth.parameters).zip(&found.parameters).zip(&found.point);
    let free = all.filter(|(((base, _), _), _)| !base.fixed);
    let one = |(((base, truth), estimate), point): (
        ((&socam_model::Parameter, &socam_model::Parameter), _),
        &f64,
    )| {
        let estimate: &socam_identify::ParameterEstimate = estimate;
        let [low, high] = estimate.ci95;
        Parameter {
            name: base.name.clone(),
            truth: truth.value,
            start: base.value,
            point: *point,
            std: estimate.std,
            ci95: low.zip(high).filter(|_| estimate.identifiable).map(|(low, high)| [low, high]),
        }
    };
    free.map(one).collect()
}
