"""Batches on a GPU. Skipped without one."""

from __future__ import annotations

import os
import pickle
from typing import Any

import clench
import numpy as np
import pytest
from clench.gymnasium import BatchEnv
from scenes import ball, example

if os.environ.get("CLENCH_GPU") == "skip" or not clench.devices():
    pytest.skip("no graphics device (mesa-vulkan-drivers has one)", allow_module_level=True)


def pair(n: int = 12, **how: Any) -> tuple[clench.Batch, clench.Batch]:
    """Returns batches of the humanoid on a GPU and on the CPU, in the same random states."""
    model = example("humanoid")
    batches = clench.Batch(model, n, device="gpu", **how), clench.Batch(model, n, "32", **how)
    rng = np.random.default_rng(4)
    velocities, controls = rng.normal(0, 0.1, (n, model.nv)), rng.uniform(-1, 1, (n, model.nu))
    for batch in batches:
        batch.qvel[:] = velocities
        batch.ctrl[:] = controls
    return batches


def test_a_device_steps_as_the_processor() -> None:
    outputs = ["xpos", "cvel", "cfrc_ext", "cinert", "contact_force"]
    device, processor = pair(record=outputs)
    assert device.device.startswith("gpu:") and processor.device == "cpu"
    assert device.precision == "32" and "on gpu:" in repr(device)
    for batch in (device, processor):
        assert batch.step(20) == 0
    np.testing.assert_allclose(device.qpos, processor.qpos, atol=1e-4)
    np.testing.assert_allclose(device.time, processor.time)
    for name in outputs:
        found, expected = device.output(name), processor.output(name)
        np.testing.assert_allclose(found, expected, atol=2e-3 * np.abs(expected).max(), err_msg=name)


def test_what_is_written_counts_and_what_is_reset_begins_anew() -> None:
    device, processor = pair(record=["xpos"])
    for batch in (device, processor):
        batch.step(3)
        batch.reset(np.arange(12) % 4 == 0)
        batch.qpos[1, 2] += 0.3
        batch.step(2)
    np.testing.assert_allclose(device.qpos, processor.qpos, atol=1e-4)
    # Outputs take writes into account before the next step.
    device.qpos[2, 2] = 5
    np.testing.assert_allclose(device.xpos[2, 1, 2], 5)


def test_states_and_pickles_go_on_to_the_bit() -> None:
    device, _ = pair()
    device.step(5)
    state, copy = device.state, pickle.loads(pickle.dumps(device))
    device.step(5)
    after = device.qpos.copy()
    copy.step(5)
    np.testing.assert_array_equal(copy.qpos, after)
    device.state = state
    device.step(5)
    np.testing.assert_array_equal(device.qpos, after)


def test_a_rollout_is_recorded() -> None:
    device, processor = pair()
    ctrl = np.random.default_rng(0).uniform(-1, 1, (6, device.model.nu))
    found, expected = (batch.rollout(ctrl=ctrl, record=["qpos", "xpos"]) for batch in (device, processor))
    for name, values in expected.items():
        np.testing.assert_allclose(found[name], values, atol=1e-4, err_msg=name)


def test_a_fault_is_that_of_its_environment() -> None:
    device, _ = pair()
    device.qvel[3, 0] = np.nan
    device.qfrc_applied[5, 2] = 1e30
    assert device.step(2) == 2
    assert device.status.tolist().count(0) == 10
    assert "qvel[0] is NaN" in str(device.fault(3))
    assert "diverged" in str(device.fault(5)) and "qacc[" in str(device.fault(5))


def test_a_device_steps_in_double_precision() -> None:
    device = clench.Batch(ball(), 3, "64", device="gpu", record=["xpos"])
    processor = clench.Batch(ball(), 3, "64", record=["xpos"])
    assert device.precision == "64" and device.qpos.dtype == np.float64
    for batch in (device, processor):
        batch.qvel[1] = 0.3
        assert batch.step(60) == 0
    np.testing.assert_allclose(device.qpos, processor.qpos, rtol=0, atol=1e-11)
    np.testing.assert_allclose(device.xpos, processor.xpos, rtol=0, atol=1e-11)


@pytest.mark.parametrize(
    ("how", "error", "words"),
    [
        ({"device": "tpu"}, ValueError, 'must be "cpu", "gpu"'),
        ({"device": 3}, TypeError, "a str, not int"),
        ({"device": "gpu:no such GPU"}, ValueError, 'no graphics device "no such GPU"'),
    ],
)
def test_what_cannot_be_is_said(how: dict[str, Any], error: type[Exception], words: str) -> None:
    with pytest.raises(error, match=words):
        clench.Batch(ball(), 2, **how)


def test_a_model_that_no_device_knows_is_refused_by_name() -> None:
    still = clench.Model.from_xml("<mujoco><worldbody><geom size='1'/></worldbody></mujoco>")
    with pytest.raises(ValueError, match="model without degrees of freedom"):
        clench.Batch(still, 2, device="gpu")


def test_conjugate_gradients_step_as_on_the_processor() -> None:
    device, processor = pair(options=clench.RigidOptions(constraint_solver="CG", tolerance=1e-7))
    for batch in (device, processor):
        assert batch.step(5) == 0
    np.testing.assert_allclose(device.qpos, processor.qpos, atol=1e-4)


def test_environments_have_parameters_of_their_own() -> None:
    device, processor = pair()
    masses = device.param("body_mass") * np.linspace(0.5, 2, 12, dtype=np.float32)[:, None]
    for batch in (device, processor):
        batch.randomize("body_mass", masses)
        batch.step(10)
    np.testing.assert_allclose(device.qpos, processor.qpos, atol=1e-4)


def test_options_stay() -> None:
    device, _ = pair()
    with pytest.raises(clench.ClenchError, match="cannot be changed yet"):
        device.options = clench.RigidOptions(iterations=3)


def test_constraints_are_added_as_on_the_processor() -> None:
    device, processor = pair()
    for batch in (device, processor):
        batch.step(3)
        grips = batch.add_weld("torso", "left_forearm", [1, 4])
        batch.step(3)
        batch.remove(grips[:1], [1])
        batch.step(3)
    np.testing.assert_allclose(device.qpos, processor.qpos, atol=1e-4)
    np.testing.assert_array_equal(device.dynamic_kind, processor.dynamic_kind)


def test_derivatives_are_those_of_the_state_on_the_device() -> None:
    device, processor = pair(2)
    device.step(3)
    processor.state = device.state
    for name in "AB":
        found, expected = (getattr(batch.linearize(), name) for batch in (device, processor))
        np.testing.assert_array_equal(found, expected)


def test_external_forces_include_the_inertia_of_tendons() -> None:
    model = clench.Model.from_xml(
        """<mujoco><worldbody>
             <body pos="0 0 1"><joint type="ball"/><geom size=".1" pos=".1 0 0"/><site name="s" pos=".2 0 0"/></body>
             <site name="t" pos="0.8 .1 1"/>
           </worldbody>
           <tendon><spatial armature="0.3"><site site="s"/><site site="t"/></spatial></tendon></mujoco>"""
    )
    device, sim = clench.Batch(model, 1, "64", device="gpu", record=["cfrc_ext"]), clench.Sim(model)
    device.qvel[:] = sim.qvel[:] = [0.1, 0.5, 0.2]
    device.step()
    sim.forward()
    assert np.abs(sim.cfrc_ext).max() > 1e-3
    np.testing.assert_allclose(device.cfrc_ext[0], sim.cfrc_ext, rtol=0, atol=1e-9)


def test_environments_train_on_a_device() -> None:
    class Stand(BatchEnv):
        model = example("humanoid")
        device = "gpu"
        outputs = ("xpos",)

        def observe(self) -> np.ndarray:
            return np.concatenate([self.batch.qpos, self.batch.qvel, self.batch.xpos[:, 1]], 1)

        def reward(self, _: Any) -> np.ndarray:
            return self.batch.qpos[:, 2]

    env = Stand(4, max_episode_steps=5)
    observation, _ = env.reset(seed=1)
    assert observation.shape == (4, env.batch.model.nq + env.batch.model.nv + 3)
    for _ in range(7):
        observation, reward, *_ = env.step(env.action_space.sample())
    assert np.isfinite(observation).all() and (reward > 0).all()
    env.close()
