//! Constraints that are added and removed while a simulation runs.

use super::Sim;
use crate::busy::lock;
use crate::error::sim_error;
use crate::kind::Kind;
use crate::queries::vector;
use crate::row_sim::{AnySim, RowSim, each_sim};
use clench::{DynamicConstraint, Precision};
use pyo3::prelude::*;

/// What `change` does to a simulation in the state of its rows, and the rows afterwards.
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
    /// Hold two bodies together as they lie now, as a weld does: what a suction gripper grips.
    ///
    /// The constraint is part of the state: `state` saves it, a reset removes it. It is as soft as MuJoCo's welds are by default.
    ///
    /// Parameters
    /// ----------
    /// body1, body2 : str or int
    ///     The bodies, by name or index.
    ///
    /// Returns
    /// -------
    /// int
    ///     What `remove` takes.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     Twice the same body; bodies that nothing moves; no free slot (see ``max_dynamic_constraints`` of `Model.from_file`).
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

    /// Hold two points together, as a connect does: a ball joint. Otherwise as `add_weld`.
    ///
    /// Parameters
    /// ----------
    /// body1, body2 : str or int
    ///     The bodies, by name or index.
    /// anchor : array_like
    ///     A point in the frame of the first body (3), m; the other is the point of the second body that lies there now.
    ///
    /// Returns
    /// -------
    /// int
    ///     What `remove` takes.
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

    /// Let go of what `add_weld` or `add_connect` holds.
    ///
    /// Parameters
    /// ----------
    /// constraint : int
    ///     What they returned.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     A constraint that is not there: it was removed, or the state is one that does not have it.
    fn remove(&self, constraint: u64) -> PyResult<()> {
        let constraint = DynamicConstraint::from_code(constraint);
        let mut guard = lock(&self.inner, "simulation")?;
        each_sim!(&mut *guard, own => change(own, |sim| sim.remove(constraint)))
    }

    /// list of int : What was added at run time and is there, as `remove` takes it.
    #[getter]
    fn dynamic_constraints(&self) -> PyResult<Vec<u64>> {
        let mut guard = lock(&self.inner, "simulation")?;
        each_sim!(&mut *guard, own => {
            let sim = own.current().map_err(sim_error)?;
            Ok(sim.dynamic_constraints().map(DynamicConstraint::to_code).collect())
        })
    }

    /// Let a weld or connect of the model hold its bodies as they lie now, and switch it on.
    ///
    /// The pose goes into the parameters of this simulation (``eq_anchor1`` and ``eq_quat1`` of a weld, ``eq_anchor2`` of a connect),
    /// which are no part of the state; the switch goes into the state.
    ///
    /// Parameters
    /// ----------
    /// which : str or int
    ///     The equality, by name or index.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     An equality of another kind.
    fn weld_here(&self, which: &Bound<'_, PyAny>) -> PyResult<()> {
        let equality = Kind::Equality.find(self.model.get().inner(), which)?;
        let mut guard = lock(&self.inner, "simulation")?;
        each_sim!(&mut *guard, own => change(own, |sim| sim.weld_here(equality)))
    }

    /// int : The serial number of the last constraint that was added at run time; for pickles, see `clench._pickle`.
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
