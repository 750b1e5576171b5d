//! Laws of model files as effects. Each different law is made once and lives as long as the process, as the laws of the catalogue do;
//! values of parameters are no part of it, so that a file that is fitted and read again adds none.

use std::{
    collections::HashMap,
    sync::{Mutex, PoisonError},
};

use super::{
    amplitude::Amplitude,
    effect::Effect,
    kinds::{EffectParameter, QuantityKind},
    law::{Acts, Form, Law, LawInput, Rule},
    places::{ActsAt, Places},
    shape,
};
use crate::formula::{CURVE, Curve, Step, Tape, Values, What};

/// Most different laws of model files in one process; it bounds the memory that files can take.
const MOST_LAWS: usize = 2000;

/// A law of a model file without the values of its parameters.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) struct OwnLaw {
    /// Name, as in the file.
    pub(crate) name: String,
    /// Place, as in the file.
    pub(crate) place: String,
    pub(crate) acts_at: ActsAt,
    /// The formula with the inputs' names of [`LawInput::symbol`].
    pub(crate) formula: String,
    pub(crate) inputs: Vec<OwnInput>,
    pub(crate) parameters: Vec<OwnParameter>,
    pub(crate) curve: Option<OwnCurve>,
    /// Whether a diagnosis tests it.
    pub(crate) is_candidate: bool,
}

/// A curve of a law of a model file.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) struct OwnCurve {
    /// Index of the law's input.
    pub(crate) input: usize,
    /// Bits of the positions of its points, SI.
    pub(crate) at: Vec<u64>,
    /// Bits of the values there, SI; where there are none, the law's last parameters are the values.
    pub(crate) values: Vec<u64>,
}

/// An input of a law of a model file.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) enum OwnInput {
    /// One that the place has.
    Place(LawInput),
    /// A channel, and its name in the formula.
    Channel { channel: String, symbol: String },
}

/// A parameter of a law of a model file.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) struct OwnParameter {
    /// Name in the formula.
    pub(crate) name: String,
    /// SI unit.
    pub(crate) unit: String,
    /// Bits of the two bounds, SI.
    pub(crate) bounds: [u64; 2],
}

impl OwnLaw {
    /// The law as an effect. `None` where the process has [`MOST_LAWS`] others already, or the steps do not compile.
    pub(crate) fn effect(self, steps: &[Step]) -> Option<&'static Effect> {
        static KNOWN: Mutex<Option<HashMap<OwnLaw, &'static Effect>>> = Mutex::new(None);
        let mut guard = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
        let known = guard.get_or_insert_with(HashMap::new);
        if let Some(effect) = known.get(&self) {
            return Some(effect);
        }
        if known.len() >= MOST_LAWS {
            return None;
        }
        let effect = self.made(steps)?;
        known.insert(self, effect);
        Some(effect)
    }

    fn made(&self, steps: &[Step]) -> Option<&'static Effect> {
        let inputs: Vec<LawInput> = self.inputs.iter().map(OwnInput::kept).collect();
        let symbols: Vec<&str> = inputs.iter().map(|input| input.symbol()).collect();
        let parameters: Vec<EffectParameter> = self.parameters.iter().map(OwnParameter::kept).collect();
        let names: Vec<&'static str> = parameters.iter().map(|own| own.name).collect();
        let curve = self.curve.as_ref().map(|curve| curve.kept(names.len()));
        let formula = match &curve {
            Some(curve) => with_curve(&self.formula, steps, &curve.formula(symbols[curve.input], &names)),
            None => self.formula.clone(),
        };
        let tape: &Tape = kept(Tape::new(steps, &symbols, &names, curve)?);
        let amplitudes: Vec<&str> = if self.is_candidate {
            tape.amplitudes(names.len()).into_iter().map(|own| names[own]).collect()
        } else {
            Vec::new()
        };
        let law = Law {
            law_inputs: Vec::leak(inputs),
            acts: match self.acts_at {
                ActsAt::Gear => Acts::Drag,
                ActsAt::Channel => Acts::Reading,
                ActsAt::Bearing | ActsAt::Node | ActsAt::Spring | ActsAt::Shaft => Acts::Torque,
            },
            rule: Rule::Formula(tape),
            formula: text(&formula),
            transition: shape::no_transition,
            inactive: shape::never,
        };
        let form = Form::Laws(Vec::leak(vec![law]));
        let name = text(&self.name);
        Some(kept(Effect {
            places: Places::Only(text(&self.place)),
            amplitude: Amplitude::of(Vec::leak(amplitudes)),
            sentence: |_| "A law that the model file holds as a candidate acts here.",
            ..Effect::bare(name, self.acts_at, Vec::leak(parameters), None, form, text(&self.formula))
        }))
    }
}

impl OwnCurve {
    fn kept(&self, parameters: usize) -> Curve {
        let numbers = |bits: &[u64]| bits.iter().map(|bits| f64::from_bits(*bits)).collect::<Vec<f64>>();
        let values = match self.values.as_slice() {
            [] => Values::Parameters((parameters - self.at.len()..parameters).collect()),
            values => Values::Numbers(numbers(values)),
        };
        Curve { input: self.input, at: numbers(&self.at), values }
    }
}

/// A formula with the curve's own formula instead of its name.
fn with_curve(formula: &str, steps: &[Step], curve: &str) -> String {
    let mut text = formula.to_owned();
    for step in steps.iter().rev().filter(|step| matches!(&step.what, What::Name(name) if name == CURVE)) {
        text.replace_range(step.at..step.at + CURVE.len(), &format!("({curve})"));
    }
    text
}

impl OwnInput {
    fn kept(&self) -> LawInput {
        match self {
            Self::Place(input) => *input,
            Self::Channel { channel, symbol } => {
                LawInput::Channel { channel: text(channel), symbol: text(symbol) }
            }
        }
    }
}

impl OwnParameter {
    fn kept(&self) -> EffectParameter {
        EffectParameter {
            name: text(&self.name),
            kind: QuantityKind::Own(text(&self.unit)),
            default: None,
            bounds: (f64::from_bits(self.bounds[0]), f64::from_bits(self.bounds[1])),
        }
    }
}

fn kept<T>(value: T) -> &'static T {
    Box::leak(Box::new(value))
}

fn text(text: &str) -> &'static str {
    Box::leak(text.into())
}

impl Effect {
    /// Whether it is a law of a model file.
    #[must_use]
    pub fn is_own(&self) -> bool {
        matches!(self.places, Places::Only(_))
    }

    /// Indices of the parameters by which a formula divides: they must not be zero.
    pub(crate) fn divisors(&self) -> Vec<usize> {
        let tapes = self.laws().iter().filter_map(|law| match law.rule {
            Rule::Formula(tape) => Some(tape),
            Rule::Code(_) => None,
        });
        tapes.flat_map(Tape::divisors).collect()
    }
}
