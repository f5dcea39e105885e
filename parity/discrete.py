"""The metric of MuJoCo's integrator `discrete`, assembled from the parts in its data."""

import mujoco
import numpy as np

NEAR = 1e-4  # MuJoCo iterates for the acceleration without constraints and stops far above rounding


def terms(model, data):
    """Yields the terms of tendons and actuators in the metric as pairs of scale and row."""
    tendons = np.zeros((model.ntendon, model.nv))
    if model.ntendon:
        mujoco.mju_sparse2dense(tendons, data.ten_J, model.ten_J_rownnz, model.ten_J_rowadr, model.ten_J_colind)
    moments = np.zeros((len(data.actuator_length), model.nv))
    if len(moments):
        mujoco.mju_sparse2dense(moments, data.actuator_moment, data.moment_rownnz, data.moment_rowadr, data.moment_colind)
    for k in range(data.nefmT):
        yield data.efm_ts[k], tendons[data.efm_tid[k]]
    for k in range(data.nefmA):
        first = model.actuator_outadr[data.efm_aid[k]]
        for row in moments[first : first + model.actuator_outnum[data.efm_aid[k]]]:
            yield data.efm_as[k], row


def metric(model, data, mass):
    """Returns the metric as a dense matrix, and the vector that is added to the smooth forces."""
    found, shift = mass.copy(), np.zeros(model.nv)
    for name in ("efm_c", "efm_ca"):
        part = getattr(data, name)
        if len(part):
            shift += part
    if len(data.efm_diag):
        found += np.diag(data.efm_diag)
    if len(data.efm_fluid):
        for i in range(model.nv):
            for place in range(model.M_rowadr[i], model.M_rowadr[i] + model.M_rownnz[i]):
                j = model.M_colind[place]
                found[i, j] += data.efm_fluid[place]
                if i != j:
                    found[j, i] += data.efm_fluid[place]
    for scale, row in terms(model, data):
        found += scale * np.outer(row, row)
    return found, shift


def untouched(model, data, jacobian):
    """Returns a mask of the dofs of trees on which neither constraints nor terms act.

    MuJoCo solves for the free bodies among them once more.
    """
    acting = np.any(jacobian != 0, axis=0)
    for scale, row in terms(model, data):
        if scale != 0:
            acting |= row != 0
    touched = set(model.dof_treeid[acting])
    return np.array([tree not in touched for tree in model.dof_treeid], dtype=bool)


def smooth_acceleration(data, metric, shift):
    """Returns the exact acceleration without constraints."""
    found = np.linalg.solve(metric, data.qfrc_smooth + shift)
    error = np.abs(found - data.qacc_smooth).max(initial=0)
    assert error <= NEAR * np.abs(found).max(initial=1), f"the parts of the metric do not fit: {error}"
    return found
