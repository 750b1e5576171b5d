//! The ways in which a drivetrain moves: one, or, where a gear has play, three, with sharp boundaries between them.
//!
//! Teeth touch on one flank, are apart, or touch on the other. Contact is stiff and quick, and so is the law that takes it back
//! while teeth are apart; but each way for itself is linear, and exact in steps of any length. So a step ends where the twist in
//! the mesh meets a boundary, and what is stiff costs nothing.

use nalgebra::DMatrix;
use socam_model::Equations;

use crate::{
    exponential::{self, Level},
    laws::Law,
    sensitivity::Constants,
    walker::Instant,
};

/// Play below this is far less than what its law is rounded over, which is then taken as it is, rad.
const LEAST_GAP: f64 = 1e-9;

/// A linear motion, with what laws add to it.
pub(crate) struct Motion {
    pub(crate) equations: Equations,
    pub(crate) slopes: Vec<Equations>,
    pub(crate) levels: Vec<Level>,
    /// What laws see at once of their own forces, row by row.
    pub(crate) coupling: Vec<f64>,
    pub(crate) constants: Constants,
}

/// A way of moving.
pub(crate) struct Side {
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
pub(crate) struct Regimes {
    motions: Vec<Motion>,
    pub(crate) sides: Vec<Side>,
    pub(crate) play: Option<Play>,
    /// Length of the shortest step, s.
    pub(crate) finest_s: f64,
}

impl Motion {
    fn new(equations: Equations, slopes: Vec<Equations>, sample_time_s: f64) -> Option<Self> {
        let levels = exponential::levels(&equations, &slopes, sample_time_s)?;
        let constants = Constants::new(&equations, &slopes);
        let coupling = equations.port_force.transpose().iter().copied().collect();
        Some(Self { equations, slopes, levels, coupling, constants })
    }

    /// Of the states, at an instant.
    pub(crate) fn rates(&self, at: &Instant) -> Vec<f64> {
        rates(&self.equations, at)
    }

    /// How these move with each parameter while states and forces stay.
    pub(crate) fn moved_rates(&self, at: &Instant) -> Vec<Vec<f64>> {
        self.slopes.iter().map(|slope| rates(slope, at)).collect()
    }
}

impl Regimes {
    /// Of `equations` at parameters `values`, with slopes with respect to those with the indices `free`; `None` where the exponential
    /// overflows.
    pub(crate) fn new(
        equations: &Equations,
        slopes: &[Equations],
        values: &[f64],
        free: &[usize],
        sample_time_s: f64,
    ) -> Option<Self> {
        let finest_s = sample_time_s * 0.5_f64.powi(exponential::HALVINGS as i32);
        let laws = || Law::all(equations, values, free);
        let touching = Motion::new(equations.clone(), slopes.to_vec(), sample_time_s)?;
        let one = |touching| {
            let everywhere = [f64::NEG_INFINITY, f64::INFINITY];
            let side = Side { motion: 0, laws: laws(), range: everywhere };
            Self { motions: vec![touching], sides: vec![side], play: None, finest_s }
        };
        // Of several gears with play none is treated so: their ways of moving would multiply.
        let mut plays = (0..equations.ports.len())
            .filter(|p| equations.ports[*p].sight == 0 && equations.ports[*p].is_play());
        let (Some(port), None) = (plays.next(), plays.next()) else { return Some(one(touching)) };
        let gap = equations.ports[port].parameters[0];
        let apart = equations.apart(slopes, values, free, port);
        let Some((loose, moved)) = apart.filter(|_| values[gap] > LEAST_GAP) else {
            return Some(one(touching));
        };
        let loose = Motion::new(loose, moved, sample_time_s)?;
        let half = 0.5 * values[gap];
        let side = |motion: usize, range: [f64; 2], flank: f64| {
            let mut laws = laws();
            laws[port].stay_on(flank);
            Side { motion, laws, range }
        };
        let sides = vec![
            side(0, [f64::NEG_INFINITY, -half], -1.0),
            side(1, [-half, half], 0.0),
            side(0, [half, f64::INFINITY], 1.0),
        ];
        let gap = free.iter().position(|index| *index == gap);
        Some(Self { motions: vec![touching, loose], sides, play: Some(Play { port, gap }), finest_s })
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
        let twist: f64 = state.iter().enumerate().map(|(i, x)| e.port[(port, i)] * x).sum::<f64>()
            + inputs.iter().enumerate().map(|(i, u)| e.port_input[(port, i)] * u).sum::<f64>();
        self.sides.iter().position(|side| twist <= side.range[1]).unwrap_or(0)
    }
}

fn rates(e: &Equations, at: &Instant) -> Vec<f64> {
    let sum = |matrix: &DMatrix<f64>, i: usize, by: &[f64]| -> f64 {
        by.iter().enumerate().map(|(j, value)| matrix[(i, j)] * value).sum()
    };
    let rate = |i| sum(&e.state, i, &at.state) + sum(&e.input, i, &at.inputs) + sum(&e.force, i, &at.forces);
    (0..e.state.nrows()).map(rate).collect()
}
