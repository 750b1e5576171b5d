//! Balances of torques on the coordinates.

use super::{
    State, Unknown,
    builder::{Builder, name, over, sum},
    has_angle_state,
};
use crate::{
    description::{Coordinate, CoordinateMotion},
    formula::Formula,
};

impl Builder<'_, '_> {
    /// Balances of torques: rates of the speeds, and the equations of the unknowns.
    pub(crate) fn balances(&mut self) -> Vec<Unknown> {
        let mut unknowns = Vec::new();
        let mut massive = Vec::new();
        self.comment("torque on each coordinate");
        for index in 0..self.d.coordinates.len() {
            let kind = self.d.coordinates[index].kind;
            let node = self.d.points[self.d.coordinates[index].node].name.clone();
            let total = self.d.names.unique(&format!("sum_{node}"));
            let balance = sum(std::mem::take(&mut self.torque[index]));
            if kind == CoordinateMotion::Prescribed {
                continue;
            }
            self.assign(&total, balance);
            let unknown = |name: &str, meaning: String| Unknown {
                name: name.to_owned(),
                meaning,
                balance: Formula::Name(total.clone()),
            };
            match kind {
                CoordinateMotion::Massive => massive.push((index, total)),
                CoordinateMotion::Damped => {
                    unknowns.push(unknown(&self.speed[index], format!("speed of {node}")))
                }
                _ => unknowns.push(unknown(&self.angle[index], format!("angle of {node}"))),
            }
        }
        for (at, (index, total)) in massive.into_iter().enumerate() {
            let node = self.d.points[self.d.coordinates[index].node].name.clone();
            let acceleration = self.d.names.unique(&format!("a_{node}"));
            let inertia = self.inertia(index);
            self.assign(&acceleration, over(name(&total), inertia));
            let state = State {
                name: self.speed[index].clone(),
                meaning: format!("speed of {node}"),
                rate: name(&acceleration),
            };
            let angles = self.d.coordinates.iter().filter(|own| has_angle_state(own.kind)).count();
            self.states.insert(angles + at, state);
        }
        unknowns
    }

    /// Inertia of a coordinate.
    fn inertia(&self, coordinate: usize) -> Formula {
        let own = self.d.points.iter().filter(|point| point.coordinate == coordinate);
        let terms = own.flat_map(|point| point.inertias.iter().map(move |inertia| (point, *inertia)));
        sum(terms
            .map(|(point, inertia)| {
                let once = self.by_lever(self.parameter(inertia), &point.lever);
                self.by_lever(once, &point.lever)
            })
            .collect())
    }

    /// Gives the coordinate whose node has this speed a rate of it, for targets that do not use the balances.
    pub(crate) fn rename_speed(&mut self, speed: &str, rate: Formula) {
        let root = |own: &Coordinate| self.d.points[own.node].speed == speed;
        if let Some(index) = self.d.coordinates.iter().position(root) {
            let name = self.speed[index].clone();
            self.states.push(State { name, meaning: String::new(), rate });
        }
    }

    /// The acceleration of a node.
    pub(crate) fn acceleration(&self, node: usize) -> Formula {
        let point = &self.d.points[node];
        let speed = &self.speed[point.coordinate];
        let own = self.states.iter().find(|state| state.name == *speed);
        own.map_or(Formula::Number(0.0), |state| self.by_lever(state.rate.clone(), &point.lever))
    }
}
