//! The ways in which a drivetrain moves: one, or, where a gear has play, three, with sharp boundaries between them.
//!
//! Teeth touch on one flank, are apart, or touch on the other. Contact is stiff and quick, and so is the law that takes it back
//! while teeth are apart; but each way for itself is linear, and exact in steps of any length. So a step ends where the twist in
//! the mesh meets a boundary, and what is stiff costs nothing.

use socam_model::Equations;

use crate::prediction::{
    exponential::{self, Sizes, StepLevel},
    inactive_laws::{self, InactiveLaws, OutputOnlyLaws},
    integrator::Instant,
    laws::Law,
    products::row_times,
    sensitivity::Constants,
};

/// Play below this is far less than what its law is rounded over, which is then taken as it is, rad.
const LEAST_GAP: f64 = 1e-9;

/// A linear motion, with what laws add to it.
pub(crate) struct Motion {
    pub(crate) equations: Equations,
    pub(crate) sensitivities: Vec<Equations>,
    pub(crate) levels: Vec<StepLevel>,
    /// What laws see at once of their own forces, row by row.
    pub(crate) coupling: Vec<f64>,
    pub(crate) constants: Constants,
    pub(crate) inactive_laws: InactiveLaws,
    pub(crate) output_only: OutputOnlyLaws,
}

/// A way of moving.
pub(crate) struct ContactMode {
    motion: usize,
    pub(crate) laws: Vec<Law>,
    /// Of the twist in the mesh, rad: beyond it lies the side before or after this one.
    pub(crate) range: [f64; 2],
}

/// What sees the play.
#[derive(Clone, Copy)]
pub(crate) struct Play {
    /// The port of the twist; that of its rate is the next.
    pub(crate) port: usize,
    /// Column of the gap, where it is estimated.
    pub(crate) gap: Option<usize>,
}

/// All ways of moving, in the order of the twist.
pub(crate) struct HybridModes {
    motions: Vec<Motion>,
    pub(crate) sides: Vec<ContactMode>,
    pub(crate) play: Option<Play>,
    /// Length of the shortest step, s.
    pub(crate) finest_s: f64,
    /// Number of free parameters, and of those up to the last that moves anything.
    pub(crate) free: usize,
    pub(crate) moving: usize,
}

impl Motion {
    /// `sensitivities` are those with respect to the parameters `free` at `values`; `None` where the exponential overflows.
    fn new(
        equations: &Equations,
        sensitivities: &[Equations],
        (values, free): (&[f64], &[usize]),
        ports: [&[usize]; 2],
        sample_time_s: f64,
    ) -> Option<Self> {
        let live = equations.with_ports(ports[0]);
        let mut moved: Vec<Equations> =
            sensitivities.iter().map(|sensitivity| sensitivity.with_ports(ports[0])).collect();
        // Parameters of laws come last and move none of this. One at least is kept, so that there is something to add up.
        let last = moved.iter().rposition(moves).unwrap_or(0);
        moved.truncate(last + 1);
        let mut levels = exponential::levels(&live, &moved, sample_time_s)?;
        let [live_ports, quiet] = ports;
        let [moving, reading] = inactive_laws::parted(equations, quiet);
        let output_only = OutputOnlyLaws::new(equations, values, free, [live_ports, &reading]);
        let ports = [live_ports, &*moving];
        let inactive_laws = InactiveLaws::new(equations, values, free, ports);
        if !moving.is_empty() {
            let sizes = Sizes::new(equations, 0);
            let all = exponential::levels(equations, &[], sample_time_s)?;
            // Where all are inactive nothing bends, and a step is a sample.
            for (level, whole) in levels.iter_mut().zip(&all) {
                level.inactive_inputs = inactive_laws.inactive_inputs(whole, sizes, ports);
            }
        }
        let constants = Constants::new(&live, &moved);
        let coupling = live.port_force.transpose().iter().copied().collect();
        Some(Self {
            equations: live,
            sensitivities: moved,
            levels,
            coupling,
            constants,
            inactive_laws,
            output_only,
        })
    }

    /// Of the states, at an instant.
    pub(crate) fn rates(&self, at: &Instant) -> Vec<f64> {
        rates(&self.equations, at)
    }

    /// How these move with each parameter while states and forces stay.
    pub(crate) fn moved_rates(&self, at: &Instant) -> Vec<Vec<f64>> {
        self.sensitivities.iter().map(|sensitivity| rates(sensitivity, at)).collect()
    }
}

impl HybridModes {
    /// Of `equations` at parameters `values`, with sensitivities with respect to those with the indices `free`; `None` where the exponential
    /// overflows.
    pub(crate) fn new(
        equations: &Equations,
        sensitivities: &[Equations],
        values: &[f64],
        free: &[usize],
        sample_time_s: f64,
    ) -> Option<Self> {
        let finest_s = sample_time_s * 0.5_f64.powi(exponential::HALVINGS as i32);
        let (quiet, live): (Vec<usize>, Vec<usize>) =
            (0..equations.ports.len()).partition(|port| equations.ports[*port].is_silent(values));
        let ports = [&*live, &*quiet];
        let motion = |equations: &Equations, sensitivities: &[Equations]| {
            Motion::new(equations, sensitivities, (values, free), ports, sample_time_s)
        };
        let touching = motion(equations, sensitivities)?;
        let laws = Law::all(&touching.equations, values, free);
        // Whatever ways of moving there are, the same parameters move them.
        let by_laws = laws.iter().flat_map(Law::columns).chain(touching.inactive_laws.columns());
        let moving = by_laws.map(|column| column + 1).fold(touching.sensitivities.len(), usize::max);
        let one = |touching, laws| {
            let everywhere = [f64::NEG_INFINITY, f64::INFINITY];
            let side = ContactMode { motion: 0, laws, range: everywhere };
            Self {
                motions: vec![touching],
                sides: vec![side],
                play: None,
                finest_s,
                free: free.len(),
                moving,
            }
        };
        // Of several gears with play none is treated so: their ways of moving would multiply.
        let is_play = |p: &usize| equations.ports[*p].law_input == 0 && equations.ports[*p].is_play();
        let mut plays = live.iter().filter(|p| is_play(p));
        let (Some(port), None) = (plays.next(), plays.next()) else { return Some(one(touching, laws)) };
        let gap = equations.ports[*port].parameters[0];
        let apart = equations.apart(sensitivities, values, free, *port);
        let Some((loose, moved)) = apart.filter(|_| values[gap] > LEAST_GAP) else {
            return Some(one(touching, laws));
        };
        let loose = motion(&loose, &moved)?;
        let by_listeners = loose.inactive_laws.columns().map(|column| column + 1);
        let moving = by_listeners.fold(moving.max(loose.sensitivities.len()), usize::max);
        let port = live.iter().position(|p| p == port)?;
        let half = 0.5 * values[gap];
        let side = |motion: usize, range: [f64; 2], flank: f64| {
            let mut laws = Law::all(&touching.equations, values, free);
            laws[port].stay_on(flank);
            ContactMode { motion, laws, range }
        };
        let sides = vec![
            side(0, [f64::NEG_INFINITY, -half], -1.0),
            side(1, [-half, half], 0.0),
            side(0, [half, f64::INFINITY], 1.0),
        ];
        let gap = free.iter().position(|index| *index == gap);
        let play = Some(Play { port, gap });
        Some(Self { motions: vec![touching, loose], sides, play, finest_s, free: free.len(), moving })
    }

    /// Of the network as it is, teeth in touch.
    pub(crate) fn network(&self) -> &Motion {
        &self.motions[0]
    }

    pub(crate) fn motion(&self, side: usize) -> &Motion {
        &self.motions[self.sides[side].motion]
    }

    /// Where the twist in the mesh is when this state is met.
    pub(crate) fn side_at(&self, state: &[f64], inputs: &[f64]) -> usize {
        let Some(Play { port, .. }) = self.play else { return 0 };
        let e = &self.network().equations;
        let twist = row_times(&e.port, port, state) + row_times(&e.port_input, port, inputs);
        self.sides.iter().position(|side| twist <= side.range[1]).unwrap_or(0)
    }
}

fn rates(e: &Equations, at: &Instant) -> Vec<f64> {
    let rate = |i| {
        row_times(&e.state, i, &at.state)
            + row_times(&e.input, i, &at.inputs)
            + row_times(&e.force, i, &at.forces)
    };
    (0..e.state.nrows()).map(rate).collect()
}

/// Whether a parameter with these sensitivities moves anything but laws.
fn moves(sensitivity: &Equations) -> bool {
    let Equations {
        state,
        input,
        force,
        output,
        feedthrough,
        force_output,
        port,
        port_input,
        port_force,
        ..
    } = sensitivity;
    [state, input, force, output, feedthrough, force_output, port, port_input, port_force]
        .into_iter()
        .any(|matrix| matrix.iter().any(|value| *value != 0.0))
}
