//! A fitted nonparametric term as a law of a model file: a curve with its range, or harmonics of an angle.

use socam_model::{Motion, NewCurve, NewLaw, NewParameter};

use super::{
    basis::{BEARING_ANGLE, BEARING_SPEED, BEARING_TIME, CHANNEL_GAIN, SPRING_STIFFNESS, transition},
    term::{Action, Unexplained},
};

/// Name of the law in the file.
pub(crate) const NAME: &str = "unexplained";
/// Half width of a 95 % interval, standard errors.
const NORMAL_95: f64 = 1.96;

impl Unexplained {
    /// The term as a law.
    pub(crate) fn law(&self) -> NewLaw {
        let curve = self
            .coordinate()
            .map(|over| NewCurve { over: over.name.into(), at: self.points().map(|(at, ..)| at).collect() });
        NewLaw { curve, ..self.law_of(&self.sum(), self.parameters()) }
    }

    /// The law that has a sum in the place of the curve: with its sign, with what the curve is multiplied by, and that factor's parameters.
    pub(crate) fn law_of(&self, sum: &str, mut parameters: Vec<NewParameter>) -> NewLaw {
        let is = |effect: &_| std::ptr::eq(self.term.effect, effect);
        let resists = [&BEARING_SPEED, &BEARING_ANGLE, &BEARING_TIME].into_iter().any(is);
        let minus = if resists || self.action() == Action::Friction { "-" } else { "" };
        if self.action() == Action::Friction {
            let model = &self.fitted.model;
            let unit = if model.motion == Motion::Rotation { "rad/s" } else { "m/s" };
            let transition = NewParameter::free("transition", transition(model.motion), unit);
            parameters.push(NewParameter { is_fixed: true, ..transition });
        }
        NewLaw {
            name: NAME.into(),
            at: self.place.clone(),
            formula: format!("{minus}{sum}{}", self.factor()),
            curve: None,
            parameters,
        }
    }

    /// Unit of the heights of the curve.
    pub(crate) fn height_unit(&self) -> String {
        match self.action() {
            Action::Gain if std::ptr::eq(self.term.effect, &CHANNEL_GAIN) => "1".to_owned(),
            Action::Gain if self.fitted.model.motion == Motion::Rotation => "N m/rad".to_owned(),
            Action::Gain => "N/m".to_owned(),
            Action::Friction | Action::Additive => self.curve.torque_unit.clone(),
        }
    }

    /// What the curve is multiplied by.
    fn factor(&self) -> &'static str {
        match self.action() {
            Action::Friction => "*tanh(speed/transition)",
            Action::Gain if std::ptr::eq(self.term.effect, &SPRING_STIFFNESS) => "*twist",
            Action::Gain => "*reading",
            Action::Additive => "",
        }
    }

    /// The curve's name, or the sum of its harmonics.
    fn sum(&self) -> String {
        if !self.term.is_by_turn() {
            return "curve".into();
        }
        let each = self.term.basis().into_iter().map(|[order, phase, _]| {
            let name = harmonic(order, phase);
            match (order, phase) {
                (0.0, _) => name,
                (1.0, _) => format!("{name}*{}(angle)", if phase == 0.0 { "sin" } else { "cos" }),
                _ => format!("{name}*{}({order}*angle)", if phase == 0.0 { "sin" } else { "cos" }),
            }
        });
        format!("({})", each.collect::<Vec<_>>().join(" + "))
    }

    /// Heights that the recordings do not determine are fixed at zero, as in the fit.
    fn parameters(&self) -> Vec<NewParameter> {
        let by_turn = self.term.is_by_turn();
        let unit = self.height_unit();
        let fitted = self.heights.iter().zip(&self.std).zip(self.term.basis()).enumerate();
        let each = fitted.map(|(index, ((height, std), [order, phase, _]))| {
            let half = NORMAL_95 * std;
            let name = if by_turn { harmonic(order, phase) } else { format!("value_{}", index + 1) };
            NewParameter {
                ci95: std.is_finite().then(|| [height - half, height + half]),
                is_fixed: !std.is_finite(),
                is_value: !by_turn,
                ..NewParameter::free(&name, if std.is_finite() { *height } else { 0.0 }, &unit)
            }
        });
        each.collect()
    }

    /// Range of the curve in words; `None` for harmonics, which repeat.
    pub(crate) fn range(&self) -> Option<String> {
        let (least, most) = (self.curve.x.first()?, self.curve.x.last()?);
        (!self.term.is_by_turn()).then(|| {
            let [least, most] = [least, most].map(|x| crate::words::short(*x));
            format!("{least} to {most} {}", self.curve.unit)
        })
    }
}

/// Name of the amplitude of a harmonic.
fn harmonic(order: f64, phase: f64) -> String {
    match (order, phase) {
        (0.0, _) => "mean".into(),
        (_, 0.0) => format!("sin_{order}"),
        _ => format!("cos_{order}"),
    }
}
