//! A fitted nonparametric term as a law of a model file: a curve with its range, or harmonics of an angle.

use socam_model::{NewCurve, NewLaw, NewParameter};

use super::{
    basis::{
        BEARING_ANGLE, BEARING_FRICTION_BY_ANGLE, BEARING_FRICTION_BY_TIME, BEARING_SPEED, BEARING_TIME,
        CHANNEL_GAIN, CHANNEL_READING, SPRING_STIFFNESS, SPRING_TWIST, transition,
    },
    term::{Action, Unexplained},
};

/// Name of the law in the file.
pub(crate) const NAME: &str = "unexplained";
/// Half width of a 95 % interval, standard errors.
const NORMAL_95: f64 = 1.96;

impl Unexplained {
    /// The term as a law.
    pub(crate) fn law(&self) -> NewLaw {
        let is = |effect: &_| std::ptr::eq(self.term.effect, effect);
        let (factor, sum) = (self.factor(), self.sum());
        let resists = [&BEARING_SPEED, &BEARING_ANGLE, &BEARING_TIME].into_iter().any(is);
        let minus = if resists || self.action() == Action::Friction { "-" } else { "" };
        let curve = (!self.term.is_by_turn()).then(|| NewCurve {
            over: if is(&BEARING_SPEED) {
                "speed"
            } else if is(&SPRING_TWIST) {
                "twist"
            } else if is(&CHANNEL_READING) {
                "reading"
            } else {
                "time"
            }
            .into(),
            at: self.term.basis().iter().map(|own| own[0]).collect(),
        });
        NewLaw {
            name: NAME.into(),
            at: self.place.clone(),
            formula: format!("{minus}{sum}{factor}"),
            curve,
            parameters: self.parameters(),
        }
    }

    /// What the curve is multiplied by.
    fn factor(&self) -> &'static str {
        match self.action() {
            Action::Friction => "*tanh(speed/width)",
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
        let unit = match self.action() {
            Action::Gain if std::ptr::eq(self.term.effect, &CHANNEL_GAIN) => "1".to_owned(),
            Action::Gain => {
                let rotates = self.fitted.model.motion == socam_model::Motion::Rotation;
                if rotates { "N m/rad" } else { "N/m" }.to_owned()
            }
            _ => self.curve.torque_unit.clone(),
        };
        let fitted = self.heights.iter().zip(&self.std).enumerate();
        let mut all: Vec<NewParameter> = fitted
            .map(|(index, (height, std))| {
                let [order, phase, _] = self.term.basis()[index];
                let half = NORMAL_95 * std;
                NewParameter {
                    name: if by_turn { harmonic(order, phase) } else { format!("value_{}", index + 1) },
                    value: if std.is_finite() { *height } else { 0.0 },
                    unit: unit.clone(),
                    ci95: std.is_finite().then(|| [height - half, height + half]),
                    is_fixed: !std.is_finite(),
                    is_value: !by_turn,
                }
            })
            .collect();
        let rubs = [&BEARING_FRICTION_BY_ANGLE, &BEARING_FRICTION_BY_TIME];
        if rubs.into_iter().any(|effect| std::ptr::eq(self.term.effect, effect)) {
            let model = &self.fitted.model;
            let rotates = model.motion == socam_model::Motion::Rotation;
            all.push(NewParameter {
                name: "width".into(),
                value: transition(model.motion),
                unit: if rotates { "rad/s" } else { "m/s" }.into(),
                ci95: None,
                is_fixed: true,
                is_value: false,
            });
        }
        all
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
