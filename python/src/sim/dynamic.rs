//! Constraints that are added and removed at run time.

use super::Sim;
use crate::busy::lock;
use crate::count::Index;
use crate::error::sim_error;
use crate::kind::Kind;
use crate::queries::vector;
use crate::row_sim::{AnySim, RowSim, each_sim};
use clench::{DynamicConstraint, Precision};
use pyo3::prelude::*;

/// Applies `change` to a simulation in the state of its rows, and updates the rows.
fn change<S: Precision, R>(
    own: &mut RowSim<S>,
    change: impl FnOnce(&mut clench::Sim<S>) -> Result<R, clench::SimError>,
) -> PyResult<R> {
    let done = own.current().and_then(change).map_err(sim_error)?;
    own.rows.write(0, &own.sim.state).map_err(sim_error)?;
    Ok(done)
}

#[pymethods]
impl Sim {
    /// Welds two bodies in their current relative pose, as a suction gripper does.
    ///
    /// The constraint is part of the state: `state` saves it, a reset removes it. It has the softness of MuJoCo's
    /// default weld.
    ///
    /// Parameters
    /// ----------
    /// body1, body2 : str or int
    ///     The bodies, by name or index.
    ///
    /// Returns
    /// -------
    /// int
    ///     The constraint, for `remove`.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If both bodies are the same or both are static, or there is no free slot (see ``max_dynamic_constraints`` of
    ///     `Model.from_file`).
    fn add_weld(&self, body1: &Bound<'_, PyAny>, body2: &Bound<'_, PyAny>) -> PyResult<u64> {
        let model = self.model.get().inner();
        let (body1, body2) = (
            Kind::Body.find(model, body1)?,
            Kind::Body.find(model, body2)?,
        );
        let mut guard = lock(&self.inner, "simulation")?;
        let added = each_sim!(&mut *guard, own => change(own, |sim| sim.add_weld(body1, body2)));
        Ok(added?.to_code())
    }

    /// Connects two bodies at a point, as a ball joint does. Otherwise it is like `add_weld`.
    ///
    /// Parameters
    /// ----------
    /// body1, body2 : str or int
    ///     The bodies, by name or index.
    /// anchor : array_like
    ///     A point in the frame of the first body (3), m; it is connected to the point of the second body that
    ///     coincides with it now.
    ///
    /// Returns
    /// -------
    /// int
    ///     The constraint, for `remove`.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     As for `add_weld`, or if `anchor` has another shape or is not finite.
    fn add_connect(
        &self,
        body1: &Bound<'_, PyAny>,
        body2: &Bound<'_, PyAny>,
        anchor: &Bound<'_, PyAny>,
    ) -> PyResult<u64> {
        let model = self.model.get().inner();
        let (body1, body2) = (
            Kind::Body.find(model, body1)?,
            Kind::Body.find(model, body2)?,
        );
        let mut guard = lock(&self.inner, "simulation")?;
        let added = each_sim!(&mut *guard, own => {
            let anchor = vector("anchor", anchor)?;
            change(own, |sim| sim.add_connect(body1, body2, anchor))
        });
        Ok(added?.to_code())
    }

    /// Removes a constraint that `add_weld` or `add_connect` added.
    ///
    /// Parameters
    /// ----------
    /// constraint : int
    ///     The number that they returned.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the constraint does not exist: it was removed, or is not part of the current state.
    fn remove(&self, constraint: Index) -> PyResult<()> {
        let constraint = DynamicConstraint::from_code(constraint.0 as u64);
        let mut guard = lock(&self.inner, "simulation")?;
        each_sim!(&mut *guard, own => change(own, |sim| sim.remove(constraint)))
    }

    /// list of int : The constraints that were added at run time and exist now, as numbers for `remove`.
    #[getter]
    fn dynamic_constraints(&self) -> PyResult<Vec<u64>> {
        let mut guard = lock(&self.inner, "simulation")?;
        each_sim!(&mut *guard, own => {
            let sim = own.current().map_err(sim_error)?;
            Ok(sim.dynamic_constraints().map(DynamicConstraint::to_code).collect())
        })
    }

    /// Makes a weld or connect of the model hold its bodies in their current relative pose, and switches it on.
    ///
    /// The pose is written into the parameters of this simulation (``eq_anchor1`` and ``eq_quat1`` of a weld,
    /// ``eq_anchor2`` of a connect), which are not part of the state; the switch is part of the state.
    ///
    /// Parameters
    /// ----------
    /// which : str or int
    ///     The equality, by name or index.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the equality is of another kind.
    fn weld_here(&self, which: &Bound<'_, PyAny>) -> PyResult<()> {
        let equality = Kind::Equality.find(self.model.get().inner(), which)?;
        let mut guard = lock(&self.inner, "simulation")?;
        each_sim!(&mut *guard, own => change(own, |sim| sim.weld_here(equality)))
    }

    /// int : The serial number of the last constraint that was added at run time, for pickles; see `clench._pickle`.
    #[getter(_last_serial)]
    fn last_serial(&self) -> PyResult<u32> {
        let guard = lock(&self.inner, "simulation")?;
        Ok(each_sim!(&*guard, own => own.sim.last_serial()))
    }

    #[setter(_last_serial)]
    fn set_last_serial(&self, serial: u32) -> PyResult<()> {
        let mut guard = lock(&self.inner, "simulation")?;
        each_sim!(&mut *guard, own => own.sim.set_last_serial(serial));
        Ok(())
    }
}
