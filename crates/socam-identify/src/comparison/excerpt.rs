//! Windows of long recordings, on which many models are compared before a few are fitted to all rows.

use rayon::prelude::*;

use crate::{
    IdentifyError,
    comparison::{Evaluation, NoiseModel, model_evaluation},
    evaluation::Point,
    optimiser::nuisance,
    prediction::replay::replay,
    preprocessing::segments::Segment,
    problem::{Problem, StartState},
};

/// Rows of a window. Each has its own start state.
const WINDOW: u64 = 750;

/// Windows of the recordings of a problem, taken evenly over all of them.
#[derive(Debug, Clone)]
pub struct Excerpt {
    /// Each window, with the index of the segment that it is a part of.
    windows: Vec<(usize, Segment)>,
}

impl Excerpt {
    /// Windows of together about `rows` rows: a systematic sample of all rows in their order. `None` where the recordings have at most twice
    /// as many, are in parts shorter than a window, or begin in equilibrium, which a window does not.
    ///
    /// ```
    /// use socam_identify::{Options, Problem, comparison::Excerpt};
    ///
    /// # let (model, recordings) = include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/doc/bench.rs"));
    /// let problem = Problem::new(&model, &recordings, Options::default())?;
    /// assert!(Excerpt::new(&problem, 6000).is_none(), "a short recording is used whole");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn new(problem: &Problem<'_>, rows: u64) -> Option<Self> {
        let all: u64 = problem.segments.iter().map(|segment| segment.rows).sum();
        if problem.options.start_state != StartState::Free || all <= 2 * rows {
            return None;
        }
        // Neither what is left at the end of a segment nor a shorter segment is a window.
        let pieces = problem
            .segments
            .iter()
            .enumerate()
            .flat_map(|(index, segment)| segment.pieces(WINDOW).map(move |piece| (index, piece)));
        let every = all.div_ceil(rows) as usize;
        let windows: Vec<_> = pieces.skip(every / 2).step_by(every).collect();
        (!windows.is_empty()).then_some(Self { windows })
    }
}

impl<'a> Problem<'a> {
    /// The same problem on the windows of an excerpt of its recordings.
    #[must_use]
    pub fn on(&self, excerpt: &Excerpt) -> Self {
        self.with_segments(excerpt.windows.iter().map(|(_, window)| window.clone()).collect())
    }
}

/// The evaluation `at` of a `problem`, on an excerpt of its recordings: windows begin in the states in which the prediction passes them, and
/// these are then fitted. `None` where a prediction overflows.
///
/// ```
/// use socam_identify::{NoiseLevels, Options, Problem, comparison::{Excerpt, NoiseModel, measure, on_excerpt}};
///
/// # let (model, recordings) = include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/doc/bench.rs"));
/// let recordings: Vec<_> = (0..8).map(|_| recordings[0].clone()).collect();
/// let problem = Problem::new(&model, &recordings, Options::default())?;
/// let excerpt = Excerpt::new(&problem, 3000).expect("8000 rows are long");
/// let levels = NoiseLevels { outputs: vec![0.07; 2], inputs: vec![0.0] };
/// let noise_model = NoiseModel::new(&[&problem], &model.values(), levels)?;
/// let all = measure(&problem, &noise_model, &model.values())?.expect("no overflow");
/// let brief = on_excerpt(&problem, &noise_model, &all, &excerpt)?.expect("no overflow");
/// // Fewer values, which say the same.
/// let values = |at: &socam_identify::comparison::Evaluation| at.count.iter().sum::<f64>();
/// assert!(values(&brief) < 0.5 * values(&all));
/// let ratio = (brief.total() / values(&brief)) / (all.total() / values(&all));
/// assert!((ratio - 1.0).abs() < 0.1, "{ratio}");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// When a recording cannot be read.
pub fn on_excerpt(
    problem: &Problem<'_>,
    noise_model: &NoiseModel,
    at: &Evaluation,
    excerpt: &Excerpt,
) -> Result<Option<Evaluation>, IdentifyError> {
    let states = problem.model.equations(&at.values)?.state_names.len();
    let each =
        problem.segments.par_iter().zip(&at.nuisance).enumerate().map(|(index, (segment, nuisance))| {
            let own = excerpt.windows.iter().filter(|(of, _)| *of == index);
            let rows: Vec<u64> = own.map(|(_, window)| window.first_row - segment.first_row).collect();
            let Some(last) = rows.last() else { return Ok(Vec::new()) };
            let passed =
                replay(problem, problem.model, &at.values, &segment.head(last + 2), nuisance, &rows)?;
            Ok(passed.states.into_iter().map(|state| [&state[..], &nuisance[states..]].concat()).collect())
        });
    let begun: Result<Vec<Vec<Vec<f64>>>, IdentifyError> = each.collect();
    let nuisance = match begun {
        Ok(begun) => begun.into_iter().flatten().collect(),
        Err(IdentifyError::Diverged { .. }) => return Ok(None),
        Err(error) => return Err(error),
    };
    let windows = Problem { free: Vec::new(), ..problem.on(excerpt) };
    let point = Point { values: at.values.clone(), nuisance };
    let weights = noise_model.weights(&windows, &at.values);
    let fitted = nuisance::with_nuisance_fitted(&windows, point, weights)?;
    Ok(fitted.map(|at| model_evaluation::measured(&windows, &at.point, &at.evaluated, true)))
}
