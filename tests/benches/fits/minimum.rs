//! Whether a fit ended at the best known minimum.

use serde::Serialize;
use socam_identify::comparison::{FINE, NoiseModel, descend, measure};
use socam_identify::{Identification, IdentifyError, NoiseLevels, Options, Problem, Reason, output_error};
use socam_model::Model;
use socam_recording::Dataset;

use crate::faults::changed;

/// Starts of the fit that searches for a better minimum.
const STARTS: usize = 24;
/// Iterations of a descent.
const ITERATIONS: usize = 150;
/// What a fit may leave above the best known minimum: this share of the whitened cost, or one unit of it.
const SHARE: f64 = 1e-3;
const UNIT: f64 = 1.0;

/// Whitened costs (halved sums of squares) under the noise model and the samples of the fit under test; `None` where a model overflows.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Costs {
    /// Where the fit ended.
    pub(crate) own: f64,
    /// Whether it converged there.
    #[serde(skip)]
    converged: bool,
    /// At the true values: what they leave more is chi-square where nothing is unmodelled.
    pub(crate) at_truth: Option<f64>,
    /// After a further descent from where the fit ended.
    pub(crate) continued: Option<f64>,
    /// After a descent from the true values.
    pub(crate) from_truth: Option<f64>,
    /// After a descent from the end of a fit with 24 starts.
    pub(crate) from_many: Option<f64>,
}

impl Costs {
    /// Cost of the fit minus the best known one. A fit that converged is judged by the minimum it is at: its own filter of input noise
    /// followed the parameters, so that the fixed one of the comparison has its minimum a little beside.
    pub(crate) fn above(&self) -> f64 {
        let own =
            self.continued.filter(|_| self.converged).map_or(self.own, |continued| continued.min(self.own));
        let others = [self.continued, self.from_truth, self.from_many].into_iter().flatten();
        own - others.fold(own, f64::min)
    }

    /// Whether the fit ended at the best known minimum.
    pub(crate) fn is_best(&self) -> bool {
        self.above() <= (SHARE * self.own).max(UNIT)
    }
}

/// Costs of a fit and of others from better starts. Each fit estimates noise of its own: costs can be compared under one noise model only.
pub(crate) fn costs(
    (base, truth): (&Model, &Model),
    data: &[Dataset],
    found: &Identification,
) -> Result<Costs, String> {
    let data_left =
        data.iter().map(|data| without_left_out(data, base, found)).collect::<Result<Vec<_>, _>>()?;
    compare((base, truth), (data, &data_left), found).map_err(|error| error.to_string())
}

fn compare(
    (base, truth): (&Model, &Model),
    (data, data_left): (&[Dataset], &[Dataset]),
    found: &Identification,
) -> Result<Costs, IdentifyError> {
    // Every machine has one input.
    let intersample = found.between.first().map(|(_, between)| between.kind);
    let problem = Problem::new(base, data_left, Options { intersample, ..Options::default() })?;
    let levels = NoiseLevels {
        outputs: found.fit.channels.iter().map(|(_, fit)| fit.noise_std).collect(),
        inputs: found.input_noise_std.iter().map(|(_, std)| *std).collect(),
    };
    let noise = NoiseModel::new(&[&problem], &found.point, levels)?;
    let descended = |start: &[f64]| -> Result<Option<f64>, IdentifyError> {
        let at = measure(&problem, &noise, start)?;
        let from = at.as_ref().map(|at| (base, at));
        let fitted = descend(&problem, &noise, start, from, (FINE, ITERATIONS))?;
        Ok(fitted.map(|fitted| 0.5 * fitted.total()))
    };
    let many = Problem::new(base, data, Options { starts: STARTS, ..Options::default() });
    let many = many.and_then(|problem| output_error(&problem)).ok();
    let at = |values: &[f64]| {
        Ok::<_, IdentifyError>(measure(&problem, &noise, values)?.map(|at| 0.5 * at.total()))
    };
    Ok(Costs {
        own: at(&found.point)?.unwrap_or(f64::NAN),
        converged: found.converged,
        at_truth: at(&truth.values())?,
        continued: descended(&found.point)?,
        from_truth: descended(&truth.values())?,
        from_many: many.map(|many| descended(&many.point)).transpose()?.flatten(),
    })
}

/// A recording without the output samples that a fit left out.
fn without_left_out(data: &Dataset, model: &Model, found: &Identification) -> Result<Dataset, String> {
    let own = || {
        let notes = found.left_out.iter();
        notes.filter(|note| note.recording == data.name() && note.reason == Reason::Outliers)
    };
    if own().next().is_none() {
        return Ok(data.clone());
    }
    let column = |channel: &str| {
        let channel = model.channels.iter().find(|own| own.name == channel)?;
        data.channel_index(&channel.column).ok()
    };
    changed(data, |(_, columns)| {
        for (column, note) in own().filter_map(|note| Some((column(&note.channel)?, note))) {
            for rows in &note.rows {
                columns[column][rows.start as usize..rows.end as usize].fill(f64::NAN);
            }
        }
    })
}
