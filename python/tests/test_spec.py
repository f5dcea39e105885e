"""`ModelSpec`: models that are built and edited in Python."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import clench
import mujoco  # type: ignore[import-untyped]
import numpy as np
import pytest
from scenes import ROOT

EXAMPLES = [*sorted((ROOT / "models").glob("*.xml")), ROOT / "parity/models/attached.xml"]
FINGER = """
<mujoco model="finger">
  <worldbody>
    <body name="base"><geom name="base" size="0.05"/>
      <body name="tip" pos="0 0 0.1">
        <joint name="bend" axis="0 1 0"/>
        <geom name="tip" type="capsule" fromto="0 0 0 0 0 0.1" size="0.02"/>
      </body>
    </body>
  </worldbody>
  <actuator><position name="bend" joint="bend" kp="5"/></actuator>
  <sensor><jointpos name="bend" joint="bend"/><framepos objtype="body" objname="tip"/></sensor>
</mujoco>"""


def ends(model: clench.Model, steps: int = 50) -> clench.State:
    sim = clench.Sim(model)
    sim.qvel += np.linspace(-0.2, 0.2, model.nv)
    sim.ctrl += 0.1
    sim.step(steps)
    return sim.state


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_what_is_loaded_and_built_steps_as_the_file(path: Path) -> None:
    built = clench.ModelSpec.from_file(path).build()
    steps = 3 if path.stem == "pile" else 50
    assert ends(built, steps) == ends(clench.Model.from_file(path), steps)


def test_what_is_built_steps_as_what_is_written() -> None:
    spec = clench.ModelSpec("built")
    spec.section("option")["timestep"] = 0.001
    spec.world.add_geom(type="plane", size=[1, 1, 1])
    arm = spec.world.add_body(name="arm", pos=[0, 0, 1 / 3])
    arm.add_joint(name="shoulder", axis=[0, 1, 0], damping=0.1, limited=True, range=[-45, 45])
    arm.add_geom(name="arm", type="capsule", fromto=[0, 0, 0, 0.3, 0, 0], size=0.03)
    arm.add_site(name="hand", pos=[0.3, 0, 0])
    spec.add_actuator("motor", name="lift", joint="shoulder", gear=2)
    spec.add_sensor("framepos", name="hand", objtype="site", objname="hand")
    spec.add_tendon("fixed", name="string").add("joint", joint="shoulder", coef=-1.5)
    written = f"""
    <mujoco model="built"><option timestep="0.001"/>
      <worldbody><geom type="plane" size="1 1 1"/>
        <body name="arm" pos="0 0 {1 / 3!r}"><joint name="shoulder" axis="0 1 0" damping="0.1" limited="true" range="-45 45"/>
          <geom name="arm" type="capsule" fromto="0 0 0 0.3 0 0" size="0.03"/><site name="hand" pos="0.3 0 0"/></body>
      </worldbody>
      <tendon><fixed name="string"><joint joint="shoulder" coef="-1.5"/></fixed></tendon>
      <actuator><motor name="lift" joint="shoulder" gear="2"/></actuator>
      <sensor><framepos name="hand" objtype="site" objname="hand"/></sensor></mujoco>"""
    model = spec.build()
    assert model.name == "built" and model.body_pos[1, 2] == 1 / 3
    assert ends(model) == ends(clench.Model.from_xml(written))


@pytest.mark.parametrize("name", ["quadruped", "suction_gripper"])
def test_a_state_becomes_a_keyframe(name: str) -> None:
    spec = clench.ModelSpec.from_file(ROOT / f"models/{name}.xml")
    sim = clench.Sim(spec.build())
    sim.ctrl += 0.1
    sim.step(20)
    spec.add_keyframe(sim.state, name="here")
    assert spec.keyframe("here")["qvel"].split()[0] == repr(float(sim.qvel[0]))
    other = clench.Sim(spec.build())
    other.reset("here")
    assert other.time == sim.time
    for field in ("qpos", "qvel", "act", "ctrl", "mocap_pos", "mocap_quat"):
        np.testing.assert_allclose(getattr(other, field), getattr(sim, field), rtol=1e-15)
    with pytest.raises(ValueError, match="of one environment"):
        spec.add_keyframe(clench.Batch(sim.model, 2).state)


def test_where_springs_that_yield_rest_becomes_part_of_a_keyframe() -> None:
    spec = clench.ModelSpec.from_file(ROOT / "parity/models/yielding.xml")
    sim = clench.Sim(spec.build())
    assert sim.plastic.shape == (sim.model.nplastic,) == (16,)
    sim.reset("bent")
    sim.step(50)
    assert (sim.plastic != sim.model.key_plastic[0]).sum() > 8
    spec.add_keyframe(sim.state, name="here")
    other = clench.Sim(spec.build())
    other.reset("here")
    np.testing.assert_allclose(other.plastic, sim.plastic, rtol=1e-15)
    joint = sim.model.joint("slide")
    assert sim.plastic[joint.plasticadr] == sim.plastic[4] and joint.springyield == 0.01


def test_numbers_of_an_element_can_be_edited() -> None:
    spec = clench.ModelSpec.from_file(ROOT / "models/humanoid.xml")
    torso = spec.body("torso")
    assert "pos" in torso and torso.tag == "body" and torso.name == "torso"
    torso["pos"] = [0, 0, 2]
    spec.geom("floor")["friction"] = np.array([0.5, 0.01, 0.001])
    model = spec.build()
    np.testing.assert_array_equal(model.body("torso").pos, [0, 0, 2])
    np.testing.assert_array_equal(model.geom("floor").friction, [0.5, 0.01, 0.001])
    del torso["pos"]
    np.testing.assert_array_equal(spec.build().body("torso").pos, [0, 0, 0])
    with pytest.raises(KeyError, match="has no attribute"):
        torso["pos"]


def test_a_model_is_attached_with_a_prefix_as_often_as_wanted() -> None:
    finger = clench.ModelSpec.from_xml(FINGER)
    hand = clench.ModelSpec("hand")
    palm = hand.world.add_body(name="palm", pos=[0, 0, 1])
    palm.add_geom(type="box", size=[0.1, 0.1, 0.02])
    for side, x in (("left_", -0.08), ("right_", 0.08)):
        palm.add_frame(pos=[x, 0, 0.02], euler=[0, 0, 90]).attach(finger, prefix=side, body="base")
    model = hand.build()
    assert model.names("body") == ["world", "palm", "left_base", "left_tip", "right_base", "right_tip"]
    assert model.names("actuator") == ["left_bend", "right_bend"] and "right_bend" in model.names("sensor")
    np.testing.assert_allclose(model.body("right_base").pos, [0.08, 0, 0.02])
    with pytest.raises(ValueError, match="already attached with the prefix 'left_'"):
        palm.attach(finger, prefix="left_")
    assert ends(clench.Model.from_xml(model.to_xml())).qpos.shape == (2,)


def armed() -> clench.ModelSpec:
    """Returns an arm in degrees with a hand in radians, which has its own classes and units."""
    arm = clench.ModelSpec("arm")
    arm.section("default").add("geom", friction=[0.5, 0.01, 0.001])
    arm.world.add_geom(name="floor", type="plane", size=[1, 1, 0.1])
    upper = arm.world.add_body(name="upper", pos=[0, 0, 0.5])
    upper.add_joint(name="shoulder", axis=[0, 1, 0], range=[-90, 90], damping=0.1)
    upper.add_geom(type="capsule", fromto=[0, 0, 0, 0.3, 0, 0], size=0.03)
    tip = upper.add_body(name="tip", pos=[0.3, 0, 0])
    tip.add_joint(name="wrist", axis=[0, 0, 1], damping=0.05)
    tip.add_geom(size=0.03)
    arm.add_actuator("position", name="shoulder", joint="shoulder", kp=20)
    tip.add_frame(pos=[0.05, 0, 0], euler=[0, 90, 0]).attach(clench.ModelSpec.from_xml(HAND, HAND_ASSETS), prefix="g_")
    return arm


HAND = """
<mujoco model="hand">
  <compiler angle="radian" eulerseq="zyx"/>
  <default>
    <geom rgba="0.8 0.3 0.3 1"/>
    <default class="pad"><geom friction="1.5" solref="0.01 1"/><joint range="-0.3 0.6" damping="0.02"/></default>
  </default>
  <asset>
    <mesh file="block.obj" scale="0.01 0.02 0.03"/>
    <material name="rubber" rgba="0.2 0.2 0.2 1"/>
  </asset>
  <worldbody>
    <body name="palm" euler="0.4 0.2 0.1">
      <geom name="palm" type="mesh" mesh="block" mass="0.2"/>
      <body name="finger" pos="0 0 0.04">
        <joint name="bend" class="pad" axis="1 0 0"/>
        <geom name="finger" class="pad" type="box" size="0.01 0.01 0.03" pos="0 0 0.03" material="rubber"/>
        <site name="pad" pos="0 0 0.06"/>
      </body>
    </body>
  </worldbody>
  <contact><exclude body1="palm" body2="finger"/></contact>
  <tendon><fixed name="cord"><joint joint="bend" coef="0.5"/></fixed></tendon>
  <actuator><motor name="bend" tendon="cord" gear="0.1"/></actuator>
  <sensor><framepos name="pad" objtype="site" objname="pad"/></sensor>
</mujoco>"""
HAND_ASSETS = {
    "block.obj": b"v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv 0 0 1\nf 1 3 2\nf 1 4 3\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n"
}


def test_what_is_attached_is_found_changed_and_referred_to() -> None:
    arm = armed()
    assert arm.names("body") == ["upper", "tip", "g_palm", "g_finger"]
    assert [arm.names(kind) for kind in ("actuator", "tendon", "mesh")] == [["shoulder", "g_bend"], ["g_cord"], ["g_block"]]
    arm.body("g_finger")["pos"] = [0, 0, 0.06]
    arm.body("g_finger").add_geom(name="nail", class_="g_pad", material="g_rubber", size=0.005)
    arm.add_sensor("touch", name="touch", site="g_pad")
    arm.add_tendon("spatial", name="string").add("site", site="g_pad")
    arm.body("tip").add_site(name="tip")
    list(arm.section("tendon"))[0].add("site", site="tip")
    model = arm.build()
    np.testing.assert_array_equal(model.body("g_finger").pos, [0, 0, 0.06])
    np.testing.assert_array_equal(model.geom("nail").friction, [1.5, 0.005, 0.0001])
    np.testing.assert_array_equal(model.geom("floor").friction, [0.5, 0.01, 0.001])
    np.testing.assert_array_equal(model.joint("g_bend").range, [-0.3, 0.6])
    assert model.names("sensor") == ["touch", "g_pad"]
    for change in (
        lambda: arm.add_sensor("touch", site="g_pod"),
        lambda: arm.body("g_finger").add_geom(type="bx"),
        lambda: arm.actuator("g_bend").__setitem__("tendon", "cord"),
    ):
        with pytest.raises(clench.LoadError):
            change()
    with pytest.raises(ValueError, match='there is already a body "g_palm"'):
        arm.body("upper").rename("g_palm")
    arm.body("g_finger").add_geom(type="mesh")
    with pytest.raises(clench.LoadError, match='^body "g_finger" / geom 2: '):
        arm.build()


def test_what_is_attached_is_renamed_and_removed() -> None:
    arm = armed()
    arm.joint("g_bend").rename("flex")
    arm.body("g_palm").rename("hand")
    model = arm.build()
    assert model.names("joint") == ["shoulder", "wrist", "flex"] and model.names("body")[3] == "hand"
    arm.joint("flex").remove()
    model = arm.build()
    assert (model.nv, model.nu, model.ntendon, model.nsensor) == (2, 1, 0, 1)
    arm.body("hand").remove()
    assert arm.build().nbody == 3 and arm.names("sensor") == []

    arm = armed()
    arm.add_sensor("touch", site="g_pad")
    list(list(arm.body("tip"))[-1])[0].remove()
    assert arm.names("body") == ["upper", "tip"] and arm.names("material") == []
    model = arm.build()
    assert (model.nbody, model.nu, model.nsensor, model.nmesh) == (3, 1, 0, 0)


def test_the_source_goes_its_own_way() -> None:
    hand = clench.ModelSpec.from_xml(HAND, HAND_ASSETS)
    two = clench.ModelSpec("two")
    left, right = (two.world.add_body(name=name, pos=[0, y, 1]) for name, y in (("left", -0.5), ("right", 0.5)))
    left.attach(hand, prefix="l_")
    hand.joint("bend").rename("curl")
    hand.body("palm").add_site(name="grip")
    attached = right.attach(hand, prefix="r_", body="finger")
    assert [child.name for child in attached] == ["r_finger"]
    assert two.names("joint") == ["l_bend", "r_curl"] and two.names("site") == ["l_pad", "r_pad"]
    two.joint("l_bend")["damping"] = 3
    assert "damping" not in hand.joint("curl")
    model = two.build()
    assert model.names("body") == ["world", "left", "l_palm", "l_finger", "right", "r_finger"]
    assert model.names("actuator") == ["l_bend", "r_bend"]
    # An attached model includes the models attached to it, and a copy is independent.
    room = clench.ModelSpec("room")
    room.world.attach(two, prefix="a_")
    room.world.add_frame(pos=[2, 0, 0]).attach(two, prefix="b_", body="right")
    other = room.copy()
    room.body("a_l_finger").rename("thumb")
    assert room.build().names("body") == [
        "world", "a_left", "a_l_palm", "thumb", "a_right", "a_r_finger", "b_right", "b_r_finger",
    ]  # fmt: skip
    assert "a_l_finger" in other.build().names("body")
    with pytest.raises(ValueError, match='no body "thumb"'):
        room.world.attach(two, prefix="c_", body="thumb")
    with pytest.raises(ValueError, match='there is already a body "left"'):
        two.world.attach(two, prefix="")


def test_a_body_is_attached_without_the_cameras_that_follow_others() -> None:
    scene = clench.ModelSpec("scene")
    for name in ("ball", "cube"):
        scene.world.add_body(name=name).add_geom(size=0.1)
        scene.world.add_camera(name=f"to_{name}", mode="targetbody", target=name)
    room = clench.ModelSpec("room")
    room.world.attach(scene, prefix="s_", body="cube")
    assert (room.names("body"), room.names("camera")) == (["s_cube"], [])
    assert room.build().nbody == 2


def test_an_attached_model_moves_in_mujoco_as_here() -> None:
    text = armed().to_xml()
    model = armed().build()
    oracle = mujoco.MjModel.from_xml_string(text)
    data, sim = mujoco.MjData(oracle), clench.Sim(model)
    assert oracle.names == mujoco.MjModel.from_xml_string(model.to_xml()).names
    for step in range(200):
        data.ctrl[:] = sim.ctrl[:] = [0.5 * np.sin(0.05 * step), np.cos(0.1 * step)]
        mujoco.mj_step(oracle, data)
        sim.step()
        np.testing.assert_allclose(sim.qpos, data.qpos, rtol=0, atol=1e-6)
    assert np.abs(sim.qpos).max() > 0.3


def test_a_model_whose_file_attaches_others_is_attached() -> None:
    part = "<mujoco><worldbody><body name='b'><joint name='j'/><geom size='1'/></body></worldbody></mujoco>"
    pair = """<mujoco><asset><model name="part" file="part.xml"/></asset>
      <worldbody><attach model="part" prefix="x_"/><body name="c"><geom size="1"/></body><attach body="c" prefix="y_"/></worldbody></mujoco>"""
    spec = clench.ModelSpec("room")
    spec.world.attach(clench.ModelSpec.from_xml(pair, {"part.xml": part.encode()}), prefix="p_")
    assert spec.names("body") == ["p_x_b", "p_c", "p_y_c"]
    assert spec.build().names("joint") == ["p_x_j"]


def test_what_refers_to_a_name_follows_it() -> None:
    spec = clench.ModelSpec.from_xml(FINGER)
    spec.joint("bend").rename("flex")
    spec.body("tip").rename("end")
    assert spec.actuator("bend")["joint"] == spec.sensor("bend")["joint"] == "flex"
    model = spec.build()
    assert model.names("joint") == ["flex"] and model.names("body") == ["world", "base", "end"]
    with pytest.raises(ValueError, match='there is already a body "base"'):
        spec.body("end").rename("base")
    with pytest.raises(ValueError, match='there is no joint "bend": there are flex'):
        spec.joint("bend")


def test_what_refers_to_what_is_removed_goes_with_it() -> None:
    spec = clench.ModelSpec.from_xml(FINGER)
    spec.add_tendon("fixed", name="string").add("joint", joint="bend", coef=1)
    spec.add_sensor("tendonpos", name="string", tendon="string")
    whole = spec.copy()
    spec.joint("bend").remove()
    model = spec.build()
    assert (model.nv, model.nu, model.ntendon, model.nsensor) == (0, 0, 0, 1)
    whole.body("tip").remove()
    assert whole.build().nbody == 2 and whole.build().nsensor == 0
    with pytest.raises(ValueError, match="already removed"):
        tip = spec.body("tip")
        tip.remove()
        tip.remove()


def test_urdf_becomes_a_document() -> None:
    path = ROOT / "models/gripper/gripper.urdf"
    spec = clench.ModelSpec.from_file(path)
    assert spec.build().nv == clench.Model.from_file(path).nv
    spec.add_actuator("motor", joint=spec.names("joint")[0])
    assert spec.build().nu == clench.Model.from_file(path).nu + 1


def test_wrong_values_are_refused() -> None:
    spec = clench.ModelSpec()
    with pytest.raises(TypeError, match="not dict"):
        spec.world.add_body(pos={})  # type: ignore[arg-type]
    assert spec.names("body") == [] and len(list(spec.world)) == 0
    with pytest.raises(ValueError, match="no kind of element"):
        spec.find("bodies", "x")
    with pytest.raises(clench.LoadError, match="was expected"):
        clench.ModelSpec.from_xml("<sdf/>")
    with pytest.raises(clench.LoadError, match="not well-formed"):
        clench.ModelSpec.from_xml("<mujoco>\n<a b=></mujoco>")


# Erroneous edits of the finger, and the messages that the calls raise.
MISTAKES: list[tuple[Callable[[clench.ModelSpec], object], str]] = [
    (lambda spec: spec.body("tip").add_geom(type="bx"), 'body "tip" / geom 1: type is "bx", not one of .*box'),
    (lambda spec: spec.body("tip").add_geom(size=0.1, frction=1), 'unknown attribute "frction"; did you mean "friction"'),
    (lambda spec: spec.body("tip").add_geom(size=[1, 2, 3, 4]), "size has more than 3 numbers"),
    (lambda spec: spec.body("tip").add_geom(pos=[1, 2]), "pos needs 3 numbers, not 2"),
    (lambda spec: spec.body("tip").add_geom(size=0.1, material="wod"), 'there is no material "wod"'),
    (lambda spec: spec.body("tip").add_geom(type="mesh", mesh="wod"), 'there is no mesh "wod"'),
    (lambda spec: spec.body("tip").add_geom(size=0.1, class_="wod"), 'there is no default class "wod"'),
    (lambda spec: spec.body("tip").add("gom", size=0.1), "unknown element <gom> in <body>; did you mean .geom."),
    (lambda spec: spec.section("opton"), "unknown element <opton> in <mujoco>; did you mean .option."),
    (lambda spec: spec.section("option").__setitem__("timestep", "fast"), "fast.* is not a finite number"),
    (lambda spec: spec.section("default").add("geom", rgba=[1, 2]), "rgba needs 4 numbers"),
    (lambda spec: spec.geom("tip").__setitem__("type", "bx"), 'geom "tip": type is "bx"'),
    (lambda spec: spec.add_actuator("motr", joint="bend"), "unknown element <motr>.*did you mean .motor."),
    (lambda spec: spec.add_actuator("motor", joint="bnd"), 'motor 0: there is no joint "bnd"; did you mean "bend"'),
    (lambda spec: spec.add_sensor("framepos", objtype="site", objname="tip"), 'there is no site "tip"'),
    (lambda spec: spec.add_sensor("framepos", objtype="sit", objname="tip"), 'objtype is "sit", not one of'),
    (lambda spec: spec.add_equality("weld", body1="base", body2="top"), 'there is no body "top"; did you mean "tip"'),
    (lambda spec: [spec.add_tendon("fixed").add("joint", joint=name, coef=1) for name in ("bend", "bnd")], 'there is no joint "bnd"'),
    (lambda spec: spec.add_asset("mesh", name="m", vertex="1 2 x"), "x.* is not a finite number"),
    (lambda spec: spec.add_asset("mesh", file="nowhere.stl"), 'cannot find the file "nowhere.stl"'),
]


@pytest.mark.parametrize(("mistake", "message"), MISTAKES, ids=lambda value: value[:30] if isinstance(value, str) else "")
def test_mistakes_are_told_where_they_are_written(mistake: Callable[[clench.ModelSpec], object], message: str) -> None:
    spec = clench.ModelSpec.from_xml(FINGER)
    before = {tag: spec.to_xml().count(f"<{tag}") for tag in ("geom", "motor", "weld", "mesh", "framepos")}
    with pytest.raises(clench.LoadError, match=message) as raised:
        mistake(spec)
    assert raised.value.line is None
    # The model is unchanged.
    assert before == {tag: spec.to_xml().count(f"<{tag}") for tag in before}
    assert spec.geom("tip")["type"] == "capsule"


def test_an_attribute_that_is_not_an_item_is_refused() -> None:
    spec = clench.ModelSpec.from_xml(FINGER)
    with pytest.raises(AttributeError, match="timestep"):
        setattr(spec.section("option"), "timestep", 0.01)
    with pytest.raises(AttributeError, match="gravity"):
        setattr(spec, "gravity", 0)


def test_what_an_element_lacks_can_be_said_later() -> None:
    spec = clench.ModelSpec.from_xml(FINGER)
    box = spec.body("tip").add_geom(type="box")
    box["size"] = [0.1, 0.1, 0.1]
    string = spec.add_tendon("spatial", name="string")
    gyro = spec.add_sensor("gyro", name="gyro")
    for body in ("base", "tip"):
        spec.body(body).add_site(name=body)
        string.add("site", site=body)
    gyro["site"] = "tip"
    model = spec.build()
    assert (model.ntendon, model.nsensor, model.ngeom) == (1, 3, 3)


def test_what_only_the_whole_can_tell_names_the_element_by_its_path() -> None:
    spec = clench.ModelSpec.from_xml(FINGER)
    spec.body("tip").add_geom(size=0.1)
    spec.body("tip").add_geom(type="box", size=0.1)
    with pytest.raises(clench.LoadError, match='^body "tip" / geom 2: ') as raised:
        spec.build()
    assert (raised.value.line, raised.value.element) == (None, 'body "tip" / geom 2')


def test_ranges_act_where_a_document_does_not_infer_it() -> None:
    spec = clench.ModelSpec.from_xml("<mujoco><compiler autolimits='false'/><worldbody/></mujoco>")
    body = spec.world.add_body(name="b")
    body.add_joint(name="j", range=[-1, 1])
    body.add_geom(size=0.1)
    body.add_joint(name="free", type="slide", range=[-1, 1], limited=False)
    spec.add_actuator("motor", name="m", joint="j", ctrlrange=[-2, 2])
    model = spec.build()
    assert model.jnt_limited.tolist() == [True, False] and model.actuator_ctrllimited.tolist() == [True]
    saved = clench.ModelSpec.from_xml(model.to_xml())
    saved.add_actuator("motor", name="n", joint="free", ctrlrange=[-2, 2], forcerange=[-1, 1])
    again = saved.build()
    assert again.actuator_ctrllimited.tolist() == [True, True] and again.actuator_forcelimited.tolist() == [False, True]


def test_a_refused_element_leaves_its_names_free() -> None:
    spec = clench.ModelSpec.from_xml(FINGER)
    with pytest.raises(clench.LoadError, match="no joint"):
        spec.add_actuator("motor", name="lift", joint="bnd")
    assert spec.add_actuator("motor", name="lift", joint="bend").name == "lift"
    with pytest.raises(clench.LoadError, match="no joint"):
        spec.actuator("lift")["joint"] = "bnd"
    spec.actuator("lift").rename("raise")
    assert spec.names("actuator") == ["bend", "raise"]
    spec.add_asset("mesh", data=b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n", file="parts/block.obj")
    spec.body("tip").add_geom(type="mesh", mesh="block")
    assert spec.build().nmesh == 1
