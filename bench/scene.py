"""The inputs of every engine: a model, controls for each step, and initial states."""

import pathlib
import sys

import gymnasium
import mujoco
import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent
GYMNASIUM = pathlib.Path(gymnasium.__file__).parent / "envs/mujoco/assets"
NEWTON, PGS = mujoco.mjtSolver.mjSOL_NEWTON, mujoco.mjtSolver.mjSOL_PGS


class Unmeasured(Exception):
    """An engine cannot complete a scene, so it is not measured; the message says why."""


def find(name):
    """Returns the path of one of gymnasium's models, or of the file with that name."""
    path = pathlib.Path(name) if name.endswith(".xml") else GYMNASIUM / f"{name}.xml"
    if not path.is_file():
        sys.exit(f"there is no {path}")
    return path


def load(path, solver=NEWTON):
    """Loads a file as a MuJoCo model, with the solver that Clench uses or another."""
    model = mujoco.MjModel.from_xml_path(str(path))
    model.opt.solver = solver
    return model


def smooth_controls(model, steps):
    """Returns filtered noise within half of each control's range (steps, nu), for lively but stable motion."""
    rng = np.random.default_rng(0)
    limited = model.actuator_ctrllimited.astype(bool)
    low = np.where(limited, model.actuator_ctrlrange[:, 0], -1.0)
    high = np.where(limited, model.actuator_ctrlrange[:, 1], 1.0)
    memory = 0.98
    noise, value = rng.standard_normal((steps, model.nu)), np.zeros(model.nu)
    controls = np.empty((steps, model.nu))
    for k in range(steps):
        value = memory * value + np.sqrt(1 - memory**2) * noise[k]
        controls[k] = (low + high) / 2 + (high - low) / 4 * np.clip(value, -2, 2)
    return controls


def perturbed_states(model, count, scale):
    """Returns the initial state (count, nq + nv) with each dof moved by up to `scale` (rad, m, per s)."""
    rng = np.random.default_rng(1)
    start = mujoco.MjData(model)
    states = np.tile(np.concatenate([start.qpos, start.qvel]), (count, 1))
    for row in states:
        qpos = row[: model.nq].copy()
        mujoco.mj_integratePos(model, qpos, rng.uniform(-scale, scale, model.nv), 1)
        row[: model.nq] = qpos
        row[model.nq :] += rng.uniform(-scale, scale, model.nv)
    return states


def describe(model, path):
    """Returns a one-line description of a model."""
    integrator = mujoco.mjtIntegrator(model.opt.integrator).name.removeprefix("mjINT_")
    return f"{path.stem}: nv {model.nv}, {integrator}, time step {model.opt.timestep:g} s"
