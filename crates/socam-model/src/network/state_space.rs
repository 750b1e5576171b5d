//! State-space matrices from the maps of velocities and accelerations.

use super::{assembly::Reference, motion::MotionMaps, ports::states_of};
use crate::{
    Equations, ModelError, Role,
    effects::Acts,
    equations::SystemRows,
    jet::{Jet, Scalar},
};

impl MotionMaps<'_, '_> {
    pub(super) fn equations(&self) -> Result<(Equations, Vec<Equations>), ModelError> {
        let model = self.a.model;
        let all: Vec<usize> = (0..self.angle.value.ncols()).collect();
        let (states, ports) = (self.first_input(), self.ports.len());
        let count = self.a.wrt.len();
        let mut rates = Jet::zeros(states, all.len(), count);
        rates.add_block(0, 0, &self.angle_rates());
        rates.add_block(self.angles.len(), 0, &self.acceleration.select(&self.massive, &all));
        for (index, (first, _)) in self.owned.iter().enumerate() {
            for column in self.acting(index, Acts::State) {
                rates.add_at(*first, column, &self.one());
            }
        }
        for (index, motor) in model.motors.iter().enumerate() {
            if let Some((column, rate)) = self.current_rate(index, motor) {
                rates.add_block(column, 0, &rate);
            }
        }
        let outputs: Vec<_> = model.channels.iter().filter(|channel| channel.role == Role::Output).collect();
        let mut observed = Jet::zeros(outputs.len(), all.len(), count);
        for (row, channel) in outputs.iter().enumerate() {
            let mut reading = self.filtered(channel, &mut rates, self.true_reading(channel)?);
            for column in self.read_beside(channel) {
                reading.add_at(0, column, &self.one());
            }
            observed.add_block(row, 0, &reading);
        }
        let mut seen = Jet::zeros(ports, all.len(), count);
        for port in 0..ports {
            seen.add_block(port, 0, &self.seen(port)?);
        }
        let rows = SystemRows { rates, observed, seen };
        let (equations, derivatives) = rows.split([states, self.inputs, ports]);
        let transforms = self.a.model.inputs().map(|input| input.transform).collect();
        Ok((
            Equations { ports: self.ports.clone(), state_names: self.state_names(), transforms, ..equations },
            derivatives,
        ))
    }

    /// Time derivative of the angle states.
    fn angle_rates(&self) -> Jet {
        let all: Vec<usize> = (0..self.angle.value.ncols()).collect();
        let mut rates = self.velocity.select(&self.angles, &all);
        if let Reference::Driven(root) | Reference::Massive(root) = self.a.reference {
            let minus = Scalar::constant(-1.0, self.a.wrt.len());
            for (row, group) in self.angles.iter().enumerate() {
                let rigid = self.velocity.row(root).scaled(&self.a.rigid[*group].times(&minus));
                rates.add_block(row, 0, &rigid);
            }
        }
        rates
    }

    fn state_names(&self) -> Vec<String> {
        let name = |group: &usize| {
            let node = self.a.group.iter().position(|candidate| candidate == group);
            node.map_or_else(|| "the frame".to_owned(), |node| self.a.model.nodes[node].name.clone())
        };
        let kind = if self.a.reference == Reference::Ground { "angle of" } else { "wind-up of" };
        let angles = self.angles.iter().map(|group| format!("{kind} {}", name(group)));
        let speeds = self.massive.iter().map(|group| format!("speed of {}", name(group)));
        let owned = self.a.model.effects.iter().flat_map(|used| {
            (0..states_of(used)).map(|index| format!("state {index} of {} at {}", used.effect.id, used.place))
        });
        let motors = self.a.model.motors.iter().filter(|motor| motor.inductance.is_some());
        let currents = motors.map(|motor| format!("current of {}", motor.name));
        angles.chain(speeds).chain(owned).chain(currents).collect()
    }
}
