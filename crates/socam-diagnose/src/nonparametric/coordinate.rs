//! The quantity over which a curve is drawn, as the input of a law.

use socam_model::Motion;

use super::{
    basis::{BEARING_SPEED, CHANNEL_READING, SPRING_TWIST},
    term::Unexplained,
};

/// The input of a law that a curve is drawn over.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Coordinate {
    /// Its name in a formula.
    pub(crate) name: &'static str,
    /// SI unit.
    pub(crate) unit: String,
    /// Whether it is the time.
    pub(crate) is_time: bool,
    /// From where it counts: the start of the recordings, or zero.
    pub(crate) from: f64,
    /// Its largest size in the recordings, from there.
    pub(crate) size: f64,
}

impl Unexplained {
    /// `None` for the angle within a turn.
    pub(crate) fn coordinate(&self) -> Option<Coordinate> {
        if self.term.is_by_turn() {
            return None;
        }
        let is = |effect: &_| std::ptr::eq(self.term.effect, effect);
        let rotates = self.fitted.model.motion == Motion::Rotation;
        let (least, most) = self.term.range;
        let of_place = |name, unit: &str| Coordinate {
            name,
            unit: unit.to_owned(),
            is_time: false,
            from: 0.0,
            size: least.abs().max(most.abs()),
        };
        Some(if is(&BEARING_SPEED) {
            of_place("speed", if rotates { "rad/s" } else { "m/s" })
        } else if is(&SPRING_TWIST) {
            of_place("twist", if rotates { "rad" } else { "m" })
        } else if is(&CHANNEL_READING) {
            of_place("reading", self.term.unit)
        } else {
            Coordinate { is_time: true, from: least, size: most - least, ..of_place("time", "s") }
        })
    }

    /// The free parameter of the model that makes the same as a part of the curve that is proportional to its coordinate: a bearing's damping, or
    /// a spring's stiffness.
    pub(crate) fn slope_beside(&self) -> Option<usize> {
        let model = &self.fitted.model;
        let is = |effect: &_| std::ptr::eq(self.term.effect, effect);
        let own = if is(&BEARING_SPEED) {
            model.bearings.iter().find(|own| own.name == self.place)?.damping?
        } else if is(&SPRING_TWIST) {
            model.springs.iter().find(|own| own.name == self.place)?.stiffness
        } else {
            return None;
        };
        Some(own).filter(|index| !model.parameters[*index].fixed)
    }

    /// The points of the curve: coordinate, height and the height's standard error, SI.
    pub(crate) fn points(&self) -> impl Iterator<Item = (f64, f64, f64)> + '_ {
        let basis = self.term.basis().into_iter();
        basis.zip(&self.heights).zip(&self.std).map(|((own, height), std)| (own[0], *height, *std))
    }
}
