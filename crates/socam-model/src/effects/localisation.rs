//! Places of a model at which an effect may act, and at which a diagnosis tests it.

use super::{
    catalogue::{find_with, screened},
    effect::Effect,
    kinds::QuantityKind,
    law::{Borrowed, Form, LawInput},
    places::{ActsAt, Places, is_part},
};
use crate::{CandidateLaw, Channel, ChannelTransform, Model, Motion, Quantity, Role};

impl Model {
    /// The candidate of the file with this name.
    #[must_use]
    pub fn candidate(&self, name: &str) -> Option<&CandidateLaw> {
        self.candidates.iter().find(|own| own.effect.id == name)
    }

    /// The candidate of the file with this id, or the effect of the catalogue with this id and these parameters, see [`find_with`].
    pub fn effect_with<'n>(
        &self,
        id: &str,
        given: impl Iterator<Item = &'n str> + Clone,
    ) -> Option<&'static Effect> {
        self.candidate(id).map(|own| own.effect).or_else(|| find_with(id, given))
    }

    /// All effects that a diagnosis tests in its first score test: those of [`screened`] and the candidates of the file.
    pub fn screened(&self) -> impl Iterator<Item = &'static Effect> + '_ {
        screened().chain(self.candidates.iter().map(|own| own.effect))
    }

    /// SI unit of a parameter of this kind at a place. [`QuantityKind::Gain`] has the unit of the channel of that name, or "1" where there is none.
    ///
    /// ```
    /// use socam_model::{Model, effects::QuantityKind};
    ///
    /// let model = Model::builtin("two-mass").expect("an embedded model");
    /// assert_eq!(model.unit_at(QuantityKind::Torque, "load_bearing"), "N m");
    /// assert_eq!(model.unit_at(QuantityKind::Gain, "load_speed"), "rad/s");
    /// ```
    #[must_use]
    pub fn unit_at(&self, kind: QuantityKind, place: &str) -> &str {
        match kind.unit(self.motion == Motion::Rotation) {
            "" => {
                self.channels.iter().find(|channel| channel.name == place).map_or("1", |channel| channel.unit)
            }
            unit => unit,
        }
    }

    /// Names of the places at which an effect may act, in the model's order; a model file may name any of them.
    ///
    /// ```
    /// use socam_model::{Model, effects};
    ///
    /// let model = Model::builtin("two-mass").expect("an embedded model");
    /// let offset = effects::find("sensor_offset").expect("an effect of the catalogue");
    /// assert_eq!(model.places(offset), ["motor_torque", "motor_speed", "load_speed"]);
    /// ```
    pub fn places(&self, effect: &Effect) -> Vec<&str> {
        let mut all = self.places_of_kind(effect);
        if let Places::Only(place) = effect.places {
            all.retain(|own| *own == place);
        }
        all
    }

    fn places_of_kind(&self, effect: &Effect) -> Vec<&str> {
        match effect.acts_at {
            ActsAt::Bearing => {
                let needs = effect.borrows == Some(Borrowed::Damping);
                let bearings = self.bearings.iter().filter(|bearing| !needs || bearing.damping.is_some());
                bearings.map(|bearing| &*bearing.name).collect()
            }
            ActsAt::Node => self.nodes.iter().map(|node| &*node.name).collect(),
            ActsAt::Spring => self.springs.iter().map(|spring| &*spring.name).collect(),
            ActsAt::Gear => self.gears.iter().map(|gear| &*gear.name).collect(),
            ActsAt::Shaft => self.shafts.iter().map(|shaft| &*shaft.name).collect(),
            ActsAt::Channel => {
                let of_outputs =
                    matches!(effect.form, Form::Lag | Form::Delay) || effect.sees(LawInput::Reading);
                let fits = |channel: &&Channel| match effect.places {
                    Places::Sensors => channel.role == Role::Output,
                    Places::Channels | Places::Only(_) => true,
                    // The rate of an input can be computed only from a column that is read as it is.
                    Places::Inputs => {
                        channel.role == Role::Input && channel.transform == ChannelTransform::Value
                    }
                    Places::Every | Places::Load | Places::Driven | Places::DrivenOnAFrame | Places::Free => {
                        channel.role == Role::Output || !of_outputs
                    }
                };
                self.channels.iter().filter(fits).map(|channel| &*channel.name).collect()
            }
        }
    }
}

impl Model {
    /// Name of the node on which an input acts: its own place, or the node of its motor or servo.
    fn driven_node<'a>(&'a self, input: &'a Channel) -> Option<&'a str> {
        let motors = self.motors.iter().map(|motor| (&motor.name, motor.node));
        let servos = self.servo.iter().map(|servo| (&servo.name, servo.node));
        let driver = motors.chain(servos).find(|(name, _)| **name == input.at);
        driver.map_or(Some(&*input.at), |(_, node)| Some(&*self.nodes.get(node)?.name))
    }
}

impl Effect {
    /// Names of the places of a model at which a diagnosis tests the effect: those of [`Model::places`] that [`Self::places`] selects, without
    /// gear contacts, clocks and signals.
    ///
    /// ```
    /// use socam_model::{Model, effects};
    ///
    /// let model = Model::builtin("two-mass").expect("an embedded model");
    /// let load = effects::find("constant_load").expect("an effect of the catalogue");
    /// assert_eq!(model.places(load), ["motor", "load"]);
    /// assert_eq!(load.places_in(&model), ["load"]);
    /// ```
    #[must_use]
    pub fn places_in(&self, model: &Model) -> Vec<String> {
        let moves = |input: &Channel| input.quantity.drives();
        let driven =
            |name: &str| model.inputs().any(|input| moves(input) && model.driven_node(input) == Some(name));
        let prescribed =
            |name: &str| model.inputs().any(|input| input.quantity == Quantity::Speed && input.at == name);
        let massive = |name: &str| model.nodes.iter().any(|node| node.name == name && node.inertia.is_some());
        let name = |node: usize| model.nodes[node].name.as_str();
        let behind_drive = |place: &str| {
            let mut joined =
                model.springs.iter().filter_map(|spring| Some((name(spring.from), name(spring.to?))));
            massive(place)
                && joined.any(|(a, b)| (a == place && prescribed(b)) || (b == place && prescribed(a)))
        };
        let channel = |name: &str| model.channels.iter().find(|channel| channel.name == name);
        let all = model.places(self).into_iter().filter(|place| is_part(place));
        let is_sensor = |place: &str| channel(place).is_some_and(|c| c.quantity.drives());
        let mut all = all.filter(|place| self.acts_at != ActsAt::Channel || is_sensor(place));
        let kept: Vec<&str> = match self.places {
            Places::Every | Places::Channels | Places::Inputs | Places::Only(_) => all.collect(),
            Places::Load => all.rfind(|place| massive(place) && !prescribed(place)).into_iter().collect(),
            Places::Driven => {
                all.filter(|place| !prescribed(place) && (driven(place) || behind_drive(place))).collect()
            }
            Places::DrivenOnAFrame if model.inputs().any(|input| input.quantity == Quantity::Speed) => {
                Vec::new()
            }
            Places::DrivenOnAFrame => all.find(|place| driven(place)).into_iter().collect(),
            Places::Free => all.filter(|place| !prescribed(place)).collect(),
            Places::Sensors => {
                all.filter(|place| channel(place).is_some_and(|c| c.role == Role::Output)).collect()
            }
        };
        kept.into_iter().map(str::to_owned).collect()
    }
}
