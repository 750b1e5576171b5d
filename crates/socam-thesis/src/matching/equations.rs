//! Equations 4.7 as the thesis prints them.

use socam_frequency::matching::{Bench, Coefficients, Equations, UNKNOWNS};

use crate::{Printed, Thesis};

/// Equations 4.7 with the printed constants, dimensionless, with the inertias in the units that the thesis used.
pub(super) struct Printed47 {
    pub(super) bench: Bench,
    pub(super) stiffness: f64,
    pub(super) damping: f64,
    pub(super) constants: Vec<f64>,
}

pub(super) const EQUATIONS: usize = 10;

impl Printed47 {
    pub(super) fn new(thesis: &Thesis) -> Self {
        let matching = &thesis.matching;
        // kg mm2, although stiffnesses are in N mm/deg: the printed coefficients show it.
        let bench = Bench {
            cam_shaft: thesis.inertia.cam_shaft_kgmm2.value,
            disk: thesis.inertia.disk_kgmm2.value,
            load: thesis.inertia.load_kgmm2.value,
            ratio: thesis.hardware.ratio.value,
        };
        Self {
            bench,
            stiffness: matching.k_char.value,
            damping: matching.c_char.value,
            constants: matching.constants.iter().map(|constant| constant.value).collect(),
        }
    }

    /// The divisor of each equation.
    pub(super) fn norms(&self) -> [f64; EQUATIONS] {
        let (k, c, n) = (self.stiffness, self.damping, self.bench.ratio);
        let cam = self.cam();
        let load = self.bench.load;
        [
            n * k * c.powi(3),
            n * (k * c).powi(2),
            n * k.powi(3) * c,
            cam * load * c * c,
            cam * load * k * c,
            cam * k * c * c,
            n * n * load * k * k * c,
            (cam + load) * k.powi(3),
            n * n * k.powi(3) * c,
            n * n * k.powi(4),
        ]
    }

    /// J2 N^2 + J3.
    pub(super) fn cam(&self) -> f64 {
        self.bench.cam_shaft * self.bench.ratio.powi(2) + self.bench.disk
    }

    pub(super) fn physical(&self, at: &[f64; UNKNOWNS]) -> [f64; UNKNOWNS] {
        std::array::from_fn(|i| at[i] * if i < 4 { self.stiffness } else { self.damping })
    }

    pub(super) fn pick(coefficients: &Coefficients) -> [f64; EQUATIONS] {
        let Coefficients { numerator: p, denominator: q } = coefficients;
        [p[3], p[2], p[1], q[6], q[5], q[4], q[3], q[2], q[1], q[0]]
    }
}

impl Equations for Printed47 {
    fn count(&self) -> usize {
        EQUATIONS
    }

    fn errors(&self, at: &[f64; UNKNOWNS]) -> Vec<f64> {
        let values = Self::pick(&self.bench.coefficients(&self.physical(at)));
        (0..EQUATIONS).map(|i| values[i] / self.norms()[i] - self.constants[i]).collect()
    }

    fn slopes(&self, at: &[f64; UNKNOWNS]) -> Vec<[f64; UNKNOWNS]> {
        let slopes = self.bench.slopes(&self.physical(at)).map(|slope| Self::pick(&slope));
        let norms = self.norms();
        let unit = |j: usize| if j < 4 { self.stiffness } else { self.damping };
        (0..EQUATIONS).map(|i| std::array::from_fn(|j| slopes[j][i] * unit(j) / norms[i])).collect()
    }
}

pub(super) fn values<const N: usize>(printed: &[Printed; N]) -> [f64; N] {
    printed.each_ref().map(|p| p.value)
}
