//! Torques that inputs and laws apply to the groups of a network.

use super::motion::MotionMaps;
use crate::{
    Channel, Quantity, Site, Spring,
    effects::Acts,
    jet::{Jet, Scalar},
};

impl MotionMaps<'_, '_> {
    /// Torque on each group from inputs and ports.
    pub(super) fn applied_force(&self) -> Jet {
        let mut force = Jet::zeros(self.a.class.len(), self.angle.value.ncols(), self.a.wrt.len());
        for (index, channel) in self.a.model.inputs().enumerate() {
            let column = self.first_input() + index;
            match channel.quantity {
                Quantity::Torque => {
                    if let Some(node) = self.a.model.nodes.iter().position(|node| node.name == channel.at) {
                        let torque = self.a.node_row(node).transpose().scaled(&self.gain(channel));
                        for (column, sign) in self.driving(index, channel) {
                            let sign = Scalar::constant(sign, self.a.wrt.len());
                            force.add_block(0, column, &torque.scaled(&sign));
                        }
                    }
                }
                Quantity::Reference => {
                    if let Some((row, proportional, _)) = self.a.servo_terms() {
                        let proportional = proportional.times(&self.gain(channel));
                        force.add_block(0, column, &row.transpose().scaled(&proportional));
                    }
                }
                Quantity::Angle => {
                    if let Some(spring) = self.a.twisted_spring(channel) {
                        let minus = Scalar::constant(-1.0, self.a.wrt.len());
                        let torque = self.twisting(spring, channel).times(&minus);
                        let twist = self.a.twist_row(spring.from, spring.to);
                        force.add_block(0, column, &twist.transpose().scaled(&torque));
                    }
                }
                // Their torques follow from the currents in `winding_force`.
                Quantity::Voltage | Quantity::Current => {}
                Quantity::Speed
                | Quantity::Acceleration
                | Quantity::Signal
                | Quantity::Time
                | Quantity::Turned
                | Quantity::Change => {}
            }
        }
        force = force.plus(&self.winding_force());
        for (index, used) in self.a.model.effects.iter().enumerate() {
            let on_node = match used.at {
                Site::Node(node) => Some((node, Acts::Torque)),
                Site::Gear { slow, .. } => Some((slow, Acts::Drag)),
                Site::Servo => self.a.model.servo.as_ref().map(|servo| (servo.node, Acts::Torque)),
                Site::Spring(_) | Site::Channel(_) => None,
            };
            if let Some((node, acts)) = on_node {
                for column in self.acting(index, acts) {
                    force.add_block(0, column, &self.a.node_row(node).transpose());
                }
            }
            if let Some(spring) = self.a.spring_of(used) {
                let twist = self.a.twist_row(spring.from, spring.to).transpose();
                let minus = Scalar::constant(-1.0, self.a.wrt.len());
                for column in self.acting(index, Acts::Torque) {
                    force.add_block(0, column, &twist.scaled(&minus));
                }
            }
        }
        force
    }

    /// Torque on each group by the currents of motors. The part of a current that the speed makes is a damping of the assembly, unless the
    /// current is a state.
    fn winding_force(&self) -> Jet {
        let mut force = Jet::zeros(self.a.class.len(), self.angle.value.ncols(), self.a.wrt.len());
        for (index, motor) in self.a.model.motors.iter().enumerate() {
            let current = match self.currents[index] {
                Some(_) => self.current(index, motor),
                None => self.volts(motor).scaled(&self.one().over(&self.a.scalar(motor.resistance))),
            };
            let torque = current.scaled(&self.a.scalar(motor.torque_constant));
            force = force.plus(&self.a.node_row(motor.node).transpose().times(&torque));
        }
        force
    }

    /// Torque through a spring per unit of an input that is added to its twist.
    pub(super) fn twisting(&self, spring: &Spring, channel: &Channel) -> Scalar {
        self.a.scalar(spring.stiffness).times(&self.gain(channel))
    }
}
