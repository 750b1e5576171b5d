//! A nonparametric term: where it acts, on what it depends and how it enters the model; and one that was fitted.

use socam_identify::comparison::CandidateScore;
use socam_model::{Model, Motion, effects::Effect};

use super::{
    basis::{
        BEARING_ANGLE, BEARING_FRICTION_BY_ANGLE, BEARING_FRICTION_BY_TIME, BEARING_SPEED, CHANNEL_GAIN,
        SPRING_STIFFNESS,
    },
    formula::FoundFormula,
};
use crate::{
    context::FittedModel,
    criterion::Difference,
    document::{Curve, Over},
};

/// Centres of the raised cosines of a curve, as shares of the distance from the middle of its range to its end: evenly spaced, and over the
/// speed of a bearing with more of them at standstill, where laws of friction bend.
const EVEN: &[f64] = &[-1.0, -0.75, -0.5, -0.25, 0.0, 0.25, 0.5, 0.75, 1.0];
const CLOSER_TO_REST: &[f64] =
    &[-1.0, -0.75, -0.5, -0.25, -0.125, -0.0625, 0.0, 0.0625, 0.125, 0.25, 0.5, 0.75, 1.0];
/// Number of orders of a curve over one turn.
const ORDERS: usize = 4;
/// Number of intervals at which a curve over one turn is drawn.
const TURN_INTERVALS: i32 = 36;

/// An unknown torque at a place, or an unknown error of a channel, as a smooth function of one quantity.
#[derive(Debug, Clone)]
pub(crate) struct NonparametricTerm {
    /// The basis function by which it enters the model.
    pub(super) effect: &'static Effect,
    pub(super) place: String,
    /// The quantity on which it depends.
    pub(super) over: Over,
    pub(super) unit: &'static str,
    /// Range of that quantity in the recordings, SI.
    pub(super) range: (f64, f64),
    /// Units of the curve's abscissa per unit of the range: a twist is drawn as the torque that belongs to it.
    pub(super) scale: f64,
    /// Units of the curve's ordinate per unit of a basis function's height: a gain is drawn as the error of the largest reading, a
    /// stiffness as the torque of the largest twist.
    pub(super) height: f64,
}

/// A nonparametric term with its score and its family-wise p-value.
pub(super) struct ScoredTerm {
    pub(super) term: NonparametricTerm,
    pub(super) score: CandidateScore,
    pub(super) p_value: f64,
}

/// How a nonparametric term acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Action {
    /// It is added to a torque or a reading.
    Additive,
    /// It multiplies a sensor's reading, or a spring's twist.
    Gain,
    /// It is a friction torque against the motion.
    Friction,
}

/// A nonparametric term that was fitted and gains in cross-validation.
#[derive(Debug, Clone)]
pub(crate) struct Unexplained {
    pub(crate) place: String,
    pub(super) term: NonparametricTerm,
    /// Standard error of each height, SI; infinite where the recordings do not determine it.
    pub(super) std: Vec<f64>,
    /// Fitted heights, SI.
    pub(super) heights: Vec<f64>,
    /// The last model with the term, at its fit.
    pub(crate) fitted: FittedModel,
    /// A formula in its place, where one was sought and found.
    pub(crate) formula: Option<FoundFormula>,
    pub(crate) curve: Curve,
    pub(crate) p_value: f64,
    /// Gain over the last model without the term.
    pub(crate) gain: Difference,
    /// Share of the last model's training deviance that the term removes, per cent.
    pub(crate) misfit_percent: f64,
}

impl NonparametricTerm {
    /// Parameters behind the height of each basis function: centre and widths below and above it of a raised cosine, or order and phase of a
    /// harmonic.
    pub(super) fn basis(&self) -> Vec<[f64; 3]> {
        if self.is_by_turn() {
            let quarter = std::f64::consts::FRAC_PI_2;
            // Friction over a turn also has a mean.
            let mean = (self.action() == Action::Friction).then_some([0.0, quarter, 0.0]);
            let waves =
                (1..=ORDERS).flat_map(|order| [[order as f64, 0.0, 0.0], [order as f64, quarter, 0.0]]);
            return mean.into_iter().chain(waves).collect();
        }
        let shares = if self.is_any_of(&[&BEARING_SPEED]) { CLOSER_TO_REST } else { EVEN };
        let (middle, half) = (0.5 * (self.range.0 + self.range.1), 0.5 * (self.range.1 - self.range.0));
        let centres: Vec<f64> = shares.iter().map(|share| middle + half * share).collect();
        let gaps: Vec<f64> = centres.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let last = gaps.len() - 1;
        let each = centres.iter().enumerate();
        each.map(|(point, centre)| [*centre, gaps[point.saturating_sub(1)], gaps[point.min(last)]]).collect()
    }

    /// Heights with which the term follows the law of an effect that was fitted at its place; `None` where that law does not depend on the
    /// term's quantity alone.
    pub(super) fn heights_of(&self, named: &FittedModel) -> Option<Vec<f64>> {
        let FittedModel { model, at, .. } = named;
        let used = model.effects.last().filter(|used| used.place == self.place)?;
        let ([law], [own]) = (used.effect.laws(), self.effect.laws()) else { return None };
        let is_alike = law.law_inputs == own.law_inputs && law.acts == own.acts;
        if !is_alike || used.effect.borrows.is_some() || self.is_by_turn() {
            return None;
        }
        let parameters: Vec<f64> = used.parameters.iter().map(|index| at.values[*index]).collect();
        let height = |[centre, below, above]: [f64; 3]| {
            let of_one = own.evaluate(&[centre], &[1.0, centre, below, above]).torque;
            law.evaluate(&[centre], &parameters).torque / of_one
        };
        Some(self.basis().into_iter().map(height).collect())
    }

    /// Whether no effect of the catalogue resembles the term, so that no candidate would indicate it: a stiffness that changes with time.
    pub(super) fn is_outside_catalogue(&self) -> bool {
        self.is_any_of(&[&SPRING_STIFFNESS])
    }

    /// Whether the term is periodic in a bearing's angle.
    pub(super) fn is_by_turn(&self) -> bool {
        self.is_any_of(&[&BEARING_ANGLE, &BEARING_FRICTION_BY_ANGLE])
    }

    pub(super) fn action(&self) -> Action {
        if self.is_any_of(&[&CHANNEL_GAIN, &SPRING_STIFFNESS]) {
            Action::Gain
        } else if self.is_any_of(&[&BEARING_FRICTION_BY_ANGLE, &BEARING_FRICTION_BY_TIME]) {
            Action::Friction
        } else {
            Action::Additive
        }
    }

    fn is_any_of(&self, effects: &[&'static Effect]) -> bool {
        effects.iter().any(|effect| std::ptr::eq(*effect, self.effect))
    }

    /// The curve that fitted heights make. A point that the recordings do not determine is missing.
    pub(super) fn curve(&self, model: &Model, heights: &[f64], std: &[f64]) -> Curve {
        let basis = self.basis();
        let known = |std: f64| Some(std).filter(|std| std.is_finite());
        let (x, torque, torque_std): (Vec<f64>, Vec<Option<f64>>, Vec<Option<f64>>) = if self.is_by_turn() {
            let x: Vec<f64> = (0..=TURN_INTERVALS)
                .map(|k| std::f64::consts::TAU * f64::from(k) / f64::from(TURN_INTERVALS))
                .collect();
            let at = |x: &f64| basis.iter().zip(heights).map(|(p, h)| h * (p[0] * x + p[1]).sin()).sum();
            let std = std.iter().filter(|std| std.is_finite()).map(|std| std * std).sum::<f64>() / 2.0;
            (x.clone(), x.iter().map(at).map(Some).collect(), vec![known(std.sqrt()); x.len()])
        } else {
            let heights =
                heights.iter().zip(std).map(|(height, std)| std.is_finite().then_some(height * self.height));
            let x = basis.iter().map(|function| function[0] * self.scale).collect();
            (x, heights.collect(), std.iter().map(|std| known(std * self.height)).collect())
        };
        let channel = model.channels.iter().find(|channel| channel.name == self.place);
        let own = if model.motion == Motion::Rotation { "N m" } else { "N" };
        Curve {
            over: self.over,
            unit: self.unit.into(),
            x,
            torque,
            torque_std,
            torque_unit: channel.map_or(own, |channel| channel.unit).into(),
        }
    }
}

impl Unexplained {
    /// The last model with the formula or, where there is none, the curve, at its fit.
    pub(crate) fn whole(&self) -> &FittedModel {
        self.formula.as_ref().map_or(&self.fitted, |formula| &formula.fitted)
    }

    pub(crate) fn action(&self) -> Action {
        self.term.action()
    }
}
