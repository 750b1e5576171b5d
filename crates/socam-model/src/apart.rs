//! Equations of a drivetrain while the teeth of a gear with backlash are apart.

use nalgebra::DMatrix;

use crate::{
    Equations, Port,
    equations::SystemRows,
    jet::{Jet, Scalar},
};

impl Port {
    /// Whether its law is backlash. The force of that law is constant while the teeth are in contact. While they are apart it cancels the
    /// torque of the linear contact.
    #[must_use]
    pub fn is_play(&self) -> bool {
        self.effect.is_play()
    }
}

impl Equations {
    /// The equations while the teeth at the gear of `port` (the first port of its law) are apart: the torque of the contact is
    /// removed from the linear part, and the force of the law is zero. `derivatives` are the derivatives of these equations with respect to
    /// the parameters `wrt` at `values`; the result is the equations apart and their derivatives.
    ///
    /// The force of the law is then K v, where K contains the negative stiffness and damping of the contact. With f = K v + g, the port inputs
    /// are v = (1 - U K)^-1 (V x + W u + U g), and the other matrices follow. `None` where 1 - U K is singular: a massless node is then
    /// connected to nothing, or `port` does not exist.
    ///
    /// ```
    /// use socam_model::Model;
    ///
    /// let model = Model::builtin("speed-o-cam").expect("an embedded model");
    /// let model = model.with_effect("backlash", "mesh", &[("gap", 2e-3)])?;
    /// let values = model.values();
    /// let equations = model.equations(&values)?;
    /// let first = equations.ports.iter().position(|port| port.is_play()).expect("the backlash");
    /// let (apart, _) = equations.apart(&[], &values, &[], first).expect("inertias on both sides");
    /// // The load is then driven by nothing: its steady response to the motor's speed is gone.
    /// let still = |e: &socam_model::Equations| e.transfer(0, 0, nalgebra::Complex::new(1e-3, 0.0)).unwrap().norm();
    /// assert!(still(&equations) > 0.1 && still(&apart) < 1e-3);
    /// # Ok::<(), socam_model::ModelError>(())
    /// ```
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
