//! Inertia, damping and stiffness matrices of a network's groups.

use super::groups::{mix_groups, tie_nodes};
use crate::{
    Channel, EffectUse, Model, ModelError, Motor, Quantity, Role, Site, Spring,
    effects::Form,
    jet::{Jet, Scalar},
};

/// Kind of a coordinate, by what determines its motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Class {
    /// A differential moves it; it has no coordinate of its own.
    Mixed,
    Prescribed,
    Massive,
    Damped,
    Static,
}

/// The origin of angles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Reference {
    /// The prescribed coordinate.
    Driven(usize),
    /// A massive coordinate of a drivetrain that floats freely.
    Massive(usize),
    /// The ground.
    Ground,
}

pub(super) struct Assembly<'m> {
    pub(super) model: &'m Model,
    pub(super) values: &'m [f64],
    pub(super) wrt: &'m [usize],
    /// Group of each node.
    pub(super) group: Vec<usize>,
    /// Motion of each node divided by the motion of its group.
    pub(super) lever: Vec<Scalar>,
    /// Motion of each group as a row over the groups with a coordinate, see [`mix_groups`].
    mixed: Vec<Jet>,
    /// Group of the frame on which the machine stands, where an effect lets it move. All other coordinates are relative to it.
    pub(super) frame: Option<usize>,
    pub(super) inertia: Jet,
    pub(super) damping: Jet,
    pub(super) stiffness: Jet,
    pub(super) class: Vec<Class>,
    pub(super) reference: Reference,
    /// Motion of each group divided by the motion of the reference while no spring twists.
    pub(super) rigid: Vec<Scalar>,
}

impl<'m> Assembly<'m> {
    pub(super) fn new(model: &'m Model, values: &'m [f64], wrt: &'m [usize]) -> Result<Self, ModelError> {
        let (group, lever, tied) = tie_nodes(model, values, wrt)?;
        // The frame's coordinate is the last: it holds no node.
        let frame =
            model.effects.iter().any(|used| matches!(used.effect.form, Form::Mounting)).then_some(tied);
        let groups = tied + usize::from(frame.is_some());
        let mixed = mix_groups(model, values, wrt, (&group, &lever, groups))?;
        let empty = Jet::zeros(groups, groups, wrt.len());
        let mut assembly = Self {
            model,
            values,
            wrt,
            group,
            lever,
            mixed,
            frame,
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

    pub(super) fn scalar(&self, parameter: usize) -> Scalar {
        Scalar::parameter(self.values, self.wrt, parameter)
    }

    /// Row that gives the motion of a node from the motions of the groups (1 x groups).
    pub(super) fn node_row(&self, node: usize) -> Jet {
        self.mixed[self.group[node]].scaled(&self.lever[node])
    }

    /// [`Self::node_row`] seen from the ground.
    pub(super) fn absolute_row(&self, node: usize) -> Jet {
        let mut row = self.node_row(node);
        if let Some(frame) = self.frame {
            row.add_at(0, frame, &Scalar::constant(1.0, self.wrt.len()));
        }
        row
    }

    /// Whether the coordinate of a group moves a node.
    pub(super) fn moves(&self, group: usize, node: usize) -> bool {
        self.mixed[self.group[node]].value[(0, group)] != 0.0
    }

    /// Whether a group has a coordinate.
    pub(super) fn is_free(&self, group: usize) -> bool {
        self.mixed[group].value[(0, group)] != 0.0
    }

    /// Row that gives the twist between two nodes (`None`: the ground).
    pub(super) fn twist_row(&self, from: usize, to: Option<usize>) -> Jet {
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
            let term = quadratic(&self.absolute_row(node), self.scalar(inertia));
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
        for motor in model.motors.iter().filter(|motor| motor.inductance.is_none()) {
            let damping = self.torque_per_volt(motor).times(&self.scalar(motor.back_emf));
            self.damping.add_block(0, 0, &quadratic(&self.node_row(motor.node), damping));
        }
        self.add_frame();
        if let Some((row, proportional, derivative)) = self.servo_terms() {
            self.stiffness.add_block(0, 0, &quadratic(&row, proportional));
            self.damping.add_block(0, 0, &quadratic(&row, derivative));
        }
    }

    fn add_frame(&mut self) {
        let Some(frame) = self.frame else { return };
        let mounted = self.model.effects.iter().filter(|used| matches!(used.effect.form, Form::Mounting));
        for used in mounted {
            let constant = |value: f64| Scalar::constant(value, self.wrt.len());
            let [stiffness, frequency, damping_ratio] =
                [0, 1, 2].map(|index| self.scalar(used.parameters[index]));
            let natural = frequency.times(&constant(std::f64::consts::TAU));
            let relaxation = constant(2.0).times(&damping_ratio).over(&natural);
            self.damping.add_at(frame, frame, &stiffness.times(&relaxation));
            self.inertia.add_at(frame, frame, &stiffness.over(&natural.times(&natural)));
            self.stiffness.add_at(frame, frame, &stiffness);
        }
    }

    /// Torque of a motor that stands still per volt, without inductance.
    pub(super) fn torque_per_volt(&self, motor: &Motor) -> Scalar {
        self.scalar(motor.torque_constant).over(&self.scalar(motor.resistance))
    }

    /// A servo acts as a spring and a damper between its node and its reference: row of the node, stiffness (N m/rad), damping (N m s/rad).
    pub(super) fn servo_terms(&self) -> Option<(Jet, Scalar, Scalar)> {
        let servo = self.model.servo.as_ref()?;
        let derivative = self.scalar(servo.drive_gain).times(&self.scalar(servo.velocity_gain));
        let proportional = derivative.times(&self.scalar(servo.position_gain));
        Some((self.node_row(servo.node), proportional, derivative))
    }

    pub(super) fn node_named(&self, place: &str, channel: &str) -> Result<usize, ModelError> {
        self.model.nodes.iter().position(|node| node.name == place).ok_or_else(|| {
            let nodes: Vec<&str> = self.model.nodes.iter().map(|node| node.name.as_str()).collect();
            ModelError::Network(format!(
                "channel {channel} needs a node, and {place} is none; write at = one of {}",
                nodes.join(", ")
            ))
        })
    }

    /// The spring that an effect acts at.
    pub(super) fn spring_of(&self, used: &EffectUse) -> Option<&'m Spring> {
        match used.at {
            Site::Spring(spring) | Site::Gear { contact: spring, .. } => self.model.springs.get(spring),
            Site::Node(_) | Site::Channel(_) | Site::Servo => None,
        }
    }

    /// The node of a channel's sensor: the channel's node, or the driving end of its spring.
    pub(super) fn shaft_of(&self, channel: &Channel) -> Option<usize> {
        let named = |name: &str| self.model.nodes.iter().position(|node| node.name == name);
        named(&channel.at).or_else(|| {
            let spring = self.model.springs.iter().find(|spring| spring.name == channel.at)?;
            Some(spring.from)
        })
    }

    /// The spring whose twist an input adds to.
    pub(super) fn twisted_spring(&self, channel: &Channel) -> Option<&'m Spring> {
        let twists = channel.role == Role::Input && channel.quantity == Quantity::Angle;
        self.model.springs.iter().find(|spring| twists && spring.name == channel.at)
    }

    pub(super) fn groups_of(&self, class: Class) -> Vec<usize> {
        (0..self.class.len()).filter(|group| self.class[*group] == class).collect()
    }
}
