//! Builds the assignments in the order in which they need one another.

use socam_model::{Quantity, effects::Acts};

use super::{Assignment, Line, Program, State, has_angle_state};
use crate::{
    description::{CoordinateMotion, Description, Lever},
    error::ExportError,
    formula::Formula,
};

pub(crate) struct Builder<'d, 'm> {
    pub(crate) d: &'d mut Description<'m>,
    pub(crate) lines: Vec<Line>,
    pub(crate) states: Vec<State>,
    /// Angle, speed and torque of each coordinate.
    pub(crate) angle: Vec<String>,
    pub(crate) speed: Vec<String>,
    pub(crate) torque: Vec<Vec<Formula>>,
    /// Torque through each spring, to be replaced as laws are added.
    pub(crate) through: Vec<String>,
    /// Identifiers of the states of each effect.
    pub(crate) own_states: Vec<Vec<String>>,
    pub(crate) changes: Vec<(usize, String)>,
}

pub(crate) fn name(text: &str) -> Formula {
    Formula::Name(text.to_owned())
}

pub(crate) fn times(a: Formula, b: Formula) -> Formula {
    Formula::Binary('*', Box::new(a), Box::new(b))
}

pub(crate) fn plus(a: Formula, b: Formula) -> Formula {
    Formula::Binary('+', Box::new(a), Box::new(b))
}

pub(crate) fn minus(a: Formula, b: Formula) -> Formula {
    Formula::Binary('-', Box::new(a), Box::new(b))
}

pub(crate) fn over(a: Formula, b: Formula) -> Formula {
    Formula::Binary('/', Box::new(a), Box::new(b))
}

/// A sum, where a negative term is subtracted; zero if there is none.
pub(crate) fn sum(terms: Vec<Formula>) -> Formula {
    let mut terms = terms.into_iter();
    let Some(first) = terms.next() else { return Formula::Number(0.0) };
    terms.fold(first, |sum, term| match term {
        Formula::Negative(inner) => minus(sum, *inner),
        term => plus(sum, term),
    })
}

pub(crate) fn negative(formula: Formula) -> Formula {
    match formula {
        Formula::Negative(inner) => *inner,
        formula => Formula::Negative(Box::new(formula)),
    }
}

impl<'d, 'm> Builder<'d, 'm> {
    pub(crate) fn new(d: &'d mut Description<'m>) -> Self {
        let count = d.coordinates.len();
        let roots: Vec<usize> = d.coordinates.iter().map(|own| own.node).collect();
        let angle = roots.iter().map(|root| d.points[*root].joint.clone()).collect();
        let wanted = roots.iter().map(|root| format!("v_{}", d.points[*root].name)).collect::<Vec<_>>();
        let speed = wanted.iter().map(|name| d.names.unique(name)).collect();
        let through = d.springs.clone();
        let through = through.iter().map(|spring| d.names.unique(&format!("torque_{spring}"))).collect();
        Self {
            lines: Vec::new(),
            states: Vec::new(),
            angle,
            speed,
            torque: vec![Vec::new(); count],
            through,
            own_states: Vec::new(),
            changes: Vec::new(),
            d,
        }
    }

    pub(crate) fn parameter(&self, index: usize) -> Formula {
        name(&self.d.parameters[index].identifier)
    }

    pub(crate) fn comment(&mut self, words: impl Into<String>) {
        self.lines.push(Line::Comment(words.into()));
    }

    pub(crate) fn assign(&mut self, name: &str, formula: Formula) {
        self.lines.push(Line::Assignment(Assignment { name: name.to_owned(), formula }));
    }

    /// `formula` times a lever.
    pub(crate) fn by_lever(&self, formula: Formula, lever: &Lever) -> Formula {
        lever.factors.iter().fold(formula, |product, (ratio, divides)| {
            if *divides {
                over(product, self.parameter(*ratio))
            } else {
                times(product, self.parameter(*ratio))
            }
        })
    }

    /// Adds a torque on a node to its coordinate's.
    pub(crate) fn push(&mut self, node: usize, torque: Formula) {
        let point = &self.d.points[node];
        let (coordinate, lever) = (point.coordinate, point.lever.clone());
        let scaled = match torque {
            Formula::Negative(inner) => negative(self.by_lever(*inner, &lever)),
            torque => self.by_lever(torque, &lever),
        };
        self.torque[coordinate].push(scaled);
    }

    pub(crate) fn program(mut self) -> Result<Program, ExportError> {
        self.nodes()?;
        self.springs()?;
        self.bearings();
        self.inputs()?;
        self.node_laws()?;
        let unknowns = self.balances();
        let outputs = self.outputs()?;
        Ok(Program { states: self.states, unknowns, lines: self.lines, outputs, changes: self.changes })
    }

    /// Angles and speeds of nodes, and the states of coordinates.
    fn nodes(&mut self) -> Result<(), ExportError> {
        for index in 0..self.d.coordinates.len() {
            let coordinate = &self.d.coordinates[index];
            if has_angle_state(coordinate.kind) {
                let meaning = format!("angle of {}", self.d.points[coordinate.node].name);
                let rate = name(&self.speed[index]);
                self.states.push(State { name: self.angle[index].clone(), meaning, rate });
            }
        }
        self.name_states();
        self.prescribed()?;
        self.comment("motion of the nodes");
        for node in 0..self.d.points.len() {
            let point = &self.d.points[node];
            let (angle, speed, coordinate) = (point.angle.clone(), point.speed.clone(), point.coordinate);
            let lever = point.lever.clone();
            let turned = self.by_lever(name(&self.angle[coordinate]), &lever);
            self.assign(&angle, turned);
            if self.d.coordinates[coordinate].kind != CoordinateMotion::Static {
                let turning = self.by_lever(name(&self.speed[coordinate]), &lever);
                self.assign(&speed, turning);
            }
        }
        Ok(())
    }

    /// Torques through springs.
    fn springs(&mut self) -> Result<(), ExportError> {
        self.comment("torques through springs");
        for index in 0..self.d.model.springs.len() {
            let spring = &self.d.model.springs[index];
            let (twist, rate) = self.twist(index);
            let mut wound = twist;
            for signal in self.d.inputs.iter().filter(|signal| self.d.twisted(signal) == Some(index)) {
                wound = plus(wound, self.gained(signal));
            }
            let mut terms = vec![times(self.parameter(spring.stiffness), wound)];
            if let Some(damping) = spring.damping {
                terms.push(times(self.parameter(damping), rate));
            }
            for used in self.effects_at(index) {
                let bound = self.seen_at_spring(used, index);
                terms.extend(self.laws_of(used, Acts::Torque, &bound)?);
                self.state_laws(used, &bound)?;
            }
            let through = self.through[index].clone();
            self.assign(&through, sum(terms));
            let (from, to) = (spring.from, spring.to);
            self.push(from, negative(name(&through)));
            if let Some(to) = to {
                self.push(to, name(&through));
            }
        }
        Ok(())
    }

    fn bearings(&mut self) {
        for bearing in &self.d.model.bearings {
            if let Some(damping) = bearing.damping {
                let drag = times(self.parameter(damping), name(&self.d.points[bearing.node].speed));
                self.push(bearing.node, negative(drag));
            }
        }
        if let (Some((node, formula)), Some(servo)) = (self.servo(), &self.d.model.servo) {
            let torque = self.d.names.unique(&format!("torque_{}", servo.name));
            self.comment("torque of the servo");
            self.assign(&torque, formula);
            self.push(node, name(&torque));
            self.through.push(torque);
        }
    }

    /// Speeds that inputs prescribe.
    fn prescribed(&mut self) -> Result<(), ExportError> {
        for index in 0..self.d.inputs.len() {
            let signal = &self.d.inputs[index];
            if signal.channel.quantity != Quantity::Speed {
                continue;
            }
            let Some(node) = self.d.node(&signal.channel.at) else { continue };
            let (coordinate, lever) = (self.d.points[node].coordinate, self.d.points[node].lever.clone());
            let speed = self.speed[coordinate].clone();
            let true_value = self.d.names.unique(&format!("true_{}", signal.channel.name));
            let inverse = Lever {
                value: 1.0 / lever.value,
                factors: lever.factors.iter().map(|(ratio, divides)| (*ratio, !divides)).collect(),
            };
            // Laws at this channel may need the angle of the node, which is a state.
            let angle = name(&self.angle[coordinate]);
            let angle = self.by_lever(angle, &lever);
            let read = self.true_input(index, Some(angle))?;
            self.comment("prescribed speed");
            self.assign(&true_value, read);
            let motion = self.by_lever(name(&true_value), &inverse);
            self.assign(&speed, motion);
        }
        Ok(())
    }

    /// Torques that inputs apply.
    fn inputs(&mut self) -> Result<(), ExportError> {
        for index in 0..self.d.inputs.len() {
            let signal = &self.d.inputs[index];
            if signal.channel.quantity != Quantity::Torque {
                continue;
            }
            let Some(node) = self.d.node(&signal.channel.at) else { continue };
            let angle = name(&self.d.points[node].angle);
            let torque = self.true_input(index, Some(angle))?;
            self.push(node, torque);
        }
        Ok(())
    }

    /// Laws at nodes and on the slow sides of gears.
    fn node_laws(&mut self) -> Result<(), ExportError> {
        for used in 0..self.d.model.effects.len() {
            let Some((node, acts, bound)) = self.seen_at_node(used) else { continue };
            if acts == Acts::Torque {
                self.state_laws(used, &bound)?;
            }
            for term in self.laws_of(used, acts, &bound)? {
                let law = self.d.names.unique(&format!("torque_{}", self.d.effects[used]));
                let (id, place) =
                    (self.d.model.effects[used].effect.id, self.d.model.effects[used].place.clone());
                self.comment(format!("{id} at {place}"));
                self.assign(&law, term);
                self.push(node, name(&law));
            }
        }
        Ok(())
    }
}
