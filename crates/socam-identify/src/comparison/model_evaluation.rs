//! A model at parameter values, evaluated under a noise model.

use socam_model::Model;

use crate::{
    IdentifyError,
    evaluation::{self, Point, SegmentEvaluation},
    problem::Problem,
};

/// A model at parameter values, evaluated under a noise model.
#[derive(Debug, Clone)]
pub struct Evaluation {
    /// All parameters, SI.
    pub values: Vec<f64>,
    /// Sum of squared whitened residuals of each recording.
    pub chi2: Vec<f64>,
    /// Number of measured values of each recording.
    pub count: Vec<f64>,
    /// Root mean square residual of each output before whitening, SI; zero without measurements.
    pub rms: Vec<f64>,
    /// Number of measured values of each output.
    pub read: Vec<f64>,
    /// Whether the descent converged.
    pub converged: bool,
    /// Nuisance parameters by segment.
    pub(crate) nuisance: Vec<Vec<f64>>,
}

impl Evaluation {
    /// Sum of squares over all recordings.
    pub fn total(&self) -> f64 {
        self.chi2.iter().sum()
    }

    /// The part of one recording of `problem`; `rms` and `read` stay those of all recordings.
    #[must_use]
    pub fn on_one(&self, problem: &Problem<'_>, recording: usize) -> Self {
        let own = problem.segments.iter().zip(&self.nuisance);
        let own = own.filter(|(segment, _)| segment.recording == recording);
        Self {
            chi2: vec![self.chi2[recording]],
            count: vec![self.count[recording]],
            nuisance: own.map(|(_, nuisance)| nuisance.clone()).collect(),
            ..self.clone()
        }
    }
}

pub(crate) fn begin(
    problem: &Problem<'_>,
    values: &[f64],
    from: Option<(&Model, &Evaluation)>,
) -> Result<Option<Point>, IdentifyError> {
    if problem.model.equations(values).is_err() {
        return Ok(None);
    }
    let mut nuisance = evaluation::first_nuisance(problem, values)?;
    if let Some((model, before)) = from
        && before.nuisance.len() == nuisance.len()
    {
        let (Ok(old), Ok(new)) = (model.equations(&before.values), problem.model.equations(values)) else {
            return Ok(None);
        };
        for (new_locals, old_locals) in nuisance.iter_mut().zip(&before.nuisance) {
            carry((&old.state_names, old_locals), (&new.state_names, new_locals));
        }
    }
    Ok(Some(Point { values: values.to_vec(), nuisance }))
}

/// Copies start states by name, and offsets; new states begin at zero.
fn carry(old: (&[String], &[f64]), new: (&[String], &mut [f64])) {
    let (names, values) = old;
    let offsets = values.len().saturating_sub(names.len());
    let states = new.1.len().saturating_sub(offsets);
    for (target, name) in new.1[..states].iter_mut().zip(new.0) {
        *target = names.iter().position(|known| known == name).map_or(0.0, |index| values[index]);
    }
    new.1[states..].copy_from_slice(&values[values.len() - offsets..]);
}

pub(crate) fn measured(
    problem: &Problem<'_>,
    point: &Point,
    evaluated: &[SegmentEvaluation],
    converged: bool,
) -> Evaluation {
    let recordings = problem.datasets.len();
    let (mut chi2, mut count) = (vec![0.0; recordings], vec![0.0; recordings]);
    for (segment, result) in problem.segments.iter().zip(evaluated) {
        chi2[segment.recording] += result.weighted_squares;
        count[segment.recording] += result.channels.iter().map(|channel| channel.count).sum::<f64>();
    }
    let channels = evaluation::channel_sums(evaluated);
    Evaluation {
        values: point.values.clone(),
        chi2,
        count,
        rms: channels.iter().map(evaluation::ChannelSums::rms).collect(),
        read: channels.iter().map(|channel| channel.count).collect(),
        converged,
        nuisance: point.nuisance.clone(),
    }
}
