//! Inactive laws: laws of zero amplitude, whose force is zero whatever their inputs. They do not change the motion; only the
//! sensitivities of their forces with respect to their own parameters are propagated.

use nalgebra::DMatrix;
use socam_model::Equations;

use crate::prediction::{
    instant::Instant,
    laws::PortLaw,
    row_products::row_times,
    step_level::{Dimensions, StepLevel},
};

/// The inactive laws of a model that would change the motion, in one mode.
pub(crate) struct InactiveLaws {
    /// One per law, with all of its inputs.
    laws: Vec<PortLaw>,
    /// First port of each law.
    first_ports: Vec<usize>,
    /// Inputs of all laws by states, by inputs, and by the forces of the active ports.
    port: DMatrix<f64>,
    port_input: DMatrix<f64>,
    port_force: DMatrix<f64>,
    /// Effect of each law's force on the rates of the states, on the inputs of the active ports, and on the outputs: one column a law.
    force: DMatrix<f64>,
    active_port: DMatrix<f64>,
    output: DMatrix<f64>,
}

/// The map of a step to the inputs of the inactive laws, and from their forces to the step's end.
#[derive(Default)]
pub(crate) struct InactiveInputs {
    /// Inputs of all laws in the middle of the step, then at its end, by the xi of the active ports: row by row.
    inputs: Vec<f64>,
    width: usize,
    /// For each law, the effect of its force at the start, in the middle and at the end on the step's rows: three columns of `rows`
    /// numbers after each other.
    drive: Vec<f64>,
    rows: usize,
}

/// The inactive laws that change what sensors read and not the motion. Their inputs are evaluated only when outputs are observed.
pub(crate) struct OutputOnlyLaws {
    laws: Vec<PortLaw>,
    /// Inputs of all laws by states, inputs and forces: `count` numbers for each of these.
    inputs: Vec<f64>,
    count: usize,
    /// Effect of each law on the outputs: one column a law.
    output: DMatrix<f64>,
}

/// Sensitivity of the force of one inactive law with respect to one free parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct InactiveSensitivity {
    law: usize,
    /// Position of the parameter among the free ones.
    pub(crate) column: usize,
    pub(crate) value: f64,
}

/// Divides the ports `inactive` into those whose forces would change the motion and those whose forces only sensors would show.
pub(crate) fn partition_by_action(equations: &Equations, inactive: &[usize]) -> [Vec<usize>; 2] {
    let mut first = 0;
    let (moving, output_only) = inactive.iter().partition(|port| {
        if equations.ports[**port].law_input == 0 {
            first = **port;
        }
        let forces = [&equations.force, &equations.port_force];
        forces.into_iter().any(|matrix| matrix.column(first).iter().any(|value| *value != 0.0))
    });
    [moving, output_only]
}

/// First port of each law that the ports belong to.
fn first_ports(equations: &Equations, ports: &[usize]) -> Vec<usize> {
    ports.iter().copied().filter(|p| equations.ports[*p].law_input == 0).collect()
}

/// Appends the sensitivities of the forces of `laws` to `all`; `inputs` holds the inputs of all laws, one law after the other.
fn evaluate(laws: &[PortLaw], inputs: &[f64], all: &mut Vec<InactiveSensitivity>) {
    let mut first = 0;
    for (index, law) in laws.iter().enumerate() {
        let by_parameter = law.at(&inputs[first..]).by_parameter;
        let own = law.free.iter().map(|(position, column)| InactiveSensitivity {
            law: index,
            column: *column,
            value: by_parameter[*position],
        });
        all.extend(own);
        first += law.count();
    }
}

impl OutputOnlyLaws {
    /// The laws of the ports `output_only` of `equations`; `active` are the ports whose laws have a force.
    pub(crate) fn new(
        equations: &Equations,
        values: &[f64],
        free: &[usize],
        [active, output_only]: [&[usize]; 2],
    ) -> Self {
        let own = equations.with_ports(output_only);
        let force = equations.port_force.select_rows(output_only).select_columns(active);
        let first_ports = first_ports(equations, output_only);
        Self {
            laws: PortLaw::all(&own, values, free).into_iter().filter(PortLaw::is_first_port).collect(),
            inputs: [own.port, own.port_input, force].iter().flat_map(|part| part.iter().copied()).collect(),
            count: output_only.len(),
            output: equations.force_output.select_columns(&first_ports),
        }
    }

    /// Sensitivities of the forces at `motion` = [x, u, f].
    pub(crate) fn evaluate(&self, motion: impl Iterator<Item = f64>, all: &mut Vec<InactiveSensitivity>) {
        all.clear();
        if self.count == 0 {
            return;
        }
        let mut inputs = vec![0.0; self.count];
        for (value, column) in motion.zip(self.inputs.chunks_exact(self.count)) {
            inputs.iter_mut().zip(column).for_each(|(input, factor)| *input += factor * value);
        }
        evaluate(&self.laws, &inputs, all);
    }

    /// Contribution of a sensitivity to an output.
    pub(crate) fn to_output(&self, output: usize, inactive: &InactiveSensitivity) -> f64 {
        self.output[(output, inactive.law)] * inactive.value
    }
}

impl InactiveLaws {
    /// The laws of the ports `inactive` of `equations`; `active` are the ports whose laws have a force.
    pub(crate) fn new(
        equations: &Equations,
        values: &[f64],
        free: &[usize],
        [active, inactive]: [&[usize]; 2],
    ) -> Self {
        let own = equations.with_ports(inactive);
        let first_ports = first_ports(equations, inactive);
        Self {
            laws: PortLaw::all(&own, values, free).into_iter().filter(PortLaw::is_first_port).collect(),
            port: own.port,
            port_input: own.port_input,
            port_force: equations.port_force.select_rows(inactive).select_columns(active),
            force: equations.force.select_columns(&first_ports),
            active_port: equations.port_force.select_rows(active).select_columns(&first_ports),
            output: equations.force_output.select_columns(&first_ports),
            first_ports,
        }
    }

    /// Positions of the laws' parameters among the free ones.
    pub(crate) fn columns(&self) -> impl Iterator<Item = usize> + '_ {
        self.laws.iter().flat_map(PortLaw::columns)
    }

    /// The part of a step of all ports, `level`, that concerns the inactive laws.
    pub(crate) fn inactive_inputs(
        &self,
        level: &StepLevel,
        dimensions: Dimensions,
        [active, inactive]: [&[usize]; 2],
    ) -> InactiveInputs {
        let (n, p) = (dimensions.states, dimensions.ports);
        let forces =
            (0..3).flat_map(|node| active.iter().map(move |port| dimensions.forces() + node * p + port));
        let columns: Vec<usize> = (0..dimensions.forces()).chain(forces).collect();
        let rows_of = |ports: &[usize]| -> Vec<usize> {
            [n, n + p].iter().flat_map(|first| ports.iter().map(move |port| first + port)).collect()
        };
        let rows: Vec<usize> = (0..n).chain(rows_of(active)).collect();
        let at = |row: usize, column: usize| level.rows[row * dimensions.width() + column];
        let inputs =
            rows_of(inactive).into_iter().flat_map(|row| columns.iter().map(move |column| at(row, *column)));
        let nodes = self
            .first_ports
            .iter()
            .flat_map(|port| (0..3).map(move |node| dimensions.forces() + node * p + port));
        InactiveInputs {
            inputs: inputs.collect(),
            width: columns.len(),
            drive: nodes.flat_map(|column| rows.iter().map(move |row| at(*row, column))).collect(),
            rows: rows.len(),
        }
    }

    /// Sensitivities of the forces at one time.
    pub(crate) fn at(&self, at: &Instant) -> Vec<InactiveSensitivity> {
        let inputs: Vec<f64> = (0..self.port.nrows())
            .map(|row| {
                row_times(&self.port, row, &at.state)
                    + row_times(&self.port_input, row, &at.inputs)
                    + row_times(&self.port_force, row, &at.forces)
            })
            .collect();
        let mut all = Vec::new();
        evaluate(&self.laws, &inputs, &mut all);
        all
    }

    /// Sensitivities of the forces in the middle of a step and at its end.
    pub(crate) fn along(
        &self,
        inactive_inputs: &InactiveInputs,
        xi: &[f64],
        [middle, end]: [&mut Vec<InactiveSensitivity>; 2],
    ) {
        let rows = inactive_inputs.inputs.chunks_exact(inactive_inputs.width.max(1));
        let inputs: Vec<f64> = rows.map(|row| row.iter().zip(xi).map(|(a, x)| a * x).sum()).collect();
        let (first, last) = inputs.split_at(inputs.len() / 2);
        for (inputs, all) in [(first, middle), (last, end)] {
            all.clear();
            evaluate(&self.laws, inputs, all);
        }
    }

    /// Contribution of a sensitivity to the rate of a state.
    pub(crate) fn to_rate(&self, state: usize, inactive: &InactiveSensitivity) -> f64 {
        self.force[(state, inactive.law)] * inactive.value
    }

    /// Contribution of a sensitivity to the input of an active port.
    pub(crate) fn to_port(&self, port: usize, inactive: &InactiveSensitivity) -> f64 {
        self.active_port[(port, inactive.law)] * inactive.value
    }

    /// Contribution of a sensitivity to an output.
    pub(crate) fn to_output(&self, output: usize, inactive: &InactiveSensitivity) -> f64 {
        self.output[(output, inactive.law)] * inactive.value
    }
}

impl InactiveInputs {
    /// Adds the effect of the forces' sensitivities at the start, in the middle and at the end of a step to the sensitivities of the
    /// step's rows from `first` on, of which each has `columns` numbers.
    pub(crate) fn add(
        &self,
        nodes: [&[InactiveSensitivity]; 3],
        first: usize,
        rows: &mut [f64],
        columns: usize,
    ) {
        for (node, sensitivities) in nodes.into_iter().enumerate() {
            for own in sensitivities {
                let drive = &self.drive[(3 * own.law + node) * self.rows..][first..];
                for (row, factor) in rows.chunks_exact_mut(columns).zip(drive) {
                    row[own.column] += factor * own.value;
                }
            }
        }
    }
}
