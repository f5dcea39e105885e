//! Gradients of functions of the states of a rollout.

use crate::linearizer::{Linearizer, source};
use crate::matrix::{Matrix, OutputGradient, RolloutGradient};
use crate::request::Request;
use crate::source::Source;
use clench_rigid::{Sim, SimError};
use std::mem::{swap, take};

impl Linearizer {
    /// Returns the gradient of a function of the states after each of the next steps of a simulation of the model,
    /// whose state does not change. `controls` holds a row for each step, `gradient` the derivatives of the function by
    /// x after each step. With `memory`, x is that of [`Request::memory`]. The memory is that of A and B of each step
    /// except the last.
    ///
    /// # Errors
    /// Returns an error if [`Sim::step`] would return one in any step.
    ///
    /// # Panics
    /// Panics if the simulation has another model, or if a matrix has another shape.
    pub fn rollout_vjp(
        &mut self,
        sim: &Sim<f64>,
        memory: bool,
        controls: &Matrix,
        gradient: &Matrix,
    ) -> Result<&RolloutGradient, SimError> {
        self.rollout_vjp_while(sim, memory, controls, gradient, &|| true)
    }

    /// Returns the gradient of a [`rollout_vjp`](Self::rollout_vjp) while `go_on` returns true, which is called before
    /// each step. All numbers are NaN if it returns false.
    ///
    /// # Errors
    /// See [`rollout_vjp`](Self::rollout_vjp).
    ///
    /// # Panics
    /// See [`rollout_vjp`](Self::rollout_vjp).
    pub fn rollout_vjp_while(
        &mut self,
        sim: &Sim<f64>,
        memory: bool,
        controls: &Matrix,
        gradient: &Matrix,
        go_on: &(dyn Fn() -> bool + Sync),
    ) -> Result<&RolloutGradient, SimError> {
        let request = Request {
            memory,
            omits_sensors: true,
            ..Request::default()
        };
        let (nx, nu) = (request.x_len(sim.model()), sim.model().nu());
        let count = controls.shape[0];
        for (matrix, columns) in [(controls, nu), (gradient, nx)] {
            assert_eq!(matrix.shape, [count, columns], "the shape of a rollout");
            assert_eq!(matrix.values.len(), count * columns, "a complete matrix");
        }
        let model = self.prepare(sim, &[])?;
        let (mut state, mut next) = (sim.state.clone(), sim.state.clone());
        let RolloutGradient { x, u } = &mut self.rollout;
        x.reset([1, nx]);
        u.reset([count, nu]);
        let Some(last) = count.checked_sub(1) else {
            return Ok(&self.rollout);
        };
        let mut steps = take(&mut self.steps);
        steps.resize_with(last.max(steps.len()), Default::default);
        for (step, [a, b]) in steps[..last].iter_mut().enumerate() {
            if !go_on() {
                self.steps = steps;
                self.rollout.x.values.fill(f64::NAN);
                self.rollout.u.values.fill(f64::NAN);
                return Ok(&self.rollout);
            }
            (state.ctrl).copy_from_slice(&controls.values[step * nu..][..nu]);
            let source = Source {
                state: &state,
                ..source(&model, sim, &request)
            };
            self.differentiate(source)?;
            swap(a, &mut self.result.a);
            swap(b, &mut self.result.b);
            self.pass.write_next(source, &mut next)?;
            swap(&mut state, &mut next);
        }
        // The gradient by the last state is known, so that no derivatives of this state are needed.
        (state.ctrl).copy_from_slice(&controls.values[last * nu..]);
        let mut by_next = OutputGradient::default();
        by_next.x.shape = [1, nx];
        by_next.x.values.extend(&gradient.values[last * nx..]);
        by_next.y.reset([1, 0]);
        let source = Source {
            state: &state,
            ..source(&model, sim, &request)
        };
        self.pull_back(source, &by_next)?;
        let RolloutGradient { x, u } = &mut self.rollout;
        swap(x, &mut self.gradient.x);
        u.values[last * nu..].copy_from_slice(&self.gradient.u.values);
        let mut by_state = Matrix::default();
        for (step, [a, b]) in steps[..last].iter().enumerate().rev() {
            let own = &gradient.values[step * nx..][..nx];
            x.values.iter_mut().zip(own).for_each(|(x, own)| *x += own);
            swap(x, &mut by_state);
            b.add_row_product(&by_state.values, &mut u.values[step * nu..][..nu]);
            x.reset([1, nx]);
            a.add_row_product(&by_state.values, &mut x.values);
        }
        self.steps = steps;
        Ok(&self.rollout)
    }
}
