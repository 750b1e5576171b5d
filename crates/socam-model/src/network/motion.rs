//! How all groups move: their velocities and accelerations as linear maps of states, inputs and what laws answer.

use super::{Assembly, Class, Reference};
use crate::{
    ModelError,
    effects::{Acts, Form, LawInput, sensor_delay},
    equations::{Equations, Port, Rows},
    file,
    jet::{Jet, Scalar},
    model::{Channel, EffectUse, Quantity, Role, Site, Spring},
};

/// Velocities and accelerations of all groups as linear maps of the columns
/// [angle states | speed states | states of effects | inputs | ports].
pub(super) struct Motion<'a, 'm> {
    a: &'a Assembly<'m>,
    massive: Vec<usize>,
    /// Groups whose angle is a state.
    angles: Vec<usize>,
    /// First column of each effect's own states, and how many it has.
    owned: Vec<(usize, usize)>,
    inputs: usize,
    ports: Vec<Port>,
    /// Effect that each port belongs to.
    port_owner: Vec<usize>,
    /// Maps per group, each groups x columns.
    angle: Jet,
    velocity: Jet,
    acceleration: Jet,
    statics: Vec<usize>,
}

impl<'a, 'm> Motion<'a, 'm> {
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
        let (ports, port_owner): (Vec<Port>, Vec<usize>) =
            a.model.effects.iter().enumerate().flat_map(|(index, used)| ports_of(index, used)).unzip();
        let columns = next + inputs + ports.len();
        let empty = Jet::zeros(groups, columns, a.wrt.len());
        let mut motion = Self {
            a,
            massive,
            angles,
            owned,
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

    fn first_input(&self) -> usize {
        self.angles.len() + self.massive.len() + self.owned.iter().map(|(_, count)| count).sum::<usize>()
    }

    fn first_port(&self) -> usize {
        self.first_input() + self.inputs
    }

    /// Columns of the ports of an effect's laws that act in some way.
    fn acting(&self, effect: usize, acts: Acts) -> impl Iterator<Item = usize> {
        let ports = self.ports.iter().zip(&self.port_owner).enumerate();
        ports
            .filter(move |(_, (port, owner))| **owner == effect && port.law.acts == acts)
            .map(|(index, _)| self.first_port() + index)
    }

    fn one(&self) -> Scalar {
        Scalar::constant(1.0, self.a.wrt.len())
    }

    /// SI value that acts per unit read, of an input; that is read per unit there is, of an output.
    fn gain(&self, channel: &Channel) -> Scalar {
        let own = channel.gain.map_or_else(|| self.one(), |parameter| self.a.scalar(parameter));
        let effects = self.a.model.effects.iter().filter(|used| matches!(used.effect.form, Form::Gain));
        effects.filter(|used| used.place == channel.name).fold(own, |gain, used| {
            let read = self.a.scalar(used.parameters[0]);
            if channel.role == Role::Input { gain.over(&read) } else { gain.times(&read) }
        })
    }

    /// Columns of the ports that are added to what a channel reads.
    fn read_beside(&self, channel: &Channel) -> Vec<usize> {
        let effects = self.a.model.effects.iter().enumerate();
        let own = effects.filter(|(_, used)| used.place == channel.name);
        own.flat_map(|(index, _)| self.acting(index, Acts::Reading)).collect()
    }

    /// An input's column, and those of the ports that tell how much it reads too much: with their signs.
    fn driving(&self, index: usize, channel: &Channel) -> Vec<(usize, f64)> {
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

    fn undetermined(&self, groups: &[usize], advice: &str) -> String {
        let names =
            self.a.model.nodes.iter().enumerate().filter(|(node, _)| groups.contains(&self.a.group[*node]));
        let names: Vec<_> = names.map(|(_, node)| node.name.as_str()).collect();
        format!("nothing decides how {} moves; {advice}", names.join(", "))
    }

    /// Inputs that prescribe a speed; a gear between the sensor's node and its group is undone here.
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

    /// Torque on each group from inputs and ports.
    fn applied_force(&self) -> Jet {
        let mut force = Jet::zeros(self.a.class.len(), self.angle.value.ncols(), self.a.wrt.len());
        for (index, channel) in self.a.model.inputs().enumerate() {
            let column = self.first_input() + index;
            match channel.quantity {
                Quantity::Torque => {
                    if let Some(node) = self.a.model.nodes.iter().position(|node| node.name == channel.at) {
                        let torque = self.gain(channel).times(&self.a.lever[node]);
                        for (column, sign) in self.driving(index, channel) {
                            let signed = torque.times(&Scalar::constant(sign, self.a.wrt.len()));
                            force.add_at(self.a.group[node], column, &signed);
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
                _ => {}
            }
        }
        for (index, used) in self.a.model.effects.iter().enumerate() {
            let on_node = match used.at {
                Site::Node(node) => Some((node, Acts::Torque)),
                Site::Gear { slow, .. } => Some((slow, Acts::Drag)),
                Site::Spring(_) | Site::Channel(_) => None,
            };
            if let Some((node, acts)) = on_node {
                for column in self.acting(index, acts) {
                    force.add_at(self.a.group[node], column, &self.a.lever[node]);
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

    /// Torque through a spring per unit of an input that is added to its twist.
    fn twisting(&self, spring: &Spring, channel: &Channel) -> Scalar {
        self.a.scalar(spring.stiffness).times(&self.gain(channel))
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

    fn node_velocity(&self, node: usize) -> Jet {
        self.a.node_row(node).times(&self.velocity)
    }

    /// Speeds of static groups are not states and would need derivatives of the input.
    fn require_speed(&self, node: usize, who: &str) -> Result<(), ModelError> {
        if self.statics.contains(&self.a.group[node]) {
            let place = &self.a.model.nodes[node].name;
            return Err(ModelError::Network(format!(
                "{who} needs the speed of {place}, which has neither inertia nor damper; give it one"
            )));
        }
        Ok(())
    }

    fn output_row(&self, channel: &Channel) -> Result<Jet, ModelError> {
        let model = self.a.model;
        if channel.quantity == Quantity::Torque {
            return self.torque_row(channel);
        }
        let node = self.a.node_named(&channel.at, &channel.name)?;
        let row = self.a.node_row(node);
        match channel.quantity {
            Quantity::Speed => {
                self.require_speed(node, &channel.name)?;
                Ok(row.times(&self.velocity))
            }
            Quantity::Angle => Ok(row.times(&self.angle)),
            Quantity::Acceleration if self.a.class[self.a.group[node]] == Class::Massive => {
                Ok(row.times(&self.acceleration))
            }
            Quantity::Acceleration => Err(ModelError::Network(format!(
                "channel {} measures an acceleration, so {} must have an inertia",
                channel.name, model.nodes[node].name
            ))),
            Quantity::Torque | Quantity::Reference | Quantity::Time | Quantity::Turned | Quantity::Change => {
                Err(ModelError::Network(format!(
                    "channel {} is a reference; that can only be an input",
                    channel.name
                )))
            }
        }
    }

    /// Torque through a spring.
    fn spring_torque(&self, spring: &Spring) -> Jet {
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

    fn torque_row(&self, channel: &Channel) -> Result<Jet, ModelError> {
        let model = self.a.model;
        if let Some(spring) = model.springs.iter().find(|spring| spring.name == channel.at) {
            return Ok(self.spring_torque(spring));
        }
        match (&model.servo, self.a.servo_terms()) {
            (Some(servo), Some((row, proportional, derivative))) if servo.name == channel.at => {
                let mut torque = Jet::zeros(1, self.angle.value.ncols(), self.a.wrt.len())
                    .minus(&row.times(&self.angle).scaled(&proportional))
                    .minus(&row.times(&self.velocity).scaled(&derivative));
                for (index, input) in model.inputs().enumerate() {
                    if input.quantity == Quantity::Reference {
                        let proportional = proportional.times(&self.gain(input));
                        torque.add_at(0, self.first_input() + index, &proportional);
                    }
                }
                Ok(torque)
            }
            _ => Err(ModelError::Network(format!(
                "channel {} measures a torque at {}, which is neither a spring nor a servo; a rigid part's torque is not known",
                channel.name, channel.at,
            ))),
        }
    }

    /// What a channel would read were its sensor true but for its gain; its filter and what is added to it come after.
    fn true_reading(&self, channel: &Channel) -> Result<Jet, ModelError> {
        if channel.role == Role::Input {
            let mut row = self.nothing();
            let index = self.a.model.inputs().position(|input| input.name == channel.name);
            row.add_at(0, self.first_input() + index.unwrap_or(0), &self.one());
            return Ok(row);
        }
        Ok(self.output_row(channel)?.scaled(&self.gain(channel)))
    }

    fn nothing(&self) -> Jet {
        Jet::zeros(1, self.angle.value.ncols(), self.a.wrt.len())
    }

    /// The sensor's filter: rates of its states in `rates`, and what comes out.
    fn filtered(&self, channel: &Channel, rates: &mut Jet, mut reading: Jet) -> Jet {
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
                // Each section: a' = b, b' = q (y - a)/d² - p b/d; out comes y - 2 p/q d b. Scaled: b is stored as d b.
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
                _ => {}
            }
        }
        reading
    }

    /// What the law of a port sees.
    fn seen(&self, port: usize) -> Result<Jet, ModelError> {
        let effect = self.port_owner[port];
        let used = &self.a.model.effects[effect];
        let Some(law_input) = self.ports[port].law.law_inputs.get(self.ports[port].law_input) else {
            return Ok(self.nothing());
        };
        let node = match used.at {
            Site::Node(node) => Some(node),
            Site::Gear { fast, slow, .. } => Some(if *law_input == LawInput::Angle { fast } else { slow }),
            Site::Spring(_) => None,
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
            (LawInput::Torque, ..) => {
                spring.map_or_else(|| self.nothing(), |spring| self.spring_torque(spring))
            }
            (LawInput::Time, ..) => self.clock(Quantity::Time),
            (LawInput::Change, ..) => self.input_named(&file::change_of(&used.place)),
            (LawInput::State, ..) => {
                let mut row = self.nothing();
                row.add_at(0, self.owned[effect].0, &self.one());
                row
            }
            (LawInput::Reading, ..) => match used.at {
                Site::Channel(channel) => self.true_reading(&self.a.model.channels[channel])?,
                _ => self.nothing(),
            },
            _ => self.nothing(),
        })
    }

    fn input_named(&self, name: &str) -> Jet {
        let mut row = self.nothing();
        if let Some(index) = self.a.model.inputs().position(|input| input.name == name) {
            row.add_at(0, self.first_input() + index, &self.one());
        }
        row
    }

    fn clock(&self, quantity: Quantity) -> Jet {
        let mut row = self.nothing();
        if let Some(index) = self.a.model.inputs().position(|input| input.quantity == quantity) {
            row.add_at(0, self.first_input() + index, &self.one());
        }
        row
    }

    /// Angle through which a node has turned: that of the shaft whose turning is an input, and what springs between wind up.
    fn turned(&self, node: usize, used: &EffectUse) -> Result<Jet, ModelError> {
        let angle = |node: usize| self.a.node_row(node).times(&self.angle);
        let Some(clock) = self.a.model.inputs().find(|input| input.quantity == Quantity::Turned) else {
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
        let rows = Rows { rates, observed, seen };
        let (equations, derivatives) = rows.split([states, self.inputs, ports]);
        let takes = self.a.model.inputs().map(|input| input.take).collect();
        Ok((
            Equations { ports: self.ports.clone(), state_names: self.state_names(), takes, ..equations },
            derivatives,
        ))
    }

    fn state_names(&self) -> Vec<String> {
        let name = |group: &usize| {
            let node = self.a.group.iter().position(|candidate| candidate == group);
            node.map_or_else(String::new, |node| self.a.model.nodes[node].name.clone())
        };
        let kind = if self.a.reference == Reference::Ground { "angle of" } else { "wind-up of" };
        let angles = self.angles.iter().map(|group| format!("{kind} {}", name(group)));
        let speeds = self.massive.iter().map(|group| format!("speed of {}", name(group)));
        let owned = self.a.model.effects.iter().flat_map(|used| {
            (0..states_of(used)).map(|index| format!("state {index} of {} at {}", used.effect.id, used.place))
        });
        angles.chain(speeds).chain(owned).collect()
    }
}

/// States that an effect has of its own.
fn states_of(used: &EffectUse) -> usize {
    match used.effect.form {
        Form::Laws(laws) => laws.iter().filter(|law| law.acts == Acts::State).count(),
        Form::Lag => 1,
        Form::Delay => 2 * sensor_delay::SECTIONS.len(),
        Form::Inertia | Form::Compliance | Form::Gain => 0,
    }
}

fn ports_of(index: usize, used: &EffectUse) -> Vec<(Port, usize)> {
    let port = |law: &'static crate::effects::Law, law_input: usize| Port {
        effect: used.effect,
        law,
        place: used.place.clone(),
        parameters: used.parameters.clone(),
        law_input,
    };
    let law_inputs =
        used.effect.laws().iter().flat_map(|law| (0..law.law_inputs.len().max(1)).map(move |s| (law, s)));
    law_inputs.map(|(law, law_input)| (port(law, law_input), index)).collect()
}
