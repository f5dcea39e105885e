//! Gradients of functions of the next state, without the derivatives of that state: one solve for each function
//! replaces one for each column.
//!
//! With the derivatives dg of the gradient of the convex problem, and a′, B and R = h dB a′ + dM (a′ − a) of implicit
//! steps (`implicit`), a function with the gradient (w_q, w_v) by the next positions and velocities has
//!
//! ```text
//! ν = h (w_v + (∂q⁺/∂v⁺)ᵀ w_q)                              by a′
//! κ = (M + h B)⁻¹ ν,   α = ν − h Bᵀ κ                        by a; α = ν in other steps
//! dw = (H⁻¹ α)·(−dg) − κ·R + the part of the integration
//! ```

use super::gradient::Gradient;
use super::implicit::is_implicit;
use super::step::Step;
use super::{FindCurves, Recursive, scope};
use crate::matrix::{InputGradient, Matrix};
use crate::source::Source;
use clench_rigid::SimError;

/// The maximum number of functions: more of them take longer than the derivatives of the state.
const MAX_FUNCTIONS: usize = 3;

impl Recursive {
    /// Computes the gradients by state and controls of functions of the next state, one row of `gradient` for each.
    /// Recursions must [cover](Self::covers) the step. Returns false if the derivatives of the state must be found.
    ///
    /// # Errors
    /// Returns an error if the step fails.
    pub(crate) fn pull_back(
        &mut self,
        source: Source<'_>,
        find_curves: &mut FindCurves<'_>,
        gradient: &Matrix,
        result: &mut InputGradient,
    ) -> Result<bool, SimError> {
        let (model, [rows, _]) = (source.model, gradient.shape);
        if rows > MAX_FUNCTIONS || !scope::pulls_back(model) {
            return Ok(false);
        }
        self.step(source)?;
        find_curves(source.state, &mut self.curves);
        let step = Step::new(source, source.state, &self.plain, &self.curves);
        if !self.gradient.prepare(&step) {
            return Ok(false);
        }
        let (nv, h) = (model.nv, source.params.timestep);
        let (nx, nu) = (2 * nv + model.na, model.nu());
        (self.advance).run(model, &source.state.qpos, &self.state.qvel, h);
        result.x.reset([rows, nx]);
        result.u.reset([rows, nu]);
        result.p.reset([rows, 0]);
        let mut row = vec![0.0; nx + nu];
        let mut by_velocity = vec![0.0; nv];
        for (k, by_next) in gradient.values.chunks_exact(nx.max(1)).enumerate() {
            row.fill(0.0);
            let (by_position, rest) = by_next.split_at(nv);
            let (own, by_activation) = rest.split_at(nv);
            by_velocity.copy_from_slice(own);
            (self.advance).pull_back(model, by_position, &mut by_velocity, &mut row[..nv]);
            row[nv..2 * nv].copy_from_slice(&by_velocity);
            by_velocity.iter_mut().for_each(|x| *x *= h);
            let Gradient { inverse, local, .. } = &mut self.gradient;
            if is_implicit(&step) {
                (local.implicit).pull_back(&step, inverse, &mut by_velocity, &mut row);
            }
            let mut activations = by_activation.iter();
            local.write_activations(model, nx + nu, &mut |rates| {
                let by = activations.next().copied().unwrap_or(0.0);
                row.iter_mut()
                    .zip(rates)
                    .for_each(|(x, rate)| *x += by * rate);
            });
            if !(self.gradient).pull_back(&step, &mut by_velocity, &mut row) {
                return Ok(false);
            }
            result.x.values[k * nx..][..nx].copy_from_slice(&row[..nx]);
            result.u.values[k * nu..][..nu].copy_from_slice(&row[nx..nx + nu]);
        }
        Ok(true)
    }
}
