//! Masses with their centres and inertias.

use nalgebra::{Isometry3, Matrix3, Vector3};

/// Mass, centre and inertia about the centre, in the axes of a frame: kg, m, kg m².
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Mass {
    pub(crate) mass: f64,
    pub(crate) centre: Vector3<f64>,
    pub(crate) inertia: Matrix3<f64>,
}

impl Mass {
    /// A mass whose own frame stands at `pose`.
    pub(crate) fn at(mass: f64, inertia: Matrix3<f64>, pose: &Isometry3<f64>) -> Self {
        Self { mass, centre: Vector3::zeros(), inertia }.moved(pose)
    }

    /// The same mass in the frame in which its own stands at `pose`.
    pub(crate) fn moved(&self, pose: &Isometry3<f64>) -> Self {
        let turn = pose.rotation.to_rotation_matrix();
        let inertia = turn.matrix() * self.inertia * turn.matrix().transpose();
        let centre = (pose * nalgebra::Point3::from(self.centre)).coords;
        Self { mass: self.mass, centre, inertia }
    }

    /// Inertia about an axis of unit length through a point.
    pub(crate) fn about(&self, axis: &Vector3<f64>, point: &Vector3<f64>) -> f64 {
        let arm = axis.cross(&(self.centre - point)).norm_squared();
        axis.dot(&(self.inertia * axis)) + self.mass * arm
    }
}

/// Inertia of a mass by its diagonal.
pub(crate) fn diagonal(x: f64, y: f64, z: f64) -> Matrix3<f64> {
    Matrix3::from_diagonal(&Vector3::new(x, y, z))
}

/// Inertia from its six numbers.
pub(crate) fn symmetric(xx: f64, yy: f64, zz: f64, (xy, xz, yz): (f64, f64, f64)) -> Matrix3<f64> {
    Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
}
