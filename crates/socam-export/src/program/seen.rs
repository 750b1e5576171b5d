//! Inputs of laws, and the places where laws act.

use socam_model::{Quantity, Site, effects::Acts};

use super::builder::{Builder, minus, name, times};
use crate::{description::Signal, formula::Formula};

/// Inputs of laws by their symbols.
pub(crate) type Seen = Vec<(&'static str, Formula)>;

impl Builder<'_, '_> {
    /// Names the states of effects.
    pub(crate) fn name_states(&mut self) {
        for used in 0..self.d.model.effects.len() {
            let count =
                self.d.model.effects[used].effect.laws().iter().filter(|law| law.acts == Acts::State).count();
            let wanted = format!("state_{}", self.d.effects[used]);
            let own = (0..count).map(|_| self.d.names.unique(&wanted)).collect();
            self.own_states.push(own);
        }
    }

    /// Twist of a spring and its rate.
    pub(crate) fn twist(&self, spring: usize) -> (Formula, Formula) {
        let spring = &self.d.model.springs[spring];
        let between = |from: &str, to: Option<&String>| match to {
            Some(to) => minus(name(from), name(to)),
            None => name(from),
        };
        let (from, to) = (&self.d.points[spring.from], spring.to.map(|to| &self.d.points[to]));
        (between(&from.angle, to.map(|to| &to.angle)), between(&from.speed, to.map(|to| &to.speed)))
    }

    /// Inputs of the laws of an effect at a spring or gear.
    pub(crate) fn seen_at_spring(&self, used: usize, spring: usize) -> Seen {
        let (twist, rate) = self.twist(spring);
        let mut bound = vec![("twist", twist), ("twist_rate", rate)];
        if let Site::Gear { fast, slow, .. } = self.d.model.effects[used].at {
            bound.push(("angle", name(&self.d.points[fast].angle)));
            bound.push(("speed", name(&self.d.points[slow].speed)));
        }
        bound
    }

    /// Effects whose laws act through a spring.
    pub(crate) fn effects_at(&self, spring: usize) -> Vec<usize> {
        let here =
            |at: Site| matches!(at, Site::Spring(own) | Site::Gear { contact: own, .. } if own == spring);
        (0..self.d.model.effects.len()).filter(|used| here(self.d.model.effects[*used].at)).collect()
    }

    /// The node on which an effect acts from outside, how its laws act there, and what they see; `None` elsewhere.
    pub(crate) fn seen_at_node(&self, used: usize) -> Option<(usize, Acts, Seen)> {
        match self.d.model.effects[used].at {
            Site::Node(node) => {
                let point = &self.d.points[node];
                Some((node, Acts::Torque, vec![("speed", name(&point.speed)), ("angle", name(&point.angle))]))
            }
            Site::Gear { fast, slow, contact } => {
                let bound = vec![
                    ("speed", name(&self.d.points[slow].speed)),
                    ("angle", name(&self.d.points[fast].angle)),
                    ("through", name(&self.through[contact])),
                ];
                Some((slow, Acts::Drag, bound))
            }
            Site::Spring(_) | Site::Channel(_) | Site::Servo => None,
        }
    }

    /// Torque of the servo.
    pub(crate) fn servo(&self) -> Option<(usize, Formula)> {
        let servo = self.d.model.servo.as_ref()?;
        let point = &self.d.points[servo.node];
        let [position, velocity, drive] =
            [servo.position_gain, servo.velocity_gain, servo.drive_gain].map(|gain| self.parameter(gain));
        let reference = self.d.inputs.iter().find(|signal| signal.channel.quantity == Quantity::Reference);
        let reference = reference.map_or(Formula::Number(0.0), |signal| self.gained(signal));
        let error = minus(times(position, minus(reference, name(&point.angle))), name(&point.speed));
        Some((servo.node, times(times(drive, velocity), error)))
    }

    /// An input times its gain.
    pub(crate) fn gained(&self, signal: &Signal<'_>) -> Formula {
        let read = name(&signal.identifier);
        self.d.gain(signal).map_or(read.clone(), |gain| times(gain, read))
    }
}
