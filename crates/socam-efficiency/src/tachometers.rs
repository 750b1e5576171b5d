//! What two tachometers say of each other where nothing between them can slip.

use nalgebra::{DMatrix, DVector};
use serde::Serialize;
use socam_calibrate::{Estimate, regression};

use crate::moments::Moment;

/// The output tachometer against the input one.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Tachometers {
    /// Output speed times the ratio over input speed; 1 where the gains of both agree.
    pub ratio: Estimate,
    /// Whether they disagree beyond their scatter.
    pub disagree: bool,
}

impl Tachometers {
    /// `None` where there is no output tachometer, or too little motion. Twists of what lies between change slowly loaded speeds by
    /// nothing on average; what they do within a moment is proportional to the slopes of both torques, and is fitted.
    pub(crate) fn of(moments: &[Moment]) -> Option<Self> {
        let used: Vec<(&Moment, f64)> = moments.iter().filter_map(|m| Some((m, m.speed_out?))).collect();
        if used.len() < 12 {
            return None;
        }
        let design = DMatrix::from_fn(used.len(), 4, |i, j| {
            let moment = used[i].0;
            [moment.speed, 1.0, moment.torque_slopes[0], moment.torque_slopes[1]][j]
        });
        let measured = DVector::from_iterator(used.len(), used.iter().map(|(_, out)| *out));
        // The zeros of tachometers are small beside speeds; at one speed alone they could not be told from gains.
        let known = [None, Some((0.0, 0.05)), None, None];
        let fitted = regression::with_knowledge(&design, &measured, &known, 3)?;
        let ratio = Estimate::new(fitted.coefficients[0], fitted.std(0), fitted.degrees);
        Some(Self { ratio, disagree: !ratio.holds(1.0) })
    }
}
