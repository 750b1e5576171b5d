//! From a network to its equations.
//!
//! Rigid gears and shafts tie nodes into groups, one coordinate each. A coordinate is prescribed (its
//! speed is an input), massive, damped (massless, but a damper makes its equation first order) or static
//! (massless and undamped: its equation is algebraic and it is condensed out). All of it is done on
//! [`Jet`]s, so that every matrix comes with its exact derivatives.

use crate::{
    ModelError,
    effects::{Form, Kind},
    equations::Equations,
    jet::{Jet, Scalar},
    model::{Channel, EffectUse, Model, Quantity, Role, Site, Spring},
};
use motion::Motion;

mod motion;
mod wiring;

impl Model {
    /// Equations of motion for parameter values in SI, in the order of [`Model::parameters`].
    ///
    /// # Errors
    /// [`ModelError::Value`] for a value outside what physics allows (an inertia, stiffness or transition speed that is
    /// not positive, a damping below zero, a ratio of zero); [`ModelError::Network`] where
    /// a node has nothing that decides its motion.
    pub fn equations(&self, values: &[f64]) -> Result<Equations, ModelError> {
        self.equations_with_derivatives(values, &[]).map(|(equations, _)| equations)
    }

    /// The same with the derivative of every matrix with respect to each parameter in `wrt`; the derivatives'
    /// `ports`, `state_names` and `takes` are empty.
    ///
    /// # Errors
    /// As [`Model::equations`].
    pub fn equations_with_derivatives(
        &self,
        values: &[f64],
        wrt: &[usize],
    ) -> Result<(Equations, Vec<Equations>), ModelError> {
        self.check_values(values)?;
        Assembly::new(self, values, wrt)?.equations()
    }

    /// How many times faster the node `fast` moves than the node `slow` while no spring twists, at the file's values:
    /// what gears, shafts and couplings fix between them on average. Negative where they turn against each other.
    ///
    /// `None` where nothing fixes it: a node that does not exist, no way from one to the other, or a spring to the ground.
    pub fn rigid_ratio(&self, fast: &str, slow: &str) -> Option<f64> {
        let values = self.values();
        let node = |name: &str| self.nodes.iter().position(|node| node.name == name);
        let (fast, slow) = (node(fast)?, node(slow)?);
        let assembly = Assembly::new(self, &values, &[]).ok()?;
        let mode = assembly.rigid_mode(assembly.group[fast])?;
        let motion = |node: usize| mode[assembly.group[node]].value * assembly.lever[node].value;
        Some(motion(fast) / motion(slow))
    }

    fn check_values(&self, values: &[f64]) -> Result<(), ModelError> {
        let fail = |index: usize, expected| {
            Err(ModelError::Value {
                name: self.parameters[index].name.clone(),
                value: values[index],
                expected,
            })
        };
        if values.len() != self.parameters.len() {
            return Err(ModelError::Network(format!(
                "{} parameter values for {}",
                values.len(),
                self.parameters.len()
            )));
        }
        if let Some(index) = values.iter().position(|value| !value.is_finite()) {
            return fail(index, "finite");
        }
        let positive =
            self.nodes.iter().filter_map(|node| node.inertia).chain(self.springs.iter().map(|s| s.stiffness));
        for index in positive {
            if values[index] <= 0.0 {
                return fail(index, "positive");
            }
        }
        if let Some(gear) = self.gears.iter().find(|gear| values[gear.ratio] == 0.0) {
            return fail(gear.ratio, "anything but zero");
        }
        for used in &self.effects {
            for (parameter, index) in used.effect.parameters.iter().zip(&used.parameters) {
                // Laws divide by these; a time of either sign is none of them.
                let scale = matches!(parameter.kind, Kind::Speed)
                    || (parameter.kind == Kind::Time && parameter.bounds.0 >= 0.0)
                    || matches!(parameter.name, "deflection" | "limit");
                if scale && values[*index] <= 0.0 {
                    return fail(*index, "positive");
                }
            }
        }
        let dampings = self
            .springs
            .iter()
            .filter_map(|s| s.damping)
            .chain(self.bearings.iter().filter_map(|b| b.damping));
        for index in dampings {
            if values[index] < 0.0 {
                return fail(index, "zero or more");
            }
        }
        Ok(())
    }
}

/// How a coordinate moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Class {
    Prescribed,
    Massive,
    Damped,
    Static,
}

/// What angles are measured against.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Reference {
    /// The prescribed coordinate.
    Driven(usize),
    /// A massive coordinate of a drivetrain that floats freely.
    Massive(usize),
    /// The ground.
    Ground,
}

struct Assembly<'m> {
    model: &'m Model,
    values: &'m [f64],
    wrt: &'m [usize],
    /// Group of each node, and its motion per motion of the group.
    group: Vec<usize>,
    lever: Vec<Scalar>,
    inertia: Jet,
    damping: Jet,
    stiffness: Jet,
    class: Vec<Class>,
    reference: Reference,
    /// Free rotation of the whole drivetrain, as motion of each group per motion of the reference.
    rigid: Vec<Scalar>,
}

impl<'m> Assembly<'m> {
    fn new(model: &'m Model, values: &'m [f64], wrt: &'m [usize]) -> Result<Self, ModelError> {
        let (group, lever, groups) = tie_nodes(model, values, wrt)?;
        let empty = Jet::zeros(groups, groups, wrt.len());
        let mut assembly = Self {
            model,
            values,
            wrt,
            group,
            lever,
            inertia: empty.clone(),
            damping: empty.clone(),
            stiffness: empty,
            class: vec![Class::Static; groups],
            reference: Reference::Ground,
            rigid: Vec::new(),
        };
        assembly.add_elements();
        assembly.classify()?;
        assembly.choose_reference();
        Ok(assembly)
    }

    fn scalar(&self, parameter: usize) -> Scalar {
        scalar(self.values, self.wrt, parameter)
    }

    /// Motion of node `node` per motion of each group, as a row.
    fn node_row(&self, node: usize) -> Jet {
        let mut row = Jet::zeros(1, self.class.len(), self.wrt.len());
        row.add_at(0, self.group[node], &self.lever[node]);
        row
    }

    fn twist_row(&self, from: usize, to: Option<usize>) -> Jet {
        match to {
            Some(to) => self.node_row(from).minus(&self.node_row(to)),
            None => self.node_row(from),
        }
    }

    fn add_elements(&mut self) {
        let model = self.model;
        let quadratic = |row: &Jet, parameter: Scalar| row.transpose().times(row).scaled(&parameter);
        let own = model.nodes.iter().enumerate().filter_map(|(i, n)| Some((i, n.inertia?)));
        let more = model.effects.iter().filter_map(|used| match (used.effect.form, used.at) {
            (Form::Inertia, Site::Node(node)) => Some((node, used.parameters[0])),
            _ => None,
        });
        for (node, inertia) in own.chain(more).collect::<Vec<_>>() {
            let term = quadratic(&self.node_row(node), self.scalar(inertia));
            self.inertia.add_block(0, 0, &term);
        }
        for spring in &model.springs {
            let row = self.twist_row(spring.from, spring.to);
            self.stiffness.add_block(0, 0, &quadratic(&row, self.scalar(spring.stiffness)));
            if let Some(damping) = spring.damping {
                self.damping.add_block(0, 0, &quadratic(&row, self.scalar(damping)));
            }
        }
        for bearing in &model.bearings {
            if let Some(damping) = bearing.damping {
                let term = quadratic(&self.node_row(bearing.node), self.scalar(damping));
                self.damping.add_block(0, 0, &term);
            }
        }
        if let Some((row, proportional, derivative)) = self.servo_terms() {
            self.stiffness.add_block(0, 0, &quadratic(&row, proportional));
            self.damping.add_block(0, 0, &quadratic(&row, derivative));
        }
    }

    /// A servo is a spring and a damper to where it is told to go: node row, N m per rad, N m per rad/s.
    fn servo_terms(&self) -> Option<(Jet, Scalar, Scalar)> {
        let servo = self.model.servo.as_ref()?;
        let derivative = self.scalar(servo.drive_gain).times(&self.scalar(servo.velocity_gain));
        let proportional = derivative.times(&self.scalar(servo.position_gain));
        Some((self.node_row(servo.node), proportional, derivative))
    }

    fn classify(&mut self) -> Result<(), ModelError> {
        let model = self.model;
        for (group, class) in self.class.iter_mut().enumerate() {
            let touches = |parameter: Option<usize>| parameter.is_some();
            let members = || (0..model.nodes.len()).filter(|node| self.group[*node] == group);
            let adds = |node: usize| {
                let effects = &model.effects;
                effects
                    .iter()
                    .any(|used| matches!(used.effect.form, Form::Inertia) && used.at == Site::Node(node))
            };
            let massive = members().any(|node| touches(model.nodes[node].inertia) || adds(node));
            // Structural, not by value: a damping that an estimator moves to zero must not change the states.
            let damped = members().any(|node| {
                model.springs.iter().any(|s| (s.from == node || s.to == Some(node)) && touches(s.damping))
                    || model.bearings.iter().any(|b| b.node == node && touches(b.damping))
                    || model.servo.as_ref().is_some_and(|servo| servo.node == node)
            });
            *class = if massive {
                Class::Massive
            } else if damped {
                Class::Damped
            } else {
                Class::Static
            };
        }
        for channel in model.inputs() {
            match channel.quantity {
                Quantity::Speed => {
                    let node = self.node_named(&channel.at, &channel.name)?;
                    let class = &mut self.class[self.group[node]];
                    if *class == Class::Prescribed {
                        return Err(ModelError::Network(format!(
                            "channel {} prescribes a speed that another input prescribes already",
                            channel.name
                        )));
                    }
                    *class = Class::Prescribed;
                }
                Quantity::Torque => {
                    self.node_named(&channel.at, &channel.name)?;
                }
                Quantity::Reference if model.servo.as_ref().is_some_and(|servo| servo.name == channel.at) => {
                }
                Quantity::Reference => {
                    return Err(ModelError::Network(format!(
                        "channel {} is a reference, so it must be at the servo",
                        channel.name
                    )));
                }
                Quantity::Angle if self.twisted_spring(channel).is_some() => {}
                Quantity::Angle => {
                    return Err(ModelError::Network(format!(
                        "channel {} is an angle; as an input it is added to the twist of a spring, and {} is none (the motion of \
                         a node is given as its speed)",
                        channel.name, channel.at
                    )));
                }
                Quantity::Time | Quantity::Turned | Quantity::Change => {}
                Quantity::Acceleration => {
                    return Err(ModelError::Network(format!(
                        "channel {} cannot drive the model: give a speed or a torque as input",
                        channel.name
                    )));
                }
            }
        }
        Ok(())
    }

    fn node_named(&self, place: &str, channel: &str) -> Result<usize, ModelError> {
        self.model.nodes.iter().position(|node| node.name == place).ok_or_else(|| {
            ModelError::Network(format!("channel {channel} needs a node, and {place} is none"))
        })
    }

    /// The spring that an effect acts at.
    fn spring_of(&self, used: &EffectUse) -> Option<&'m Spring> {
        match used.at {
            Site::Spring(spring) | Site::Gear { contact: spring, .. } => self.model.springs.get(spring),
            Site::Node(_) | Site::Channel(_) => None,
        }
    }

    /// The node whose shaft a channel's sensor sits on: its own, or the driving end of a spring.
    fn shaft_of(&self, channel: &Channel) -> Option<usize> {
        let named = |name: &str| self.model.nodes.iter().position(|node| node.name == name);
        named(&channel.at).or_else(|| {
            let spring = self.model.springs.iter().find(|spring| spring.name == channel.at)?;
            Some(spring.from)
        })
    }

    /// The spring whose twist an input adds to.
    fn twisted_spring(&self, channel: &Channel) -> Option<&'m Spring> {
        let twists = channel.role == Role::Input && channel.quantity == Quantity::Angle;
        self.model.springs.iter().find(|spring| twists && spring.name == channel.at)
    }

    fn groups_of(&self, class: Class) -> Vec<usize> {
        (0..self.class.len()).filter(|group| self.class[*group] == class).collect()
    }

    /// Angles are taken relative to a node of the drivetrain unless something knows absolute ones.
    fn choose_reference(&mut self) {
        let absolute = self.model.springs.iter().any(|spring| spring.to.is_none())
            || self.model.servo.is_some()
            || self.model.outputs().any(|channel| channel.quantity == Quantity::Angle);
        let prescribed = self.groups_of(Class::Prescribed);
        let candidate = match prescribed[..] {
            [group] => Some(Reference::Driven(group)),
            [] => self.groups_of(Class::Massive).first().map(|group| Reference::Massive(*group)),
            _ => None,
        };
        if absolute {
            return;
        }
        if let Some(reference) = candidate
            && let Reference::Driven(root) | Reference::Massive(root) = reference
            && let Some(rigid) = self.rigid_mode(root)
        {
            self.reference = reference;
            self.rigid = rigid;
        }
    }

    /// Motion of each group when everything turns with `root` and no spring twists; `None` if springs form a
    /// loop that prevents it, or if a group is not connected to the root.
    fn rigid_mode(&self, root: usize) -> Option<Vec<Scalar>> {
        let mut mode: Vec<Option<Scalar>> = vec![None; self.class.len()];
        mode[root] = Some(Scalar::constant(1.0, self.wrt.len()));
        for _ in 0..self.class.len() {
            for spring in &self.model.springs {
                let to = spring.to?;
                for (known, unknown) in [(spring.from, to), (to, spring.from)] {
                    let (Some(motion), None) = (&mode[self.group[known]], &mode[self.group[unknown]]) else {
                        continue;
                    };
                    let next = motion.times(&self.lever[known]).over(&self.lever[unknown]);
                    mode[self.group[unknown]] = Some(next);
                }
            }
        }
        let mode: Vec<Scalar> = mode.into_iter().collect::<Option<_>>()?;
        let twists = self.model.springs.iter().any(|spring| {
            let end = |node: usize| mode[self.group[node]].value * self.lever[node].value;
            spring.to.is_none_or(|to| (end(spring.from) - end(to)).abs() > 1e-9 * end(spring.from).abs())
        });
        (!twists).then_some(mode)
    }

    fn equations(&self) -> Result<(Equations, Vec<Equations>), ModelError> {
        Motion::new(self)?.equations()
    }
}

fn scalar(values: &[f64], wrt: &[usize], parameter: usize) -> Scalar {
    let derivatives = wrt.iter().map(|index| f64::from(*index == parameter)).collect();
    Scalar { value: values[parameter], derivatives }
}

/// Joins nodes that gears and shafts tie rigidly: group of each node, its lever, number of groups.
fn tie_nodes(
    model: &Model,
    values: &[f64],
    wrt: &[usize],
) -> Result<(Vec<usize>, Vec<Scalar>, usize), ModelError> {
    let unity = Scalar::constant(1.0, wrt.len());
    let shafts = model.shafts.iter().map(|shaft| (&shaft.name, shaft.nodes.0, shaft.nodes.1, unity.clone()));
    let gears =
        model.gears.iter().map(|gear| (&gear.name, gear.from, gear.to, scalar(values, wrt, gear.ratio)));
    let mut group: Vec<usize> = (0..model.nodes.len()).collect();
    let mut lever = vec![unity.clone(); model.nodes.len()];
    for (name, from, to, ratio) in shafts.chain(gears) {
        if group[from] == group[to] {
            return Err(ModelError::Network(format!(
                "{name} closes a rigid loop: its two nodes are tied already"
            )));
        }
        // Every member of the `to` group now moves with the `from` group.
        let factor = lever[from].over(&ratio).over(&lever[to]);
        let joined = group[to];
        for node in (0..model.nodes.len()).filter(|node| group[*node] == joined).collect::<Vec<_>>() {
            group[node] = group[from];
            lever[node] = lever[node].times(&factor);
        }
    }
    let mut names = group.clone();
    names.sort_unstable();
    names.dedup();
    let group = group.iter().map(|g| names.partition_point(|name| name < g)).collect();
    Ok((group, lever, names.len()))
}
