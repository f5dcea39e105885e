"""Compares sleeping trees and states after each step with MuJoCo: one environment, and environments in lanes.

Both engines find their own contacts. The scenes have few bodies and unique contact points, so that only rounding
differs, and motion amplifies it by less than `NEAR`.
"""

import mujoco
import numpy as np
import pytest

import oracle
import program

STEPS = 1200
NEAR = 1e-8
SCENES = sorted((program.ROOT / "parity/sleeping").glob("*.xml"))
AWAKE = -11


@pytest.fixture(scope="module", params=SCENES, ids=lambda path: path.stem)
def scene(request):
    """Returns the scene, and MuJoCo's positions, velocities and `tree_asleep` after each step."""
    model = oracle.load(request.param)
    data = mujoco.MjData(model)
    rows = []
    for _ in range(STEPS):
        mujoco.mj_step(model, data)
        rows.append((data.qpos.copy(), data.qvel.copy(), data.tree_asleep.copy()))
    return request.param, *map(np.array, zip(*rows, strict=True))


def flags():
    return "--steps", STEPS, "--solver", "newton", "--iterations", 300, *program.EXACT


def assert_same(record, qpos, qvel, asleep):
    differing = np.flatnonzero((record["tree_asleep"] != asleep).any(axis=1))
    assert differing.size == 0, (
        f"after step {differing[0] + 1} {record['tree_asleep'][differing[0]]}, MuJoCo has {asleep[differing[0]]}"
    )
    assert np.abs(record["qpos"] - qpos).max() < NEAR
    assert np.abs(record["qvel"] - qvel).max() < NEAR / 1e-3


def test_the_same_trees_sleep(scene):
    path, qpos, qvel, asleep = scene
    assert (np.diff((asleep >= 0).astype(int), axis=0) != 0).sum() >= 4, "nothing to compare"
    record, _ = program.simulate(path, *flags())
    assert_same(record, qpos, qvel, asleep)


def test_the_same_trees_sleep_in_lanes(scene):
    path, qpos, qvel, asleep = scene
    record, _ = program.simulate(path, *flags(), "--envs", 3)
    for env in range(3):
        assert_same({name: record[name][env] for name in ("qpos", "qvel", "tree_asleep")}, qpos, qvel, asleep)


def test_lengths_and_beginnings(scene):
    """The trees that sleep after the first step are MuJoCo's."""
    path, *_ = scene
    model = oracle.load(path)
    data = mujoco.MjData(model)
    record, _ = program.simulate(path, *flags()[2:], "--steps", 1, "--every", 1)
    mujoco.mj_step(model, data)
    assert record["tree_asleep"][0].tolist() == data.tree_asleep.tolist()


def touches():
    """Returns a user's writes before some steps: (step, field, index, value)."""
    return [
        (150, "qvel", 2, -0.0),
        (200, "qfrc_applied", 2, -0.0),
        (203, "qfrc_applied", 2, 0.0),
        (260, "qpos", 0, 1e-9),
        (320, "xfrc_applied", (1, 0), 1e-9),
        (325, "xfrc_applied", (1, 0), 0.0),
        (380, "qvel", 0, 0.02),
        (440, "mocap_pos", (0, 0), 0.149),
        (470, "mocap_pos", (0, 0), 1.0),
        (540, "eq_active", 0, 1),
    ]


TOUCHED = """
<mujoco>
  <option><flag sleep="enable"/></option>
  <worldbody>
    <geom type="plane" size="0 0 1"/>
    <body pos="0 0 0.1"><freejoint/><geom type="box" size="0.1 0.1 0.1"/></body>
    <body pos="0 1 0.1"><freejoint/><geom type="box" size="0.1 0.1 0.1"/></body>
    <body pos="0 2 0.1"><freejoint/><geom type="box" size="0.1 0.1 0.1"/></body>
    <body mocap="true" pos="1 0 0.1"><geom type="sphere" size="0.05"/><body pos="0 0 1"><joint damping="1"/><geom size="0.1"/></body></body>
  </worldbody>
  <equality><connect body1="1" body2="2" anchor="0 0.5 0" active="false"/></equality>
</mujoco>
"""


def test_what_users_touch_wakes(tmp_path):
    """Each step starts from the state that the program returned, which includes the sleeping trees."""
    path = tmp_path / "touched.xml"
    named = TOUCHED.replace("<body pos=\"0 0 0.1\">", "<body name=\"1\" pos=\"0 0 0.1\">")
    path.write_text(named.replace("<body pos=\"0 1 0.1\">", "<body name=\"2\" pos=\"0 1 0.1\">"))
    model = oracle.load(path)
    data = mujoco.MjData(model)
    state, woke = {}, 0
    with program.Forward(path, "--step", "--solver", "newton", "--iterations", 300, *program.EXACT) as forward:
        for step in range(620):
            for _, name, index, value in (t for t in touches() if t[0] == step):
                theirs = getattr(data, name)
                ours = np.array(state.get(name, theirs), dtype=float)
                for array in (theirs, ours):
                    array[index] = array[index] + value if name == "qpos" else value
                state[name] = ours.tolist()
            asleep = data.tree_asleep >= 0
            mujoco.mj_step(model, data)
            woke += int((asleep & (data.tree_asleep < 0)).any())
            state.update(forward(state)["next"])
            assert state["tree_asleep"] == data.tree_asleep.tolist(), f"after step {step + 1}"
            assert np.abs(np.array(state["qpos"]) - data.qpos).max() < NEAR, f"after step {step + 1}"
    assert woke >= 8, "too little was woken"
