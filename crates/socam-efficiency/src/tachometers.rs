//! Comparison of two tachometers with a fixed speed ratio.

use nalgebra::{DMatrix, DVector};
use serde::Serialize;
use socam_calibrate::{Estimate, regression};

use crate::windows::Window;

/// Gain of the output tachometer relative to the input one.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Tachometers {
    /// Output speed times the ratio over input speed; 1 if both gains agree.
    pub ratio: Estimate,
    /// Whether they disagree beyond their scatter.
    pub disagree: bool,
}

impl Tachometers {
    /// `None` without an output tachometer or with too little motion. The twist between the tachometers does not change mean speeds; its effect
    /// within an averaging window is proportional to the derivatives of both torques, which are fitted.
    pub(crate) fn of(windows: &[Window]) -> Option<Self> {
        let used: Vec<(&Window, f64)> = windows.iter().filter_map(|m| Some((m, m.speed_out?))).collect();
        if used.len() < 12 {
            return None;
        }
        let design = DMatrix::from_fn(used.len(), 4, |i, j| {
            let window = used[i].0;
            [window.speed, 1.0, window.torque_slopes[0], window.torque_slopes[1]][j]
        });
        let measured = DVector::from_iterator(used.len(), used.iter().map(|(_, out)| *out));
        // Zeros of tachometers are neglected: they are small compared with speeds, and at one speed cannot be distinguished from gains.
        let known = [None, Some((0.0, 0.05)), None, None];
        let fitted = regression::with_knowledge(&design, &measured, &known, 3)?;
        let ratio = Estimate::new(fitted.coefficients[0], fitted.std(0), fitted.degrees);
        Some(Self { ratio, disagree: !ratio.holds(1.0) })
    }
}
