//! The truth's equations of motion: rigid groups of nodes, springs, laws. They share nothing with `socam_model`'s assembly: no
//! matrices, no condensation of massless nodes, no sensitivities.

mod assembly;

use super::laws::{self, Law, Seen, Site};
use super::machine::{Drive, Machine};
use super::unmodelled::{CompliantTie, Unmodelled};

/// Nodes that are rigidly tied together.
#[derive(Debug, Clone, Copy)]
struct Group {
    inertia: f64,
    prescribed: bool,
}

/// A spring with its true values.
#[derive(Debug, Clone, Copy)]
struct Elastic {
    from: usize,
    to: usize,
    /// Speed ratio of `from` to `to` without twist; 1 except for gears.
    ratio: f64,
    stiffness: f64,
    damping: f64,
}

/// The equations of motion of a machine.
#[derive(Debug)]
pub(super) struct Motion {
    /// Group of each node, and its speed ratio to the group.
    nodes: Vec<(usize, f64)>,
    groups: Vec<Group>,
    springs: Vec<Elastic>,
    names: Vec<String>,
    dampers: Vec<(usize, f64)>,
    gravity: Option<(usize, f64)>,
    laws: Vec<Law>,
    drive: Drive,
    driven: usize,
    servo: (f64, f64),
    states: usize,
}

/// The input of a motion at a time.
#[derive(Debug, Clone, Copy)]
pub(super) struct DriveInput {
    /// Torque on the driven node, its speed, or the servo's reference.
    pub(super) value: f64,
    /// Rate of change of `value`, per s.
    pub(super) slope: f64,
    /// Torque of a sampled servo, which replaces that of a continuous one.
    pub(super) held: Option<f64>,
}

/// A motion at a time.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct MotionSample {
    /// Angle and speed of each node, rad and rad/s.
    pub(super) angle: Vec<f64>,
    pub(super) speed: Vec<f64>,
    /// Twist and torque of each spring of the machine, rad and N m.
    pub(super) twist: Vec<f64>,
    pub(super) torque: Vec<f64>,
    /// Torque of the drive.
    pub(super) effort: f64,
}

impl Motion {
    pub(super) fn states(&self) -> usize {
        self.states
    }

    /// Number of angles. The states are the angles, then their speeds, then those of the laws.
    pub(super) fn angles(&self) -> usize {
        self.groups.len()
    }

    /// Inertia referred to a node, with all that is rigidly tied to it.
    pub(super) fn inertia_at(&self, node: usize) -> f64 {
        let (group, lever) = self.nodes[node];
        self.groups[group].inertia / (lever * lever)
    }

    /// Speed ratio to a node of each node that is rigidly tied to it; `None` for the others.
    pub(super) fn tied_to(&self, node: usize) -> Vec<Option<f64>> {
        let (group, lever) = self.nodes[node];
        self.nodes.iter().map(|(other, own)| (*other == group).then(|| own / lever)).collect()
    }

    fn angle(&self, state: &[f64], node: usize) -> f64 {
        let (group, lever) = self.nodes[node];
        lever * state[group]
    }

    fn speed(&self, state: &[f64], node: usize) -> f64 {
        let (group, lever) = self.nodes[node];
        lever * state[self.groups.len() + group]
    }

    /// Torque of the drive at an input.
    fn effort(&self, state: &[f64], input: f64) -> f64 {
        match self.drive {
            Drive::Torque => input,
            Drive::Speed => 0.0,
            Drive::Servo => {
                let (angle, speed) = (self.angle(state, self.driven), self.speed(state, self.driven));
                self.servo.1 * (self.servo.0 * (input - angle) - speed)
            }
        }
    }

    /// Rates of all states.
    pub(super) fn rates(&self, time_s: f64, state: &[f64], fed: DriveInput, rates: &mut [f64]) {
        let count = self.groups.len();
        rates.fill(0.0);
        let push = |rates: &mut [f64], node: usize, torque: f64| {
            let (group, lever) = self.nodes[node];
            rates[count + group] += lever * torque;
        };
        if self.drive != Drive::Speed {
            push(rates, self.driven, fed.held.unwrap_or_else(|| self.effort(state, fed.value)));
        }
        for (node, damping) in &self.dampers {
            push(rates, *node, -damping * self.speed(state, *node));
        }
        if let Some((node, torque)) = self.gravity {
            push(rates, node, -torque * self.angle(state, node).sin());
        }
        for law in &self.laws {
            if let Site::Node(node) = law.site {
                let seen = Seen {
                    time_s,
                    angle: self.angle(state, node),
                    speed: self.speed(state, node),
                    ..Seen::default()
                };
                let own = law.first..law.first + law.kind.states();
                let torque = laws::on_node(law, &seen, &state[own.clone()], &mut rates[own]);
                push(rates, node, torque);
            }
        }
        for index in 0..self.springs.len() {
            let spring = self.springs[index];
            let (torque, drag) = self.spring_torque(index, time_s, state, Some(&mut *rates));
            push(rates, spring.from, -torque / spring.ratio);
            push(rates, spring.to, torque + drag);
        }
        for (group, Group { inertia, prescribed }) in self.groups.iter().enumerate() {
            rates[group] = state[count + group];
            let rate = &mut rates[count + group];
            *rate = if *prescribed { 0.0 } else { *rate / inertia };
        }
        if self.drive == Drive::Speed {
            let (group, lever) = self.nodes[self.driven];
            rates[count + group] = fed.slope / lever;
        }
    }

    /// Torque through a spring, and drag on its driven side.
    fn spring_torque(
        &self,
        index: usize,
        time_s: f64,
        state: &[f64],
        mut rates: Option<&mut [f64]>,
    ) -> (f64, f64) {
        let spring = self.springs[index];
        let seen = Seen {
            time_s,
            angle: self.angle(state, spring.from),
            speed: self.speed(state, spring.to),
            twist: self.angle(state, spring.from) / spring.ratio - self.angle(state, spring.to),
            twist_rate: self.speed(state, spring.from) / spring.ratio - self.speed(state, spring.to),
            stiffness: spring.stiffness,
            damping: spring.damping,
            fast_speed: self.speed(state, spring.from),
            ratio: spring.ratio,
        };
        let mut through = laws::Through::plain(&seen);
        let mut spare = [0.0; laws::MOST_STATES];
        for law in self.laws.iter().filter(|law| law.site == Site::Spring(index)) {
            let count = law.kind.states();
            let own = law.first..law.first + count;
            let target = match &mut rates {
                Some(rates) => &mut rates[own.clone()],
                None => &mut spare[..count],
            };
            laws::at_spring(law, &seen, &state[own], target, &mut through);
        }
        (through.torque, through.drag)
    }

    /// All quantities that sensors measure.
    pub(super) fn moment(
        &self,
        time_s: f64,
        state: &[f64],
        fed: DriveInput,
        machine: &Machine,
    ) -> MotionSample {
        let nodes = 0..self.nodes.len();
        let springs = 0..machine.springs.len();
        let twist = |index: usize| {
            let spring = &machine.springs[index];
            self.angle(state, spring.from) - self.angle(state, spring.to)
        };
        MotionSample {
            angle: nodes.clone().map(|node| self.angle(state, node)).collect(),
            speed: nodes.map(|node| self.speed(state, node)).collect(),
            twist: springs.clone().map(twist).collect(),
            torque: springs.map(|index| self.spring_torque(index, time_s, state, None).0).collect(),
            effort: fed.held.unwrap_or_else(|| self.effort(state, fed.value)),
        }
    }
}

/// Reduced inertia of the two sides of a compliant shaft or gear, referred to its driven side.
pub(super) fn loose_inertia(machine: &Machine, tie: &str, (from, to): (usize, usize)) -> f64 {
    let compliant = vec![CompliantTie { tie: tie.into(), stiffness: 1.0, damping: 1.0 }];
    let motion = Motion::new(machine, &Unmodelled { compliant, ..Unmodelled::default() });
    1.0 / (1.0 / motion.inertia_at(from) + 1.0 / motion.inertia_at(to))
}
