//! Laws that answer nothing as yet: nothing depends on them, and what they would answer moves with their own parameters only.

use nalgebra::DMatrix;
use socam_model::Equations;

use crate::prediction::{
    exponential::{Sizes, StepLevel},
    integrator::Instant,
    laws::Law,
    products::row_times,
};

/// All of a model's, along one way of moving.
pub(crate) struct InactiveLaws {
    /// By what they hear first; each hears as much as its law has law_inputs.
    laws: Vec<Law>,
    /// First port of each.
    leaders: Vec<usize>,
    /// What they hear of states, inputs and the forces of the others.
    port: DMatrix<f64>,
    port_input: DMatrix<f64>,
    port_force: DMatrix<f64>,
    /// What their forces, one for each, would do to states, to what the others see, and to outputs.
    force: DMatrix<f64>,
    seen: DMatrix<f64>,
    output: DMatrix<f64>,
}

/// A step as they hear it.
#[derive(Default)]
pub(crate) struct InactiveInputs {
    /// What is inactive in its middle, then at its end, by its xi; row by row.
    inactive: Vec<f64>,
    width: usize,
    /// For each law what its force at the start, in the middle and at the end does to the step's rows: three after each other.
    drive: Vec<f64>,
    rows: usize,
}

/// Those of them that would change what sensors read, and move nothing: they hear the motion when it is observed.
pub(crate) struct OutputOnlyLaws {
    /// By what they hear first.
    laws: Vec<Law>,
    /// What they hear of states, inputs and forces, one after the other: for each as many numbers as there is to hear.
    inactive: Vec<f64>,
    count: usize,
    /// What each law's answer does to outputs.
    output: DMatrix<f64>,
}

/// How what a law would answer moves with one free parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct InactiveSensitivities {
    law: usize,
    pub(crate) column: usize,
    pub(crate) sensitivity: f64,
}

/// Parts the ports that are `quiet` into those whose forces would move something, and those that only sensors would show.
pub(crate) fn parted(equations: &Equations, quiet: &[usize]) -> [Vec<usize>; 2] {
    let mut leader = 0;
    let (moving, reading) = quiet.iter().partition(|port| {
        if equations.ports[**port].law_input == 0 {
            leader = **port;
        }
        let forces = [&equations.force, &equations.port_force];
        forces.into_iter().any(|matrix| matrix.column(leader).iter().any(|value| *value != 0.0))
    });
    [moving, reading]
}

/// First port of each law that some ports belong to.
fn leaders(equations: &Equations, ports: &[usize]) -> Vec<usize> {
    ports.iter().copied().filter(|p| equations.ports[*p].law_input == 0).collect()
}

impl OutputOnlyLaws {
    /// Of the ports `reading` of `equations`, of whose others `live` answer.
    pub(crate) fn new(
        equations: &Equations,
        values: &[f64],
        free: &[usize],
        [live, reading]: [&[usize]; 2],
    ) -> Self {
        let own = equations.with_ports(reading);
        let force = equations.port_force.select_rows(reading).select_columns(live);
        let leaders = leaders(equations, reading);
        Self {
            laws: Law::all(&own, values, free).into_iter().filter(Law::leads).collect(),
            inactive: [own.port, own.port_input, force]
                .iter()
                .flat_map(|part| part.iter().copied())
                .collect(),
            count: reading.len(),
            output: equations.force_output.select_columns(&leaders),
        }
    }

    /// What they would answer now.
    pub(crate) fn evaluate(&self, motion: impl Iterator<Item = f64>, all: &mut Vec<InactiveSensitivities>) {
        all.clear();
        if self.count == 0 {
            return;
        }
        let mut inactive = vec![0.0; self.count];
        for (value, column) in motion.zip(self.inactive.chunks_exact(self.count)) {
            inactive.iter_mut().zip(column).for_each(|(inactive, factor)| *inactive += factor * value);
        }
        evaluate(&self.laws, &inactive, all);
    }

    /// Of one of them to an output.
    pub(crate) fn to_output(&self, output: usize, inactive: &InactiveSensitivities) -> f64 {
        self.output[(output, inactive.law)] * inactive.sensitivity
    }
}

/// What laws would answer to what they hear, one after the other.
fn evaluate(laws: &[Law], inactive: &[f64], all: &mut Vec<InactiveSensitivities>) {
    let mut first = 0;
    for (index, law) in laws.iter().enumerate() {
        let sensitivities = law.at(&inactive[first..]).by_parameter;
        let own = law.free.iter().map(|(position, column)| InactiveSensitivities {
            law: index,
            column: *column,
            sensitivity: sensitivities[*position],
        });
        all.extend(own);
        first += law.count();
    }
}

impl InactiveLaws {
    /// Of the ports `quiet` of `equations`, of whose others `live` answer.
    pub(crate) fn new(
        equations: &Equations,
        values: &[f64],
        free: &[usize],
        [live, quiet]: [&[usize]; 2],
    ) -> Self {
        let own = equations.with_ports(quiet);
        let leaders = leaders(equations, quiet);
        Self {
            laws: Law::all(&own, values, free).into_iter().filter(Law::leads).collect(),
            port: own.port,
            port_input: own.port_input,
            port_force: equations.port_force.select_rows(quiet).select_columns(live),
            force: equations.force.select_columns(&leaders),
            seen: equations.port_force.select_rows(live).select_columns(&leaders),
            output: equations.force_output.select_columns(&leaders),
            leaders,
        }
    }

    /// Columns of what they would answer.
    pub(crate) fn columns(&self) -> impl Iterator<Item = usize> + '_ {
        self.laws.iter().flat_map(Law::columns)
    }

    /// What a step is to them, which is one of all ports.
    pub(crate) fn inactive_inputs(
        &self,
        level: &StepLevel,
        sizes: Sizes,
        [live, quiet]: [&[usize]; 2],
    ) -> InactiveInputs {
        let (n, p) = (sizes.states, sizes.ports);
        let others = (0..3).flat_map(|node| live.iter().map(move |port| sizes.forces() + node * p + port));
        let columns: Vec<usize> = (0..sizes.forces()).chain(others).collect();
        let ends = |ports: &[usize]| -> Vec<usize> {
            [n, n + p].iter().flat_map(|first| ports.iter().map(move |port| first + port)).collect()
        };
        let rows: Vec<usize> = (0..n).chain(ends(live)).collect();
        let at = |row: usize, column: usize| level.rows[row * sizes.width() + column];
        let inactive =
            ends(quiet).into_iter().flat_map(|row| columns.iter().map(move |column| at(row, *column)));
        let nodes =
            self.leaders.iter().flat_map(|port| (0..3).map(move |node| sizes.forces() + node * p + port));
        InactiveInputs {
            inactive: inactive.collect(),
            width: columns.len(),
            drive: nodes.flat_map(|column| rows.iter().map(move |row| at(*row, column))).collect(),
            rows: rows.len(),
        }
    }

    /// What they would answer at an instant.
    pub(crate) fn at(&self, at: &Instant) -> Vec<InactiveSensitivities> {
        let inactive: Vec<f64> = (0..self.port.nrows())
            .map(|row| {
                row_times(&self.port, row, &at.state)
                    + row_times(&self.port_input, row, &at.inputs)
                    + row_times(&self.port_force, row, &at.forces)
            })
            .collect();
        let mut all = Vec::new();
        evaluate(&self.laws, &inactive, &mut all);
        all
    }

    /// What they would answer in the middle of a step and at its end.
    pub(crate) fn along(
        &self,
        inactive_inputs: &InactiveInputs,
        xi: &[f64],
        [middle, end]: [&mut Vec<InactiveSensitivities>; 2],
    ) {
        let rows = inactive_inputs.inactive.chunks_exact(inactive_inputs.width.max(1));
        let inactive: Vec<f64> = rows.map(|row| row.iter().zip(xi).map(|(a, x)| a * x).sum()).collect();
        let (first, last) = inactive.split_at(inactive.len() / 2);
        for (inactive, all) in [(first, middle), (last, end)] {
            all.clear();
            evaluate(&self.laws, inactive, all);
        }
    }

    /// Of one of them to the rate of a state, to what a port sees, and to an output.
    pub(crate) fn to_rate(&self, state: usize, inactive: &InactiveSensitivities) -> f64 {
        self.force[(state, inactive.law)] * inactive.sensitivity
    }

    /// See [`InactiveLaws::to_rate`].
    pub(crate) fn to_port(&self, port: usize, inactive: &InactiveSensitivities) -> f64 {
        self.seen[(port, inactive.law)] * inactive.sensitivity
    }

    /// See [`InactiveLaws::to_rate`].
    pub(crate) fn to_output(&self, output: usize, inactive: &InactiveSensitivities) -> f64 {
        self.output[(output, inactive.law)] * inactive.sensitivity
    }
}

impl InactiveInputs {
    /// Adds to a step's rows, from row `first` on, what the answers at its start, in its middle and at its end do to them.
    pub(crate) fn add(
        &self,
        nodes: [&[InactiveSensitivities]; 3],
        first: usize,
        rows: &mut [f64],
        columns: usize,
    ) {
        for (node, answers) in nodes.into_iter().enumerate() {
            for answer in answers {
                let drive = &self.drive[(3 * answer.law + node) * self.rows..][first..];
                for (row, factor) in rows.chunks_exact_mut(columns).zip(drive) {
                    row[answer.column] += factor * answer.sensitivity;
                }
            }
        }
    }
}
