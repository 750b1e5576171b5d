//! Equations of a drivetrain while the teeth of a gear with play do not touch.

use nalgebra::DMatrix;

use crate::{
    Equations, Port,
    equations::SystemRows,
    jet::{Jet, Scalar},
};

impl Port {
    /// Whether its law is a gear's play: constant while teeth touch, and just what transforms their contact back while they do not.
    #[must_use]
    pub fn is_play(&self) -> bool {
        self.effect.is_play()
    }
}

impl Equations {
    /// The equations while the teeth at the gear of `port` (the first port of its law) are apart: the contact's torque is cancelled in
    /// the linear part, and the law's force is zero. `derivatives` are those of these equations with respect to the parameters `wrt` at
    /// `values`; the result has them too.
    ///
    /// The law's force is K v there, where K holds the contact's negative stiffness and damping. With f = K v + g, the port inputs are
    /// v = (1 - U K)^-1 (V x + W u + U g), and the other matrices follow. `None` where a massless node is then connected to nothing.
    #[must_use]
    pub fn apart(
        &self,
        derivatives: &[Self],
        values: &[f64],
        wrt: &[usize],
        port: usize,
    ) -> Option<(Self, Vec<Self>)> {
        let (states, inputs, ports) = (self.state.nrows(), self.input.ncols(), self.ports.len());
        let own = &self.ports.get(port)?.parameters;
        let contact = &own[own.len().checked_sub(2)?..];
        let mut released = Jet::zeros(ports, ports, wrt.len());
        for (law_input, parameter) in contact.iter().enumerate() {
            let moved = wrt.iter().map(|index| if index == parameter { -1.0 } else { 0.0 });
            released.add_at(
                port,
                port + law_input,
                &Scalar { value: -values[*parameter], derivatives: moved.collect() },
            );
        }
        let all = |pick: &dyn Fn(&Self) -> [&DMatrix<f64>; 3]| Jet {
            value: beside(pick(self)),
            derivatives: derivatives.iter().map(|derivative| beside(pick(derivative))).collect(),
        };
        let rates = all(&|e| [&e.state, &e.input, &e.force]);
        let observed = all(&|e| [&e.output, &e.feedthrough, &e.force_output]);
        let seen = all(&|e| [&e.port, &e.port_input, &e.port_force]);
        let by_force = |jet: &Jet| jet.columns(states + inputs, ports);
        let mut resists = Jet::zeros(ports, ports, wrt.len());
        resists.value.fill_with_identity();
        let seen = resists.minus(&by_force(&seen).times(&released)).solve(&seen)?;
        let torque = released.times(&seen);
        let rates = rates.plus(&by_force(&rates).times(&torque));
        let observed = observed.plus(&by_force(&observed).times(&torque));
        let rows = SystemRows { rates, observed, seen };
        let (apart, derivatives) = rows.split([states, inputs, ports]);
        let (ports, state_names, transforms) =
            (self.ports.clone(), self.state_names.clone(), self.transforms.clone());
        Some((Self { ports, state_names, transforms, ..apart }, derivatives))
    }
}

fn beside(parts: [&DMatrix<f64>; 3]) -> DMatrix<f64> {
    let columns: Vec<_> = parts.iter().flat_map(|part| part.column_iter()).collect();
    if columns.is_empty() {
        return DMatrix::zeros(parts[0].nrows(), 0);
    }
    DMatrix::from_columns(&columns)
}
