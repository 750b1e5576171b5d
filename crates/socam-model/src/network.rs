//! The equations of a network.
//!
//! Rigid gears and shafts tie nodes into groups of one coordinate each. A coordinate is prescribed (its
//! speed is an input), massive, damped (massless, but a damper makes its equation first order) or static
//! (massless and undamped: its equation is algebraic and is eliminated). All operations are on
//! [`Jet`](crate::jet::Jet)s, so that every matrix comes with its exact derivatives.

use crate::{Equations, Model, ModelError};
use assembly::Assembly;
use motion::MotionMaps;

mod assembly;
mod classes;
mod driving;
mod forces;
mod groups;
mod law_inputs;
mod motion;
mod outputs;
mod ports;
mod rigid;
mod state_space;
mod values;
mod windings;
mod wiring;

impl Model {
    /// Equations of motion for parameter values (SI, in the order of [`Model::parameters`]).
    ///
    /// ```
    /// let model = socam_model::Model::builtin("two-mass").expect("an embedded model");
    /// let equations = model.equations(&model.values())?;
    /// assert_eq!(equations.input.shape(), (equations.state.nrows(), model.inputs().count()));
    /// assert_eq!(equations.output.nrows(), model.outputs().count());
    /// # Ok::<(), socam_model::ModelError>(())
    /// ```
    ///
    /// # Errors
    /// [`ModelError::Value`] for a value outside what physics allows (an inertia, stiffness or transition speed that is
    /// not positive, a damping below zero, a ratio of zero); [`ModelError::Network`] where
    /// the motion of a node is not determined.
    pub fn equations(&self, values: &[f64]) -> Result<Equations, ModelError> {
        self.equations_with_derivatives(values, &[]).map(|(equations, _)| equations)
    }

    /// [`Model::equations`] and the derivative of each matrix with respect to each parameter index in `wrt`. In the derivatives, `ports`,
    /// `state_names` and `transforms` are empty.
    ///
    /// ```
    /// # let model = socam_model::Model::builtin("two-mass").expect("an embedded model");
    /// # let values = model.values();
    /// let stiffness = model.parameter("stiffness").expect("a parameter of it");
    /// let (equations, derivatives) = model.equations_with_derivatives(&values, &[stiffness])?;
    /// // The stiffness accelerates the motor by wind-up (state 0), linearly.
    /// let expected = equations.state[(1, 0)] / values[stiffness];
    /// assert!((derivatives[0].state[(1, 0)] / expected - 1.0).abs() < 1e-9);
    /// # Ok::<(), socam_model::ModelError>(())
    /// ```
    ///
    /// # Errors
    /// The errors of [`Model::equations`].
    pub fn equations_with_derivatives(
        &self,
        values: &[f64],
        wrt: &[usize],
    ) -> Result<(Equations, Vec<Equations>), ModelError> {
        self.check_values(values)?;
        let assembly = Assembly::new(self, values, wrt)?;
        MotionMaps::new(&assembly)?.equations()
    }

    /// Speed of the node `fast` divided by that of the node `slow` while no spring twists, at the file's values: the ratio of their mean
    /// speeds. Negative where they turn in opposite directions.
    ///
    /// `None` for an unknown node, for nodes that are not connected, and where springs prevent the motion (one to the ground, or a loop).
    ///
    /// ```
    /// # use socam_model::Model;
    /// let model = Model::builtin("speed-o-cam").expect("a model with a gear of ratio 8");
    /// assert_eq!(model.rigid_ratio("motor", "load"), Some(8.0));
    /// assert_eq!(model.rigid_ratio("motor", "attic"), None);
    /// ```
    pub fn rigid_ratio(&self, fast: &str, slow: &str) -> Option<f64> {
        let values = self.values();
        let node = |name: &str| self.nodes.iter().position(|node| node.name == name);
        let (fast, slow) = (node(fast)?, node(slow)?);
        let assembly = Assembly::new(self, &values, &[]).ok()?;
        let mode = assembly.rigid_mode(assembly.group[fast])?;
        let motion = |node: usize| mode[assembly.group[node]].value * assembly.lever[node].value;
        Some(motion(fast) / motion(slow))
    }
}
