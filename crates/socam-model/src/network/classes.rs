//! The class of each group of a network: prescribed by an input, massive, damped, or static.

use super::assembly::{Assembly, Class};
use crate::{Channel, ModelError, Quantity, Site, effects::Form};

impl Assembly<'_> {
    /// Sets the class of each group, and checks that each input acts where it can.
    ///
    /// # Errors
    /// [`ModelError::Network`] for an input of a quantity that cannot drive its place, and for two inputs that prescribe one speed.
    pub(super) fn classify(&mut self) -> Result<(), ModelError> {
        for group in 0..self.class.len() {
            self.class[group] = self.structural_class(group);
        }
        let model = self.model;
        for channel in model.inputs() {
            self.check_input(channel)?;
            if channel.quantity != Quantity::Speed {
                continue;
            }
            let node = self.node_named(&channel.at, &channel.name)?;
            let class = &mut self.class[self.group[node]];
            if *class == Class::Mixed {
                return Err(ModelError::Network(format!(
                    "channel {} prescribes the speed of {}, which a differential moves; prescribe the speeds of the nodes that move it",
                    channel.name, channel.at
                )));
            }
            if *class == Class::Prescribed {
                return Err(ModelError::Network(format!(
                    "channel {} prescribes a speed that another input prescribes already; make one of them an output",
                    channel.name
                )));
            }
            *class = Class::Prescribed;
        }
        Ok(())
    }

    /// The class of a group before inputs are considered. It depends on which parameters a group has and not on their values: a damping
    /// that an estimator moves to zero must not change the states.
    fn structural_class(&self, group: usize) -> Class {
        let model = self.model;
        if !self.is_free(group) {
            return Class::Mixed;
        }
        if self.frame == Some(group) {
            return Class::Massive;
        }
        let members = || (0..model.nodes.len()).filter(|node| self.moves(group, *node));
        let adds_inertia = |node: usize| {
            let mut effects = model.effects.iter();
            effects.any(|used| matches!(used.effect.form, Form::Inertia) && used.at == Site::Node(node))
        };
        let is_damped = |node: usize| {
            model.springs.iter().any(|s| (s.from == node || s.to == Some(node)) && s.damping.is_some())
                || model.bearings.iter().any(|b| b.node == node && b.damping.is_some())
                || model.motors.iter().any(|motor| motor.node == node && motor.inductance.is_none())
                || model.servo.as_ref().is_some_and(|servo| servo.node == node)
        };
        if members().any(|node| model.nodes[node].inertia.is_some() || adds_inertia(node)) {
            Class::Massive
        } else if members().any(is_damped) {
            Class::Damped
        } else {
            Class::Static
        }
    }

    /// Whether an input of this quantity can act at its place.
    fn check_input(&self, channel: &Channel) -> Result<(), ModelError> {
        let fail = |message: String| Err(ModelError::Network(message));
        match channel.quantity {
            Quantity::Speed | Quantity::Torque => self.node_named(&channel.at, &channel.name).map(|_| ()),
            Quantity::Reference
                if self.model.servo.as_ref().is_some_and(|servo| servo.name == channel.at) =>
            {
                Ok(())
            }
            Quantity::Reference => fail(format!(
                "channel {} is a reference, so it must be at the servo; write at = the name of a [servo]",
                channel.name
            )),
            Quantity::Voltage if self.model.motors.iter().any(|motor| motor.name == channel.at) => Ok(()),
            Quantity::Voltage => fail(format!(
                "channel {} is a voltage, so it must be at one of the [[motors]], and {} is none; write a [[motors]] table with at = \"{}\", and its name here",
                channel.name, channel.at, channel.at
            )),
            Quantity::Angle if self.twisted_spring(channel).is_some() => Ok(()),
            Quantity::Angle => fail(format!(
                "channel {} is an angle; as an input it is added to the twist of a spring, and {} is none; the motion of a node is given as quantity = \"speed\", of an encoder's column with take = \"rate\"",
                channel.name, channel.at
            )),
            Quantity::Signal | Quantity::Time | Quantity::Turned | Quantity::Change => Ok(()),
            Quantity::Current => fail(format!(
                "channel {} is a current, which is an output of a motor; where it drives the model, write quantity = \"torque\", at = a node and scale = the torque constant",
                channel.name
            )),
            Quantity::Acceleration => fail(format!(
                "channel {} cannot drive the model: give a speed or a torque as input",
                channel.name
            )),
        }
    }
}
