//! The mass matrix applied to vectors, and joint forces of forces on bodies.

use super::check_body;
use super::frames::Anchor;
use crate::Precision;
use crate::sim::Sim;
use crate::validity::Computed;
use clench_dynamics::Step;
use clench_dynamics::check::{check_length, check_values};
use clench_dynamics::dynamics::jacobian::add_point_forces;
use clench_dynamics::error::{Fault, SimError};
use clench_dynamics::joint_description::massless;
use clench_math::{Mask, Real, Vec3};

impl<T: Precision> Sim<T> {
    /// Writes M x to `product` (nv) at the poses of [`refresh`](Self::refresh): for accelerations x, the required
    /// forces along dofs (MuJoCo's `mj_mulM`).
    ///
    /// # Errors
    /// Returns an error if a length is wrong or a value is not finite, or as [`refresh`](Self::refresh) does.
    pub fn mul_mass(&mut self, x: &[T], product: &mut [T]) -> Result<(), SimError> {
        check_values("x", x, self.model().nv)?;
        check_length("product", product.len(), x.len())?;
        self.require(Computed::Positions)?;
        let x = Vec::from_iter(x.iter().copied().map(T::SingleEnv::splat));
        self.change(product, |sim, product| {
            let mass = sim.workspace().mass();
            (Step::compiled().mul)(mass, &sim.model().tree, &x, product);
        });
        Ok(())
    }

    /// Replaces x (nv) by M⁻¹ x at the same poses: for forces along dofs, the accelerations that they cause (MuJoCo's
    /// `mj_solveM`).
    ///
    /// # Errors
    /// Returns an error as [`mul_mass`](Self::mul_mass) does, or if the mass matrix is singular; x is then unchanged.
    pub fn solve_mass(&mut self, x: &mut [T]) -> Result<(), SimError> {
        check_values("x", x, self.model().nv)?;
        self.require(Computed::Positions)?;
        let (model, ws) = (self.model(), self.workspace());
        if ws.singular.lane(0) {
            let (time, place) = (self.state.time, massless(model, ws, 0));
            return Err(Fault::Singular { time, place }.into());
        }
        self.change(x, |sim, x| {
            let factor = sim.workspace().mass_factor();
            (Step::compiled().solve)(factor, &sim.model().tree, x);
        });
        Ok(())
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
        self.change(qfrc, |sim, qfrc| {
            let point = sim.body_point(Anchor::Point { body, place });
            let pos = &sim.workspace().position;
            add_point_forces(sim.model(), pos, &point, wrench, qfrc);
        });
        Ok(())
    }
}
