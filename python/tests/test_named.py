"""Elements of simulations and batches by name, such as `Sim.body`, and single contacts."""

from __future__ import annotations

from typing import Any

import clench
import numpy as np
import pytest
from clench import _named
from clench._lines import Line
from scenes import example

SCENE = """
<mujoco model="named">
  <option gravity="0 0 -9.81"/>
  <worldbody>
    <geom name="floor" type="plane" size="2 2 1"/>
    <geom type="box" size="0.1 0.1 0.1" pos="1 0 0.1"/>
    <camera name="eye" pos="0 -2 1"/>
    <body name="ball" pos="0 0 0.0999">
      <freejoint name="free"/>
      <geom name="ball" size="0.1" mass="2"/>
      <geom size="0.02" pos="0 0 0.3" mass="0.1"/>
    </body>
    <body name="arm" pos="1 0 1">
      <joint name="shoulder" axis="0 1 0" damping="0.5" range="-2 2"/>
      <geom name="upper" type="capsule" fromto="0 0 0 0.3 0 0" size="0.03"/>
      <body name="fore" pos="0.3 0 0">
        <joint name="elbow" axis="0 1 0"/>
        <geom name="fore" type="capsule" fromto="0 0 0 0.3 0 0" size="0.03"/>
        <site name="tip" pos="0.3 0 0"/>
      </body>
    </body>
    <body name="goal" mocap="true" pos="0 1 1"><geom size="0.01" contype="0" conaffinity="0"/></body>
  </worldbody>
  <tendon><fixed name="both"><joint joint="shoulder" coef="1"/><joint joint="elbow" coef="2"/></fixed></tendon>
  <equality><weld name="hold" body1="fore" body2="goal" active="false"/></equality>
  <actuator><motor name="lift" joint="shoulder" ctrlrange="-5 5"/><position name="bend" joint="elbow" kp="3"/></actuator>
</mujoco>"""
VIEWS = [getattr(clench, name) for name in _named.__all__ if name.endswith("View") and name != "ElementView"]


@pytest.fixture
def sim() -> clench.Sim:
    return clench.Sim(clench.Model.from_xml(SCENE))


def lines(view: type[clench.ElementView]) -> dict[str, Line]:
    return {name: line for name, line in vars(view).items() if isinstance(line, Line)}


@pytest.mark.parametrize("view", VIEWS)
def test_views_name_every_parameter_of_their_kind(view: type[clench.ElementView]) -> None:
    prefix = {"joint": "jnt_", "camera": "cam_", "equality": "eq_"}.get(view._kind, f"{view._kind}_")
    of_kind = {name for name in clench.PARAMETERS if name.startswith(prefix)}
    assert of_kind <= {line._array for line in lines(view).values()}


@pytest.mark.parametrize("view", VIEWS)
def test_every_quantity_reads_and_says_what_it_is(view: type[clench.ElementView], sim: clench.Sim) -> None:
    batch = clench.Batch(sim.model, 3, record=clench.OUTPUTS)
    which = {"body": "goal", "joint": "free", "equality": "hold"}.get(view._kind, 0)
    alone, many = view(sim, which), view(batch, which)
    for name, line in lines(view).items():
        assert line.__doc__ and line.__doc__.endswith(".")
        one, all_of_them = np.asarray(getattr(alone, name)), np.asarray(getattr(many, name))
        assert all_of_them.shape == (3, *one.shape), name
        np.testing.assert_array_equal(all_of_them[1], one, err_msg=name)


def test_states_by_name_are_the_memory_of_the_simulation(sim: clench.Sim) -> None:
    elbow = sim.joint("elbow")
    elbow.qpos = 0.5
    elbow.qvel[0] = -1
    np.testing.assert_array_equal(sim.qpos[-1:], [0.5])
    assert sim.qvel[-1] == -1 and np.shares_memory(elbow.qpos, sim.qpos)
    assert sim.joint("free").qpos.shape == (7,) and sim.joint("free").qvel.shape == (6,)
    sim.actuator("bend").ctrl = 0.2
    sim.body("ball").xfrc_applied[2] = 1
    sim.body("goal").mocap_pos = [0, 1, 2]
    sim.equality("hold").active = True
    np.testing.assert_array_equal(sim.ctrl, [0, 0.2])
    assert sim.xfrc_applied[1, 2] == 1 and sim.mocap_pos[0, 2] == 2 and sim.eq_active[0]


def test_outputs_by_name_are_those_of_the_simulation(sim: clench.Sim) -> None:
    sim.joint("shoulder").qpos = 0.3
    fore = sim.model.body("fore").id
    np.testing.assert_array_equal(sim.body("fore").xpos, sim.xpos[fore])
    np.testing.assert_array_equal(sim.site("tip").xmat, sim.site_xmat[0])
    np.testing.assert_allclose(sim.tendon("both").length, 0.3)
    with pytest.raises(AttributeError, match="xpos is computed from the state"):
        sim.body("fore").xpos = [0, 0, 0]
    with pytest.raises(ValueError, match="read-only"):
        sim.body("fore").xpos[0] = 1


def test_parameters_by_name_are_checked_and_of_this_simulation_alone(sim: clench.Sim) -> None:
    other = clench.Sim(sim.model)
    sim.geom("ball").friction = [0.3, 0.01, 0]
    sim.body("ball").mass = 3
    sim.joint("shoulder").damping = 2
    np.testing.assert_array_equal(sim.param("geom_friction")[sim.model.geom("ball").id], [0.3, 0.01, 0])
    assert sim.body("ball").subtreemass == 3 and other.body("ball").mass == 2.1
    np.testing.assert_array_equal(sim.joint("shoulder").damping, [2])
    with pytest.raises(ValueError, match="geom_friction"):
        sim.geom("ball").friction = [-1, 0, 0]
    with pytest.raises(ValueError, match="body_subtreemass"):
        sim.body("ball").subtreemass = 1
    with pytest.raises(ValueError, match="read-only"):
        sim.geom("ball").friction[0] = 1


def test_gravity_wind_and_options_can_be_set_while_running(sim: clench.Sim) -> None:
    sim.joint("free").qpos[2] = 1
    sim.params.gravity = [0, 0, -1.62]
    sim.forward()
    np.testing.assert_allclose(sim.joint("free").qacc[2], -1.62)
    np.testing.assert_array_equal(sim.params.gravity, [0, 0, -1.62])
    sim.options = clench.RigidOptions(disable_constraint=True)
    sim.joint("free").qpos[2] = 0
    sim.forward()
    np.testing.assert_allclose(sim.joint("free").qacc[2], -1.62)
    assert len(sim.constraints) == 0
    with pytest.raises(ValueError, match="impratio"):
        sim.options = clench.RigidOptions(impratio=-1)
    assert sim.options.disable_constraint
    with pytest.raises(ValueError, match="timestep"):
        sim.params.timestep = -1
    with pytest.raises(AttributeError, match="gravitation"):
        sim.params.gravitation = 1


def test_a_batch_gives_parts_for_every_environment(sim: clench.Sim) -> None:
    batch = clench.Batch(sim.model, 3, record=["xpos"])
    batch.joint("elbow").qpos = [[0.1], [0.2], [0.3]]
    np.testing.assert_array_equal(batch.qpos[:, -1], [0.1, 0.2, 0.3])
    batch.body("ball").mass = [1, 2, 3]
    np.testing.assert_array_equal(batch.param("body_mass")[:, 1], [1, 2, 3])
    batch.params.gravity = [0, 0, -1]
    np.testing.assert_array_equal(batch.params.gravity, [[0, 0, -1]] * 3)
    assert batch.body("fore").xpos.shape == (3, 3)
    with pytest.raises(ValueError, match="not recorded"):
        batch.body("fore").cvel  # noqa: B018


def test_unknown_names_say_what_was_meant(sim: clench.Sim) -> None:
    with pytest.raises(ValueError, match='there is no body "fora"; did you mean "fore"'):
        sim.body("fora")
    with pytest.raises(IndexError, match="there is no joint 7"):
        sim.joint(7)
    with pytest.raises(AttributeError, match="not a mocap body"):
        sim.body("ball").mocap_pos  # noqa: B018


def test_contacts_can_be_indexed_iterated_and_filtered() -> None:
    sim = clench.Sim(example("box_stack"))
    sim.step(100)
    contacts = sim.contacts
    everything = list(contacts)
    assert len(everything) == len(contacts) > 4
    for i, contact in enumerate(everything):
        assert contact.geom == tuple(contacts.geom[i]) and contact.geom_names == contacts.geom_names[i]
        np.testing.assert_array_equal(contact.wrench, contacts.wrench[i])
        assert contact.dist == contacts.dist[i]
    np.testing.assert_array_equal(contacts[-1].pos, contacts.pos[-1])
    np.testing.assert_array_equal(contacts[2:4].pos, contacts.pos[2:4])
    deep = contacts.dist < np.median(contacts.dist)
    np.testing.assert_array_equal(contacts[deep].force, contacts.force[deep])
    with pytest.raises(IndexError, match="there is no contact"):
        contacts[len(contacts)]
    geom = int(contacts.geom[0, 1])
    assert len(contacts.of_geom(geom)) == (contacts.geom == geom).any(axis=1).sum()
    first, second = map(int, contacts.geom[0])
    between = contacts.between(second, first)
    assert len(between) == sum({first, second} == set(pair) for pair in contacts.geom.tolist())


def test_the_net_contact_force_of_a_body_is_the_sum_of_its_contacts(sim: clench.Sim) -> None:
    sim.step(50)
    net = np.zeros(3)
    for contact in sim.contacts.of_body("ball"):
        net += contact.wrench[:3] * (1 if contact.body[1] == sim.model.body("ball").id else -1)
    np.testing.assert_allclose(sim.body("ball").contact_force[:3], net, atol=1e-9)
    assert net[2] > 1


def test_geoms_without_a_name_go_by_body_and_number() -> None:
    sim = clench.Sim(clench.Model.from_xml(SCENE.replace('pos="0 0 0.0999"', 'pos="1 0 0.2999"').replace('name="ball" size', "size")))
    assert {frozenset(contact.geom_names) for contact in sim.contacts.of_body("ball")} == {frozenset(("ball[0]", "world[1]"))}
    hit = sim.ray([1, 0, 0.9], [0, 0, -1])
    assert hit is not None and hit.geom_name == "ball[1]"


def test_batch_queries_are_those_of_each_environment() -> None:
    batch = clench.Batch(clench.Model.from_xml(SCENE), 4)
    batch.joint("free").qpos[:, 2] = [0.09, 0.2, 0.3, 0.4]
    batch.joint("elbow").qpos = np.linspace(0, 1, 4)[:, None]
    origin, direction = np.array([[0, 0, 3.0 + i] for i in range(4)]), [0, 0, -1]
    distance, geom = batch.ray(origin, direction, exclude_body="arm")
    gaps, masses = batch.distance("floor", "ball"), batch.mass_matrix()
    for env in range(4):
        sim: Any = batch.sim(env)
        hit = sim.ray(origin[env], direction, exclude_body="arm")
        assert (distance[env], geom[env]) == (hit.distance, hit.geom)
        assert gaps[env] == sim.distance("floor", "ball").distance
        np.testing.assert_array_equal(masses[env], sim.mass_matrix())
        np.testing.assert_array_equal(batch.contacts(env).force, sim.contacts.force)
        np.testing.assert_array_equal(batch.constraints(env).J, sim.constraints.J)
    assert [len(batch.contacts(env)) for env in range(4)] == [1, 0, 0, 0]
    nothing, none = batch.ray([0, 0, 3], [0, 0, 1])
    assert np.isinf(nothing).all() and (none == -1).all()
    batch.set_equality("hold", [True, False, True, False])
    assert batch.eq_active[:, 0].tolist() == [True, False, True, False]
    with pytest.raises(ValueError, match="origin has shape"):
        batch.ray([[0, 0, 1]], direction)


def test_parameters_of_nothing_have_no_names() -> None:
    assert not hasattr(clench.Parameters.__new__(clench.Parameters), "gravity")
