"""The flag `multiccd`: without it, pairs that MuJoCo solves with its general algorithm have one contact."""

import mujoco
import numpy as np
import pytest

import program

CUBE = "  ".join(f"{x} {y} {z}" for x in (-0.05, 0.05) for y in (-0.04, 0.04) for z in (-0.05, 0.05))
SHAPES = {
    "capsule": 'type="capsule" size="0.04 0.05"',
    "ellipsoid": 'type="ellipsoid" size="0.05 0.04 0.06"',
    "cylinder": 'type="cylinder" size="0.05 0.05"',
    "box": 'type="box" size="0.06 0.04 0.05"',
    "mesh": 'type="mesh" mesh="cube"',
}
PAIRS = [(a, b) for k, a in enumerate(SHAPES) for b in list(SHAPES)[k:]]
# Pairs that MuJoCo solves with other algorithms, which ignore the flag.
OTHERS = {("capsule", "capsule"), ("capsule", "box"), ("box", "box")}
STATES = 60


def scene(below, above):
    return f"""<mujoco>
      <option tolerance="0" ccd_tolerance="1e-12" ccd_iterations="500"><flag multiccd="disable"/></option>
      <asset><mesh name="cube" vertex="{CUBE}"/></asset>
      <worldbody>
        <geom {SHAPES[below]}/>
        <body><freejoint/><geom {SHAPES[above]}/></body>
      </worldbody></mujoco>"""


def poses(rng):
    """Returns a random pose above the other shape, upright or lying, tilted by up to 0.1 rad to avoid symmetry."""
    quat = np.empty(4)
    turns = [([0, 0, 1], rng.uniform(0, 2 * np.pi)), ([0, 1, 0], rng.choice([0, np.pi / 2])), (rng.standard_normal(3), rng.uniform(0.01, 0.1))]
    total = np.array([1.0, 0, 0, 0])
    for axis, angle in turns:
        mujoco.mju_axisAngle2Quat(quat, np.asarray(axis) / np.linalg.norm(axis), angle)
        mujoco.mju_mulQuat(total, quat, total.copy())
    return [*rng.uniform(-0.02, 0.02, 2), rng.uniform(0.09, 0.1), *total]


@pytest.mark.parametrize("below, above", PAIRS)
def test_without_multiccd_the_contacts_are_mujocos(tmp_path, below, above):
    path = tmp_path / "pair.xml"
    path.write_text(scene(below, above))
    model = mujoco.MjModel.from_xml_string(path.read_text())
    data, rng, touching, same = mujoco.MjData(model), np.random.default_rng(7), 0, 0
    several = False
    with program.Forward(path) as forward:
        for _ in range(STATES):
            data.qpos[:] = poses(rng)
            mujoco.mj_forward(model, data)
            own = forward({"qpos": data.qpos.tolist()})["contacts"]
            assert bool(own) == bool(data.ncon)
            several |= len(own) > 1
            if not own:
                continue
            touching += 1
            if (below, above) in OTHERS:
                continue
            assert len(own) == data.ncon == 1
            # Our depth is exact (`test_shapes.py`); MuJoCo may find another direction of nearly equal depth.
            same += np.linalg.norm(np.subtract(own[0]["pos"], data.contact.pos[0])) < 1e-5
    assert touching >= STATES // 4
    if (below, above) in OTHERS:
        assert several or above == "capsule", "the flag takes nothing from them"
    else:
        assert same >= 0.9 * touching, f"{same} of {touching} points are the same"
