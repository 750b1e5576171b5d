//! The modes of a drivetrain as a hybrid system: one, or three where a gear has play, with sharp boundaries between them.
//!
//! The teeth of a gear with play touch on one flank, are apart, or touch on the other flank. Contact is stiff and fast, and so is the
//! law that cancels it while the teeth are apart. Each mode for itself is linear, and exact in steps of any length. A step therefore
//! ends where the twist in the mesh crosses a boundary, and the stiffness of the contact costs no steps.

use socam_model::Equations;

use crate::prediction::{
    exponential::{self, SampleSteps},
    inactive_laws::{self, InactiveInputs, InactiveLaws, OutputOnlyLaws},
    instant::Instant,
    laws::PortLaw,
    output_map::OutputMap,
    row_products::row_times,
    step_level::{Dimensions, StepLevel},
};

/// Play below this is integrated through its smooth law, rad: the law rounds its corners over a similar width.
const LEAST_GAP: f64 = 1e-9;

/// The linear motion of a mode, and its force laws.
pub(crate) struct LinearDynamics {
    /// Equations with only the active ports.
    pub(crate) equations: Equations,
    /// Derivatives of `equations` with respect to the free parameters up to the last that changes a matrix.
    pub(crate) sensitivities: Vec<Equations>,
    /// Steps of a sample, half a sample, and so on.
    pub(crate) levels: Vec<StepLevel>,
    /// One for each of `levels`; empty where all laws are active.
    inactive_inputs: Vec<InactiveInputs>,
    /// Direct effect of each port's force on each port's input: ports x ports, row by row.
    pub(crate) coupling: Vec<f64>,
    pub(crate) output_map: OutputMap,
    pub(crate) inactive_laws: InactiveLaws,
    pub(crate) output_only: OutputOnlyLaws,
}

/// One mode.
pub(crate) struct ContactMode {
    dynamics: usize,
    pub(crate) laws: Vec<PortLaw>,
    /// Range of the twist in the mesh, rad. The previous mode lies below, the next one above.
    pub(crate) range: [f64; 2],
}

/// The law of a gear's play.
#[derive(Clone, Copy)]
pub(crate) struct Play {
    /// The port of the mesh's twist; the next port is that of its rate.
    pub(crate) port: usize,
    /// Position of the gap among the free parameters; `None` where it is fixed.
    pub(crate) gap: Option<usize>,
}

/// All modes, in the order of the twist.
pub(crate) struct HybridModes {
    dynamics: Vec<LinearDynamics>,
    pub(crate) modes: Vec<ContactMode>,
    pub(crate) play: Option<Play>,
    /// Length of the shortest step, s.
    pub(crate) finest_s: f64,
    /// Number of free parameters.
    pub(crate) free: usize,
    /// Number of free parameters up to the last that changes the motion.
    pub(crate) moving: usize,
}

impl LinearDynamics {
    /// The mode with these `equations`. `sensitivities` are their derivatives with respect to the parameters `free`, at `values`;
    /// `ports` are the active and the inactive ones. `None` where the exponential overflows.
    fn new(
        equations: &Equations,
        sensitivities: &[Equations],
        (values, free): (&[f64], &[usize]),
        ports: [&[usize]; 2],
        steps: SampleSteps,
    ) -> Option<Self> {
        let [active, inactive] = ports;
        let own = equations.with_ports(active);
        let mut moved: Vec<Equations> =
            sensitivities.iter().map(|sensitivity| sensitivity.with_ports(active)).collect();
        // The parameters of laws come last and change no matrix. At least one derivative is kept, so that no sum is empty.
        let last = moved.iter().rposition(changes_a_matrix).unwrap_or(0);
        moved.truncate(last + 1);
        let levels = exponential::levels(&own, &moved, steps)?;
        let [moving, output_only] = inactive_laws::partition_by_action(equations, inactive);
        let output_only = OutputOnlyLaws::new(equations, values, free, [active, &output_only]);
        let ports = [active, &*moving];
        let inactive_laws = InactiveLaws::new(equations, values, free, ports);
        let mut inactive_inputs = Vec::new();
        if !moving.is_empty() {
            let dimensions = Dimensions::new(equations, 0);
            let all = exponential::levels(equations, &[], steps)?;
            inactive_inputs =
                all.iter().map(|level| inactive_laws.inactive_inputs(level, dimensions, ports)).collect();
        }
        // Without active ports there is one level, a sample.
        inactive_inputs.resize_with(inactive_inputs.len().max(levels.len()), InactiveInputs::default);
        Some(Self {
            output_map: OutputMap::new(&own, &moved),
            coupling: own.port_force.transpose().iter().copied().collect(),
            equations: own,
            sensitivities: moved,
            levels,
            inactive_inputs,
            inactive_laws,
            output_only,
        })
    }

    /// The map of a step to the inputs of the inactive laws.
    pub(crate) fn inactive_inputs(&self, level: usize) -> &InactiveInputs {
        &self.inactive_inputs[level]
    }

    /// Rates of the states at an instant.
    pub(crate) fn rates(&self, at: &Instant) -> Vec<f64> {
        rates(&self.equations, at)
    }

    /// Derivative of the rates with respect to each parameter, at constant states and forces.
    pub(crate) fn rate_sensitivities(&self, at: &Instant) -> Vec<Vec<f64>> {
        self.sensitivities.iter().map(|sensitivity| rates(sensitivity, at)).collect()
    }
}

impl HybridModes {
    /// The modes of `equations` at parameters `values`. `sensitivities` are the derivatives of `equations` with respect to the
    /// parameters with the indices `free`. `None` where the exponential overflows.
    pub(crate) fn new(
        equations: &Equations,
        sensitivities: &[Equations],
        values: &[f64],
        free: &[usize],
        steps: SampleSteps,
    ) -> Option<Self> {
        let finest_s = steps.longest_s() * 0.5_f64.powi(exponential::HALVINGS as i32);
        let (inactive, active): (Vec<usize>, Vec<usize>) =
            (0..equations.ports.len()).partition(|port| equations.ports[*port].is_inactive(values));
        let ports = [&*active, &*inactive];
        let dynamics = |equations: &Equations, sensitivities: &[Equations]| {
            LinearDynamics::new(equations, sensitivities, (values, free), ports, steps)
        };
        let touching = dynamics(equations, sensitivities)?;
        let laws = PortLaw::all(&touching.equations, values, free);
        // All modes keep sensitivities with respect to the same parameters.
        let by_laws = laws.iter().flat_map(PortLaw::columns).chain(touching.inactive_laws.columns());
        let moving = by_laws.map(|column| column + 1).fold(touching.sensitivities.len(), usize::max);
        let single = |touching, laws| {
            let range = [f64::NEG_INFINITY, f64::INFINITY];
            let (dynamics, modes) = (vec![touching], vec![ContactMode { dynamics: 0, laws, range }]);
            Self { dynamics, modes, play: None, finest_s, free: free.len(), moving }
        };
        // Several gears with play are integrated through their smooth laws: the number of their modes would multiply.
        let is_play = |p: &usize| equations.ports[*p].law_input == 0 && equations.ports[*p].is_play();
        let mut plays = active.iter().filter(|p| is_play(p));
        let (Some(port), None) = (plays.next(), plays.next()) else { return Some(single(touching, laws)) };
        let gap = equations.ports[*port].parameters[0];
        let apart = equations.apart(sensitivities, values, free, *port);
        let Some((apart, moved)) = apart.filter(|_| values[gap] > LEAST_GAP) else {
            return Some(single(touching, laws));
        };
        let apart = dynamics(&apart, &moved)?;
        let by_inactive = apart.inactive_laws.columns().map(|column| column + 1);
        let moving = by_inactive.fold(moving.max(apart.sensitivities.len()), usize::max);
        let port = active.iter().position(|p| p == port)?;
        let half = 0.5 * values[gap];
        let mode = |dynamics: usize, range: [f64; 2], flank: f64| {
            let mut laws = PortLaw::all(&touching.equations, values, free);
            laws[port].fix_flank(flank);
            ContactMode { dynamics, laws, range }
        };
        let modes = vec![
            mode(0, [f64::NEG_INFINITY, -half], -1.0),
            mode(1, [-half, half], 0.0),
            mode(0, [half, f64::INFINITY], 1.0),
        ];
        let gap = free.iter().position(|index| *index == gap);
        let play = Some(Play { port, gap });
        Some(Self { dynamics: vec![touching, apart], modes, play, finest_s, free: free.len(), moving })
    }

    /// Dynamics while teeth touch: those of the unchanged network.
    pub(crate) fn network(&self) -> &LinearDynamics {
        &self.dynamics[0]
    }

    pub(crate) fn dynamics(&self, mode: usize) -> &LinearDynamics {
        &self.dynamics[self.modes[mode].dynamics]
    }

    /// The mode whose range contains the twist in the mesh at this state.
    pub(crate) fn mode_at(&self, state: &[f64], inputs: &[f64]) -> usize {
        let Some(Play { port, .. }) = self.play else { return 0 };
        let e = &self.network().equations;
        let twist = row_times(&e.port, port, state) + row_times(&e.port_input, port, inputs);
        self.modes.iter().position(|mode| twist <= mode.range[1]).unwrap_or(0)
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

/// Whether the derivative with respect to a parameter has an entry that is not zero.
fn changes_a_matrix(sensitivity: &Equations) -> bool {
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
