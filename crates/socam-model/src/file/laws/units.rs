//! The units of a law's formula against those of its place.

use super::{
    super::{curves::ReadCurve, raw::RawLaw, reader::Reader},
    names::{Meaning, Names, symbols},
};
use crate::{
    Model, ModelError,
    effects::{ActsAt, LawInput, QuantityKind},
    formula::{self, Step},
};

impl Reader<'_> {
    /// SI unit of what a law's curve is drawn over.
    pub(super) fn unit_over(
        &self,
        raw: &RawLaw,
        acts_at: ActsAt,
        names: &Names<'_>,
        model: &Model,
    ) -> String {
        let over = raw.curve.as_ref().map_or("", |curve| curve.get_ref().over.get_ref().as_str());
        let meaning = names.found.iter().find(|(name, _)| *name == over).map(|(_, meaning)| meaning);
        match meaning {
            Some(Meaning::Channel(index)) => model.channels[*index].unit.to_owned(),
            Some(Meaning::Place(LawInput::Reading)) => channel_unit(raw, model).to_owned(),
            Some(Meaning::Place(input)) => {
                let kind = symbols(acts_at).into_iter().find(|(_, own, _)| own == input);
                kind.map_or("1", |(.., kind)| kind.unit(self.rotational)).to_owned()
            }
            _ => "1".to_owned(),
        }
    }

    pub(super) fn check_units(
        &self,
        raw: &RawLaw,
        acts_at: ActsAt,
        steps: &[Step],
        (names, curve): (&Names<'_>, Option<&ReadCurve>),
        model: &Model,
    ) -> Result<(), ModelError> {
        let unit = |kind: QuantityKind| kind.unit(self.rotational);
        let powers = |unit: &str| formula::powers_of(unit).unwrap_or_default();
        let named = |name: &str| {
            let (_, meaning) = names.found.iter().find(|(known, _)| *known == name)?;
            Some(match meaning {
                Meaning::Place(LawInput::Reading) => powers(channel_unit(raw, model)),
                Meaning::Place(input) => {
                    let (.., kind) = symbols(acts_at).into_iter().find(|(_, own, _)| own == input)?;
                    powers(unit(kind))
                }
                Meaning::Channel(index) => powers(model.channels[*index].unit),
                Meaning::Parameter(index) => powers(&self.parameters[*index].file_unit),
                Meaning::Curve => powers(curve.map_or("1", |curve| curve.unit.as_str())),
            })
        };
        let usual = self.usual_units();
        let found = formula::check(raw.formula.get_ref(), steps, &usual, &named)
            .map_err(|problem| self.in_formula(raw, &problem))?;
        let (what, wanted) = match acts_at {
            ActsAt::Channel => ("a reading", channel_unit(raw, model)),
            _ if self.rotational => ("a torque", "N m"),
            _ => ("a force", "N"),
        };
        if found.is(powers(wanted)) {
            return Ok(());
        }
        let (own, wanted_powers) = (found.powers(), powers(wanted));
        let missing = std::array::from_fn(|index| wanted_powers[index] - own[index]);
        let message = format!(
            "laws.{}.formula is in \"{}\", but at {} it gives {what} in \"{wanted}\"; a factor in \"{}\" is missing",
            raw.name.get_ref(),
            formula::unit_of(own, &usual),
            raw.at.get_ref(),
            formula::unit_of(missing, &usual)
        );
        self.fail(&raw.formula, message)
    }

    /// Units by which a formula's units are called.
    fn usual_units(&self) -> Vec<&'static str> {
        use QuantityKind::{Angle, Damping, Drag, Inertia, Ratio, Speed, Stiffness, Time, Torque};
        let kinds = [Ratio, Torque, Speed, Angle, Inertia, Stiffness, Damping, Drag, Time];
        kinds
            .iter()
            .map(|kind| kind.unit(self.rotational))
            .chain(["m", "N", "N m/s", "A", "V", "K"])
            .collect()
    }

    /// Calls the SI units of parameters that the file gives in others by their usual names: a width in rpm is in rad/s, and not in 1/s.
    pub(super) fn name_units(&mut self, names: &Names<'_>) {
        let usual = self.usual_units();
        for (_, index) in names.parameters() {
            let own = &mut self.parameters[index];
            if let Some(powers) = formula::powers_of(&own.file_unit).filter(|_| own.unit != own.file_unit) {
                own.unit = formula::unit_of(powers, &usual);
            }
        }
    }
}

/// Unit of the channel at which a law acts.
fn channel_unit(raw: &RawLaw, model: &Model) -> &'static str {
    model
        .channels
        .iter()
        .find(|channel| channel.name == *raw.at.get_ref())
        .map_or("1", |channel| channel.unit)
}
