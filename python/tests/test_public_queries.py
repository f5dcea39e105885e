"""Models of other packages: inverse dynamics undo forward dynamics, and Jacobians are MuJoCo's."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import clench
import mujoco  # type: ignore[import-untyped]
import numpy as np
import pytest
from models import PUBLIC, ROOT

FOLDER = ROOT / ".venv/models"
# Relative to the forces involved; the remainder is rounding in the solver.
PRECISION = 1e-9


def moving(path: Path) -> clench.Sim:
    """Returns a moving simulation with controls and applied forces, which solves as exactly as possible."""
    model = clench.Model.from_file(path)
    options = clench.RigidOptions(tolerance=0.0, iterations=300, noslip_iterations=0)
    sim = clench.Sim(model, options)
    rng = np.random.default_rng(11)
    sim.ctrl[:] = rng.uniform(-0.1, 0.1, model.nu)
    sim.step(20)
    sim.qfrc_applied[:] = 0.01 * rng.normal(size=model.nv)
    return sim


def largest(*arrays: Any) -> float:
    return max([1e-6, *(float(np.max(np.abs(a), initial=0.0)) for a in arrays)])


@pytest.mark.parametrize("name", PUBLIC)
def test_inverse_dynamics_undo_forward_dynamics(name: str) -> None:
    sim = moving(FOLDER / name)
    sim.forward()
    given = sim.qfrc_actuator + sim.qfrc_applied
    found = sim.inverse(sim.qacc, discrete=False)
    scale = largest(given, sim.qfrc_bias, sim.qfrc_passive, sim.qfrc_constraint, sim.mul_mass(sim.qacc))
    assert np.max(np.abs(found - given), initial=0.0) <= PRECISION * scale


@pytest.mark.parametrize("name", PUBLIC)
def test_jacobians_are_mujocos(name: str) -> None:
    sim = moving(FOLDER / name)
    sim.forward()
    model = mujoco.MjModel.from_xml_path(str(FOLDER / name))
    data = mujoco.MjData(model)
    data.qpos[:], data.qvel[:] = sim.qpos, sim.qvel
    data.mocap_pos[:], data.mocap_quat[:] = sim.mocap_pos, sim.mocap_quat
    mujoco.mj_forward(model, data)
    expected = np.zeros((2, 3, model.nv))
    for body in {1, model.nbody // 2, model.nbody - 1} - {0}:
        if body >= model.nbody:
            continue
        mujoco.mj_jacBody(model, data, expected[0], expected[1], body)
        np.testing.assert_allclose(sim.jacobian(body=body), expected, atol=1e-10 * largest(expected))
        point = data.xpos[body] + 0.1
        mujoco.mj_jacDot(model, data, expected[0], expected[1], point, body)
        np.testing.assert_allclose(sim.jacobian_rate(body=body, point=point), expected, atol=1e-9 * largest(expected, sim.qvel))
        mujoco.mj_jacSubtreeCom(model, data, expected[0], body)
        # MuJoCo's Jacobian of a subtree without mass is invalid.
        if model.body_subtreemass[body] > 0:
            np.testing.assert_allclose(sim.subtree_jacobian(body), expected[0], atol=1e-10 * largest(expected[0]))
