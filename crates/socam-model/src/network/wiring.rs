//! Warnings of networks that have equations but are probably mistakes.

use super::assembly::{Assembly, Class};
use crate::{Channel, Model, Motion, Quantity, Role};

/// Relative difference above which two motions count as different.
const ROUNDING: f64 = 1e-9;

impl Model {
    /// Probable mistakes in the model, one sentence each: unused parameters, parts that carry no torque, loops that cannot turn, channels
    /// without information. Equations exist nevertheless.
    ///
    /// ```
    /// use socam_model::{BUILTIN, Model};
    ///
    /// let text = BUILTIN[1].1.replacen("[parameters]", "[parameters]\nspare = { value = 1, unit = \"1\" }", 1);
    /// let warnings = Model::parse(&text)?.warnings();
    /// assert!(warnings.len() == 1 && warnings[0].contains("spare"));
    /// # Ok::<(), socam_model::ModelError>(())
    /// ```
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = self.unused_parameters();
        warnings.extend(self.laws_that_drive());
        let values = self.values();
        if let Ok(assembly) = Assembly::new(self, &values, &[]) {
            warnings.extend(assembly.dead_ends());
            warnings.extend(assembly.springs_without_load());
            warnings.extend(assembly.locked_loops());
            warnings.extend(assembly.idle_channels());
        }
        warnings
    }

    /// Whether an element, an effect or a channel uses each parameter.
    /// Those of candidate laws are not.
    pub fn used_parameters(&self) -> Vec<bool> {
        let nodes = self.nodes.iter().filter_map(|node| node.inertia);
        let springs =
            self.springs.iter().flat_map(|spring| [Some(spring.stiffness), spring.damping]).flatten();
        let gears = self.gears.iter().map(|gear| gear.ratio);
        let bearings = self.bearings.iter().filter_map(|bearing| bearing.damping);
        let mixed = self.differentials.iter().flat_map(|differential| differential.factors);
        let windings = self.motors.iter().flat_map(|motor| {
            let always = [motor.resistance, motor.torque_constant, motor.back_emf];
            always.into_iter().chain(motor.inductance)
        });
        let servo =
            self.servo.iter().flat_map(|servo| [servo.position_gain, servo.velocity_gain, servo.drive_gain]);
        let effects = self.effects.iter().flat_map(|used| used.parameters.iter().copied());
        let channels = self.channels.iter().filter_map(|channel| channel.gain);
        let mut used = vec![false; self.parameters.len()];
        let all = nodes.chain(springs).chain(gears).chain(mixed).chain(bearings).chain(windings);
        let all = all.chain(servo).chain(effects).chain(channels);
        all.for_each(|index| used[index] = true);
        used
    }

    fn unused_parameters(&self) -> Vec<String> {
        let mut used = self.used_parameters();
        self.candidates.iter().flat_map(|own| &own.parameters).for_each(|index| used[*index] = true);
        let unused = self.parameters.iter().zip(used).filter(|(_, used)| !used);
        let sentence = |name: &str| {
            format!(
                "nothing uses the parameter {name}; name it where it belongs (as in damping = \"{name}\"), or remove it"
            )
        };
        unused.map(|(parameter, _)| sentence(&parameter.name)).collect()
    }
}

impl Model {
    /// Fixes the parameters that only candidates use: the model does not depend on them.
    pub(crate) fn fix_candidates(&mut self) {
        let used = self.used_parameters();
        for index in self.candidates.iter().flat_map(|own| &own.parameters).filter(|index| !used[**index]) {
            self.parameters[*index].fixed = true;
        }
    }
}

impl Assembly<'_> {
    /// Massless nodes with one gear or shaft and no other element.
    fn dead_ends(&self) -> Vec<String> {
        let model = self.model;
        let is_dead = |node: usize| {
            let sprung = model.springs.iter().any(|spring| spring.from == node || spring.to == Some(node));
            let name = &model.nodes[node].name;
            let watched = model.channels.iter().any(|channel| channel.at == *name);
            !sprung && !watched && model.nodes[node].inertia.is_none() && !self.is_held(node)
        };
        let gears = model.gears.iter().map(|gear| ("gear", &gear.name, gear.from, gear.to));
        let shafts = model.shafts.iter().map(|shaft| ("shaft", &shaft.name, shaft.nodes.0, shaft.nodes.1));
        let links: Vec<_> = gears.chain(shafts).collect();
        let ties = |node: usize| links.iter().filter(|(_, _, a, b)| *a == node || *b == node).count();
        let mut found = Vec::new();
        for (kind, name, from, to) in &links {
            for node in [*from, *to].into_iter().filter(|node| is_dead(*node) && ties(*node) == 1) {
                let node = &model.nodes[node].name;
                found.push(format!(
                    "the {kind} {name} moves nothing: its node {node} has no inertia, and nothing else is tied to it; tie the part that it moves to {node}"
                ));
            }
        }
        found
    }

    /// Whether something acts on a node besides springs, gears and shafts.
    fn is_held(&self, node: usize) -> bool {
        let model = self.model;
        let name = &model.nodes[node].name;
        let bearing = model.bearings.iter().any(|bearing| bearing.node == node);
        let servo = model.servo.as_ref().is_some_and(|servo| servo.node == node);
        let driven = model.inputs().any(|input| input.at == *name && input.quantity.drives());
        let effect = model.effects.iter().any(|used| used.place == *name);
        let motor = model.motors.iter().any(|motor| motor.node == node);
        let mixed = model.differentials.iter().any(|d| d.to == node || d.from.contains(&node));
        bearing || servo || driven || effect || motor || mixed
    }

    /// Springs that carry no torque, because the nodes behind them have no inertia and no load. A bearing without damping or effect is no
    /// load, but is no mistake either: it is a place for an effect.
    fn springs_without_load(&self) -> Vec<String> {
        let model = self.model;
        let mut heavy = vec![false; self.class.len()];
        for node in 0..model.nodes.len() {
            heavy[self.group[node]] |= model.nodes[node].inertia.is_some() || self.is_held(node);
        }
        let ends = |spring: usize| {
            let spring = &model.springs[spring];
            (self.group[spring.from], spring.to.map(|to| self.group[to]))
        };
        let mut left: Vec<usize> = (0..model.springs.len()).collect();
        let mut found = Vec::new();
        loop {
            let springs_at = |group: usize| {
                left.iter().filter(|s| ends(**s).0 == group || ends(**s).1 == Some(group)).count()
            };
            let loose = |group: usize| !heavy[group] && springs_at(group) == 1;
            let next = left.iter().position(|s| loose(ends(*s).0) || ends(*s).1.is_some_and(loose));
            let Some(next) = next else { return found };
            let spring = left[next];
            let (from, to) = ends(spring);
            let group = to.filter(|to| loose(*to)).unwrap_or(from);
            let behind = (0..model.nodes.len()).filter(|node| self.group[*node] == group);
            let behind: Vec<&str> = behind.map(|node| model.nodes[node].name.as_str()).collect();
            found.push(format!(
                "the spring {} carries no torque: {} behind it has no inertia, and nothing loads it; give it what it moves, or tie the spring to another node",
                model.springs[spring].name,
                behind.join(", ")
            ));
            left.remove(next);
        }
    }

    /// Springs that close a loop whose two paths have different ratios, which prevents motion.
    fn locked_loops(&self) -> Vec<String> {
        let model = self.model;
        if !model.differentials.is_empty()
            || model.motion != Motion::Rotation
            || model.springs.iter().any(|spring| spring.to.is_none())
        {
            return Vec::new();
        }
        // Motion of each group for a unit motion of the first group of its part. Each spring either extends the part or closes a loop.
        let mut motion: Vec<Option<f64>> = vec![None; self.class.len()];
        let mut open: Vec<usize> = (0..model.springs.len()).collect();
        let end =
            |motion: &[Option<f64>], node: usize| Some(motion[self.group[node]]? * self.lever[node].value);
        let mut found = Vec::new();
        while !open.is_empty() {
            let reaches = |spring: &usize| {
                let spring = &model.springs[*spring];
                end(&motion, spring.from).is_some() || spring.to.is_some_and(|to| end(&motion, to).is_some())
            };
            let Some(next) = open.iter().position(reaches) else {
                motion[self.group[model.springs[open[0]].from]] = Some(1.0);
                continue;
            };
            let spring = &model.springs[open.remove(next)];
            let Some(to) = spring.to else { continue };
            match (end(&motion, spring.from), end(&motion, to)) {
                (Some(from), None) => motion[self.group[to]] = Some(from / self.lever[to].value),
                (None, Some(to)) => {
                    motion[self.group[spring.from]] = Some(to / self.lever[spring.from].value)
                }
                (Some(a), Some(b)) if (a - b).abs() > ROUNDING * a.abs().max(b.abs()) => {
                    let [from, to] = [spring.from, to].map(|node| &model.nodes[node].name);
                    found.push(format!(
                        "nothing can turn: the spring {} makes {from} and {to} turn at one speed, but through the rest of its loop {from} turns {} times as fast; one spring of this loop is tied to the wrong side of a gear",
                        spring.name,
                        (1e4 * a / b).round() / 1e4
                    ));
                }
                _ => {}
            }
        }
        found
    }

    /// Channels without influence or information, because an input prescribes the speed at their place.
    fn idle_channels(&self) -> Vec<String> {
        let group_of = |channel: &Channel| {
            let node = self.model.nodes.iter().position(|node| node.name == channel.at)?;
            Some(self.group[node])
        };
        let prescribing = |group: usize| {
            self.model
                .inputs()
                .find(|input| input.quantity == Quantity::Speed && group_of(input) == Some(group))
        };
        let mut found = Vec::new();
        for channel in self.model.channels.iter().filter(|channel| !channel.quantity.is_clock()) {
            let Some(group) = group_of(channel).filter(|group| self.class[*group] == Class::Prescribed)
            else {
                continue;
            };
            let Some(input) = prescribing(group) else { continue };
            let (name, by) = (&channel.name, &input.name);
            match (channel.role, channel.quantity) {
                (Role::Input, Quantity::Torque) => found.push(format!(
                    "channel {name} moves nothing: the speed of {} is prescribed by channel {by}; make that one an output, or leave {name} out",
                    channel.at
                )),
                (Role::Output, Quantity::Speed | Quantity::Angle | Quantity::Acceleration) => found.push(format!(
                    "channel {name} contains no information on the drivetrain: it measures what channel {by} prescribes; leave it out, or measure elsewhere"
                )),
                (Role::Input, Quantity::Speed | Quantity::Angle | Quantity::Acceleration)
                | (Role::Output, Quantity::Torque)
                | (_, Quantity::Voltage | Quantity::Current)
                | (_, Quantity::Reference | Quantity::Signal | Quantity::Time | Quantity::Turned | Quantity::Change) => {}
            }
        }
        found
    }
}
