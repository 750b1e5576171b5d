//! Signs and factors of channels that one shaft joins: a speed beside the angle whose derivative it is, and beside the torque that drives it.
//!
//! Both are judged by increments over windows of a few rows, so that neither is differentiated: the change of the angle beside the integral of
//! the speed, and the change of the speed beside the integrals of the torque and of the speed.

use super::finding::Finding;
use super::options::{AlongShaft, Speed};
use crate::dataset::Block;

/// Rows of a window.
const ROWS: usize = 16;
/// Fewest windows for a judgement.
const FEWEST: u32 = 30;
/// Share of the increments' squares that the relation must explain for a factor, and for a sign, to be judged.
const EXPLAINS: [f64; 2] = [0.9, 0.6];
/// Factors between which a derivative counts as the speed.
const ALIKE: [f64; 2] = [0.8, 1.25];

/// Sums of one pair of channels.
pub(super) struct MotionFit {
    pair: AlongShaft,
    columns: [usize; 2],
    window: Vec<[f64; 3]>,
    segment: usize,
    windows: u32,
    /// Squares of the increment that is explained, products with what explains it, and products of these.
    squares: f64,
    right: [f64; 2],
    matrix: [[f64; 2]; 2],
}

impl MotionFit {
    pub(super) fn new(pair: AlongShaft, columns: [usize; 2]) -> Self {
        Self {
            pair,
            columns,
            window: Vec::with_capacity(ROWS),
            segment: 0,
            windows: 0,
            squares: 0.0,
            right: [0.0; 2],
            matrix: [[0.0; 2]; 2],
        }
    }

    pub(super) fn take(&mut self, block: &Block) {
        if self.segment != block.segment {
            (self.segment, self.window) = (block.segment, Vec::with_capacity(ROWS));
        }
        let (speed, other) = match &self.pair {
            AlongShaft::Angle { speed, angle } => (speed.clone(), angle.clone()),
            AlongShaft::Torque { speed, torque } => (speed.clone(), torque.clone()),
        };
        let [of_speed, of_other] = self.columns.map(|column| block.columns[column].values());
        for ((time_s, own), value) in block.time_s.iter().zip(of_speed).zip(of_other) {
            let row = [*time_s, speed.si(*own), other.si(*value)];
            if row.iter().any(|value| !value.is_finite()) {
                self.window.clear();
                continue;
            }
            self.window.push(row);
            if self.window.len() > ROWS {
                self.close();
                self.window.drain(..ROWS);
            }
        }
    }

    fn close(&mut self) {
        let change = |k: usize| self.window[ROWS][k] - self.window[0][k];
        let integral = |k: usize| -> f64 {
            self.window
                .windows(2)
                .map(|pair| 0.5 * (pair[0][k] + pair[1][k]) * (pair[1][0] - pair[0][0]))
                .sum()
        };
        let (explained, by) = match self.pair {
            AlongShaft::Angle { .. } => (change(2), [integral(1), 0.0]),
            AlongShaft::Torque { .. } => (change(1), [integral(2), integral(1)]),
        };
        self.squares += explained * explained;
        for (row, own) in by.iter().enumerate() {
            self.right[row] += own * explained;
            self.matrix[row].iter_mut().zip(by).for_each(|(sum, other)| *sum += own * other);
        }
        self.windows += 1;
    }

    /// A finding if the factor or the sign is wrong; `None` also where the channels do not show it.
    pub(super) fn finish(self) -> Option<Finding> {
        if self.windows < FEWEST || self.squares == 0.0 {
            return None;
        }
        let ([[a, b], [_, d]], [e, f]) = (self.matrix, self.right);
        match self.pair {
            AlongShaft::Angle { speed, angle } => {
                let factor = e / a;
                let share = factor * e / self.squares;
                let is_wrong =
                    factor.is_finite() && share > EXPLAINS[0] && !(ALIKE[0]..ALIKE[1]).contains(&factor);
                is_wrong.then(|| named(&speed, &angle, factor))
            }
            AlongShaft::Torque { speed, torque } => {
                let determinant = a * d - b * b;
                let (by_torque, by_speed) = ((e * d - b * f) / determinant, (a * f - b * e) / determinant);
                let share = (by_torque * e + by_speed * f) / self.squares;
                (share > EXPLAINS[1] && by_torque < 0.0)
                    .then_some(Finding::RunsAgainst { speed: speed.channel, torque: torque.channel })
            }
        }
    }
}

fn named(speed: &Speed, angle: &Speed, factor: f64) -> Finding {
    Finding::NotTheDerivative {
        speed: speed.channel.clone(),
        angle: angle.channel.clone(),
        factor: 1.0 / factor,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::{CheckOptions, check};
    use crate::{Channel, Dataset, Unit};

    /// What is found about a shaft of 0.02 kg m2 and 0.1 N m s/rad whose speed is recorded times `factor`.
    fn found(factor: f64) -> Vec<Finding> {
        let step_s = 1e-3;
        let (mut speed, mut angle) = (0.0_f64, 0.0);
        let mut columns = vec![Vec::new(); 3];
        for k in 0..4000 {
            let t = step_s * f64::from(k);
            let torque = (3.0 * t).sin() + 0.5 * (17.0 * t * t).sin();
            let noise = 0.05 * (1e6 * t * t).sin();
            for (column, value) in columns.iter_mut().zip([torque, factor * (speed + noise), angle]) {
                column.push(value);
            }
            speed += step_s * (torque - 0.1 * speed) / 0.02;
            angle += step_s * speed;
        }
        let units = [("torque", Unit::Nm), ("speed", Unit::RadPerS), ("angle", Unit::Rad)];
        let channels = units.map(|(name, unit)| Channel::new(name, unit)).to_vec();
        let time_s = (0..4000).map(|k| step_s * f64::from(k)).collect();
        let data = Dataset::from_columns("run", channels, time_s, columns).unwrap();
        let of = |channel: &str| Speed { channel: channel.into(), scale: 1.0, offset: 0.0 };
        let shafts = vec![
            AlongShaft::Angle { speed: of("speed"), angle: of("angle") },
            AlongShaft::Torque { speed: of("speed"), torque: of("torque") },
        ];
        let options = CheckOptions { shafts, input: Some("torque".into()), ..CheckOptions::default() };
        let is_own =
            |one: &Finding| matches!(one, Finding::NotTheDerivative { .. } | Finding::RunsAgainst { .. });
        check(&data, &options).unwrap().findings.into_iter().filter(is_own).collect()
    }

    #[test]
    fn a_wrong_factor_or_sign_of_a_speed_is_found() {
        assert_eq!(found(1.0), []);
        let factor = |found: &[Finding]| match found {
            [Finding::NotTheDerivative { factor, .. }, ..] => *factor,
            _ => panic!("{found:?}"),
        };
        let tenfold = found(10.0);
        assert!((factor(&tenfold) - 10.0).abs() < 0.1 && tenfold.len() == 1, "{tenfold:?}");
        let turned = found(-1.0);
        assert!((factor(&turned) + 1.0).abs() < 0.01, "{turned:?}");
        assert!(matches!(turned[1], Finding::RunsAgainst { .. }), "{turned:?}");
    }
}
