//! The definition of one effect.

use super::{
    amplitude::{Amplitude, Linearisation, Steady},
    discrepancy::Discrepancy,
    experiment::{self, Experiment},
    family::Family,
    kinds::{EffectParameter, QuantityKind},
    law::{Borrowed, Form, Law, LawInput},
    places::{ActsAt, Places},
    prior::Prior,
    relations::{Equivalent, FittedValues, Replaces},
    rig::{Rig, RigLaw, Values},
    starts::{PHASES, begin_with_little},
    usual::{self, Usual},
};

/// One effect of the catalogue.
///
/// ```
/// use socam_model::{Model, effects::{self, FittedValues, Rig}};
///
/// let hum = effects::find("sensor_hum").expect("an effect of the catalogue");
/// assert_eq!(hum.given().map(|own| own.name).collect::<Vec<_>>(), ["amplitude", "frequency"]);
/// assert!(hum.is_wave() && !hum.is_by_turn() && !hum.has_memory() && !hum.is_structural());
///
/// // Starts and priors follow from the scales of the rig.
/// let model = Model::builtin("two-mass").expect("an embedded model");
/// let mut rig = Rig::of_model(&model, &model.values());
/// (rig.sample_time_s, rig.longest_s) = (1e-3, 10.0);
/// let speed = rig.channels.iter_mut().find(|channel| channel.name == "load_speed").unwrap();
/// (speed.std, speed.lines_hz) = (5.0, vec![50.0]);
/// let start = &(hum.starts)(&rig, "load_speed")[0];
/// assert_eq!(FittedValues(start).get("frequency"), 50.0);
/// // Four phases, each with the median amplitude of the prior.
/// let large = hum.large_starts(&rig, "load_speed", 0.5);
/// assert_eq!(large.len(), 4);
/// assert!(hum.log_prior(&rig, "load_speed", &large[0]).is_finite());
/// assert_eq!(hum.log_prior(&rig, "load_speed", &[("frequency", 700.0)]), f64::NEG_INFINITY);
/// // 0.1 % of the amplitude.
/// assert_eq!((hum.least_half_width("amplitude", 2.0), hum.upper_factor("amplitude")), (2e-3, 1.0));
/// ```
#[derive(Debug)]
pub struct Effect {
    /// Stable id, as in reports and model files.
    pub id: &'static str,
    /// Name within a sentence.
    pub name: &'static str,
    /// Kind of place at which it acts.
    pub acts_at: ActsAt,
    /// What it has in common with laws that recordings tell from it least.
    pub family: Family,
    /// Places of this kind at which a diagnosis tests the effect.
    pub places: Places,
    /// Parameters of the effect.
    pub parameters: &'static [EffectParameter],
    /// Parameters of its place that its laws use after their own.
    pub borrows: Option<Borrowed>,
    /// Form in which the effect enters the equations.
    pub form: Form,
    /// Parameters in which the model is linear and that are zero (or another null value) without the effect.
    pub amplitude: Amplitude,
    /// Whether sensitivities at a start predict the change of the outputs.
    pub linearisation: Linearisation,
    /// Points at which a score test linearises: amplitudes at their null value unless [`Linearisation::NonNull`], the other parameters that
    /// a file must give on a grid of values that recordings of the rig can distinguish. Empty where the effect is not to be tested.
    pub starts: fn(&Rig, &str) -> Vec<Values>,
    /// Start points of a fit. Arguments: rig, place, values with a small part of the predicted amplitude, values with all of it.
    pub fit_starts: fn(&Rig, &str, &Values, &Values) -> Vec<Values>,
    /// Priors of the parameters that a file must give.
    pub priors: fn(&Rig, &str) -> Vec<(&'static str, Prior)>,
    /// Least interval widths of its parameters, see [`Discrepancy`].
    pub discrepancy: &'static [Discrepancy],
    /// Whether fitted values are those of an ordinary imperfection, and why.
    pub usual: Usual,
    /// Simpler laws that this law contains and may replace.
    pub replaces: &'static [Replaces],
    /// Effects that are observationally equivalent to it under a condition.
    pub equivalents: &'static [Equivalent],
    /// Influence of the effect on steady states.
    pub steady: Steady,
    /// The law as text.
    pub equation: &'static str,
    /// One sentence for a mechanic, chosen by the fitted values.
    pub sentence: fn(&FittedValues<'_>) -> &'static str,
    /// The part of a recording in which its residuals are large.
    pub shows: &'static str,
    /// The recording that determines it best.
    pub experiment: Experiment,
}

/// Largest speeds of a place, rad/s (m/s), below which the default speeds of transition are more than a 25th of them.
const SLOW: (f64, f64) = (1.25, 0.05);
/// Multiple of these speeds of which the defaults are a hundredth.
const NARROW: f64 = 4.0;

impl Effect {
    /// An effect outside the catalogue: a law without amplitude, starts, priors or texts.
    ///
    /// ```
    /// use socam_model::effects::{Acts, ActsAt, Effect, Form, Law, LawInput, MAX_LAW_INPUTS, MAX_PARAMETERS, Response, Rule};
    ///
    /// fn brake(inputs: &[f64], _: &[f64]) -> Response {
    ///     let torque = -0.1 * inputs[0].powi(3);
    ///     Response { torque, derivatives: [0.0; MAX_LAW_INPUTS], by_parameter: [0.0; MAX_PARAMETERS] }
    /// }
    /// const LAW: Law = Law {
    ///     law_inputs: &[LawInput::Speed],
    ///     acts: Acts::Torque,
    ///     rule: Rule::Code(brake),
    ///     formula: "-0.1*speed^3",
    ///     transition: |_| 0.0,
    ///     inactive: |_| false,
    /// };
    /// static BRAKE: Effect = Effect::bare("brake", ActsAt::Bearing, &[], None, Form::Laws(&[LAW]), "T = -0.1 w^3");
    /// assert_eq!(BRAKE.laws()[0].evaluate(&[2.0], &[]).torque, -0.8);
    /// ```
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
            family: Family::Own,
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
            usual: usual::never,
            replaces: &[],
            equivalents: &[],
            steady: Steady::Unseen,
            equation,
            sentence: |_| "",
            shows: "everywhere",
            experiment: experiment::LARGE_TORQUE,
        }
    }

    /// Force laws of the effect; empty if its form is not [`Form::Laws`].
    pub fn laws(&self) -> &'static [Law] {
        match self.form {
            Form::Laws(laws) => laws,
            Form::Inertia | Form::Compliance | Form::Mounting | Form::Gain | Form::Lag | Form::Delay => &[],
        }
    }

    /// Parameters that a file must give.
    pub fn given(&self) -> impl Iterator<Item = &'static EffectParameter> {
        self.parameters.iter().filter(|own| own.default.is_none())
    }

    /// Values of parameters whose default is too wide for a place where the largest speed is `speed`, rad/s (m/s): speeds of transition of a
    /// friction law, a hundredth of the largest speed. Empty where the defaults do.
    ///
    /// ```
    /// use socam_model::effects;
    ///
    /// let friction = effects::find("coulomb_friction").expect("an effect of the catalogue");
    /// assert!(friction.narrowed(20.0, true).is_empty());
    /// assert_eq!(friction.narrowed(5e-3, true), [("transition_speed", 5e-5)]);
    /// ```
    pub fn narrowed(&self, speed: f64, rotational: bool) -> Values {
        let usual = if rotational { SLOW.0 } else { SLOW.1 };
        if !(speed > 0.0 && speed < usual) {
            return Values::new();
        }
        let speeds = self.parameters.iter().filter(|own| own.is_transition_speed());
        let each = speeds.filter_map(|own| Some((own.name, own.default?)));
        each.map(|(name, (turning, sliding))| {
            (name, speed / (NARROW * usual) * if rotational { turning } else { sliding })
        })
        .collect()
    }

    /// [`Self::starts`]; of a candidate of the model file one start, without amplitude and otherwise at the file's values.
    #[must_use]
    pub fn starts_in(&self, rig: &Rig, place: &str) -> Vec<Values> {
        if !self.is_own() {
            return (self.starts)(rig, place);
        }
        let known = |name: &str| rig.laws.iter().find(|own| own.law == self.id && own.parameter == name);
        let start = self.parameters.iter().map(|own| {
            let is_amplitude = self.amplitude.parameters.contains(&own.name);
            Some((own.name, if is_amplitude { self.amplitude.null } else { known(own.name)?.value }))
        });
        start.collect::<Option<Values>>().into_iter().collect()
    }

    /// [`Self::priors`]; of a candidate of the model file those of the file, else its bounds.
    #[must_use]
    pub fn priors_in(&self, rig: &Rig, place: &str) -> Vec<(&'static str, Prior)> {
        if !self.is_own() {
            return (self.priors)(rig, place);
        }
        let own = |name: &str| rig.laws.iter().find(|own| own.law == self.id && own.parameter == name);
        let each = self.parameters.iter().filter_map(|known| Some((known.name, own(known.name)?)));
        let prior = |own: &RigLaw| match own.prior {
            Some((mean, std)) => Prior::normal([mean, std], own.bounds, "the prior of the model file"),
            None => Prior::flat(own.bounds, "the bounds of the model file"),
        };
        each.map(|(name, own)| (name, prior(own))).collect()
    }

    /// Whether it has a phase parameter. A wave of unknown phase is the sum of a sine and a cosine, each with its own amplitude.
    #[must_use]
    pub fn is_wave(&self) -> bool {
        self.parameters.iter().any(|own| own.kind == QuantityKind::Phase)
    }

    /// Whether one of its laws depends on an angle.
    #[must_use]
    pub fn is_by_turn(&self) -> bool {
        self.sees(LawInput::Angle)
    }

    /// Whether it adds a state to the equations.
    #[must_use]
    pub fn has_memory(&self) -> bool {
        self.sees(LawInput::State)
    }

    /// Whether the effect changes the network itself. A diagnosis tests such an effect in a model without others of its kind.
    #[must_use]
    pub fn is_structural(&self) -> bool {
        !matches!(self.form, Form::Laws(_)) || self.acts_at == ActsAt::Gear
    }

    /// Starts with large amplitudes, for a base model with a large error. Each of [`Self::starts`] is given every amplitude at the
    /// quantile `share` of its prior (0.5 is the median), and a wave is started at each of four phases. Starts whose amplitudes
    /// have an improper prior are left out.
    #[must_use]
    pub fn large_starts(&self, rig: &Rig, place: &str, share: f64) -> Vec<Values> {
        let priors = self.priors_in(rig, place);
        let large = |name: &str| priors.iter().find(|(known, _)| *known == name)?.1.quantile(share);
        let filled = |values: Values| -> Option<Values> {
            let each = values.into_iter().map(|(name, value)| {
                let is_amplitude = self.amplitude.parameters.contains(&name);
                Some((name, if is_amplitude { large(name)? } else { value }))
            });
            each.collect()
        };
        let filled = self.starts_in(rig, place).into_iter().filter_map(filled);
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

    /// Sum of the natural log prior densities of fitted values at a place, SI; minus infinity where a value is outside its support.
    /// Parameters that are not given do not count.
    #[must_use]
    pub fn log_prior(&self, rig: &Rig, place: &str, values: &[(&str, f64)]) -> f64 {
        let sizes = FittedValues(values);
        let each = self.priors_in(rig, place).into_iter().map(|(name, prior)| (sizes.get(name), prior));
        each.filter(|(value, _)| !value.is_nan()).map(|(value, prior)| prior.log_density(value)).sum()
    }

    /// Least half width of the 95 % interval of a parameter at a fitted value, SI, by its [`Discrepancy`]; 0 where none is given.
    #[must_use]
    pub fn least_half_width(&self, parameter: &str, value: f64) -> f64 {
        let is_amplitude = self.amplitude.parameters.contains(&parameter);
        let null = if is_amplitude && self.amplitude.null.is_finite() { self.amplitude.null } else { 0.0 };
        let own = self.discrepancy.iter().filter(|own| own.parameter == parameter);
        own.map(|own| own.share * (value - null).abs() + own.absolute).fold(0.0, f64::max)
    }

    /// [`Discrepancy::upper_factor`] of a parameter; 1 where it has no discrepancy.
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
