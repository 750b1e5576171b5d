//! Readings of sensors: rows of the output equation, and the filters of lags and delays.

use super::{assembly::Class, motion::MotionMaps};
use crate::{
    Channel, ModelError, Quantity, Role, Site, Spring,
    effects::{Acts, Form, sensor_delay},
    jet::{Jet, Scalar},
};

impl MotionMaps<'_, '_> {
    /// Refuses the speed of a static group: it depends on derivatives of the inputs.
    pub(super) fn require_speed(&self, node: usize, who: &str) -> Result<(), ModelError> {
        if self.statics.iter().any(|group| self.a.moves(*group, node)) {
            let place = &self.a.model.nodes[node].name;
            return Err(ModelError::Network(format!(
                "{who} needs the speed of {place}, which has neither inertia nor damper; give it one"
            )));
        }
        Ok(())
    }

    /// What an output would read with a perfect sensor.
    pub(super) fn output_row(&self, channel: &Channel) -> Result<Jet, ModelError> {
        let model = self.a.model;
        if channel.quantity == Quantity::Torque {
            return self.torque_row(channel);
        }
        if channel.quantity == Quantity::Current {
            return self.current_row(channel);
        }
        let node = self.a.node_named(&channel.at, &channel.name)?;
        let row = self.a.node_row(node);
        match channel.quantity {
            Quantity::Speed => {
                self.require_speed(node, &channel.name)?;
                Ok(row.times(&self.velocity))
            }
            Quantity::Angle => Ok(row.times(&self.angle)),
            Quantity::Acceleration if self.is_massive(node) => {
                Ok(self.a.absolute_row(node).times(&self.acceleration))
            }
            Quantity::Acceleration => Err(ModelError::Network(format!(
                "channel {} measures an acceleration, so {} must have an inertia",
                channel.name, model.nodes[node].name
            ))),
            Quantity::Voltage => Err(ModelError::Network(format!(
                "channel {} is a voltage, which drives a motor; write role = \"input\", or measure the current",
                channel.name
            ))),
            Quantity::Signal => Err(ModelError::Network(format!(
                "channel {} is a signal, which laws read; write role = \"input\"",
                channel.name
            ))),
            Quantity::Torque
            | Quantity::Current
            | Quantity::Reference
            | Quantity::Time
            | Quantity::Turned
            | Quantity::Change => Err(ModelError::Network(format!(
                "channel {} is a reference; that can only be an input",
                channel.name
            ))),
        }
    }

    /// Whether each coordinate that moves a node has an inertia.
    fn is_massive(&self, node: usize) -> bool {
        let class = &self.a.class;
        (0..class.len()).all(|group| class[group] == Class::Massive || !self.a.moves(group, node))
    }

    fn current_row(&self, channel: &Channel) -> Result<Jet, ModelError> {
        let found = self.a.model.motors.iter().enumerate().find(|(_, motor)| motor.name == channel.at);
        let Some((index, motor)) = found else {
            return Err(ModelError::Network(format!(
                "channel {} is a current, so it must be at one of the [[motors]], and {} is none",
                channel.name, channel.at
            )));
        };
        if self.currents[index].is_none() {
            self.require_speed(motor.node, &channel.name)?;
        }
        Ok(self.current(index, motor))
    }

    /// Torque through a spring.
    pub(super) fn spring_torque(&self, spring: &Spring) -> Jet {
        let model = self.a.model;
        let twist = self.a.twist_row(spring.from, spring.to);
        let mut torque = twist.times(&self.angle).scaled(&self.a.scalar(spring.stiffness));
        if let Some(damping) = spring.damping {
            torque = torque.plus(&twist.times(&self.velocity).scaled(&self.a.scalar(damping)));
        }
        for (index, input) in model.inputs().enumerate() {
            if self.a.twisted_spring(input).is_some_and(|twisted| twisted.name == spring.name) {
                torque.add_at(0, self.first_input() + index, &self.twisting(spring, input));
            }
        }
        for (index, used) in model.effects.iter().enumerate() {
            if self.a.spring_of(used).is_some_and(|own| own.name == spring.name) {
                for column in self.acting(index, Acts::Torque) {
                    torque.add_at(0, column, &self.one());
                }
            }
        }
        torque
    }

    /// Torque that a servo asks for, before its limit.
    pub(super) fn servo_command(&self) -> Jet {
        let mut torque = self.nothing();
        let Some((row, proportional, derivative)) = self.a.servo_terms() else { return torque };
        torque = torque
            .minus(&row.times(&self.angle).scaled(&proportional))
            .minus(&row.times(&self.velocity).scaled(&derivative));
        for (index, input) in self.a.model.inputs().enumerate() {
            if input.quantity == Quantity::Reference {
                let proportional = proportional.times(&self.gain(input));
                torque.add_at(0, self.first_input() + index, &proportional);
            }
        }
        torque
    }

    fn torque_row(&self, channel: &Channel) -> Result<Jet, ModelError> {
        let model = self.a.model;
        if let Some(spring) = model.springs.iter().find(|spring| spring.name == channel.at) {
            return Ok(self.spring_torque(spring));
        }
        match &model.servo {
            Some(servo) if servo.name == channel.at => {
                let mut torque = self.servo_command();
                for (index, _) in model.effects.iter().enumerate().filter(|(_, used)| used.at == Site::Servo)
                {
                    for column in self.acting(index, Acts::Torque) {
                        torque.add_at(0, column, &self.one());
                    }
                }
                Ok(torque)
            }
            _ => Err(ModelError::Network(format!(
                "channel {} measures a torque at {}, which is neither a spring nor a servo; a rigid part's torque is not known, so write at = one of {}",
                channel.name,
                channel.at,
                model.springs.iter().map(|spring| spring.name.as_str()).collect::<Vec<_>>().join(", "),
            ))),
        }
    }

    /// The reading of a channel with its gain, before its lag or delay and before additions to its reading.
    pub(super) fn true_reading(&self, channel: &Channel) -> Result<Jet, ModelError> {
        if channel.role == Role::Input {
            let mut row = self.nothing();
            let index = self.a.model.inputs().position(|input| input.name == channel.name);
            row.add_at(0, self.first_input() + index.unwrap_or(0), &self.one());
            return Ok(row);
        }
        Ok(self.output_row(channel)?.scaled(&self.gain(channel)))
    }

    /// Applies the lag or delay of a channel: writes the rates of its states to `rates` and returns the filtered reading.
    pub(super) fn filtered(&self, channel: &Channel, rates: &mut Jet, mut reading: Jet) -> Jet {
        let effects = self.a.model.effects.iter().zip(&self.owned);
        for (used, (first, _)) in effects.filter(|(used, _)| used.place == channel.name) {
            let constant = |value: f64| Scalar::constant(value, self.a.wrt.len());
            match used.effect.form {
                Form::Lag => {
                    let rate = self.one().over(&self.a.scalar(used.parameters[0]));
                    rates.add_block(*first, 0, &reading.scaled(&rate));
                    rates.add_at(*first, *first, &rate.times(&constant(-1.0)));
                    reading = self.nothing();
                    reading.add_at(0, *first, &self.one());
                }
                // Each section: a' = b, b' = q (y - a)/d² - p b/d; output y - 2 p/q d b. Scaled: b is stored as d b.
                Form::Delay => {
                    let rate = self.one().over(&self.a.scalar(used.parameters[0]));
                    for (section, (p, q)) in sensor_delay::SECTIONS.into_iter().enumerate() {
                        let [late, later] = [0, 1].map(|state| first + 2 * section + state);
                        rates.add_at(late, later, &rate);
                        rates.add_block(later, 0, &reading.scaled(&rate.times(&constant(q))));
                        rates.add_at(later, late, &rate.times(&constant(-q)));
                        rates.add_at(later, later, &rate.times(&constant(-p)));
                        reading.add_at(0, later, &constant(-2.0 * p / q));
                    }
                }
                Form::Laws(_) | Form::Inertia | Form::Compliance | Form::Mounting | Form::Gain => {}
            }
        }
        reading
    }
}
