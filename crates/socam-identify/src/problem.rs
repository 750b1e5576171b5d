//! An identification problem: a model, recordings, and assumptions.

use socam_model::{Intersample, Model};
use socam_recording::Dataset;

use crate::{
    IdentifyError,
    between::Between,
    noise::innovations_filter::NoiseLevels,
    prediction::start_state,
    preprocessing::{
        mask::LeftOut,
        screening,
        segments::{self, Segment},
    },
    progress::ProgressMonitor,
};

/// Most nodes and free parameters of a model that is fitted. On one core, a recording of 3000 samples and a chain of 30 nodes take 4 s, of
/// 50 nodes 23 s; 10 nodes and 100 free parameters 4 s, 300 more than half a minute.
const MOST_NODES: usize = 40;
const MOST_FREE: usize = 100;

/// Levels of the sensor noise, which is assumed to be white and independent between channels.
#[derive(Debug, Clone, PartialEq)]
pub enum Noise {
    /// Levels of outputs and of measured inputs are estimated from the data. References and clocks are known exactly.
    Estimated,
    /// Known levels.
    Given(NoiseLevels),
}

/// Start state of each uninterrupted segment of data.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StartState {
    /// Unknown: estimated with the parameters.
    Free,
    /// Equilibrium at the first input sample, for the current parameters. Only for drivetrains that have one (no free-running
    /// position).
    Equilibrium,
}

/// A linear constraint: lower <= sum of coefficient * parameter <= upper, SI.
#[derive(Debug, Clone, PartialEq)]
pub struct Constraint {
    /// Parameter index and coefficient.
    pub terms: Vec<(usize, f64)>,
    /// Lower limit.
    pub lower: f64,
    /// Upper limit.
    pub upper: f64,
}

/// Assumptions and limits of a fit.
#[derive(Debug, Clone)]
pub struct Options {
    /// Noise levels.
    pub noise: Noise,
    /// Start state of each segment.
    pub start_state: StartState,
    /// Reconstruction of every input between its samples. `None`: that of the model file; where it states none, that which fits the recordings
    /// best, and where they do not tell, that of [`socam_model::Intersample::of`].
    pub intersample: Option<Intersample>,
    /// Whether to warn where the result depends on the reconstruction of inputs between their samples.
    pub try_other_intersamples: bool,
    /// Number of starts: the file's values first, then values spread by factors of up to three around them.
    pub starts: usize,
    /// Seed of that spread.
    pub seed: u64,
    /// Most iterations of one descent.
    pub max_iterations: usize,
    /// Most attempts at a step per sample of a model with force laws, on average over a recording; a prediction that needs more counts as
    /// overflowing. For searches among many models: with rattling teeth, one prediction may take as long as a thousand others.
    pub most_steps: Option<usize>,
    /// Linear constraints on parameters.
    pub constraints: Vec<Constraint>,
    /// Receiver of progress, which may end the search.
    pub progress: ProgressMonitor,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            noise: Noise::Estimated,
            start_state: StartState::Free,
            intersample: None,
            try_other_intersamples: false,
            starts: 6,
            seed: 1,
            max_iterations: 150,
            most_steps: None,
            constraints: Vec::new(),
            progress: ProgressMonitor::default(),
        }
    }
}

/// Recordings bound to the channels of a model. [`Problem::new`] divides them into segments and searches them for saturated outputs and
/// spikes of inputs once; only the search for outliers after a fit adds to the masks, on a copy.
#[derive(Debug, Clone)]
pub struct Problem<'a> {
    pub(crate) model: &'a Model,
    pub(crate) datasets: &'a [Dataset],
    /// Indices of the parameters to estimate.
    pub(crate) free: Vec<usize>,
    pub(crate) segments: Vec<Segment>,
    pub(crate) options: Options,
    /// One per input.
    pub(crate) intersample: Vec<Intersample>,
    pub(crate) warnings: Vec<String>,
    /// What is known of that, one per input; empty before the recordings were asked.
    pub(crate) between: Vec<Between>,
    /// Samples that are not used as measured.
    pub(crate) left_out: Vec<LeftOut>,
    /// Sentences about channels with too many large residuals to be outliers.
    pub(crate) misfits: Vec<String>,
}

impl<'a> Problem<'a> {
    /// The model that is fitted.
    pub fn model(&self) -> &'a Model {
        self.model
    }

    /// Binds `datasets` to the channels that `model` reads. Parameters that the model marks as fixed stay so; where all are, a fit estimates
    /// noise levels, start states and offsets, and says whether the model explains the recordings.
    ///
    /// ```
    /// use socam_identify::{Options, Problem};
    ///
    /// # let (model, recordings) = include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/doc/bench.rs"));
    /// let problem = Problem::new(&model, &recordings, Options::default())?;
    /// assert_eq!(problem.model().name, model.name);
    /// assert!(Problem::new(&model, &[], Options::default()).is_err());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// When a recording lacks a channel or is too short, or when a file cannot be read.
    pub fn new(model: &'a Model, datasets: &'a [Dataset], options: Options) -> Result<Self, IdentifyError> {
        let free: Vec<usize> =
            (0..model.parameters.len()).filter(|index| !model.parameters[*index].fixed).collect();
        let (nodes, free_count) = (model.nodes.len(), free.len());
        if nodes > MOST_NODES || free_count > MOST_FREE {
            return Err(IdentifyError::TooLarge {
                model: model.name.clone(),
                nodes,
                free: free_count,
                most_nodes: MOST_NODES,
                most_free: MOST_FREE,
            });
        }
        Self::bound(model, datasets, options, free)
    }

    /// Creates a problem in which all parameters are fixed, for [`crate::evaluate`] and [`crate::start_states`].
    ///
    /// ```
    /// use socam_identify::{Options, Problem, evaluate};
    ///
    /// # let (model, recordings) = include!(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/doc/bench.rs"));
    /// let problem = Problem::of_known(&model, &recordings, Options::default())?;
    /// assert!(evaluate(&problem, &model.values()).is_ok());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// The errors of [`Problem::new`].
    pub fn of_known(
        model: &'a Model,
        datasets: &'a [Dataset],
        options: Options,
    ) -> Result<Self, IdentifyError> {
        Self::bound(model, datasets, options, Vec::new())
    }

    fn bound(
        model: &'a Model,
        datasets: &'a [Dataset],
        options: Options,
        free: Vec<usize>,
    ) -> Result<Self, IdentifyError> {
        if datasets.is_empty() {
            return Err(IdentifyError::NoRecordings);
        }
        for parameter in free.iter().map(|index| &model.parameters[*index]) {
            let (value, (low, high)) = (parameter.value, parameter.bounds);
            if !(low..=high).contains(&value) {
                return Err(IdentifyError::StartOutOfBounds {
                    name: parameter.name.clone(),
                    value,
                    low,
                    high,
                });
            }
        }
        check(model, &options)?;
        if options.start_state == StartState::Equilibrium {
            start_at_rest(model)?;
        }
        let mut warnings = Vec::new();
        // A part that begins in the middle of a motion is not in equilibrium.
        let longest = match options.start_state {
            StartState::Free => segments::MOST_ROWS,
            StartState::Equilibrium => u64::MAX,
        };
        let mut segments = segments::segments(model, datasets, longest, &mut warnings)?;
        let (inputs, outputs): (Vec<_>, Vec<_>) = (model.inputs().collect(), model.outputs().collect());
        let left_out = screening::find(&inputs, &outputs, datasets, &mut segments)?;
        let intersample =
            inputs.iter().map(|input| options.intersample.unwrap_or_else(|| input.intersample())).collect();
        Ok(Self {
            model,
            datasets,
            free,
            segments,
            options,
            intersample,
            between: Vec::new(),
            warnings,
            left_out,
            misfits: Vec::new(),
        })
    }

    /// A problem of given segments, which are neither searched nor checked.
    pub(crate) fn of_segments(
        (model, datasets): (&'a Model, &'a [Dataset]),
        free: Vec<usize>,
        segments: Vec<Segment>,
        options: Options,
        intersample: Vec<Intersample>,
    ) -> Self {
        Self {
            model,
            datasets,
            free,
            segments,
            options,
            intersample,
            between: Vec::new(),
            warnings: Vec::new(),
            left_out: Vec::new(),
            misfits: Vec::new(),
        }
    }

    /// The same problem with other segments, which are neither searched nor checked.
    pub(crate) fn with_segments(&self, segments: Vec<Segment>) -> Self {
        let data = (self.model, self.datasets);
        Self::of_segments(data, self.free.clone(), segments, self.options.clone(), self.intersample.clone())
    }

    /// Number of outputs of the model.
    pub(crate) fn outputs(&self) -> usize {
        self.model.outputs().count()
    }
}

/// Checks that the model has an equilibrium to start from.
fn start_at_rest(model: &Model) -> Result<(), IdentifyError> {
    let values = model.values();
    let inputs = vec![0.0; model.inputs().count()];
    match start_state::equilibrium(&model.equations(&values)?, &values, &inputs) {
        Some(_) => Ok(()),
        None => Err(IdentifyError::Unsuited {
            method: "a start from equilibrium",
            model: model.name.clone(),
            why: "nothing holds its position, so that it has no state of rest; let the start state be fitted"
                .into(),
        }),
    }
}

/// Checks that the options fit the model.
fn check(model: &Model, options: &Options) -> Result<(), IdentifyError> {
    let refuse = |text: String| Err(IdentifyError::Option(text));
    if let Noise::Given(given) = &options.noise {
        let sizes = [
            ("outputs", model.outputs().count(), &given.outputs, f64::MIN_POSITIVE),
            ("inputs", model.inputs().count(), &given.inputs, 0.0),
        ];
        for (kind, count, stds, least) in sizes {
            if stds.len() != count {
                return refuse(format!(
                    "{} noise levels for the {count} {kind} of {}",
                    stds.len(),
                    model.name
                ));
            }
            if let Some(std) = stds.iter().find(|std| !(std.is_finite() && **std >= least)) {
                return refuse(format!("a noise level of the {kind} is {std}, but it must be positive"));
            }
        }
    }
    for constraint in &options.constraints {
        let known =
            constraint.terms.iter().all(|(index, c)| *index < model.parameters.len() && c.is_finite());
        if !known
            || constraint.lower.is_nan()
            || constraint.upper.is_nan()
            || constraint.lower > constraint.upper
        {
            return refuse(format!(
                "a constraint from {} to {} names unknown parameters or has its limits the wrong way round",
                constraint.lower, constraint.upper
            ));
        }
    }
    Ok(())
}

/// The different sample times of a problem.
pub(crate) fn sample_times(problem: &Problem<'_>) -> Vec<f64> {
    let mut times: Vec<f64> = problem.segments.iter().map(|segment| segment.sample_time_s).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    times
}
