//! The types that the definition of an effect uses.

pub(super) use super::{
    amplitude::{Amplitude, Coordinate, Linearisation, Steady},
    discrepancy::Discrepancy,
    effect::Effect,
    family::Family,
    kinds::{ANY, EffectParameter, POSITIVE, QuantityKind},
    law::{Acts, Borrowed, Form, Law, LawInput, Response, Rule},
    places::{ActsAt, Places},
    prior::Prior,
    relations::{Condition, Equivalent, FittedValues, Replaces},
    rig::{Rig, Values},
    starts::{all_zero, begin_with_little, wave},
};
