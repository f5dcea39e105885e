"""Compares `Sim.ray` and `Sim.distance` with known answers, and with MuJoCo if it is exact."""

from __future__ import annotations

from typing import Any

import clench
import mujoco  # type: ignore[import-untyped]
import numpy as np
import pytest
from scenes import example

SCENE = """
<mujoco>
  <asset>
    <hfield name="hills" nrow="3" ncol="4" size="1 1.5 0.3 0.1" elevation="0 1 0 2  3 0 1 1  0 2 2 0"/>
    <mesh name="wedge" vertex="0 0 0  0.4 0 0  0 0.4 0  0.4 0.4 0  0 0 0.3  0 0.4 0.3"/>
  </asset>
  <worldbody>
    <geom name="floor" type="plane" size="5 4 1"/>
    <geom name="hills" type="hfield" hfield="hills" pos="-2 0 0.5" euler="5 10 20"/>
    <geom name="ghost" size="0.5" pos="0 0 3" rgba="1 1 1 0"/>
    <body name="a" pos="0 0 1">
      <freejoint/>
      <geom name="ball" size="0.2" group="1"/>
      <geom name="pill" type="capsule" fromto="0.3 0 0 0.6 0.2 0.1" size="0.05"/>
      <geom name="egg" type="ellipsoid" size="0.1 0.2 0.15" pos="0 0.6 0" euler="30 0 0"/>
    </body>
    <body name="b" pos="1.5 0 1" euler="10 20 30">
      <freejoint/>
      <geom name="can" type="cylinder" size="0.15 0.2"/>
      <geom name="crate" type="box" size="0.1 0.2 0.3" pos="0.5 0 0" group="3"/>
      <geom name="wedge" type="mesh" mesh="wedge" pos="0 0.5 0"/>
    </body>
  </worldbody>
</mujoco>
"""


def both(xml: str) -> tuple[clench.Sim, Any, Any]:
    sim = clench.Sim(clench.Model.from_xml(xml))
    sim.forward()
    model = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return sim, model, data


def test_rays_hit_what_mujocos_hit() -> None:
    sim, model, data = both(SCENE)
    rng = np.random.default_rng(1)
    seen = set()
    for k in range(2000):
        geom = rng.integers(model.ngeom)
        # Not inside the terrain, where MuJoCo's rays also hit its base.
        origin = rng.uniform([-3, -2, 0.01], [3, 2, 3])
        if np.all(np.abs(origin - [-2, 0, 0.5]) < [1.2, 1.7, 0.6]):
            continue
        to = data.geom_xpos[geom] + rng.normal(size=3) * 0.3
        direction = (to - origin) * rng.uniform(0.1, 2)
        groups = None if k % 3 else np.flatnonzero(rng.integers(0, 2, 6))
        exclude = int(rng.integers(model.nbody)) if k % 4 == 0 else None
        mask = None if groups is None else np.isin(np.arange(6), groups).astype(np.uint8)
        found, normal = np.array([-1], dtype=np.int32), np.zeros(3)
        flat = -1 if exclude is None else exclude
        distance = mujoco.mj_ray(model, data, origin, direction, mask, int(k % 5 != 0), flat, found, normal)
        hit = sim.ray(origin, direction, groups=groups, fixed=k % 5 != 0, exclude_body=exclude)
        if hit is None:
            assert distance == -1
            continue
        seen.add(hit.geom_name)
        assert hit.geom == found[0] and model.geom(hit.geom).name == hit.geom_name
        # MuJoCo stores heights and vertices with 24 bits.
        assert hit.distance == pytest.approx(distance, abs=1e-5)
        np.testing.assert_allclose(hit.position, origin + direction * hit.distance, atol=1e-12)
        np.testing.assert_allclose(hit.normal, normal, atol=1e-4)
    assert seen == {"floor", "hills", "ball", "pill", "egg", "can", "crate", "wedge"}


def test_distances_are_mujocos() -> None:
    sim, model, data = both(SCENE)
    compared = 0
    for first in range(model.ngeom):
        for second in range(model.ngeom):
            if first == second or "hills" in (model.geom(first).name, model.geom(second).name):
                continue
            fromto = np.zeros(6)
            distance = mujoco.mj_geomDistance(model, data, first, second, 10, fromto)
            found = sim.distance(first, second, 10)
            assert found is not None
            # MuJoCo computes depths of overlaps only to the tolerance of its solver.
            if distance > 0:
                compared += 1
                assert found.distance == pytest.approx(distance, abs=1e-5)
                # Other shapes may have many pairs of nearest points.
                if "ball" in (model.geom(first).name, model.geom(second).name):
                    np.testing.assert_allclose(found.points, fromto.reshape(2, 3), atol=1e-3)
            np.testing.assert_allclose(found.points[1] - found.points[0], found.normal * found.distance, atol=1e-9)
    assert compared > 30


def test_distances_have_limits_and_names() -> None:
    sim = clench.Sim(clench.Model.from_xml(SCENE))
    sim.forward()
    near = sim.distance("floor", "ball")
    assert near is not None
    assert near.distance == pytest.approx(0.8)
    np.testing.assert_allclose(near.normal, [0, 0, 1])
    np.testing.assert_allclose(near.points, np.array([[0, 0, 0], [0, 0, 0.8]]), atol=1e-12)
    assert near.points.shape == (2, 3) and repr(near).startswith("<clench.Separation: 0.8")
    back = sim.distance("ball", "floor", limit=0.9)
    assert back is not None
    np.testing.assert_allclose(back.normal, [0, 0, -1])
    np.testing.assert_array_equal(back.points, near.points[::-1])
    assert sim.distance("ball", "floor", 0.7) is None
    # The ball above the terrain is nearer than the floor below.
    hills = sim.distance("hills", "ball")
    assert hills is not None and 0 < hills.distance < 2


def test_rays_see_what_was_written_in_either_precision() -> None:
    model = clench.Model.from_xml(SCENE)
    for precision, tolerance in (("64", 1e-12), ("32", 1e-6)):
        sim = clench.Sim(model, precision=precision)  # type: ignore[arg-type]
        hit = sim.ray([0, 0, 2], (0, 0, -2))
        assert hit is not None
        assert (hit.geom_name, hit.geom) == ("ball", model.geom("ball").id)
        assert hit.distance == pytest.approx(0.4, abs=tolerance)
        assert hit.position.dtype == hit.normal.dtype == np.float64
        assert repr(hit).startswith("<clench.RayHit: geom 3 'ball' at 0.4")
        sim.qpos[0] = -1
        below = sim.ray([0, 0, 2], (0, 0, -2))
        assert below is not None and below.geom_name == "floor"


def test_a_sensor_does_not_see_its_own_body() -> None:
    sim = clench.Sim(example("humanoid"))
    sim.forward()
    torso = sim.model.body("torso").id
    origin = sim.xpos[torso]
    own, other = sim.ray(origin, [0, 0, -1]), sim.ray(origin, [0, 0, -1], exclude_body="torso")
    assert own is not None and other is not None
    assert own.distance < other.distance


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        (([0, 0], [0, 0, 1]), ValueError, r"origin has shape \(2,\), but must have \(3,\)"),
        (([0, 0, 0], [0, 0, 0]), ValueError, "direction has no length"),
        (([0, 0, 0], [0, np.nan, 1]), ValueError, "direction is not finite: number 1 is NaN"),
        (([0, 0, np.inf], [0, 0, 1]), ValueError, "origin is not finite"),
        (("up", [0, 0, 1]), TypeError, "origin must be numbers"),
    ],
)
def test_rays_that_are_none(arguments: Any, error: type[Exception], message: str) -> None:
    sim = clench.Sim(clench.Model.from_xml(SCENE))
    with pytest.raises(error, match=message):
        sim.ray(*arguments)


def test_arguments_that_cannot_be() -> None:
    sim = clench.Sim(clench.Model.from_xml(SCENE))
    with pytest.raises(IndexError, match="groups has 6, but indices go from 0 to 5"):
        sim.ray([0, 0, 0], [0, 0, 1], groups=[1, 6])
    with pytest.raises(TypeError, match="groups must be integers"):
        sim.ray([0, 0, 0], [0, 0, 1], groups=[0.5])
    with pytest.raises(ValueError, match='there is no body "c"'):
        sim.ray([0, 0, 0], [0, 0, 1], exclude_body="c")
    with pytest.raises(ValueError, match='there is no geom "bell"; did you mean "ball"'):
        sim.distance("bell", "floor")
    with pytest.raises(IndexError, match="there is no geom 9"):
        sim.distance(0, 9)
    with pytest.raises(ValueError, match="limit is not a number"):
        sim.distance(0, 3, float("nan"))
