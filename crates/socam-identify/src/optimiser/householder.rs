//! Inner loop of least squares: rows are folded into a triangular factor by Householder reflections.
//!
//! The triangle on top keeps its shape throughout, so the reflection of column j touches only row j of it and the rows below (LAPACK's
//! `tpqrt` with a full pentagon). A library's factorisation of a few columns spends most of its time on packing. Here every pass applies
//! one reflection and computes the products for the next one, four columns at a time, so that a block that fits the first cache is read
//! once per column.

use pulp::{Simd, WithSimd};

/// Heights and strides are multiples of this; rows of zeros fill up.
pub(crate) const LANES: usize = 8;

/// Number of columns that one pass over the reflection vector changes.
const GROUP: usize = 4;

/// Makes [top; rows] upper triangular by orthogonal transformations. `top` is `columns` x `columns`, upper triangular, one column after
/// another; so are the rows, `stride` values from column to column, the first `height` of which count. The final content of `rows` has no
/// meaning.
pub(crate) fn fold(top: &mut [f64], rows: &mut [f64], stride: usize, height: usize, columns: usize) {
    debug_assert!(height.is_multiple_of(LANES) && stride.is_multiple_of(LANES) && height <= stride);
    if height > 0 && columns > 0 {
        pulp::Arch::new().dispatch(Fold { top, rows, stride, height, columns });
    }
}

struct Fold<'a> {
    top: &'a mut [f64],
    rows: &'a mut [f64],
    stride: usize,
    height: usize,
    columns: usize,
}

impl WithSimd for Fold<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let n = self.columns;
        let mut factors = vec![0.0; n];
        let mut products = vec![0.0; n];
        for j in 0..n {
            let (done, open) = self.rows.split_at_mut(j * self.stride);
            let size = Size { stride: self.stride, height: self.height };
            if j == 0 {
                pass::<S, false>(simd, &[], open, size, &factors, &mut products);
            } else {
                let mirror = &done[(j - 1) * self.stride..][..self.height];
                pass::<S, true>(simd, mirror, open, size, &factors[j..], &mut products[j..]);
            }
            reflect(self.top, j, &products, &mut factors);
        }
    }
}

/// Reflects row j of the triangle, given the products of column j of the rows with itself and with the columns after it. Sets `factors` to
/// the multiples of column j that are subtracted from these columns of the rows.
#[inline(always)]
fn reflect(top: &mut [f64], j: usize, products: &[f64], factors: &mut [f64]) {
    let n = products.len();
    let (schur_complement, below) = (top[j * n + j], products[j]);
    if below == 0.0 {
        factors[j + 1..].fill(0.0);
        return;
    }
    let reflected = -(schur_complement * schur_complement + below).sqrt().copysign(schur_complement);
    let first = schur_complement - reflected;
    let twice = 2.0 / (first * first + below);
    top[j * n + j] = reflected;
    for l in j + 1..n {
        let along = twice * (first * top[l * n + j] + products[l]);
        top[l * n + j] -= along * first;
        factors[l] = along;
    }
}

#[derive(Clone, Copy)]
struct Size {
    stride: usize,
    height: usize,
}

/// Subtracts `factors` times the reflection vector from each remaining column; computes the products of the first of these with all.
#[inline(always)]
fn pass<S: Simd, const APPLY: bool>(
    simd: S,
    mirror: &[f64],
    open: &mut [f64],
    size: Size,
    factors: &[f64],
    products: &mut [f64],
) {
    let count = products.len();
    let group = count.min(GROUP);
    let (head, rest) = open.split_at_mut(group * size.stride);
    let mirror = S::as_simd_f64s(mirror).0;
    let mut part = Part { head: None, mirror, size, columns: head, factors, products: &mut *products };
    match group {
        1 => part.run::<S, APPLY, 1>(simd),
        2 => part.run::<S, APPLY, 2>(simd),
        3 => part.run::<S, APPLY, 3>(simd),
        _ => part.run::<S, APPLY, GROUP>(simd),
    }
    let first = S::as_simd_f64s(&head[..size.height]).0;
    let mut from = group;
    for columns in rest.chunks_mut(GROUP * size.stride) {
        let width = (count - from).min(GROUP);
        let mut part = Part {
            head: Some(first),
            mirror,
            size,
            columns,
            factors: &factors[from..],
            products: &mut products[from..],
        };
        match width {
            1 => part.run::<S, APPLY, 1>(simd),
            2 => part.run::<S, APPLY, 2>(simd),
            3 => part.run::<S, APPLY, 3>(simd),
            _ => part.run::<S, APPLY, GROUP>(simd),
        }
        from += width;
    }
}

/// A group of remaining columns in a [`pass`].
struct Part<'a, V> {
    /// The first remaining column; `None` if this group begins with it.
    head: Option<&'a [V]>,
    mirror: &'a [V],
    size: Size,
    columns: &'a mut [f64],
    factors: &'a [f64],
    products: &'a mut [f64],
}

impl<V: Copy> Part<'_, V> {
    #[inline(always)]
    fn run<S: Simd<f64s = V>, const APPLY: bool, const W: usize>(&mut self, simd: S) {
        let height = self.size.height / S::F64_LANES;
        let mut parts = self.columns.chunks_mut(self.size.stride);
        let columns: [&mut [S::f64s]; W] = std::array::from_fn(|_| {
            let column = parts.next().unwrap_or_default();
            &mut S::as_mut_simd_f64s(column).0[..height]
        });
        let factors: [S::f64s; W] = std::array::from_fn(|c| simd.splat_f64s(-self.factors[c]));
        let mut sums = [simd.splat_f64s(0.0); W];
        let head = self.head.map(|head| &head[..height]);
        let mirror = if APPLY { &self.mirror[..height] } else { self.mirror };
        for i in 0..height {
            let mut values: [S::f64s; W] = std::array::from_fn(|c| columns[c][i]);
            if APPLY {
                for c in 0..W {
                    values[c] = simd.mul_add_e_f64s(mirror[i], factors[c], values[c]);
                    columns[c][i] = values[c];
                }
            }
            let first = head.map_or(values[0], |head| head[i]);
            for c in 0..W {
                sums[c] = simd.mul_add_e_f64s(first, values[c], sums[c]);
            }
        }
        for (product, sum) in self.products.iter_mut().zip(sums) {
            *product = simd.reduce_sum_f64s(sum);
        }
    }
}
