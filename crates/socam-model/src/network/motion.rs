//! Velocities and accelerations of all groups as linear maps of states, inputs and the forces of ports.

use super::{
    assembly::{Assembly, Class, Reference},
    ports::{ports_of, states_of},
};
use crate::{
    Channel, ModelError, Port, Quantity, Role,
    effects::{Acts, Form},
    jet::{Jet, Scalar},
};

/// Velocities and accelerations of all groups as linear maps of the columns
/// [angle states | speed states | states of effects | inputs | ports].
pub(super) struct MotionMaps<'a, 'm> {
    pub(super) a: &'a Assembly<'m>,
    pub(super) massive: Vec<usize>,
    /// Groups whose angle is a state.
    pub(super) angles: Vec<usize>,
    /// First column and number of the states of each effect.
    pub(super) owned: Vec<(usize, usize)>,
    /// Column of the current of each motor, where its inductance makes it a state.
    pub(super) currents: Vec<Option<usize>>,
    pub(super) inputs: usize,
    pub(super) ports: Vec<Port>,
    /// Effect that each port belongs to.
    pub(super) port_owner: Vec<usize>,
    /// Maps per group, each groups x columns.
    pub(super) angle: Jet,
    pub(super) velocity: Jet,
    pub(super) acceleration: Jet,
    pub(super) statics: Vec<usize>,
}

impl<'a, 'm> MotionMaps<'a, 'm> {
    pub(super) fn new(a: &'a Assembly<'m>) -> Result<Self, ModelError> {
        let of = |class| a.groups_of(class);
        let (massive, damped, statics, prescribed) =
            (of(Class::Massive), of(Class::Damped), of(Class::Static), of(Class::Prescribed));
        let mut angles: Vec<usize> = massive.iter().chain(&damped).copied().collect();
        match a.reference {
            Reference::Driven(_) => {}
            Reference::Massive(root) => angles.retain(|group| *group != root),
            Reference::Ground => angles.extend(&prescribed),
        }
        let (groups, inputs) = (a.class.len(), a.model.inputs().count());
        let mut next = angles.len() + massive.len();
        let owned: Vec<(usize, usize)> = a
            .model
            .effects
            .iter()
            .map(|used| {
                let own = (next, states_of(used));
                next += own.1;
                own
            })
            .collect();
        let currents = a.model.motors.iter().map(|motor| {
            motor.inductance?;
            next += 1;
            Some(next - 1)
        });
        let currents: Vec<Option<usize>> = currents.collect();
        let (ports, port_owner): (Vec<Port>, Vec<usize>) =
            a.model.effects.iter().enumerate().flat_map(|(index, used)| ports_of(index, used)).unzip();
        let columns = next + inputs + ports.len();
        let empty = Jet::zeros(groups, columns, a.wrt.len());
        let mut motion = Self {
            a,
            massive,
            angles,
            owned,
            currents,
            inputs,
            ports,
            port_owner,
            angle: empty.clone(),
            velocity: empty.clone(),
            acceleration: empty,
            statics,
        };
        motion.solve(&damped, &prescribed)?;
        Ok(motion)
    }

    pub(super) fn first_input(&self) -> usize {
        let owned: usize = self.owned.iter().map(|(_, count)| count).sum();
        self.angles.len() + self.massive.len() + owned + self.currents.iter().flatten().count()
    }

    fn first_port(&self) -> usize {
        self.first_input() + self.inputs
    }

    /// Columns of the ports of an effect whose laws act as `acts`.
    pub(super) fn acting(&self, effect: usize, acts: Acts) -> impl Iterator<Item = usize> {
        let ports = self.ports.iter().zip(&self.port_owner).enumerate();
        ports
            .filter(move |(_, (port, owner))| **owner == effect && port.law.acts == acts)
            .map(|(index, _)| self.first_port() + index)
    }

    pub(super) fn one(&self) -> Scalar {
        Scalar::constant(1.0, self.a.wrt.len())
    }

    pub(super) fn nothing(&self) -> Jet {
        Jet::zeros(1, self.angle.value.ncols(), self.a.wrt.len())
    }

    /// Gain of a channel: of an input, the acting value divided by its SI value; of an output, its reading divided by the true value.
    pub(super) fn gain(&self, channel: &Channel) -> Scalar {
        let own = channel.gain.map_or_else(|| self.one(), |parameter| self.a.scalar(parameter));
        let effects = self.a.model.effects.iter().filter(|used| matches!(used.effect.form, Form::Gain));
        effects.filter(|used| used.place == channel.name).fold(own, |gain, used| {
            let read = self.a.scalar(used.parameters[0]);
            if channel.role == Role::Input { gain.over(&read) } else { gain.times(&read) }
        })
    }

    /// Columns of the ports whose forces are added to the reading of a channel.
    pub(super) fn read_beside(&self, channel: &Channel) -> Vec<usize> {
        let effects = self.a.model.effects.iter().enumerate();
        let own = effects.filter(|(_, used)| used.place == channel.name);
        own.flat_map(|(index, _)| self.acting(index, Acts::Reading)).collect()
    }

    /// Columns and signs that give the true value of an input: its own column, minus those of the ports that are added to its reading.
    pub(super) fn driving(&self, index: usize, channel: &Channel) -> Vec<(usize, f64)> {
        let beside = self.read_beside(channel).into_iter().map(|column| (column, -1.0));
        std::iter::once((self.first_input() + index, 1.0)).chain(beside).collect()
    }

    fn solve(&mut self, damped: &[usize], prescribed: &[usize]) -> Result<(), ModelError> {
        let one = self.one();
        for (column, group) in self.angles.clone().into_iter().enumerate() {
            self.angle.add_at(group, column, &one);
        }
        for (index, group) in self.massive.clone().into_iter().enumerate() {
            self.velocity.add_at(group, self.angles.len() + index, &one);
        }
        self.set_prescribed(prescribed);
        let force = self.applied_force();
        self.condense_statics(&force)?;
        let restoring = self.a.stiffness.times(&self.angle);
        // Damped groups: C_ss v_s = F_s - K_s angle - C_s,known v_known.
        let known = self.a.damping.times(&self.velocity);
        let all: Vec<usize> = (0..self.angle.value.ncols()).collect();
        let balance = force.minus(&restoring).minus(&known).select(damped, &all);
        let Some(speeds) = self.a.damping.select(damped, damped).solve(&balance) else {
            return Err(ModelError::Network(
                self.undetermined(damped, "give one of them an inertia or a damper to a massive node"),
            ));
        };
        for (row, group) in damped.iter().enumerate() {
            self.velocity.add_block(*group, 0, &speeds.row(row));
        }
        self.refuse_prescribed_inertia(prescribed)?;
        let balance =
            force.minus(&restoring).minus(&self.a.damping.times(&self.velocity)).select(&self.massive, &all);
        let Some(accelerations) = self.a.inertia.select(&self.massive, &self.massive).solve(&balance) else {
            return Err(ModelError::Network(self.undetermined(&self.massive, "give them positive inertias")));
        };
        for (row, group) in self.massive.iter().enumerate() {
            self.acceleration.add_block(*group, 0, &accelerations.row(row));
        }
        Ok(())
    }

    /// Refuses an inertia that a prescribed and a free group move together, by a differential: its torque depends on the acceleration of
    /// the input, which no input gives.
    fn refuse_prescribed_inertia(&self, prescribed: &[usize]) -> Result<(), ModelError> {
        if self.a.inertia.select(&self.massive, prescribed).value.iter().all(|shared| *shared == 0.0) {
            return Ok(());
        }
        if self.a.frame.is_some() {
            let problem = "a mounting that gives way needs torques as inputs: the reaction of a prescribed motion depends on the acceleration of the input";
            return Err(ModelError::Network(problem.to_owned()));
        }
        let names = self.a.model.differentials.iter().map(|differential| differential.name.as_str());
        Err(ModelError::Network(format!(
            "{} couples the inertia of a node whose speed is an input to one that moves freely; give the torques of both as inputs, the speeds of both, or a spring behind the differential",
            names.collect::<Vec<_>>().join(", ")
        )))
    }

    fn undetermined(&self, groups: &[usize], advice: &str) -> String {
        let names =
            self.a.model.nodes.iter().enumerate().filter(|(node, _)| groups.contains(&self.a.group[*node]));
        let names: Vec<_> = names.map(|(_, node)| node.name.as_str()).collect();
        format!("nothing determines how {} moves; {advice}", names.join(", "))
    }

    /// Sets the velocities that inputs prescribe. The lever between the input's node and its group is divided out.
    fn set_prescribed(&mut self, prescribed: &[usize]) {
        let inputs: Vec<_> =
            self.a.model.inputs().enumerate().filter(|(_, c)| c.quantity == Quantity::Speed).collect();
        for (index, channel) in inputs {
            let Some(node) = self.a.model.nodes.iter().position(|node| node.name == channel.at) else {
                continue;
            };
            let group = self.a.group[node];
            debug_assert!(prescribed.contains(&group));
            let motion = self.gain(channel).over(&self.a.lever[node]);
            for (column, sign) in self.driving(index, channel) {
                let signed = motion.times(&Scalar::constant(sign, self.a.wrt.len()));
                self.velocity.add_at(group, column, &signed);
            }
        }
    }

    /// Angles of static groups follow from the others: K_aa angle_a = F_a - K_a,rest angle_rest.
    fn condense_statics(&mut self, force: &Jet) -> Result<(), ModelError> {
        let all: Vec<usize> = (0..self.angle.value.ncols()).collect();
        let balance = force.minus(&self.a.stiffness.times(&self.angle)).select(&self.statics, &all);
        let Some(angles) = self.a.stiffness.select(&self.statics, &self.statics).solve(&balance) else {
            return Err(ModelError::Network(
                self.undetermined(&self.statics, "they have no inertia, spring or damper that holds them"),
            ));
        };
        for (row, group) in self.statics.clone().into_iter().enumerate() {
            self.angle.add_block(group, 0, &angles.row(row));
        }
        Ok(())
    }
}
