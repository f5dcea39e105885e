"""Sensors by name, in single simulations and in batches."""

from __future__ import annotations

import clench
import mujoco  # type: ignore[import-untyped]
import numpy as np
import pytest

SCENE = """<mujoco>
  <worldbody>
    <geom name="floor" type="plane" size="1 1 1"/>
    <camera name="eye" pos="0 -1 0.2" euler="90 0 0" resolution="2 3"/>
    <body name="ball" pos="0 0 0.099">
      <freejoint/>
      <geom name="ball" size="0.1"/>
      <site name="top" pos="0 0 0.1"/>
    </body>
  </worldbody>
  <sensor>
    <contact name="touch" geom1="ball" data="found dist normal"/>
    <clock/>
    <rangefinder name="picture" camera="eye"/>
    <framepos name="top" objtype="site" objname="top"/>
  </sensor>
</mujoco>"""


def test_a_sensor_is_its_part_of_all_numbers() -> None:
    sim = clench.Sim(clench.Model.from_xml(SCENE))
    sim.forward()
    assert sim.sensordata.shape == (5 + 1 + 6 + 3,)
    np.testing.assert_allclose(sim.sensor("touch"), [1, -0.001, 0, 0, -1], rtol=0, atol=1e-12)
    np.testing.assert_array_equal(sim.sensor(3), sim.sensordata[-3:])
    assert sim.sensor("picture").shape == (6,)
    with pytest.raises(ValueError, match='there is no sensor "any"'):
        sim.sensor("any")
    with pytest.raises(IndexError):
        sim.sensor(4)


def test_a_batch_has_a_row_for_each_environment() -> None:
    batch = clench.Batch(clench.Model.from_xml(SCENE), 5, record=["sensordata"])
    batch.qpos[:, 2] += 0.01 * np.arange(5)
    batch.forward()
    assert batch.sensor("top").shape == (5, 3)
    np.testing.assert_allclose(batch.sensor("top")[:, 2], batch.qpos[:, 2] + 0.1, rtol=0, atol=1e-12)
    np.testing.assert_array_equal(batch.sensor("touch")[:, 0], [1, 0, 0, 0, 0])
    with pytest.raises(ValueError, match="sensordata"):
        clench.Batch(batch.model, 2).sensor("top")


def test_forces_and_accelerations_of_bodies() -> None:
    sim = clench.Sim(clench.Model.from_xml(SCENE))
    sim.forward()
    ball, weight = 1, 9.81 * sim.model.body_mass[1]
    pressed = sim.contact_force[ball, 2]
    np.testing.assert_allclose(sim.cacc[ball, 5], pressed / sim.model.body_mass[ball], rtol=1e-9)
    np.testing.assert_allclose(sim.cacc[0], [0, 0, 0, 0, 0, 9.81], rtol=1e-12)
    np.testing.assert_allclose(sim.cfrc_ext[ball, 5], pressed, rtol=1e-9)
    np.testing.assert_allclose(sim.cfrc_int[ball], np.zeros(6), atol=1e-8 * weight)
    np.testing.assert_allclose(sim.cam_xpos[0], [0, -1, 0.2])
    assert sim.cam_xmat.shape == (1, 9)


@pytest.mark.parametrize("interp", ["zoh", "linear", "cubic"])
@pytest.mark.parametrize("time", [0, 0.013, 1.5])
def test_delays_after_a_keyframe_with_a_time(interp: str, time: float) -> None:
    delay = f'delay="0.025" nsample="6" interp="{interp}"'
    text = f"""<mujoco><option timestep="0.01"/>
      <worldbody><body><joint name="j" type="slide"/><geom size="0.1"/></body></worldbody>
      <actuator><motor joint="j" {delay}/></actuator>
      <sensor><jointpos joint="j" {delay}/><jointpos joint="j" interval="0.025" nsample="3"/></sensor>
      <keyframe><key time="{time}" qpos="0.3" ctrl="0.7"/></keyframe></mujoco>"""
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    sim, batch = clench.Sim(clench.Model.from_xml(text)), clench.Batch(clench.Model.from_xml(text), 2)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    sim.reset(0)
    batch.reset(keyframe=0)
    for step in range(12):
        data.ctrl[:] = sim.ctrl[:] = batch.ctrl[:] = step
        mujoco.mj_step(model, data)
        sim.step()
        batch.step()
        np.testing.assert_allclose(sim.sensordata, data.sensordata, atol=1e-12)
        np.testing.assert_allclose(sim.qvel, data.qvel, atol=1e-12)
    np.testing.assert_array_equal(batch.qpos, np.tile(sim.qpos, (2, 1)))


def test_forces_of_open_contacts_by_coulombs_law_are_those_of_one_to_the_bit() -> None:
    bodies = "".join(
        f'<body pos="{x} 0 {z}" euler="{4 + 20 * x} 11 0"><freejoint/><geom type="{kind}" size=".1 .08 .09" condim="4"/></body>'
        for x, z, kind in ((0, 0.097, "box"), (0.25, 0.113, "capsule"), (0.5, 0.091, "sphere"))
    )
    model = clench.Model.from_xml(f"""<mujoco>
      <worldbody><geom name="floor" type="plane" size="1 1 1" margin="0.02" condim="4"/>{bodies}</worldbody>
      <sensor><contact geom1="floor" num="8" data="found force torque"/></sensor></mujoco>""")
    options = clench.RigidOptions(contact_model="coulomb")
    batch = clench.Batch(model, 8, options=options, record=["sensordata"])
    batch.qvel = 2 * np.random.default_rng(6).normal(size=(8, model.nv))
    sims = [batch.sim(env) for env in range(8)]
    for _ in range(20):
        batch.step()
        for env, sim in enumerate(sims):
            sim.step()
            assert batch.sensordata[env].tobytes() == sim.sensordata.tobytes(), env


def test_forces_of_tendons_after_a_step_are_those_of_its_start() -> None:
    model = clench.Model.from_xml("""
        <mujoco>
          <worldbody>
            <body pos="0 0 1">
              <joint axis="0 1 0"/><geom size=".1" pos=".1 0 0"/>
              <body pos=".2 0 0"><joint axis="1 0 0"/><geom size=".1" pos=".1 .1 0"/><site name="s" pos=".2 .1 0"/></body>
            </body>
            <site name="t" pos="1 .1 1"/>
          </worldbody>
          <tendon>
            <spatial armature=".3" stiffness="200" springlength=".2" springyield=".02"><site site="s"/><site site="t"/></spatial>
          </tendon>
        </mujoco>""")
    batch = clench.Batch(model, 1, record=["cfrc_ext", "cfrc_int"])
    batch.qvel = [[5, 7]]
    batch.forward()
    before = batch.cfrc_ext.copy(), batch.cfrc_int.copy()
    assert abs(before[0]).max() > 50
    batch.step()
    np.testing.assert_array_equal(batch.cfrc_ext, before[0])
    np.testing.assert_array_equal(batch.cfrc_int, before[1])


def test_a_distance_of_bodies_is_the_least_of_their_geoms() -> None:
    """Also where they overlap, and beyond the cutoff."""
    shapes = {"sphere": ".1", "capsule": ".05 .2", "box": ".1 .2 .05", "ellipsoid": ".2 .1 .05", "cylinder": ".1 .05"}
    spec = clench.ModelSpec()
    spec.world.add_geom(name="w0", type="plane", size=[1, 1, 1])
    for name, x in (("a", 0.0), ("b", 0.9)):
        body = spec.world.add_body(name=name, pos=[x, 0, 0.6])
        body.add_freejoint()
        for k, (shape, size) in enumerate(shapes.items()):
            pos, euler = [0.1 * k, 0.2 * (k % 2), -0.1 * k], [30 * k, 20, 0]
            body.add_geom(name=f"{name}{k}", type=shape, size=size, pos=pos, euler=euler)
    names = {"a": [f"a{k}" for k in range(5)], "b": [f"b{k}" for k in range(5)], "world": ["w0"]}
    pairs = [("a", "b"), ("b", "a"), ("a", "world"), ("world", "b")]
    for first, second in pairs:
        spec.add_sensor("distance", body1=first, body2=second, cutoff=0.6)
        for a in names[first]:
            for b in names[second]:
                spec.add_sensor("distance", geom1=a, geom2=b, cutoff=0.6)
    sim = clench.Sim(spec.build())
    rng = np.random.default_rng(3)
    for _ in range(30):
        sim.qpos[:] = rng.normal(0.3, 0.5, 14)
        found, at = sim.sensordata, 0
        for first, second in pairs:
            count = len(names[first]) * len(names[second])
            assert found[at] == found[at + 1 : at + 1 + count].min()
            at += 1 + count
