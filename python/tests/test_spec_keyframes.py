"""Keyframes of models whose elements are added and removed in Python."""

from __future__ import annotations

import clench
import mujoco  # type: ignore[import-untyped]
import numpy as np
import pytest

HOST = """
<mujoco>
  <worldbody>
    <body name="cup" mocap="true" pos="1 1 1"><geom size="0.1"/></body>
    <body name="a"><joint name="a" axis="1 0 0"/><geom size="0.1"/><site name="a"/>
      <body name="b"><joint name="b" axis="0 1 0"/><geom size="0.1"/><site name="b"/></body>
    </body>
    <body name="lid" mocap="true" pos="2 2 2"><geom size="0.1"/></body>
    <body name="c" pos="3 0 0"><joint name="c" type="ball"/><geom size="0.1"/></body>
  </worldbody>
  <tendon><spatial name="t"><site site="a"/><site site="b"/></spatial></tendon>
  <actuator><motor name="t" tendon="t"/><position name="c" joint="c" timeconst="0.1"/><motor name="a" joint="a"/></actuator>
  <keyframe>
    <key name="full" qpos="1 2 0.6 0.8 0 0" qvel="1 2 3 4 5" ctrl="1 2 3" act="4" mpos="1 2 3 4 5 6" mquat="1 0 0 0 0 1 0 0"/>
    <key name="short" qpos="1 2" ctrl="5 6"/>
  </keyframe>
</mujoco>"""
HAND = """
<mujoco>
  <worldbody><body name="palm"><joint name="turn" type="ball"/><geom size="0.1"/></body></worldbody>
  <actuator><motor name="turn" joint="turn"/></actuator>
  <keyframe><key name="open" qpos="0 1 0 0"/></keyframe>
</mujoco>"""
FIELDS = ("key_qpos", "key_qvel", "key_ctrl", "key_act", "key_mpos", "key_mquat")


def check(spec: clench.ModelSpec, oracle: mujoco.MjSpec) -> None:
    model, expected = spec.build(), oracle.compile()
    for name in FIELDS:
        np.testing.assert_allclose(getattr(model, name).ravel(), getattr(expected, name).ravel(), atol=1e-12, err_msg=name)


@pytest.mark.parametrize("name", ["a", "b", "c", "cup", "lid"])
def test_keyframes_lose_the_numbers_of_what_is_removed(name: str) -> None:
    spec, oracle = clench.ModelSpec.from_xml(HOST), mujoco.MjSpec.from_string(HOST)
    spec.body(name).remove()
    oracle.delete(oracle.body(name))
    check(spec, oracle)


def test_keyframes_lose_the_numbers_of_actuators() -> None:
    spec = clench.ModelSpec.from_xml(HOST)
    # The tendon refers to the site, and a motor to the tendon.
    spec.site("b").remove()
    model = spec.build()
    np.testing.assert_array_equal(model.key_ctrl, [[2, 3], [6, 0]])
    np.testing.assert_array_equal(model.key_act[0], [4])
    spec.joint("c").remove()
    np.testing.assert_array_equal(spec.build().key_ctrl, [[3], [0]])
    for name in ("a", "c", "cup", "lid"):
        spec.body(name).remove()
    assert spec.build().nkey == 2


@pytest.mark.parametrize("body", ["a", "b", "c"])
def test_keyframes_retain_their_numbers_where_a_model_is_attached(body: str) -> None:
    spec, oracle = clench.ModelSpec.from_xml(HOST), mujoco.MjSpec.from_string(HOST)
    spec.body(body).attach(clench.ModelSpec.from_xml(HAND), prefix="h_", body="palm")
    oracle.body(body).add_frame().attach_body(mujoco.MjSpec.from_string(HAND).body("palm"), "h_", "")
    check(spec, oracle)


def test_keyframes_of_attached_models_lose_numbers_too() -> None:
    spec = clench.ModelSpec.from_xml(HOST)
    hand = clench.ModelSpec.from_xml(HAND)
    hand.body("palm").add_body(name="tip").add_joint(name="bend")
    hand.body("tip").add_geom(size=0.1)
    hand.keyframe("open")["qpos"] = [0, 1, 0, 0, 0.5]
    attached = spec.body("a").attach(hand, prefix="h_")
    spec.joint("h_turn").remove()
    np.testing.assert_array_equal(spec.build().key_qpos[:, :3], [[1, 2, 0], [1, 2, 0], [0, 0, 0.5]])
    attached.remove()
    np.testing.assert_array_equal(spec.build().key_qpos[:, :3], [[1, 2, 0.6], [1, 2, 1]])


def test_keyframes_of_a_model_that_cannot_be_built_stay() -> None:
    spec = clench.ModelSpec.from_xml(HOST)
    spec.world.add_body(name="empty").add_joint()
    spec.body("a").remove()
    spec.body("empty").remove()
    with pytest.raises(clench.LoadError, match='key "full": qpos has 6 numbers, the model has 4'):
        spec.build()
