"""Compares the rest lengths of yielding springs with MuJoCo, step by step, with every integrator and in lanes."""

import mujoco
import numpy as np
import pytest

import oracle
import program
from compare import assert_close

PATH = program.ROOT / "parity/models/yielding.xml"
STEPS = 300
NEAR = 1e-7  # tolerance after motion has amplified rounding
INTEGRATORS = {
    "Euler": mujoco.mjtIntegrator.mjINT_EULER,
    "RK4": mujoco.mjtIntegrator.mjINT_RK4,
    "implicit": mujoco.mjtIntegrator.mjINT_IMPLICIT,
    "implicitfast": mujoco.mjtIntegrator.mjINT_IMPLICITFAST,
    "discrete": mujoco.mjtIntegrator.mjINT_DISCRETE,
}


@pytest.fixture(params=INTEGRATORS)
def written(request, tmp_path):
    """Returns the model with an integrator, and MuJoCo's states after each step from its first keyframe."""
    path = tmp_path / "yielding.xml"
    path.write_text(PATH.read_text().replace('integrator="implicitfast"', f'integrator="{request.param}"'))
    model = oracle.load(path)
    assert model.opt.integrator == INTEGRATORS[request.param]
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    rows = []
    for _ in range(STEPS):
        mujoco.mj_step(model, data)
        rows.append((data.qpos.copy(), data.qvel.copy(), data.plastic.copy()))
    return path, model, *map(np.array, zip(*rows, strict=True))


def test_plastic_rest_lengths(written):
    path, model, qpos, qvel, plastic = written
    moved = np.abs(np.diff(plastic, axis=0)).max(axis=0)
    assert (moved > 1e-4).all(), "every spring that can yield does"
    state = {"plastic": model.key_plastic[0].tolist()}
    with program.Forward(path, "--step", *program.EXACT) as forward:
        for step in range(STEPS):
            state = {**forward(state)["next"]}
            for name, expected in (("qpos", qpos), ("qvel", qvel), ("plastic", plastic)):
                assert_close(f"{name} after step {step + 1}", state[name], expected[step], NEAR, 1.0)


def test_motion_in_lanes(written):
    path, _, qpos, qvel, _ = written
    flags = ("--keyframe", "bent", "--steps", STEPS, *program.EXACT)
    alone, _ = program.simulate(path, *flags)
    many, _ = program.simulate(path, *flags, "--envs", 5)
    assert_close("qpos", alone["qpos"][-STEPS:], qpos, NEAR, 1.0)
    assert_close("qvel", alone["qvel"][-STEPS:], qvel, NEAR, 1.0)
    for env in range(5):
        for name in ("qpos", "qvel"):
            assert np.array_equal(many[name][env], alone[name]), f"{name} of environment {env}"
