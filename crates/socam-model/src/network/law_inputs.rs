//! The inputs of laws: for each port a row over states, inputs and ports.

use super::motion::MotionMaps;
use crate::{
    EffectUse, ModelError, Quantity, Site,
    effects::LawInput,
    file,
    jet::{Jet, Scalar},
};

impl MotionMaps<'_, '_> {
    /// The row of a port's input.
    pub(super) fn seen(&self, port: usize) -> Result<Jet, ModelError> {
        let effect = self.port_owner[port];
        let used = &self.a.model.effects[effect];
        let Some(law_input) = self.ports[port].law.law_inputs.get(self.ports[port].law_input) else {
            return Ok(self.nothing());
        };
        let node = match used.at {
            Site::Node(node) => Some(node),
            Site::Gear { fast, slow, .. } => Some(if *law_input == LawInput::Angle { fast } else { slow }),
            Site::Spring(_) | Site::Servo => None,
            Site::Channel(channel) => self.a.shaft_of(&self.a.model.channels[channel]),
        };
        let spring = self.a.spring_of(used);
        let twist = spring.map(|spring| self.a.twist_row(spring.from, spring.to));
        Ok(match (law_input, node, twist) {
            (LawInput::Speed, Some(node), _) => {
                self.require_speed(node, used.effect.id)?;
                self.node_velocity(node)
            }
            (LawInput::Angle, Some(node), _) => self.turned(node, used)?,
            (LawInput::Twist, _, Some(twist)) => twist.times(&self.angle),
            (LawInput::TwistRate, _, Some(twist)) => {
                let ends = spring.into_iter().flat_map(|spring| [Some(spring.from), spring.to]);
                ends.flatten().try_for_each(|node| self.require_speed(node, used.effect.id))?;
                twist.times(&self.velocity)
            }
            (LawInput::Torque, ..) if used.at == Site::Servo => self.servo_command(),
            (LawInput::Torque, ..) => {
                spring.map_or_else(|| self.nothing(), |spring| self.spring_torque(spring))
            }
            (LawInput::Time, ..) => self.clock(Quantity::Time),
            (LawInput::Change, ..) => self.input_named(&file::change_of(&used.place)),
            (LawInput::Channel { channel, .. }, ..) => self.true_value(channel)?,
            (LawInput::State, ..) => {
                let mut row = self.nothing();
                row.add_at(0, self.owned[effect].0, &self.one());
                row
            }
            (LawInput::Reading, ..) => match used.at {
                Site::Channel(channel) => self.true_reading(&self.a.model.channels[channel])?,
                _ => self.nothing(),
            },
            (LawInput::Speed | LawInput::Angle | LawInput::Twist | LawInput::TwistRate, ..) => self.nothing(),
        })
    }

    fn node_velocity(&self, node: usize) -> Jet {
        self.a.node_row(node).times(&self.velocity)
    }

    fn input_named(&self, name: &str) -> Jet {
        let mut row = self.nothing();
        if let Some(index) = self.a.model.inputs().position(|input| input.name == name) {
            row.add_at(0, self.first_input() + index, &self.one());
        }
        row
    }

    /// The true value of an input, or what the model predicts of an output, without gain and lag.
    fn true_value(&self, name: &str) -> Result<Jet, ModelError> {
        let model = self.a.model;
        if let Some((index, input)) = model.inputs().enumerate().find(|(_, input)| input.name == name) {
            let mut row = self.nothing();
            let gain = self.gain(input);
            for (column, sign) in self.driving(index, input) {
                let sign = Scalar::constant(sign, self.a.wrt.len());
                row.add_at(0, column, &gain.times(&sign));
            }
            return Ok(row);
        }
        match model.outputs().find(|output| output.name == name) {
            Some(output) => self.output_row(output),
            None => Ok(self.nothing()),
        }
    }

    fn clock(&self, quantity: Quantity) -> Jet {
        let mut row = self.nothing();
        if let Some(index) = self.a.model.inputs().position(|input| input.quantity == quantity) {
            row.add_at(0, self.first_input() + index, &self.one());
        }
        row
    }

    /// Angle through which a node has turned: the angle of the shaft whose turned angle is an input, plus the twist of the springs
    /// between that shaft and the node.
    fn turned(&self, node: usize, used: &EffectUse) -> Result<Jet, ModelError> {
        let angle = |node: usize| self.a.node_row(node).times(&self.angle);
        let clock = self.a.model.inputs().find(|input| input.quantity == Quantity::Turned);
        // With a differential, angles are absolute: the turned angle of one shaft does not give that of another.
        let Some(clock) = clock.filter(|_| self.a.model.differentials.is_empty()) else {
            return Ok(angle(node));
        };
        let from = self.a.node_named(&clock.at, &clock.name)?;
        let lost = || {
            ModelError::Network(format!(
                "{} at {} needs the angle of {}, which nothing ties to {}",
                used.effect.id, used.place, self.a.model.nodes[node].name, clock.at
            ))
        };
        let mode = self.a.rigid_mode(self.a.group[from]).ok_or_else(lost)?;
        let ratio = mode[self.a.group[node]].times(&self.a.lever[node]).over(&self.a.lever[from]);
        Ok(self.clock(Quantity::Turned).scaled(&ratio).plus(&angle(node)).minus(&angle(from).scaled(&ratio)))
    }
}
