//! The catalogue of physics that a plain spring-damper network leaves out, one file each.
//!
//! An effect changes the drivetrain's structure ([`Form::Inertia`] and the like) or is made of force laws ([`Form::Laws`]):
//! static functions of what they see of the motion, with exact derivatives. Its file says all that is known of it: law, amplitude,
//! places, starts, priors, how nearly it is obeyed, what it is mistaken for, and its words. Adding one is adding its file and
//! its line in [`CATALOGUE`]; simulator, predictors, model files and diagnosis take it from there, and name no effect.

mod backlash;
mod constant_load;
mod coulomb_friction;
mod coupling_slip;
mod damping_drift;
mod direction_dependence;
mod direction_gain;
pub mod discrepancy;
pub mod experiment;
mod external_disturbance;
mod gravity_unbalance;
mod hysteresis;
mod kinds;
mod kinematic_error;
mod law;
pub mod meanings;
mod mesh_loss;
mod missing_compliance;
mod missing_inertia;
mod places;
mod presliding;
mod prior;
mod quadratic_drag;
mod rig;
pub(crate) mod sensor_delay;
mod sensor_fold;
mod sensor_gain;
mod sensor_hum;
mod sensor_lag;
mod sensor_offset;
mod sensor_ripple;
mod sensor_saturation;
mod shape;
mod stiffness_hardening;
mod stribeck_friction;
mod torque_ripple;
mod velocity_weakening;

use discrepancy::Discrepancy;
use experiment::Experiment;
use kinds::{ANY, POSITIVE};

pub use coulomb_friction::TRANSITION_SPEED;
pub use kinds::{EffectParameter, Kind};
pub use law::{Acts, Borrowed, Form, Law, LawInput, MAX_LAW_INPUTS, MAX_PARAMETERS, Response};
pub use places::{Places, is_part};
pub use prior::{Prior, Shape};
pub(crate) use rig::rigid_stiffness;
pub use rig::{Rig, RigBearing, RigChannel, RigGear, RigNode, RigShaft, RigSpring, Values};

/// Every effect, in the order of the documentation.
pub const CATALOGUE: &[&Effect] = &[
    &coulomb_friction::EFFECT,
    &stribeck_friction::EFFECT,
    &quadratic_drag::EFFECT,
    &damping_drift::EFFECT,
    &direction_dependence::EFFECT,
    &velocity_weakening::EFFECT,
    &constant_load::EFFECT,
    &mesh_loss::EFFECT,
    &backlash::EFFECT,
    &kinematic_error::EFFECT,
    &stiffness_hardening::EFFECT,
    &hysteresis::EFFECT,
    &missing_compliance::EFFECT,
    &missing_inertia::EFFECT,
    &coupling_slip::EFFECT,
    &gravity_unbalance::EFFECT,
    &external_disturbance::EFFECT,
    &torque_ripple::EFFECT,
    &sensor_gain::EFFECT,
    &sensor_offset::EFFECT,
    &sensor_lag::EFFECT,
    &sensor_delay::EFFECT,
    &sensor_saturation::EFFECT,
    &sensor_fold::EFFECT,
    &direction_gain::EFFECT,
    &sensor_hum::EFFECT,
    &sensor_ripple::EFFECT,
];

/// Laws that stand for an effect of the catalogue where a parameter is given that it has not, or at a place where it cannot act.
pub const REFINED: &[&Effect] =
    &[&presliding::COULOMB, &presliding::STRIBECK, &sensor_delay::AT_INPUT, &sensor_saturation::AT_INPUT];

/// All laws that are looked for from the beginning.
pub fn screened() -> impl Iterator<Item = &'static Effect> {
    let refined = [&presliding::COULOMB, &sensor_delay::AT_INPUT, &sensor_saturation::AT_INPUT];
    CATALOGUE.iter().copied().chain(refined)
}

/// Looks an effect up by its id.
pub fn find(id: &str) -> Option<&'static Effect> {
    CATALOGUE.iter().copied().find(|effect| effect.id == id)
}

/// Looks an effect up by its id and parameters that are given for it: its refined law, where only that knows them all.
pub fn find_with<'n>(id: &str, given: impl Iterator<Item = &'n str> + Clone) -> Option<&'static Effect> {
    let knows = |effect: &&Effect| given.clone().all(|name| effect.parameters.iter().any(|p| p.name == name));
    laws_of(id).find(knows).or_else(|| find(id))
}

/// The same, of those laws that may act at a place.
pub(crate) fn find_at<'n>(
    id: &str,
    given: impl Iterator<Item = &'n str> + Clone,
    acts_there: impl Fn(&Effect) -> bool,
) -> Option<&'static Effect> {
    let knows = |effect: &&Effect| given.clone().all(|name| effect.parameters.iter().any(|p| p.name == name));
    laws_of(id).filter(knows).find(|effect| acts_there(effect)).or_else(|| find_with(id, given))
}

/// Names of all parameters that may be given for an effect.
pub fn parameters_of(id: &str) -> Vec<&'static str> {
    let mut names: Vec<&str> = laws_of(id).flat_map(|effect| effect.parameters).map(|own| own.name).collect();
    let mut known = std::collections::HashSet::new();
    names.retain(|name| known.insert(*name));
    names
}

fn laws_of(id: &str) -> impl Iterator<Item = &'static Effect> {
    CATALOGUE.iter().chain(REFINED).copied().filter(move |effect| effect.id == id)
}

/// Where an effect can sit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ActsAt {
    /// A bearing: friction and drag between a node and the ground.
    Bearing,
    /// A node: a torque that acts on it from outside, or its inertia.
    Node,
    /// A spring: a coupling or an elastic shaft.
    Spring,
    /// A gear.
    Gear,
    /// A rigid shaft.
    Shaft,
    /// A channel: what its sensor does to the truth.
    Channel,
}

impl ActsAt {
    /// What such a place is called.
    #[must_use]
    pub fn noun(self) -> &'static str {
        match self {
            Self::Bearing => "a bearing",
            Self::Node => "a node",
            Self::Spring => "a spring",
            Self::Gear => "a gear",
            Self::Shaft => "a rigid shaft",
            Self::Channel => "a channel",
        }
    }
}

/// Parameters that measure how strong an effect is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Amplitude {
    /// Their names. The model is linear in them near the null value.
    pub parameters: &'static [&'static str],
    /// Their value where the effect does nothing.
    pub null: f64,
    /// What of them the model is linear in.
    pub coordinate: Coordinate,
}

impl Amplitude {
    /// Parameters that are zero where there is no effect.
    const fn of(parameters: &'static [&'static str]) -> Self {
        Self { parameters, null: 0.0, coordinate: Coordinate::Value }
    }
}

/// The coordinate in which a model is linear in an amplitude.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Coordinate {
    /// The value itself.
    Value,
    /// Its inverse: a stiffness acts by its compliance.
    Inverse,
}

/// How far the sensitivities at a start predict what an effect does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Linearisation {
    /// At the null value, for any amplitude.
    Null,
    /// At the null value, for small amplitudes only: such an effect is fitted whatever the prediction says.
    NearNull,
    /// Starts are of some amplitude already, and sensitivities hold there.
    NonNull,
    /// Not at all: sensitivities cannot predict the amplitude, and a fit is begun from several starts with all parameters free.
    Restarts,
}

/// What a steady state shows of an effect.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Steady {
    /// Nothing, or nothing that one number measures.
    Unseen,
    /// Its first amplitude, in which all readings are linear.
    Linear,
    /// Two ends of its place turn at different speeds.
    Slips,
}

/// Fitted values of an effect's parameters, for its sentence and for laws that continue from there.
#[derive(Debug, Clone, Copy)]
pub struct Sizes<'v>(pub &'v [(&'v str, f64)]);

impl Sizes<'_> {
    /// A value, SI; NaN where it is not determined, so that no comparison with it holds.
    #[must_use]
    pub fn get(&self, name: &str) -> f64 {
        self.0.iter().find(|(known, _)| *known == name).map_or(f64::NAN, |(_, value)| *value)
    }
}

/// A simpler law in whose place this one may be put once that is fitted.
#[derive(Debug, Clone, Copy)]
pub struct Replaces {
    /// Id of the simpler law.
    pub law: &'static str,
    /// Starts from the simpler law's fitted values: those of this law's parameters that are not carried over as they are.
    pub starts: fn(&Rig, &Sizes<'_>) -> Vec<Values>,
}

/// An effect that recordings do not tell from this one under some condition.
#[derive(Debug, Clone, Copy)]
pub struct Equivalent {
    /// Its id.
    pub effect: &'static str,
    /// When.
    pub holds: Condition,
}

/// A condition for [`Equivalent`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Condition {
    /// At the other of two springs in a row with nothing measured between them.
    InARow,
    /// Likewise, if the stiffness of either is free and could be the other's.
    InARowOfFreeStiffness,
    /// At the same channel, while the amplitude is below this share of the sample time.
    ShorterThanSamples(f64),
    /// While the place always turns the same way.
    OneDirection,
    /// Anything else, as a clause.
    Stated(&'static str),
}

/// One effect of the catalogue.
#[derive(Debug)]
pub struct Effect {
    /// Stable id, as in reports and model files.
    pub id: &'static str,
    /// What it is called within a sentence.
    pub name: &'static str,
    /// Where it may sit.
    pub acts_at: ActsAt,
    /// At which of these places a diagnosis looks for it.
    pub places: Places,
    /// Its parameters.
    pub parameters: &'static [EffectParameter],
    /// Of its place; laws see it after their own parameters.
    pub borrows: Option<Borrowed>,
    /// How it acts.
    pub form: Form,
    /// How strong it is.
    pub amplitude: Amplitude,
    /// How far sensitivities predict what it does.
    pub linearisation: Linearisation,
    /// Points from which to look at a place: amplitude at its null value unless [`Linearisation::NonNull`], the other parameters that a
    /// file must give on a grid of what the rig could show.
    pub starts: fn(&Rig, &str) -> Vec<Values>,
    /// Points from which a fit is begun, from the one with a little of the predicted amplitude and the one with all of it.
    pub fit_starts: fn(&Rig, &str, &Values, &Values) -> Vec<Values>,
    /// Priors of the parameters that a file must give.
    pub priors: fn(&Rig, &str) -> Vec<(&'static str, Prior)>,
    /// How nearly its law is obeyed.
    pub discrepancy: &'static [Discrepancy],
    /// Simpler laws that it may take the place of.
    pub replaces: &'static [Replaces],
    /// What it is mistaken for.
    pub equivalents: &'static [Equivalent],
    /// What of it steady states show.
    pub steady: Steady,
    /// The law, for people.
    pub equation: &'static str,
    /// One sentence for a mechanic that is true of the fitted values.
    pub sentence: fn(&Sizes<'_>) -> &'static str,
    /// Where in a recording it shows.
    pub shows: &'static str,
    /// What to record so that it shows.
    pub experiment: Experiment,
}

impl Effect {
    /// A law that stands in no catalogue: nothing is known of it but what it does.
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

    /// Whether it is a wave of unknown phase: its amplitude is that of two waves, a quarter of a period apart.
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

    /// Whether it changes the network itself, so that it is tried in a model without others of its kind.
    #[must_use]
    pub fn is_structural(&self) -> bool {
        !matches!(self.form, Form::Laws(_)) || self.acts_at == ActsAt::Gear
    }

    /// Starts with large amplitudes, for a base model that is far off: each of [`Self::starts`] with every amplitude at the given
    /// share of its prior (0.5: the median), if that is known.
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

    /// Logarithm of the prior density of fitted values at a place: minus infinity where one of them cannot be.
    #[must_use]
    pub fn log_prior(&self, rig: &Rig, place: &str, values: &[(&str, f64)]) -> f64 {
        let sizes = Sizes(values);
        let each = (self.priors)(rig, place).into_iter().map(|(name, prior)| (sizes.get(name), prior));
        each.filter(|(value, _)| !value.is_nan()).map(|(value, prior)| prior.log_density(value)).sum()
    }

    /// Whether it is play: its law is linear in three regimes, between which teeth meet and part.
    pub(crate) fn is_play(&self) -> bool {
        self.id == backlash::EFFECT.id
    }

    /// Whether some law sees this.
    pub(crate) fn sees(&self, law_input: LawInput) -> bool {
        self.laws().iter().any(|law| law.law_inputs.contains(&law_input))
    }
}

/// Phases from which a wave of unknown phase is begun, rad.
const PHASES: [f64; 4] =
    [0.0, std::f64::consts::FRAC_PI_2, std::f64::consts::PI, 3.0 * std::f64::consts::FRAC_PI_2];

/// A fit begins with a little of the predicted amplitude: the whole of it fits only once all other parameters have moved.
fn begin_with_little(_: &Rig, _: &str, little: &Values, _: &Values) -> Vec<Values> {
    vec![little.clone()]
}

/// The amplitudes of an effect without other parameters, at zero.
fn all_zero<const N: usize>(names: [&'static str; N]) -> Vec<Values> {
    vec![names.map(|name| (name, 0.0)).to_vec()]
}

/// A wave of no size.
fn wave(what: &'static str, value: f64, size: &'static str) -> Values {
    vec![(what, value), (size, 0.0), ("phase", 0.0)]
}

#[cfg(test)]
mod tests;
