//! The definition of one effect.

use super::{
    amplitude::{Amplitude, Linearisation, Steady},
    discrepancy::Discrepancy,
    experiment::{self, Experiment},
    kinds::{EffectParameter, Kind},
    law::{Borrowed, Form, Law, LawInput},
    places::{ActsAt, Places},
    prior::Prior,
    relations::{Equivalent, FittedValues, Replaces},
    rig::{Rig, Values},
    starts::{PHASES, begin_with_little},
};

/// One effect of the catalogue.
#[derive(Debug)]
pub struct Effect {
    /// Stable id, as in reports and model files.
    pub id: &'static str,
    /// Name within a sentence.
    pub name: &'static str,
    /// Kind of place at which it acts.
    pub acts_at: ActsAt,
    /// At which of these places a diagnosis looks for it.
    pub places: Places,
    /// Its parameters.
    pub parameters: &'static [EffectParameter],
    /// Parameters of its place that its laws use after their own.
    pub borrows: Option<Borrowed>,
    /// How it enters the equations.
    pub form: Form,
    /// Parameters that measure its strength.
    pub amplitude: Amplitude,
    /// How far a linearisation predicts its effect.
    pub linearisation: Linearisation,
    /// Points at which a score test linearises: amplitudes at their null value unless [`Linearisation::NonNull`], the other parameters that
    /// a file must give on a grid of values that the rig could show.
    pub starts: fn(&Rig, &str) -> Vec<Values>,
    /// Start points of a fit, made from two points: one with a small part of the predicted amplitude, and one with all of it.
    pub fit_starts: fn(&Rig, &str, &Values, &Values) -> Vec<Values>,
    /// Priors of the parameters that a file must give.
    pub priors: fn(&Rig, &str) -> Vec<(&'static str, Prior)>,
    /// Model discrepancy of its parameters.
    pub discrepancy: &'static [Discrepancy],
    /// Simpler laws that it may replace.
    pub replaces: &'static [Replaces],
    /// Effects that recordings may not tell from it.
    pub equivalents: &'static [Equivalent],
    /// What steady states show of it.
    pub steady: Steady,
    /// The law as text.
    pub equation: &'static str,
    /// One sentence for a mechanic that is true of the fitted values.
    pub sentence: fn(&FittedValues<'_>) -> &'static str,
    /// Where in a recording it is visible.
    pub shows: &'static str,
    /// What to record so that it becomes visible.
    pub experiment: Experiment,
}

impl Effect {
    /// An effect outside the catalogue: a law without amplitude, starts, priors or texts.
    #[must_use]
    pub const fn bare(
        id: &'static str,
        acts_at: ActsAt,
        parameters: &'static [EffectParameter],
        borrows: Option<Borrowed>,
        form: Form,
        equation: &'static str,
    ) -> Self {
        Self {
            id,
            name: id,
            acts_at,
            places: Places::Every,
            parameters,
            borrows,
            form,
            amplitude: Amplitude::of(&[]),
            linearisation: Linearisation::Null,
            starts: |_, _| Vec::new(),
            fit_starts: begin_with_little,
            priors: |_, _| Vec::new(),
            discrepancy: &[],
            replaces: &[],
            equivalents: &[],
            steady: Steady::Unseen,
            equation,
            sentence: |_| "",
            shows: "everywhere",
            experiment: experiment::LARGE_TORQUE,
        }
    }

    /// Its force laws.
    pub fn laws(&self) -> &'static [Law] {
        match self.form {
            Form::Laws(laws) => laws,
            _ => &[],
        }
    }

    /// Parameters that a file must give.
    pub fn given(&self) -> impl Iterator<Item = &'static EffectParameter> {
        self.parameters.iter().filter(|own| own.default.is_none())
    }

    /// Whether it is a wave of unknown phase, which is the sum of two waves a quarter of a period apart.
    #[must_use]
    pub fn is_wave(&self) -> bool {
        self.parameters.iter().any(|own| own.kind == Kind::Phase)
    }

    /// Whether it depends on an angle, so that it needs something that turns.
    #[must_use]
    pub fn is_by_turn(&self) -> bool {
        self.sees(LawInput::Angle)
    }

    /// Whether its laws have a state of their own.
    #[must_use]
    pub fn has_memory(&self) -> bool {
        self.sees(LawInput::State)
    }

    /// Whether it changes the network itself. A diagnosis tests such an effect in a model without others of its kind.
    #[must_use]
    pub fn is_structural(&self) -> bool {
        !matches!(self.form, Form::Laws(_)) || self.acts_at == ActsAt::Gear
    }

    /// Starts with large amplitudes, for a base model with a large error: each of [`Self::starts`] with every amplitude at the given
    /// quantile of its prior (0.5: the median), where that exists.
    #[must_use]
    pub fn large_starts(&self, rig: &Rig, place: &str, share: f64) -> Vec<Values> {
        let priors = (self.priors)(rig, place);
        let large = |name: &str| priors.iter().find(|(known, _)| *known == name)?.1.quantile(share);
        let filled = |values: Values| -> Option<Values> {
            let each = values.into_iter().map(|(name, value)| {
                let is_amplitude = self.amplitude.parameters.contains(&name);
                Some((name, if is_amplitude { large(name)? } else { value }))
            });
            each.collect()
        };
        let filled = (self.starts)(rig, place).into_iter().filter_map(filled);
        let phases: &[f64] = if self.is_wave() { &PHASES } else { &[0.0] };
        let turned = |values: &Values, phase: f64| {
            let each =
                values.iter().map(|(name, value)| (*name, if *name == "phase" { phase } else { *value }));
            each.collect::<Values>()
        };
        filled
            .flat_map(|values| phases.iter().map(move |phase| turned(&values, *phase)).collect::<Vec<_>>())
            .collect()
    }

    /// Logarithm of the prior density of fitted values at a place; minus infinity where one is outside its support.
    #[must_use]
    pub fn log_prior(&self, rig: &Rig, place: &str, values: &[(&str, f64)]) -> f64 {
        let sizes = FittedValues(values);
        let each = (self.priors)(rig, place).into_iter().map(|(name, prior)| (sizes.get(name), prior));
        each.filter(|(value, _)| !value.is_nan()).map(|(value, prior)| prior.log_density(value)).sum()
    }

    /// Least half width of a parameter's 95 % interval at a fitted value, SI.
    #[must_use]
    pub fn least_half_width(&self, parameter: &str, value: f64) -> f64 {
        let is_amplitude = self.amplitude.parameters.contains(&parameter);
        let null = if is_amplitude && self.amplitude.null.is_finite() { self.amplitude.null } else { 0.0 };
        let own = self.discrepancy.iter().filter(|own| own.parameter == parameter);
        own.map(|own| own.share * (value - null).abs() + own.absolute).fold(0.0, f64::max)
    }

    /// See [`Discrepancy::upper_factor`]; one where nothing is known of it.
    #[must_use]
    pub fn upper_factor(&self, parameter: &str) -> f64 {
        let own = self.discrepancy.iter().find(|own| own.parameter == parameter);
        own.map_or(1.0, |own| own.upper_factor)
    }

    /// Whether one of its laws has this input.
    pub(crate) fn sees(&self, law_input: LawInput) -> bool {
        self.laws().iter().any(|law| law.law_inputs.contains(&law_input))
    }
}
