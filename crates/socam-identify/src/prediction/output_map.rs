//! Factors of the outputs, and their sensitivities, arranged for products with rows.

use socam_model::Equations;

use crate::prediction::step_level::{Dimensions, padded};

/// The output equation y = C x + D u + E f of one mode.
pub(crate) struct OutputMap {
    pub(super) dimensions: Dimensions,
    /// Per output, its factors of [x, f].
    pub(super) outputs: Vec<Vec<f64>>,
    /// Per output and entry of [x, u, f], the sensitivities of its factor with respect to the free parameters, [`padded`].
    pub(super) output_sensitivities: Vec<Vec<f64>>,
}

impl OutputMap {
    pub(crate) fn new(equations: &Equations, sensitivities: &[Equations]) -> Self {
        let dimensions = Dimensions::new(equations, sensitivities.len());
        let stride = padded(dimensions.free);
        let each = |o: usize| {
            let entries = |e: &Equations| -> Vec<f64> {
                let (x, u, f) = (e.output.row(o), e.feedthrough.row(o), e.force_output.row(o));
                x.iter().chain(u.iter()).chain(f.iter()).copied().collect()
            };
            let mut moved = vec![0.0; (dimensions.states + dimensions.inputs + dimensions.ports) * stride];
            for (j, sensitivity) in sensitivities.iter().enumerate() {
                let places = moved.iter_mut().skip(j).step_by(stride);
                places.zip(entries(sensitivity)).for_each(|(place, value)| *place = value);
            }
            let kept =
                equations.output.row(o).iter().chain(equations.force_output.row(o).iter()).copied().collect();
            (kept, moved)
        };
        let (outputs, output_sensitivities) = (0..equations.output.nrows()).map(each).unzip();
        Self { dimensions, outputs, output_sensitivities }
    }
}
