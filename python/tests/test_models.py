"""Batches of several models."""

from __future__ import annotations

import pickle
from typing import Literal

import clench
import numpy as np
import pytest

SCENE = """
<mujoco model="{name}">
  <asset>
    <mesh name="wedge" vertex="-.1 -.1 -.1  .1 -.1 -.1  .1 .1 -.1  -.1 .1 -.1  -.1 -.1 .05  -.1 .1 .05"/>
    <mesh name="octahedron" vertex=".12 0 0  -.12 0 0  0 .12 0  0 -.12 0  0 0 .12  0 0 -.12"/>
    <hfield name="waves" nrow="3" ncol="3" size="1 1 .1 .1" elevation="0 1 0  1 0 1  0 1 0"/>
  </asset>
  <worldbody>
    {world}
    <camera name="front" pos="0 -2 1" xyaxes="1 0 0 0 .5 1"/>
    <body name="object" pos="0 0 .3">
      <freejoint name="free"/>
      {object}
    </body>
    <body name="pusher" pos="-.4 0 .15">
      <joint name="push" type="slide" axis="1 0 0" damping="2"/>
      <geom name="tool" type="box" size=".05 .1 .1" mass=".5"/>
    </body>
  </worldbody>
  <actuator><position name="push" joint="push" kp="30"/></actuator>
  <sensor><framepos name="place" objtype="body" objname="object"/></sensor>
  <keyframe><key name="high" qpos="0 0 {height} 1 0 0 0  0"/></keyframe>
</mujoco>"""
PLANE = '<geom name="floor" type="plane" size="2 2 .1"/>'
WAVES = '<geom name="floor" type="hfield" hfield="waves"/>'
OBJECTS = {
    "ball": ('<geom name="ball" type="sphere" size=".1" mass=".2"/>', PLANE),
    "box": ('<geom name="box" type="box" size=".08 .06 .1" mass=".4" rgba="1 0 0 1"/>', PLANE),
    "wedge": ('<geom name="hull" type="mesh" mesh="wedge" mass=".3"/>', WAVES),
    "octahedron": ('<geom type="mesh" mesh="octahedron" mass=".3"/><geom type="sphere" size=".05" pos=".1 0 0"/>', PLANE),
}


def scene(name: str, height: float = 1.0) -> str:
    """Returns the text of a scene."""
    geoms, world = OBJECTS[name]
    return SCENE.format(name=name, object=geoms, world=world, height=height)


@pytest.fixture(scope="module")
def models() -> list[clench.Model]:
    """Models that differ in their object and in the ground."""
    return [clench.Model.from_xml(scene(name, 1.0 + 0.1 * k)) for k, name in enumerate(OBJECTS)]


@pytest.mark.parametrize("precision", ["64", "32"])
def test_environments_equal_simulations_of_their_models(models: list[clench.Model], precision: Literal["64", "32"]) -> None:
    env_model = [2, 0, 1, 3, 3, 1, 0, 2, 2, 0]
    batch = clench.Batch(models, 10, precision, 1, env_model=env_model, record=["sensordata", "geom_xpos"])
    assert batch.models == tuple(models)
    assert batch.env_model.tolist() == env_model
    sims = [clench.Sim(models[m], precision=precision) for m in env_model]
    targets = np.linspace(-0.3, 0.5, 10)
    batch.ctrl[:, 0] = targets
    for sim, target in zip(sims, targets, strict=True):
        sim.ctrl[0] = target
        sim.step(300)
    assert batch.step(300) == 0
    for env, sim in enumerate(sims):
        np.testing.assert_array_equal(batch.qpos[env], sim.qpos)
        np.testing.assert_array_equal(batch.qvel[env], sim.qvel)
        geoms = batch.geoms_of(env_model[env])
        batch_contacts = batch.contacts(env)
        assert len(batch_contacts) == len(sim.contacts)
        np.testing.assert_array_equal(batch_contacts.geom, sim.contacts.geom)
        assert [batch.model.geom_type[g] for g in geoms] == models[env_model[env]].geom_type.tolist()
    batch.forward()
    for env, sim in enumerate(sims):
        sim.forward()
        np.testing.assert_array_equal(batch.output("sensordata")[env], sim.sensordata)
        np.testing.assert_array_equal(batch.output("geom_xpos")[env, batch.geoms_of(env_model[env])], sim.geom_xpos)


def test_models_take_turns_by_default(models: list[clench.Model]) -> None:
    batch = clench.Batch(models, 6)
    assert batch.env_model.tolist() == [0, 1, 2, 3, 0, 1]
    assert clench.Batch(models[:1], 3).model is models[0]
    assert clench.Batch(models[0], 3).models == (models[0],)


def test_reset_gives_environments_other_models(models: list[clench.Model]) -> None:
    batch = clench.Batch(models, 5, env_model=[0] * 5, threads=1)
    batch.step(50)
    mask = np.array([False, True, False, True, True])
    batch.reset(mask, env_model=[3, 2, 1])
    assert batch.env_model.tolist() == [0, 3, 0, 2, 1]
    other = clench.Batch(models, 5, env_model=[0, 3, 0, 2, 1], threads=1)
    other.step(50)
    batch.reset(~mask)
    batch.step(50)
    np.testing.assert_array_equal(batch.qpos, other.qpos)
    # Each environment has the keyframes of its own model.
    batch.reset(keyframe="high")
    np.testing.assert_allclose(batch.qpos[:, 2], [1.0, 1.3, 1.0, 1.2, 1.1])
    batch.reset([True] * 5, "high", env_model=[1, 1, 2, 2, 3])
    np.testing.assert_allclose(batch.qpos[:, 2], [1.1, 1.1, 1.2, 1.2, 1.3])


def test_parameters_are_those_of_the_own_model(models: list[clench.Model]) -> None:
    batch = clench.Batch(models, 8, threads=1)
    object_ = models[0].body("object").id
    masses = [float(model.body_mass[object_]) for model in models]
    np.testing.assert_array_equal(batch.param("body_mass")[:, object_], masses * 2)
    heavier = batch.param("body_mass")
    heavier[4:] *= 2
    batch.randomize("body_mass", heavier[4:], envs=[4, 5, 6, 7], consistent=True)
    np.testing.assert_array_equal(batch.sim(5).param("body_mass"), 2 * np.asarray(models[1].body_mass))
    assert batch.sim(5).model is models[1]
    batch.reset([False] * 5 + [True] + [False] * 2, env_model=[0])
    np.testing.assert_array_equal(batch.sim(5).param("body_mass"), models[0].body_mass)


def test_a_pickle_keeps_the_models(models: list[clench.Model]) -> None:
    batch = clench.Batch(models, 7, threads=1)
    mass = batch.param("body_mass")
    mass[2] *= 1.5
    batch.randomize("body_mass", mass)
    batch.step(100)
    copy = pickle.loads(pickle.dumps(batch))
    assert copy.env_model.tolist() == batch.env_model.tolist()
    batch.step(50)
    copy.step(50)
    np.testing.assert_array_equal(copy.qpos, batch.qpos)


@pytest.mark.parametrize("threads", [1, 2])
def test_queries_are_those_of_the_own_model(models: list[clench.Model], threads: int) -> None:
    batch = clench.Batch(models, 7, threads=threads)
    batch.step(150)
    masses = batch.mass_matrix()
    distances, geoms = batch.ray([0, 0, 3], [0, 0, -1])
    batch.record("energy")
    gaps = batch.distance("tool", "ball")
    ball = batch.model.geom("ball").id
    for env in range(7):
        sim = batch.sim(env)
        np.testing.assert_array_equal(masses[env], sim.mass_matrix())
        np.testing.assert_array_equal(batch.output("energy")[env], sim.energy)
        hit = sim.ray([0, 0, 3], [0, 0, -1])
        assert hit is not None
        assert geoms[env] == batch.geoms_of(batch.env_model[env])[hit.geom]
        assert distances[env] == hit.distance
        own = batch.geoms_of(batch.env_model[env]).tolist()
        found = sim.distance("tool", own.index(ball)) if ball in own else None
        assert gaps[env] == (np.inf if found is None else found.distance)
        assert len(batch.constraints(env).force) == len(sim.constraints.force)


def test_derivatives_are_those_of_the_own_model(models: list[clench.Model]) -> None:
    batch = clench.Batch(models, 6, threads=2)
    batch.step(150)
    try:
        found = batch.linearize(outputs=["xpos"], parameters=["body_mass"])
    except clench.ClenchError as error:
        pytest.skip(str(error))
    for env in range(6):
        own = batch.sim(env).linearize(outputs=["xpos"], parameters=["body_mass"])
        for name in ("A", "B", "C", "D"):
            np.testing.assert_array_equal(getattr(found, name)[env], getattr(own, name))
        np.testing.assert_array_equal(found.parameters["body_mass"][env], own.parameters["body_mass"])
    with pytest.raises(ValueError, match="a parameter of geoms needs a batch of one model"):
        batch.linearize(parameters=["geom_friction"])
    with pytest.raises(ValueError, match="an output of geoms needs a batch of one model"):
        batch.linearize(outputs=["geom_xpos"])


def test_pictures_show_the_own_model(models: list[clench.Model]) -> None:
    batch = clench.Batch(models, 4)
    for env, model in enumerate(models):
        sim = clench.Sim(model)
        sim.state = batch.state[env]
        try:
            expected = sim.render(64, 48, camera="front", kind="geom")
        except clench.ClenchError as error:
            pytest.skip(str(error))
        np.testing.assert_array_equal(batch.render(env, 64, 48, camera="front", kind="geom"), expected)
    singly = [batch.render(env, 64, 48, camera="front") for env in (3, 0, 2)]
    np.testing.assert_array_equal(batch.render([3, 0, 2], 64, 48, camera="front"), np.stack(singly))


def test_mistakes_name_the_models_and_the_element(models: list[clench.Model]) -> None:
    changed = clench.Model.from_xml(scene("box").replace('name="push" joint', 'name="pull" joint'))
    with pytest.raises(ValueError, match='models 0 ."ball".*1 ."box".* name of actuator 0, "push" in one'):
        clench.Batch([models[0], changed], 4)
    with pytest.raises(ValueError, match="a batch needs a model"):
        clench.Batch([], 4)
    with pytest.raises(TypeError, match="a Model or a sequence of Model"):
        clench.Batch("ball", 4)  # type: ignore[arg-type]
    with pytest.raises(IndexError, match="env_model has 4"):
        clench.Batch(models, 1, env_model=[4])
    with pytest.raises(ValueError, match="env_model has 2 numbers, but there are 3"):
        clench.Batch(models, 3, env_model=[0, 1])
    with pytest.raises(ValueError, match="needs a batch of one model"):
        clench.Batch(models, 3, options=clench.RigidOptions(stiction=True))
    batch = clench.Batch(models, 3)
    with pytest.raises(ValueError, match="models"):
        batch.reset([True, True, False], env_model=[0])
    for model in (4, -1, 2**70):
        with pytest.raises(IndexError):
            batch.geoms_of(model)
    # A plane in some models, a height field in others: one of them would be that of a few environments.
    for call in (batch.geom, lambda name: batch.jacobian(geom=name), lambda name: batch.distance(name, "tool")):
        with pytest.raises(ValueError, match='several geoms "floor", since it has other types in some models'):
            call("floor")
    assert batch.geom("tool").name == "tool"
    with pytest.raises(TypeError, match="common layout"):
        pickle.dumps(batch.model)
    with pytest.raises(ValueError, match="a viewer needs a batch of one model"):
        clench.view(batch, open_browser=False)
