//! The truth's equations of motion: rigid groups of nodes, springs, laws. They share nothing with `socam_model`'s assembly: no
//! matrices, no condensation of massless nodes, no slopes.

use std::f64::consts::TAU;

use super::laws::{self, Acting, Law, Seen, Site};
use super::machine::{Control, Drive, Machine};

/// A gear that is not rigid is a contact whose oscillation lies so many times above the machine's band, its lowest frequency, Hz,
/// and its damping ratio.
const CONTACT_OVER_BAND: f64 = 12.0;
const LOWEST_CONTACT_HZ: f64 = 1200.0;
const CONTACT_DAMPING: f64 = 0.2;

/// Everything that turns as one.
#[derive(Debug, Clone, Copy)]
struct Group {
    inertia: f64,
    prescribed: bool,
}

/// A spring with its true numbers.
#[derive(Debug, Clone, Copy)]
struct Elastic {
    from: usize,
    to: usize,
    /// `from` turns so many times as fast as `to` while it does not twist; 1 but for gears.
    ratio: f64,
    stiffness: f64,
    damping: f64,
}

/// A shaft or gear that is not rigid in the truth: its name, stiffness and damping.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Released {
    pub(super) tie: String,
    pub(super) stiffness: f64,
    pub(super) damping: f64,
}

/// What a machine has beside its model.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Beside {
    pub(super) released: Vec<Released>,
    pub(super) acting: Vec<Acting>,
    /// Inertia more at a node, by name.
    pub(super) inertia: Vec<(String, f64)>,
}

/// A machine in motion.
#[derive(Debug)]
pub(super) struct Motion {
    /// Group of each node, and how many times as fast as the group it turns.
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

/// What drives a motion at a moment.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fed {
    /// Torque on the driven node, its speed, or the servo's reference.
    pub(super) value: f64,
    /// How fast that changes, per s.
    pub(super) slope: f64,
    /// Torque of a servo that is sampled, in the place of the servo's own.
    pub(super) held: Option<f64>,
}

/// A moment of a motion.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Moment {
    /// Of each node, rad and rad/s.
    pub(super) angle: Vec<f64>,
    pub(super) speed: Vec<f64>,
    /// Of each spring of the machine, rad and N m.
    pub(super) twist: Vec<f64>,
    pub(super) torque: Vec<f64>,
    /// What the drive puts out.
    pub(super) effort: f64,
}

impl Motion {
    /// The machine with what it has beside its model.
    pub(super) fn new(machine: &Machine, beside: &Beside) -> Self {
        let Beside { released, acting, inertia } = beside;
        let nodes = tie(machine, released, acting);
        let mut motion = Self {
            groups: groups(machine, &nodes, inertia),
            nodes,
            springs: Vec::new(),
            names: Vec::new(),
            dampers: Vec::new(),
            gravity: machine.gravity.map(|(node, torque)| (node, machine.value(torque))),
            laws: Vec::new(),
            drive: machine.input.drive,
            driven: machine.input.node,
            servo: match machine.control {
                Control::Position { position_gain, velocity_gain } => (position_gain, velocity_gain),
                _ => (0.0, 0.0),
            },
            states: 0,
        };
        motion.add_springs(machine, released, acting);
        motion.dampers = machine
            .bearings
            .iter()
            .filter_map(|bearing| Some((bearing.node, machine.value(bearing.damping?))))
            .collect();
        motion.states = 2 * motion.groups.len();
        for law in acting {
            motion.add_law(machine, law);
        }
        motion
    }

    fn add_springs(&mut self, machine: &Machine, released: &[Released], acting: &[Acting]) {
        for spring in &machine.springs {
            self.names.push(spring.name.clone());
            self.springs.push(Elastic {
                from: spring.from,
                to: spring.to,
                ratio: 1.0,
                stiffness: machine.value(spring.stiffness),
                damping: spring.damping.map_or(0.0, |damping| machine.value(damping)),
            });
        }
        for tie in machine.shafts.iter().chain(&machine.gears) {
            let own = released.iter().find(|released| released.tie == tie.name);
            if own.is_none() && !is_loose(&tie.name, released, acting) {
                continue;
            }
            let ratio = tie.ratio.map_or(1.0, |ratio| machine.value(ratio));
            let (stiffness, damping) = own.map_or_else(
                || self.contact(machine, (tie.from, tie.to), ratio),
                |own| (own.stiffness, own.damping),
            );
            self.names.push(tie.name.clone());
            self.springs.push(Elastic { from: tie.from, to: tie.to, ratio, stiffness, damping });
        }
    }

    /// Stiffness and damping of a contact, so stiff that no recording shows it.
    fn contact(&self, machine: &Machine, (from, to): (usize, usize), ratio: f64) -> (f64, f64) {
        let inertia = |node: usize| {
            let (group, lever) = self.nodes[node];
            self.groups[group].inertia / (lever * lever)
        };
        let fast = if self.groups[self.nodes[from].0].prescribed { f64::INFINITY } else { inertia(from) };
        let (fast, slow) = (fast * ratio * ratio, inertia(to));
        let reduced = 1.0 / (1.0 / fast + 1.0 / slow);
        let pace = TAU * (CONTACT_OVER_BAND * machine.band_hz.1).max(LOWEST_CONTACT_HZ);
        (reduced * pace * pace, 2.0 * CONTACT_DAMPING * reduced * pace)
    }

    fn add_law(&mut self, machine: &Machine, acting: &Acting) {
        let named = |name: &str| machine.nodes.iter().position(|node| node.name == name);
        let bearing = machine.bearings.iter().find(|bearing| bearing.name == acting.place);
        let site = if let Some(bearing) = bearing {
            Site::Node(bearing.node)
        } else if let Some(node) = named(&acting.place) {
            Site::Node(node)
        } else if let Some(spring) = self.names.iter().position(|name| *name == acting.place) {
            Site::Spring(spring)
        } else {
            return;
        };
        let law = Law { kind: acting.kind, site, parameters: acting.parameters.clone(), first: self.states };
        self.states += law.kind.states();
        self.laws.push(law);
    }

    pub(super) fn states(&self) -> usize {
        self.states
    }

    /// The first states are so many angles, then their speeds, then the laws' own.
    pub(super) fn angles(&self) -> usize {
        self.groups.len()
    }

    /// Inertia that a node feels, all that is rigidly tied to it included.
    pub(super) fn inertia_at(&self, node: usize) -> f64 {
        let (group, lever) = self.nodes[node];
        self.groups[group].inertia / (lever * lever)
    }

    /// For each node that turns as one with a node, how many times as fast it turns; `None` for the others.
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

    /// What the drive puts out at an input.
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
    pub(super) fn rates(&self, time_s: f64, state: &[f64], fed: Fed, rates: &mut [f64]) {
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

    /// All that sensors may want to know.
    pub(super) fn moment(&self, time_s: f64, state: &[f64], fed: Fed, machine: &Machine) -> Moment {
        let nodes = 0..self.nodes.len();
        let springs = 0..machine.springs.len();
        let twist = |index: usize| {
            let spring = &machine.springs[index];
            self.angle(state, spring.from) - self.angle(state, spring.to)
        };
        Moment {
            angle: nodes.clone().map(|node| self.angle(state, node)).collect(),
            speed: nodes.map(|node| self.speed(state, node)).collect(),
            twist: springs.clone().map(twist).collect(),
            torque: springs.map(|index| self.spring_torque(index, time_s, state, None).0).collect(),
            effort: fed.held.unwrap_or_else(|| self.effort(state, fed.value)),
        }
    }
}

/// A gear at which something acts is not rigid.
fn is_loose(name: &str, released: &[Released], acting: &[Acting]) -> bool {
    released.iter().any(|released| released.tie == name) || acting.iter().any(|law| law.place == name)
}

/// Group and lever of each node: what rigid shafts and gears tie together.
fn tie(machine: &Machine, released: &[Released], acting: &[Acting]) -> Vec<(usize, f64)> {
    let mut nodes: Vec<(usize, f64)> = (0..machine.nodes.len()).map(|node| (node, 1.0)).collect();
    let ties = machine.shafts.iter().chain(&machine.gears);
    for tie in ties.filter(|tie| !is_loose(&tie.name, released, acting)) {
        let ratio = tie.ratio.map_or(1.0, |ratio| machine.value(ratio));
        let ((kept, lever), (joined, own)) = (nodes[tie.from], nodes[tie.to]);
        // angle(from) = ratio angle(to): the joined group turns so many times as fast as the kept one.
        let factor = lever / (ratio * own);
        for node in nodes.iter_mut().filter(|node| node.0 == joined) {
            *node = (kept, node.1 * factor);
        }
    }
    let mut kept: Vec<usize> = nodes.iter().map(|node| node.0).collect();
    kept.sort_unstable();
    kept.dedup();
    let number = |group: usize| kept.iter().position(|other| *other == group).unwrap_or(0);
    nodes.iter().map(|(group, lever)| (number(*group), *lever)).collect()
}

fn groups(machine: &Machine, nodes: &[(usize, f64)], more: &[(String, f64)]) -> Vec<Group> {
    let count = nodes.iter().map(|node| node.0 + 1).max().unwrap_or(0);
    let mut groups = vec![Group { inertia: 0.0, prescribed: false }; count];
    for (node, (group, lever)) in machine.nodes.iter().zip(nodes) {
        let own = node.inertia.map_or(node.small_inertia, |inertia| machine.value(inertia));
        let added: f64 = more.iter().filter(|(name, _)| *name == node.name).map(|(_, inertia)| inertia).sum();
        groups[*group].inertia += lever * lever * (own + added);
    }
    if machine.input.drive == Drive::Speed {
        groups[nodes[machine.input.node].0].prescribed = true;
    }
    groups
}
