//! What a first run says about the motor's winding.

use nalgebra::{DMatrix, DVector};
use socam_core::scaling::RAD_S_PER_RPM;

use super::run::Run;
use super::{FirstRunError, Uncertain};
use crate::regression::{Regression, plain};

/// The winding by voltage = resistance (current - offset) + inductance d(current)/dt + back-EMF speed.
pub(super) struct Winding {
    pub(super) is_reversed: bool,
    pub(super) resistance_ohm: Uncertain,
    pub(super) inductance_h: Uncertain,
    pub(super) back_emf_v_s: Uncertain,
    pub(super) current_offset_a: Uncertain,
}

impl Winding {
    pub(super) fn of(run: &Run, counts_per_turn: f64, period_s: f64) -> Result<Self, FirstRunError> {
        let rad = std::f64::consts::TAU / counts_per_turn;
        let slope = |column: &[f64], row: usize| (column[row + 1] - column[row - 1]) / (2.0 * period_s);
        let rows = (1..run.volts.len() - 1).map(|row| {
            let regressors = [run.amperes[row], slope(&run.amperes, row), slope(&run.motor, row) * rad, 1.0];
            (regressors, run.volts[row])
        });
        let Some(fitted) = least_squares(rows) else {
            return Err(FirstRunError::NoWinding { ohm: f64::NAN, v_s: f64::NAN });
        };
        let [resistance, inductance, back_emf, at_zero] =
            std::array::from_fn(|i| Uncertain { value: fitted.coefficients[i], std: fitted.std(i) });
        let (ohm, v_s) = (resistance.value, back_emf.value);
        if !(v_s > 0.0 && ohm != 0.0 && resistance.std < 0.5 * ohm.abs() && back_emf.std < 0.5 * v_s) {
            return Err(FirstRunError::NoWinding { ohm, v_s });
        }
        Ok(Self {
            is_reversed: ohm < 0.0,
            resistance_ohm: Uncertain { value: ohm.abs(), ..resistance },
            inductance_h: Uncertain { value: inductance.value * ohm.signum(), ..inductance },
            back_emf_v_s: back_emf,
            current_offset_a: Uncertain { value: -at_zero.value / ohm, std: at_zero.std / ohm.abs() },
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
    let line = least_squares(points)?.coefficients;
    (line[0] > 0.0).then_some([line[0], line[1]])
}

fn least_squares<const N: usize>(rows: impl Iterator<Item = ([f64; N], f64)>) -> Option<Regression> {
    let (regressors, values): (Vec<[f64; N]>, Vec<f64>) = rows.unzip();
    plain(
        &DMatrix::from_row_slice(regressors.len(), N, regressors.as_flattened()),
        &DVector::from_vec(values),
    )
}
