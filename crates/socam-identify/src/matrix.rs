//! Products and decompositions of matrices, on one thread.
//!
//! faer's operators and methods take their number of threads from a setting of the whole process, and their rounding depends on that
//! number. The functions here do the same calculations, always on one thread.

use faer::{
    Accum, ColRef, Conj, Mat, Par,
    diag::Diag,
    dyn_stack::{MemBuffer, MemStack},
    linalg::{
        cholesky::llt,
        evd::{self, ComputeEigenvectors},
        matmul::{dot::inner_prod, matmul},
        qr::no_pivoting as qr,
        svd::{self, ComputeSvdVectors},
    },
    mat::AsMatRef,
};
use nalgebra::Complex;

const PAR: Par = Par::Seq;

/// The product of two matrices.
pub(crate) fn product(
    left: impl AsMatRef<T = f64, Rows = usize, Cols = usize>,
    right: impl AsMatRef<T = f64, Rows = usize, Cols = usize>,
) -> Mat<f64> {
    let (left, right) = (left.as_mat_ref(), right.as_mat_ref());
    let mut product = Mat::zeros(left.nrows(), right.ncols());
    matmul(product.as_mut(), Accum::Replace, left, right, 1.0, PAR);
    product
}

/// The inner product of two columns of equal length.
pub(crate) fn dot(left: ColRef<'_, f64>, right: ColRef<'_, f64>) -> f64 {
    inner_prod(left.transpose(), Conj::No, right, Conj::No)
}

/// The product of a transposed matrix with itself.
pub(crate) fn gram(matrix: impl AsMatRef<T = f64, Rows = usize, Cols = usize>) -> Mat<f64> {
    let matrix = matrix.as_mat_ref();
    product(matrix.transpose(), matrix)
}

/// Singular values, the largest first, and vectors of a matrix.
pub(crate) struct Svd {
    pub(crate) left: Mat<f64>,
    pub(crate) values: Vec<f64>,
    pub(crate) right: Mat<f64>,
}

impl Svd {
    /// Decomposes a matrix, with as many vectors as singular values; `None` if the values do not converge.
    pub(crate) fn new(matrix: &Mat<f64>) -> Option<Self> {
        let (rows, columns) = matrix.shape();
        let size = rows.min(columns);
        let (mut left, mut right) = (Mat::zeros(rows, size), Mat::zeros(columns, size));
        let mut values = Diag::zeros(size);
        let thin = ComputeSvdVectors::Thin;
        let scratch = svd::svd_scratch::<f64>(rows, columns, thin, thin, PAR, Default::default());
        svd::svd(
            matrix.as_ref(),
            values.as_mut(),
            Some(left.as_mut()),
            Some(right.as_mut()),
            PAR,
            MemStack::new(&mut MemBuffer::new(scratch)),
            Default::default(),
        )
        .ok()?;
        Some(Self { left, values: (0..size).map(|k| values[k]).collect(), right })
    }
}

/// Eigenvalues, the smallest first, and eigenvectors of a symmetric matrix.
pub(crate) struct SymmetricEigen {
    pub(crate) values: Vec<f64>,
    pub(crate) vectors: Mat<f64>,
}

impl SymmetricEigen {
    /// Decomposes a symmetric matrix, of which only the lower triangle is read; `None` if the values do not converge.
    pub(crate) fn new(matrix: &Mat<f64>) -> Option<Self> {
        let n = matrix.nrows();
        let (mut values, mut vectors) = (Diag::zeros(n), Mat::zeros(n, n));
        let scratch =
            evd::self_adjoint_evd_scratch::<f64>(n, ComputeEigenvectors::Yes, PAR, Default::default());
        evd::self_adjoint_evd(
            matrix.as_ref(),
            values.as_mut(),
            Some(vectors.as_mut()),
            PAR,
            MemStack::new(&mut MemBuffer::new(scratch)),
            Default::default(),
        )
        .ok()?;
        Some(Self { values: (0..n).map(|k| values[k]).collect(), vectors })
    }
}

/// Eigenvalues of a square matrix, and its eigenvectors in columns.
pub(crate) struct Eigen {
    pub(crate) values: Vec<Complex<f64>>,
    pub(crate) vectors: Mat<Complex<f64>>,
}

impl Eigen {
    /// `None` where the values do not converge.
    pub(crate) fn new(matrix: &Mat<f64>) -> Option<Self> {
        let n = matrix.nrows();
        let (mut re, mut im, mut real) = (Diag::zeros(n), Diag::zeros(n), Mat::zeros(n, n));
        let scratch = evd::evd_scratch::<f64>(
            n,
            ComputeEigenvectors::No,
            ComputeEigenvectors::Yes,
            PAR,
            Default::default(),
        );
        evd::evd_real(
            matrix.as_ref(),
            re.as_mut(),
            im.as_mut(),
            None,
            Some(real.as_mut()),
            PAR,
            MemStack::new(&mut MemBuffer::new(scratch)),
            Default::default(),
        )
        .ok()?;
        // A conjugate pair has the real part of its vector in one column and the imaginary part in the next.
        let values: Vec<Complex<f64>> = (0..n).map(|k| Complex::new(re[k], im[k])).collect();
        let mut vectors = Mat::zeros(n, n);
        let mut k = 0;
        while k < n {
            let is_pair = im[k] != 0.0;
            for i in 0..n {
                let imaginary = if is_pair { real[(i, k + 1)] } else { 0.0 };
                vectors[(i, k)] = Complex::new(real[(i, k)], imaginary);
                if is_pair {
                    vectors[(i, k + 1)] = Complex::new(real[(i, k)], -imaginary);
                }
            }
            k += if is_pair { 2 } else { 1 };
        }
        Some(Self { values, vectors })
    }
}

/// Least squares of a matrix with at least as many rows as columns, by its QR decomposition. Returns the solution and R.
pub(crate) fn least_squares(matrix: Mat<f64>, right: &Mat<f64>) -> (Mat<f64>, Mat<f64>) {
    let (rows, columns) = matrix.shape();
    let block = qr::factor::recommended_block_size::<f64>(rows, columns);
    let (mut basis, mut coefficients) = (matrix, Mat::zeros(block, rows.min(columns)));
    let scratch = qr::factor::qr_in_place_scratch::<f64>(rows, columns, block, PAR, Default::default());
    qr::factor::qr_in_place(
        basis.as_mut(),
        coefficients.as_mut(),
        PAR,
        MemStack::new(&mut MemBuffer::new(scratch)),
        Default::default(),
    );
    let r = Mat::from_fn(columns, columns, |i, j| if i <= j { basis[(i, j)] } else { 0.0 });
    for j in 0..columns {
        (0..j).for_each(|i| basis[(i, j)] = 0.0);
        basis[(j, j)] = 1.0;
    }
    let mut solution = right.clone();
    let scratch = qr::solve::solve_lstsq_in_place_scratch::<f64>(rows, columns, block, right.ncols(), PAR);
    qr::solve::solve_lstsq_in_place_with_conj(
        basis.as_ref(),
        coefficients.as_ref(),
        r.as_ref(),
        Conj::No,
        solution.as_mut(),
        PAR,
        MemStack::new(&mut MemBuffer::new(scratch)),
    );
    (solution, r)
}

/// The solution of a symmetric positive definite system, by Cholesky's decomposition of its lower triangle; `None` where it is not positive
/// definite.
pub(crate) fn solve_symmetric(matrix: &Mat<f64>, right: &Mat<f64>) -> Option<Mat<f64>> {
    let n = matrix.nrows();
    let mut factor = Mat::from_fn(n, n, |i, j| if j <= i { matrix[(i, j)] } else { 0.0 });
    let scratch = llt::factor::cholesky_in_place_scratch::<f64>(n, PAR, Default::default());
    llt::factor::cholesky_in_place(
        factor.as_mut(),
        Default::default(),
        PAR,
        MemStack::new(&mut MemBuffer::new(scratch)),
        Default::default(),
    )
    .ok()?;
    let mut solution = right.clone();
    let scratch = llt::solve::solve_in_place_scratch::<f64>(n, right.ncols(), PAR);
    llt::solve::solve_in_place_with_conj(
        factor.as_ref(),
        Conj::No,
        solution.as_mut(),
        PAR,
        MemStack::new(&mut MemBuffer::new(scratch)),
    );
    Some(solution)
}
