//! A monic denominator, by its coefficients or, if it must be stable, by second-order sections.

use nalgebra::Complex;

use crate::polynomial;

type C = Complex<f64>;

#[derive(Debug, Clone)]
pub(super) enum Denominator {
    /// All but the leading 1, ascending.
    Coefficients(Vec<f64>),
    /// s^2 + a s + b for each pair and s + p for a single pole, by the logarithms of a, b, p, so that it is always stable.
    Sections { pairs: Vec<[f64; 2]>, single: Option<f64> },
}

impl Denominator {
    pub(super) fn unknowns(&self) -> Vec<f64> {
        match self {
            Self::Coefficients(values) => values.clone(),
            Self::Sections { pairs, single } => pairs.iter().flatten().chain(single).copied().collect(),
        }
    }

    pub(super) fn moved(&self, by: &[f64]) -> Self {
        match self {
            Self::Coefficients(values) => {
                Self::Coefficients(values.iter().zip(by).map(|(value, by)| value + by).collect())
            }
            Self::Sections { pairs, single } => Self::Sections {
                pairs: pairs.iter().zip(by.chunks(2)).map(|(p, by)| [p[0] + by[0], p[1] + by[1]]).collect(),
                single: single.map(|p| p + by[2 * pairs.len()]),
            },
        }
    }

    pub(super) fn coefficients(&self) -> Vec<f64> {
        match self {
            Self::Coefficients(values) => values.iter().copied().chain([1.0]).collect(),
            Self::Sections { pairs, single } => {
                let singles = single.iter().map(|p| vec![p.exp(), 1.0]);
                let sections = pairs.iter().map(|[a, b]| vec![b.exp(), a.exp(), 1.0]).chain(singles);
                sections.fold(vec![1.0], |whole, section| polynomial::product(&whole, &section))
            }
        }
    }

    /// Value at s, with derivatives with respect to each unknown.
    pub(super) fn value(&self, s: C) -> (C, Vec<C>) {
        match self {
            Self::Coefficients(values) => {
                let value = values.iter().rev().fold(C::new(1.0, 0.0), |sum, c| sum * s + c);
                (value, (0..values.len()).map(|i| s.powu(i as u32)).collect())
            }
            Self::Sections { pairs, single } => {
                let section = |[a, b]: &[f64; 2]| s * s + s * a.exp() + b.exp();
                let ends = single.map(|p| s + p.exp());
                let value = pairs.iter().map(section).chain(ends).product::<C>();
                let of_pair = |pair: &[f64; 2]| {
                    let rest = value / section(pair);
                    [rest * s * pair[0].exp(), rest * pair[1].exp()]
                };
                let of_single = single.map(|p| value / (s + p.exp()) * p.exp());
                (value, pairs.iter().flat_map(of_pair).chain(of_single).collect())
            }
        }
    }

    pub(super) fn is_stable(&self) -> bool {
        polynomial::roots(&self.coefficients()).iter().all(|pole| pole.re < 0.0)
    }

    /// The denominator with every pole mirrored into the left half plane, as sections.
    pub(super) fn mirrored(&self) -> Self {
        let poles = polynomial::roots(&self.coefficients());
        let left = |pole: &C| C::new(-pole.re.abs().max(1e-6 * pole.norm()).max(1e-12), pole.im);
        let is_real = |pole: &&C| pole.im.abs() <= 1e-9 * pole.norm();
        let mut pairs: Vec<[f64; 2]> = poles
            .iter()
            .filter(|pole| !is_real(pole) && pole.im > 0.0)
            .map(left)
            .map(|pole| [(-2.0 * pole.re).ln(), pole.norm_sqr().ln()])
            .collect();
        let real: Vec<f64> = poles.iter().filter(is_real).map(|pole| -left(pole).re).collect();
        pairs.extend(real.chunks_exact(2).map(|two| [(two[0] + two[1]).ln(), (two[0] * two[1]).ln()]));
        Self::Sections { pairs, single: real.chunks_exact(2).remainder().first().map(|p| p.ln()) }
    }
}
