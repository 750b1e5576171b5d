//! Matrices with their derivatives with respect to chosen parameters.
//!
//! Forward-mode differentiation of the matrix operations that assembly needs. Derivatives are exact to rounding.

use nalgebra::DMatrix;

/// A matrix and its derivative with respect to each chosen parameter.
#[derive(Debug, Clone)]
pub(crate) struct Jet {
    pub(crate) value: DMatrix<f64>,
    pub(crate) derivatives: Vec<DMatrix<f64>>,
}

/// A number and its derivatives. It is separate from a 1 x 1 [`Jet`] because assembly creates many and these need one allocation each.
#[derive(Debug, Clone)]
pub(crate) struct Scalar {
    pub(crate) value: f64,
    pub(crate) derivatives: Vec<f64>,
}

impl Scalar {
    /// The value of one of a model's parameters, with its derivatives with respect to the parameters `wrt`.
    pub(crate) fn parameter(values: &[f64], wrt: &[usize], index: usize) -> Self {
        let derivatives = wrt.iter().map(|other| f64::from(*other == index)).collect();
        Self { value: values[index], derivatives }
    }

    pub(crate) fn constant(value: f64, count: usize) -> Self {
        Self { value, derivatives: vec![0.0; count] }
    }

    pub(crate) fn times(&self, other: &Self) -> Self {
        let derivatives = self.derivatives.iter().zip(&other.derivatives);
        Self {
            value: self.value * other.value,
            derivatives: derivatives.map(|(a, b)| a * other.value + self.value * b).collect(),
        }
    }

    pub(crate) fn over(&self, other: &Self) -> Self {
        let value = self.value / other.value;
        let derivatives = self.derivatives.iter().zip(&other.derivatives);
        Self { value, derivatives: derivatives.map(|(a, b)| (a - value * b) / other.value).collect() }
    }
}

impl Jet {
    pub(crate) fn zeros(rows: usize, columns: usize, count: usize) -> Self {
        let zero = DMatrix::zeros(rows, columns);
        Self { derivatives: vec![zero.clone(); count], value: zero }
    }

    pub(crate) fn rows(&self) -> usize {
        self.value.nrows()
    }

    fn zip(&self, other: &Self, f: impl Fn(&DMatrix<f64>, &DMatrix<f64>) -> DMatrix<f64>) -> Self {
        let derivatives = self.derivatives.iter().zip(&other.derivatives);
        Self { value: f(&self.value, &other.value), derivatives: derivatives.map(|(a, b)| f(a, b)).collect() }
    }

    fn map(&self, f: impl Fn(&DMatrix<f64>) -> DMatrix<f64>) -> Self {
        Self { value: f(&self.value), derivatives: self.derivatives.iter().map(f).collect() }
    }

    pub(crate) fn plus(&self, other: &Self) -> Self {
        self.zip(other, |a, b| a + b)
    }

    pub(crate) fn minus(&self, other: &Self) -> Self {
        self.zip(other, |a, b| a - b)
    }

    pub(crate) fn times(&self, other: &Self) -> Self {
        let derivatives = self.derivatives.iter().zip(&other.derivatives);
        Self {
            value: &self.value * &other.value,
            derivatives: derivatives.map(|(a, b)| a * &other.value + &self.value * b).collect(),
        }
    }

    pub(crate) fn scaled(&self, factor: &Scalar) -> Self {
        let derivatives = self.derivatives.iter().zip(&factor.derivatives);
        Self {
            value: &self.value * factor.value,
            derivatives: derivatives.map(|(a, b)| a * factor.value + &self.value * *b).collect(),
        }
    }

    pub(crate) fn transpose(&self) -> Self {
        self.map(DMatrix::transpose)
    }

    /// `self⁻¹ right`; `None` where `self` is singular to working precision.
    pub(crate) fn solve(&self, right: &Self) -> Option<Self> {
        if self.rows() == 0 {
            return Some(right.clone());
        }
        // Row equilibration: dampers and inertias differ by ten decades, and the rank test below is relative.
        let scale: Vec<f64> = self.value.row_iter().map(|row| row.amax()).collect();
        if scale.contains(&0.0) {
            return None;
        }
        let equilibrated = DMatrix::from_fn(self.rows(), self.rows(), |i, j| self.value[(i, j)] / scale[i]);
        let lu = equilibrated.full_piv_lu();
        let pivots = lu.u().diagonal().map(f64::abs);
        if pivots.min() <= 1e-13 * pivots.max() {
            return None;
        }
        let scaled = |m: &DMatrix<f64>| DMatrix::from_fn(m.nrows(), m.ncols(), |i, j| m[(i, j)] / scale[i]);
        let value = lu.solve(&scaled(&right.value))?;
        let derivatives = self.derivatives.iter().zip(&right.derivatives);
        let derivatives: Option<Vec<_>> =
            derivatives.map(|(a, b)| lu.solve(&scaled(&(b - a * &value)))).collect();
        Some(Self { value, derivatives: derivatives? })
    }

    pub(crate) fn select(&self, rows: &[usize], columns: &[usize]) -> Self {
        self.map(|m| m.select_rows(rows).select_columns(columns))
    }

    pub(crate) fn row(&self, row: usize) -> Self {
        self.map(|m| m.rows(row, 1).into_owned())
    }

    pub(crate) fn at(&self, row: usize, column: usize) -> Scalar {
        let derivatives = self.derivatives.iter().map(|matrix| matrix[(row, column)]).collect();
        Scalar { value: self.value[(row, column)], derivatives }
    }

    pub(crate) fn columns(&self, start: usize, count: usize) -> Self {
        self.map(|m| m.columns(start, count).into_owned())
    }

    /// Adds `block` with its top left corner at (`row`, `column`).
    pub(crate) fn add_block(&mut self, row: usize, column: usize, block: &Self) {
        let shape = block.value.shape();
        let add = |target: &mut DMatrix<f64>, source: &DMatrix<f64>| {
            let mut view = target.view_mut((row, column), shape);
            view += source;
        };
        add(&mut self.value, &block.value);
        for (target, source) in self.derivatives.iter_mut().zip(&block.derivatives) {
            add(target, source);
        }
    }

    pub(crate) fn add_at(&mut self, row: usize, column: usize, number: &Scalar) {
        self.value[(row, column)] += number.value;
        for (target, derivative) in self.derivatives.iter_mut().zip(&number.derivatives) {
            target[(row, column)] += derivative;
        }
    }
}
