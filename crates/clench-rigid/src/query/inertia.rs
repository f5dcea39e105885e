//! The mass matrix applied to vectors, and joint forces of forces on bodies.

use super::checks::check_body;
use super::table::Query;
use crate::Precision;
use crate::sim::Sim;
use crate::validity::Computed;
use clench_dynamics::check::{check_length, check_values};
use clench_dynamics::dynamics::chains::BodyPoint;
use clench_dynamics::dynamics::jacobian::add_point_forces;
use clench_dynamics::error::SimError;
use clench_math::{Real, Vec3, read_lane};

impl<T: Precision> Sim<T> {
    /// Writes M x to `product` (nv) at the poses of [`refresh`](Self::refresh): for accelerations x, the required
    /// forces along dofs (MuJoCo's `mj_mulM`).
    ///
    /// # Errors
    /// Returns an error if a length is wrong or a value is not finite, or as [`refresh`](Self::refresh) does.
    pub fn mul_mass(&mut self, x: &[T], product: &mut [T]) -> Result<(), SimError> {
        check_values("x", x, self.model().nv)?;
        check_length("product", product.len(), x.len())?;
        self.write_answer(Query::MulMass, x, product)
    }

    /// Replaces x (nv) by M⁻¹ x at the same poses: for forces along dofs, the accelerations that they cause (MuJoCo's
    /// `mj_solveM`).
    ///
    /// # Errors
    /// Returns an error as [`mul_mass`](Self::mul_mass) does, or if the mass matrix is singular; x is then unchanged.
    pub fn solve_mass(&mut self, x: &mut [T]) -> Result<(), SimError> {
        check_values("x", x, self.model().nv)?;
        let forces = x.to_vec();
        self.write_answer(Query::SolveMass, &forces, x)
    }

    /// Adds to `qfrc` (nv) the forces along dofs of a force, N, and a torque, N m, on a body at a world position, in
    /// world axes, at the poses of [`refresh`](Self::refresh) (MuJoCo's `mj_applyFT`).
    ///
    /// # Errors
    /// Returns an error if there is no such body or a length is wrong, or as [`refresh`](Self::refresh) does.
    pub fn add_joint_forces(
        &mut self,
        body: usize,
        place: Vec3<T>,
        (force, torque): (Vec3<T>, Vec3<T>),
        qfrc: &mut [T],
    ) -> Result<(), SimError> {
        check_body(self.model(), body)?;
        check_length("qfrc", qfrc.len(), self.model().nv)?;
        self.require(Computed::Positions)?;
        let wrench = (Vec3::splat(force), Vec3::splat(torque));
        let (model, pos) = (self.model(), &self.workspace().position);
        let point = BodyPoint::new(model, pos, body, Vec3::splat(place));
        let mut forces = Vec::from_iter(qfrc.iter().copied().map(T::SingleEnv::splat));
        add_point_forces(model, pos, &point, wrench, &mut forces);
        read_lane(&forces, 0, qfrc);
        Ok(())
    }
}
