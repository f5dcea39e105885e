"""`linearize` agrees with central differences of MuJoCo's own step, over models of each feature and of other packages.

`cargo xtask soak --only derivatives` compares 20 states of each model with every integrator.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import clench
import mujoco  # type: ignore[import-untyped]
import numpy as np
import pytest
from models import FEATURES, PUBLIC, ROOT

# Their contacts or states are not comparable, and the reason.
DIFFERENT = {
    "delays": "past values are stored otherwise",
    "tactile": "past values are stored otherwise",
    "drosophila_fused": "meshes touch at other points",
    "floor": "hulls of meshes touch at points that differ by 2e-9 m, stiffly",
    "fruitfly": "hulls of meshes touch at points that differ by 5e-9 m, stiffly",
    "jaco_arm": "meshes touch at other points",
    "four_bar_linkage_weld": "its cylinders just touch, which MuJoCo does not find",
    "thin_box_mesh": "of two level faces, MuJoCo takes the normal of the inner one",
    "bimanual_viperx_end_effector_insertion": "meshes touch at other points",
    "bimanual_viperx_end_effector_transfer_cube": "meshes touch at other points",
}
# Of an orientation servo at its limit, rounding decides in MuJoCo if implicit integrators use its damping.
DIFFERENT_IMPLICITLY = ("orientations", "scaled_frames")
PATHS = [path for path in (*FEATURES, *(ROOT / ".venv/models" / name for name in PUBLIC)) if path.stem not in DIFFERENT]
# A soak has a seed. It compares many states of each model with every integrator.
SEED = os.environ.get("SOAK_SEED")
INTEGRATORS = ("model",) if SEED is None else ("Euler", "RK4", "implicit", "implicitfast")
STATES = 1 if SEED is None else 20
# The maximum number of compared derivatives of a state, which are chosen at random.
COLUMNS = 40 if SEED is None else 10
STEPS, PERIOD = 40, 10  # Controls change every PERIOD steps.
SIZES = (1e-4, 1e-5) if SEED is None else (1e-4, 3e-5, 1e-5, 3e-6, 1e-6)
# Relative to 1 + the derivative.
PRECISION = 1e-6
# Numbers that differ by more between two step sizes switch: neither is a derivative.
NOISE = 1e-4
MAX_SWITCHING = 0.2 if SEED is None else 0.6
# The maximum number of states of a soak from which MuJoCo's step differs: hulls may touch at other points.
MAX_DIFFERENT = STATES // 2
# MuJoCo resets a state that diverges, with one of these warnings.
DIVERGED = (mujoco.mjtWarning.mjWARN_BADQPOS, mujoco.mjtWarning.mjWARN_BADQVEL, mujoco.mjtWarning.mjWARN_BADQACC)
Array = Any


class Differences:
    """Central differences of MuJoCo's step."""

    def __init__(self, path: Path, integrator: str) -> None:
        self.model = model = mujoco.MjModel.from_xml_path(str(path))
        if integrator != "model":
            model.opt.integrator = getattr(mujoco.mjtIntegrator, f"mjINT_{integrator.upper()}")
        model.opt.solver = mujoco.mjtSolver.mjSOL_NEWTON
        model.opt.iterations, model.opt.tolerance = 300, 0.0
        model.opt.ls_iterations, model.opt.ls_tolerance = 200, 1e-10
        model.opt.noslip_iterations = 0
        model.opt.ccd_iterations, model.opt.ccd_tolerance = 200, 1e-14
        model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_WARMSTART
        self.data = mujoco.MjData(model)
        self.start = np.empty(0)
        self.center = np.empty(0)

    def roll(self, rng: np.random.Generator) -> None:
        """Takes steps under random controls, and begins the differences there."""
        model, data = self.model, self.data
        limited = model.actuator_ctrllimited.astype(bool)
        low, high = np.where(limited, model.actuator_ctrlrange.T, [[-1.0], [1.0]])
        mujoco.mj_resetData(model, data)
        data.qvel[:] = 0.1 * rng.standard_normal(model.nv)
        for step in range(STEPS):
            if step % PERIOD == 0:
                data.ctrl[:] = rng.uniform(low, high)
            mujoco.mj_step(model, data)
        state = mujoco.mjtState.mjSTATE_INTEGRATION
        self.start = np.empty(mujoco.mj_stateSize(model, state))
        mujoco.mj_getState(model, data, self.start, state)
        self.qpos = data.qpos.copy()
        self.center = self.after("ctrl", 0, 0.0)

    def after(self, name: str, k: int, change: float) -> Array:
        """Returns the results of a step that starts from a changed number."""
        model, data = self.model, self.data
        mujoco.mj_setState(model, data, self.start, mujoco.mjtState.mjSTATE_INTEGRATION)
        if change and name == "qpos":
            motion = np.zeros(model.nv)
            motion[k] = 1.0
            mujoco.mj_integratePos(model, data.qpos, motion, change)
        elif change:
            getattr(data, name)[k] += change
        mujoco.mj_step(model, data)
        if not change:
            self.qpos = data.qpos.copy()
        moved = np.zeros(model.nv)
        mujoco.mj_differentiatePos(model, moved, 1.0, self.qpos, data.qpos)
        return np.concatenate([moved, data.qvel, data.act, data.sensordata])

    def derivative(self, name: str, k: int) -> tuple[Array, Array]:
        """Returns a column of derivatives and of bounds of their errors."""
        best, noise = np.zeros_like(self.center), np.full_like(self.center, np.inf)
        found = []
        for size in SIZES:
            columns, kinks = [], []
            for h in (size, size / 2):
                ahead, behind = self.after(name, k, h), self.after(name, k, -h)
                columns.append((ahead - behind) / (2 * h))
                kinks.append(np.abs(ahead + behind - 2 * self.center) / h)
            column = (4 * columns[1] - columns[0]) / 3
            rounding = 1e-15 * (np.abs(self.center) + np.abs(self.center[: 2 * self.model.nv]).max(initial=0.0)) / size
            error = np.maximum(np.abs(columns[1] - columns[0]), rounding)
            # The slopes to both sides differ, and no less over half the distance.
            kink = (kinks[1] > 0.7 * kinks[0]) & (kinks[1] > 1e-3 * np.abs(column) + 10 * rounding)
            error[kink] = np.inf
            better = error < noise
            best, noise = np.where(better, column, best), np.where(better, error, noise)
            found.append(column)
        if SEED is not None:
            # Among many states, errors of MuJoCo's solver and switches within a distance pass for small noise. Most sizes
            # must agree.
            noise = np.maximum(noise, np.median(np.abs(np.array(found) - best), axis=0))
        return best, noise


def simulation(path: Path, integrator: str) -> clench.Sim:
    """Returns a simulation whose solver ends at rounding."""
    if integrator == "model":
        model = clench.Model.from_file(path)
    else:
        spec = clench.ModelSpec.from_file(path)
        spec.section("option")["integrator"] = integrator
        model = spec.build()
    return clench.Sim(
        model,
        clench.RigidOptions(
            constraint_solver="Newton",
            tolerance=0.0,
            iterations=300,
            ls_iterations=200,
            ls_tolerance=1e-10,
            noslip_iterations=0,
            warmstart=False,
            ccd_iterations=200,
            ccd_tolerance=1e-14,
        ),
    )


def copy_state(mujocos: Differences, sim: clench.Sim) -> None:
    """Copies the state of MuJoCo's data."""
    mujoco.mj_setState(mujocos.model, mujocos.data, mujocos.start, mujoco.mjtState.mjSTATE_INTEGRATION)
    for name in ("qpos", "qvel", "act", "plastic", "ctrl"):
        getattr(sim, name)[:] = getattr(mujocos.data, name)


def steps_agree(mujocos: Differences, sim: clench.Sim) -> bool:
    """Returns true if both make the same step."""
    nv = mujocos.model.nv
    copy_state(mujocos, sim)
    sim.step()
    return bool(np.allclose(sim.qvel, mujocos.center[nv : 2 * nv], rtol=1e-9, atol=1e-9))


def assert_derivatives_agree(mujocos: Differences, sim: clench.Sim, rng: np.random.Generator) -> None:
    """Compares columns of the derivatives at the state of MuJoCo's data."""
    model = mujocos.model
    copy_state(mujocos, sim)
    derivatives = sim.linearize()
    exact = np.block([[derivatives.A, derivatives.B], [derivatives.C, derivatives.D]])
    columns = [("qpos", k) for k in range(model.nv)] + [("qvel", k) for k in range(model.nv)]
    columns += [("act", k) for k in range(model.na)] + [("ctrl", k) for k in range(model.nu)]
    chosen = rng.permutation(len(columns))[:COLUMNS]
    switching = 0
    for number in chosen:
        found, noise = mujocos.derivative(*columns[number])
        scale = 1 + np.abs(found)
        compared = noise < NOISE * scale
        switching += int(np.count_nonzero(~compared))
        error = np.where(compared, np.abs(exact[:, number] - found) - 3 * noise, 0.0)
        worst = int(np.argmax(error / scale))
        assert error[worst] <= PRECISION * scale[worst], (
            f"row {worst} by {columns[number]}: {exact[worst, number]:.9g}, MuJoCo {found[worst]:.9g} ± {noise[worst]:.1e}"
        )
    assert switching <= MAX_SWITCHING * exact.shape[0] * len(chosen)


@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("path", PATHS, ids=lambda path: path.stem)
def test_derivatives_are_mujocos(path: Path, integrator: str) -> None:
    if integrator.startswith("implicit") and path.stem in DIFFERENT_IMPLICITLY:
        pytest.skip("an orientation servo is at its limit")
    mujocos, sim = Differences(path, integrator), simulation(path, integrator)
    rng = np.random.default_rng(int(SEED or 0))
    different = 0
    for _ in range(STATES):
        mujocos.roll(rng)
        if any(mujocos.data.warning[kind].number > 0 for kind in DIVERGED):
            pytest.skip("the motion diverges")
        if SEED is not None and not steps_agree(mujocos, sim):
            different += 1
        else:
            assert_derivatives_agree(mujocos, sim, rng)
    assert different <= MAX_DIFFERENT
