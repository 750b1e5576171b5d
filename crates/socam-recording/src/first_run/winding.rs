//! What a first run says about the motor's winding.

use socam_core::scaling::RAD_S_PER_RPM;

use super::run::Run;
use super::{FirstRunError, Measured};
use crate::linear::{Fitted, least_squares};

/// The winding by voltage = resistance (current - offset) + inductance d(current)/dt + back-EMF speed.
pub(super) struct Winding {
    pub(super) is_reversed: bool,
    pub(super) resistance_ohm: Measured,
    pub(super) inductance_h: Measured,
    pub(super) back_emf_v_s: Measured,
    pub(super) current_offset_a: Measured,
}

impl Winding {
    pub(super) fn of(run: &Run, counts_per_turn: f64, period_s: f64) -> Result<Self, FirstRunError> {
        let rad = std::f64::consts::TAU / counts_per_turn;
        let slope = |column: &[f64], row: usize| (column[row + 1] - column[row - 1]) / (2.0 * period_s);
        let rows = (1..run.volts.len() - 1).map(|row| {
            let regressors = [run.amperes[row], slope(&run.amperes, row), slope(&run.motor, row) * rad, 1.0];
            (regressors, run.volts[row])
        });
        let Some(Fitted { values: [ohm, henry, v_s, at_zero], std }) = least_squares(rows) else {
            return Err(FirstRunError::NoWinding { ohm: f64::NAN, v_s: f64::NAN });
        };
        if !(v_s > 0.0 && ohm != 0.0 && std[0] < 0.5 * ohm.abs() && std[2] < 0.5 * v_s) {
            return Err(FirstRunError::NoWinding { ohm, v_s });
        }
        Ok(Self {
            is_reversed: ohm < 0.0,
            resistance_ohm: Measured { value: ohm.abs(), std: std[0] },
            inductance_h: Measured { value: henry * ohm.signum(), std: std[1] },
            back_emf_v_s: Measured { value: v_s, std: std[2] },
            current_offset_a: Measured { value: -at_zero / ohm, std: std[3] / ohm.abs() },
        })
    }
}

/// Steady speed over voltage, both mirrored to positive ones.
pub(super) fn motor_line(run: &Run, counts_per_turn: f64, period_s: f64) -> Option<[f64; 2]> {
    let rpm_per_count = std::f64::consts::TAU / counts_per_turn / period_s / RAD_S_PER_RPM;
    let points = run.steady().filter(|part| part.len() > 50).filter_map(|part| {
        let (first, last) = (run.motor[part.start], run.motor[part.end - 1]);
        let rpm = (last - first) / (part.len() - 1) as f64 * rpm_per_count;
        let volts = run.volts[part.clone()].iter().sum::<f64>() / part.len() as f64;
        // At standstill there is no line.
        (rpm * volts > 0.0 && rpm.abs() > 1.0).then_some(([volts.abs(), 1.0], rpm.abs()))
    });
    let Fitted { values: [slope, offset], .. } = least_squares(points)?;
    (slope > 0.0).then_some([slope, offset])
}
