"""Mistakes in calls of a `ModelSpec` are errors of these calls, and leave the model as it was."""

from __future__ import annotations

import copy
from collections.abc import Callable
from typing import Any

import clench
import pytest

ARM = """
<mujoco model="arm">
  <worldbody><body name="arm"><joint name="hinge"/><geom name="bar" size="0.1"/></body></worldbody>
  <actuator><motor name="drive" joint="hinge"/></actuator>
</mujoco>"""


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda spec: spec.world.add_body(name="a\0b"), ValueError, r"'a\\x00b' has the character '\\x00', which XML"),
        (lambda spec: spec.world.add_body(name="\ud800"), ValueError, "which XML does not allow"),
        (lambda spec: spec.body("arm").rename("\x1b"), ValueError, "which XML does not allow"),
        (lambda spec: spec.body("arm").rename(""), ValueError, "must not be empty"),
        (lambda spec: setattr(spec, "name", 5), TypeError, "a name is a str, not int"),
        (lambda spec: setattr(spec, "name", "a\0"), ValueError, "which XML does not allow"),
        (lambda spec: spec.__init__(None), TypeError, "a name is a str, not NoneType"),
        (lambda spec: spec.names("joints"), ValueError, 'there is no kind of element "joints"'),
        (lambda spec: spec.add_actuator("motor", name="drive"), ValueError, 'there is already an actuator "drive"'),
        (lambda spec: spec.geom("bar").attach(clench.ModelSpec(), prefix="p_"), ValueError, 'attached to geom "bar", only to a body'),
        (lambda spec: spec.world.attach(clench.ModelSpec(), prefix=None), TypeError, "a name is a str, not NoneType"),
    ],
)
def test_mistakes_change_nothing(call: Callable[[Any], object], error: type[Exception], message: str) -> None:
    spec = clench.ModelSpec.from_xml(ARM)
    with pytest.raises(error, match=message):
        call(spec)
    assert spec.build().to_xml() == clench.Model.from_xml(ARM).to_xml()


def test_a_shallow_copy_is_a_copy_too() -> None:
    spec = clench.ModelSpec.from_xml(ARM)
    copy.copy(spec).body("arm").rename("other")
    assert spec.names("body") == ["arm"]


CLASSES = """
<mujoco>
  <default>
    <geom friction="1"/>
    <default class="rough"><geom friction="2"/><default class="rougher"><geom friction="3"/></default></default>
    <default class="other"><geom friction="4"/></default>
  </default>
  <worldbody>
    <body childclass="other">
      <geom class="rough" size="1"/>
      <geom class="rougher" size="1"/>
      <geom class="main" size="1"/>
      <body childclass="rough"><geom size="1"/></body>
    </body>
    <geom class="rougher" size="1"/>
  </worldbody>
</mujoco>"""


def frictions(spec: clench.ModelSpec) -> list[float]:
    return [geom.friction[0] for geom in map(spec.build().geom, range(5))]


def test_a_default_class_is_renamed_and_removed_with_its_references() -> None:
    spec = clench.ModelSpec.from_xml(CLASSES)
    before = frictions(spec)
    assert sorted(before) == [1, 2, 2, 3, 3]
    main = list(spec.section("default"))
    rough = next(element for element in main if "class" in element and element["class"] == "rough")
    with pytest.raises(ValueError, match='there is already a default class "other"'):
        rough.rename("other")
    rough.rename("coarse")
    assert 'childclass="coarse"' in spec.to_xml() and '"rough"' not in spec.to_xml()
    assert frictions(spec) == before
    rough.remove()
    # One is in no body, so that it has the numbers of the outermost class.
    assert sorted(frictions(spec)) == [1, 1, 4, 4, 4]
