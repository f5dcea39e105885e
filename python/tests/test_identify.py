"""`clench.identify` finds the parameters that moved a simulation."""

from __future__ import annotations

import importlib.util
import sys
from typing import Any, cast

import clench
import numpy as np
import pytest
from scenes import ball, example

EXACT = clench.RigidOptions(tolerance=0, iterations=200, ls_iterations=200, ls_tolerance=1e-10)

needs_scipy = pytest.mark.skipif(importlib.util.find_spec("scipy") is None, reason="needs SciPy")


def recorded(sim: clench.Sim, steps: int, **true: Any) -> dict[str, Any]:
    """Returns the motion of a simulation from its state, with other values of some parameters."""
    recording: dict[str, Any] = {"initial": sim.state, "ctrl": np.tile(sim.ctrl, (steps, 1))}
    batch = clench.Batch(sim.model, 1, options=EXACT)
    for name, values in true.items():
        batch.randomize(name, np.asarray(values)[np.newaxis])
    rows = batch.rollout(sim.state, recording["ctrl"], record=["qpos", "qvel", "sensordata"])
    return recording | {name: row[0] for name, row in rows.items()}


@needs_scipy
def test_damping_and_dry_friction_are_identified() -> None:
    sim = clench.Sim(example("pendulum"))
    recordings = []
    for start in (-1.5, -0.5):
        sim.reset()
        sim.qpos, sim.ctrl = [start], [1.5]
        recordings.append(recorded(sim, 150, dof_damping=[0.1], dof_frictionloss=[0.4]))
    found = clench.identify(sim.model, recordings, ["dof_damping", "dof_frictionloss"], options=EXACT)
    np.testing.assert_allclose(found.estimates, [0.1, 0.4], rtol=1e-5)
    np.testing.assert_allclose(found.parameters["dof_frictionloss"], [0.4], rtol=1e-5)
    assert found.covariance.shape == (2, 2) and found.residual < 1e-6
    assert found.result.nfev < 20


@needs_scipy
def test_inertia_is_identified_from_orientations_and_sensors() -> None:
    model = clench.Model.from_xml(
        "<mujoco><option timestep='0.01' gravity='0 0 0'/><worldbody><body><freejoint/>"
        "<geom type='box' size='0.1 0.2 0.3' mass='2'/><site name='s' pos='0.1 0 0'/></body></worldbody>"
        "<sensor><gyro site='s'/></sensor></mujoco>"
    )
    sim = clench.Sim(model)
    sim.qvel[3:] = [1, 2, 3]
    true = np.array(model.body_inertia)
    true[1, :2] *= [1.4, 0.9]
    whole = recorded(sim, 100, body_inertia=true)
    # The opposite quaternion is the same orientation. Numbers that are missing do not count.
    whole["qpos"][::2, 3:] *= -1.0
    whole["qpos"][5:10, 4] = np.nan
    whole["sensordata"][::3] = np.nan
    for measured in ({"qpos"}, {"sensordata"}, {"qpos", "qvel"}):
        recording = {name: whole[name] for name in measured | {"initial"}}
        found = clench.identify(model, [recording], {"body_inertia": [3, 4]})
        np.testing.assert_allclose(found.parameters["body_inertia"], true, rtol=1e-5)


@needs_scipy
def test_uncertainty_is_that_of_the_noise() -> None:
    sim, rng = clench.Sim(example("pendulum")), np.random.default_rng(0)
    sim.qpos = [-1.5]
    clean = recorded(sim, 150, dof_damping=[0.1])
    errors = []
    for _ in range(10):
        noisy = {**clean, "qpos": clean["qpos"] + 1e-3 * rng.normal(size=clean["qpos"].shape)}
        del noisy["qvel"], noisy["sensordata"]
        settings: Any = {"scale": {"qpos": 1e-3}, "bounds": {"dof_damping": (0, 1)}}
        found = clench.identify(sim.model, [noisy], ["dof_damping"], **settings)
        assert found.residual == pytest.approx(1.0, abs=0.25)
        errors.append((found.estimates[0] - 0.1) / np.sqrt(found.covariance[0, 0]))
    assert 0.4 < np.sqrt(np.mean(np.square(errors))) < 1.8
    # The margin of a geom that touches nothing cannot be seen.
    found = clench.identify(sim.model, [clean], {"dof_damping": [0], "geom_margin": [0]})
    assert np.isinf(found.covariance).all()


@needs_scipy
def test_identify_refuses() -> None:
    sim = clench.Sim(example("pendulum"))
    clean = recorded(sim, 10)

    def fails(error: type[Exception], match: str, recording: Any, parameters: Any, **settings: Any) -> None:
        with pytest.raises(error, match=match):
            clench.identify(sim.model, [recording], parameters, **settings)

    fails(ValueError, "dof_damping", clean, ["dof_dampin"])
    for index in (1, -1):
        fails(IndexError, "dof_damping has 1 numbers, not one", clean, {"dof_damping": [index]})
    fails(ValueError, "no parameters", clean, [])
    fails(ValueError, "no measured numbers", {"ctrl": clean["ctrl"]}, ["dof_damping"])
    fails(ValueError, "velocity", {**clean, "velocity": clean["qvel"]}, ["dof_damping"])
    fails(ValueError, r"shape \(9, 1\)", {**clean, "qvel": clean["qvel"][1:]}, ["dof_damping"])
    fails(ValueError, "bounds of body_mass", clean, ["dof_damping"], bounds={"body_mass": (0, 1)})
    fails(ValueError, "scale", clean, ["dof_damping"], scale={"xpos": 1.0})
    for scale in (0.0, -1.0, np.nan):
        fails(ValueError, "scale of qpos has a number that is not positive", clean, ["dof_damping"], scale={"qpos": scale})
    fails(ValueError, r"scale of qpos has shape \(3,\), not \(\) or \(1,\)", clean, ["dof_damping"], scale={"qpos": [1, 1, 1]})
    fails(ValueError, r"initial of a recording has shape \(2,\), not \(3,\)", {**clean, "initial": [0, 0]}, ["dof_damping"])
    fails(TypeError, r'such as \["dof_damping"\], not a str', clean, "dof_damping")
    fails(TypeError, "interpreted as an integer", clean, {"dof_damping": [0.5]})
    with pytest.raises(TypeError, match=r"one recording as \[recording\]"):
        clench.identify(sim.model, cast(Any, clean), ["dof_damping"])


def test_identify_names_the_missing_package(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "scipy.optimize", None)
    with pytest.raises(ModuleNotFoundError, match="pip install scipy"):
        clench.identify(ball(), [], ["body_mass"])
