//! Steps, forward passes, resets and rollouts of a batch.

use super::{AnyBatch, Batch};
use crate::arrays::indices;
use crate::busy::{in_portions, lock};
use crate::count::Count;
use crate::error::sim_error;
use crate::kind::Kind;
use crate::model::Model;
use crate::names::Names;
use crate::rollout::{self, Start};
use crate::state_views::is_state;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Returns the index of a keyframe of a model.
fn find_key(model: &Py<Model>, which: &Bound<'_, PyAny>) -> PyResult<usize> {
    Kind::Keyframe.find(model.get().inner(), which)
}

#[pymethods]
impl Batch {
    /// Advances every running environment.
    ///
    /// Other Python threads run meanwhile; their writes to the arrays of this batch can take effect in the middle of
    /// the step. With the option `autoreset`, an environment that diverges does the step from the initial state
    /// instead, which includes controls and applied forces, and counts it in `resets`.
    ///
    /// Parameters
    /// ----------
    /// n : int
    ///     Number of time steps, with the same controls and applied forces.
    ///
    /// Returns
    /// -------
    /// int
    ///     Number of environments that failed in this call.
    ///
    /// Raises
    /// ------
    /// BusyError
    ///     While another thread is in a call of this batch.
    /// ClenchError
    ///     In a process forked from the one that created this batch, if it has several threads: a fork does not copy
    ///     them.
    #[pyo3(signature = (n = Count(1)), text_signature = "($self, n=1)")]
    fn step(&self, py: Python<'_>, n: Count) -> PyResult<usize> {
        let mut guard = lock(&self.inner, "batch")?;
        let any = &mut *guard;
        let mut failed = 0;
        in_portions(py, n.0, |steps| {
            let summary = each!(any, batch => batch.step_n(steps));
            failed += summary.map_err(sim_error)?.failed;
            Ok(())
        })?;
        Ok(failed)
    }

    /// Computes the recorded outputs from the states, and does not change the states.
    ///
    /// Parameters
    /// ----------
    /// mask : array_like of bool, optional
    ///     Mask of environments (n); by default all. The outputs of the others do not change.
    ///
    /// Returns
    /// -------
    /// int
    ///     Number of environments that failed in this call.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the mask has another shape.
    #[pyo3(signature = (mask = None))]
    fn forward(&self, py: Python<'_>, mask: Option<&Bound<'_, PyAny>>) -> PyResult<usize> {
        let chosen = self.mask(mask)?;
        let mut guard = lock(&self.inner, "batch")?;
        let any = &mut *guard;
        let summary = py.detach(|| each!(any, batch => batch.forward_mask(&chosen)));
        Ok(summary.map_err(sim_error)?.failed)
    }

    /// Resets environments to the initial state or to a keyframe, and sets them running.
    ///
    /// Parameters
    /// ----------
    /// mask : array_like of bool, optional
    ///     Mask of environments (n); by default all.
    /// keyframe : str or int, optional
    ///     A keyframe, by name or index; of several models, each environment has those of its own.
    /// env_model : array_like of int, optional
    ///     Models for the environments of the mask, an index of `models` for each of them. Their parameters become
    ///     those of the models, also where a model stays the same.
    ///
    /// Raises
    /// ------
    /// IndexError
    ///     If there is no such model.
    /// ValueError
    ///     If a length is wrong, or a model has no such keyframe.
    #[pyo3(signature = (mask = None, keyframe = None, *, env_model = None))]
    fn reset(
        &self,
        py: Python<'_>,
        mask: Option<&Bound<'_, PyAny>>,
        keyframe: Option<&Bound<'_, PyAny>>,
        env_model: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let chosen = self.mask(mask)?;
        let envs = Vec::from_iter((0..self.n_envs).filter(|&env| chosen[env]));
        let count = self.models.len();
        let other = env_model.map(|given| indices("env_model", given, count));
        let other = other.transpose()?;
        let mut guard = lock(&self.inner, "batch")?;
        let any = &mut *guard;
        let keys = match (keyframe, &other) {
            (None, _) => Vec::new(),
            (Some(which), Some(other)) if other.len() == envs.len() => {
                let models = other.iter().map(|&model| &self.models[model]);
                models
                    .map(|model| find_key(model, which))
                    .collect::<PyResult<_>>()?
            }
            (Some(which), _) => {
                let models = envs.iter().map(|&env| self.model_of(any, env));
                models
                    .map(|model| find_key(model, which))
                    .collect::<PyResult<_>>()?
            }
        };
        let done = py.detach(|| {
            each!(any, batch => {
                if let Some(other) = other {
                    batch.reset_to_models(&envs, &other)?;
                }
                envs.iter().enumerate().try_for_each(|(k, &env)| match keys.get(k) {
                    None => batch.reset(env),
                    Some(&key) => batch.reset_to_keyframe(env, key),
                })
            })
        });
        done.map_err(sim_error)
    }

    /// Sets environments running again from the states in their rows.
    ///
    /// Parameters
    /// ----------
    /// mask : array_like of bool, optional
    ///     Mask of environments (n); by default all.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the mask has another shape.
    #[pyo3(signature = (mask = None))]
    fn revive(&self, mask: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
        let chosen = self.mask(mask)?;
        let mut guard = lock(&self.inner, "batch")?;
        let mut envs = (0..self.n_envs).filter(|&env| chosen[env]);
        each!(&mut *guard, batch => envs.try_for_each(|env| batch.revive(env))).map_err(sim_error)
    }

    /// Steps all running environments and records outputs after each step.
    ///
    /// Other Python threads run meanwhile. Ctrl-C is checked periodically: it ends the rollout with a `RuntimeWarning`,
    /// and the steps recorded so far are returned. With a function for `ctrl` the batch may be a step further.
    ///
    /// Parameters
    /// ----------
    /// initial : State or array_like, optional
    ///     Initial states: a complete `State`, of a `Sim` for all environments or of the batch; or one row for all (1 +
    ///     nq + nv + na) or a row each (n, ...) with time, positions, velocities and activations. Rows clear the
    ///     solver's warm start, so that the result does not depend on earlier steps. All environments are set running.
    ///     By default they continue from their current states.
    /// ctrl : array_like or callable, optional
    ///     Controls of each step, for all (steps, nu) or each (n, steps, nu) environment. By default those in `ctrl`,
    ///     which do not change in any case. A function is called before each step with the step's index, from 0; it may
    ///     read and call the batch, and returns the controls of all (nu) or each (n, nu) environment, or None for those
    ///     in `ctrl`.
    /// record : sequence of str
    ///     Outputs to record; see `clench.OUTPUTS`.
    /// steps : int, optional
    ///     Number of steps; required only if `ctrl` is not an array.
    /// progress : bool or callable, optional
    ///     True shows the progress in a line on stderr. A function is called every fraction of a second, and at the
    ///     end, with the number of steps done and the total; an exception that it raises ends the rollout.
    ///
    /// Returns
    /// -------
    /// dict of str to numpy.ndarray
    ///     Each output (n, steps, ...). Steps that an environment did not do are NaN.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a shape is wrong, or no output has a name. The states do not change then.
    /// TypeError
    ///     If `progress` is neither a bool nor a function.
    #[pyo3(signature = (initial = None, ctrl = None, record = None, steps = None, *, progress = None),
           text_signature = "($self, initial=None, ctrl=None, record=('qpos', 'qvel'), steps=None, *, progress=None)")]
    fn rollout<'py>(
        this: &Bound<'py, Self>,
        py: Python<'py>,
        initial: Option<&Bound<'py, PyAny>>,
        ctrl: Option<&Bound<'py, PyAny>>,
        record: Option<Names>,
        steps: Option<Count>,
        progress: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let progress = rollout::progress(progress, this.get().n_envs)?;
        let record = record.map_or_else(|| vec!["qpos".into(), "qvel".into()], |names| names.0);
        let steps = steps.map(|count| count.0);
        if let Some(policy) = ctrl.filter(|ctrl| ctrl.is_callable()) {
            let steps = steps.ok_or_else(|| {
                PyValueError::new_err("rollout needs steps where ctrl is a function")
            })?;
            let controlled = rollout::module(py)?.getattr("controlled")?;
            let rows = controlled.call1((this, initial, policy, record, steps, progress))?;
            return Ok(rows.cast_into()?);
        }
        let start = match initial {
            Some(state) if is_state(state)? => Start::State(this.as_super().get(), state),
            Some(rows) => Start::Rows(rows),
            None => Start::Here,
        };
        let mut guard = lock(&this.get().inner, "batch")?;
        each!(&mut *guard, batch => {
            rollout::rollout(py, batch, &start, ctrl, &record, steps, progress.as_ref())
        })
    }
}
