"""Colours and lights of pictures that differ between environments."""

from __future__ import annotations

import os
from typing import Any

import clench
import numpy as np
import pytest
from numpy.typing import NDArray

LIT = """<mujoco>
  <visual><headlight ambient="0.2 0.2 0.2" diffuse="0.1 0.1 0.1" specular="0 0 0"/></visual>
  <asset><material name="green" rgba="0.1 0.9 0.2 1"/></asset>
  <worldbody>
    <light name="lamp" pos="1 0 3" dir="0 0 -1" diffuse="0.6 0.5 0.4" cutoff="80" exponent="1"/>
    <geom name="floor" type="plane" size="3 3 1" rgba="0.6 0.6 0.6 1"/>
    <geom name="post" type="box" size="0.2 0.2 0.4" pos="-0.8 0 0.4" material="green"/>
    <body pos="0 0 0.5"><freejoint/><geom name="ball" size="0.3" rgba="0.2 0.3 0.8 1"/><site size="0.05" pos="0 0 0.4"/></body>
  </worldbody>
</mujoco>"""
CAMERA = clench.FreeCamera([0, 0, 0.4], 3, elevation=-30)


def has_device() -> bool:
    """Returns true if colours can be drawn."""
    return os.environ.get("CLENCH_GPU") != "skip" and clench.render_device() is not None


drawn = pytest.mark.skipif(not has_device(), reason="no graphics device draws here")


def picture(owner: Any, *env: Any, **arguments: Any) -> NDArray[Any]:
    """Renders a small picture."""
    return np.asarray(owner.render(*env, 48, 36, camera=CAMERA, **arguments))


def test_looks_of_a_model_are_those_of_its_file() -> None:
    looks = clench.Model.from_xml(LIT).appearance()
    np.testing.assert_allclose(looks["geom_rgba"], [[0.6, 0.6, 0.6, 1], [0.1, 0.9, 0.2, 1], [0.2, 0.3, 0.8, 1]], rtol=1e-6)
    np.testing.assert_array_equal(looks["light_pos"], [[1, 0, 3]])
    np.testing.assert_array_equal(looks["light_dir"], [[0, 0, -1]])
    np.testing.assert_array_equal(looks["light_diffuse"], [[0.6, 0.5, 0.4]])
    np.testing.assert_array_equal(looks["headlight_ambient"], [0.2, 0.2, 0.2])
    assert {name: array.shape for name, array in looks.items()} == {
        "geom_rgba": (3, 4),
        "site_rgba": (1, 4),
        **dict.fromkeys(("light_pos", "light_dir", "light_ambient", "light_diffuse", "light_specular"), (1, 3)),
        **dict.fromkeys(("headlight_ambient", "headlight_diffuse", "headlight_specular"), (3,)),
    }


@drawn
@pytest.mark.parametrize("lights", [True, False])
def test_own_looks_change_nothing(lights: bool) -> None:
    text = LIT if lights else LIT.replace("<light ", "<site ").split("<site ")[0] + "<geom" + LIT.split("<geom", 1)[1]
    sim = clench.Sim(clench.Model.from_xml(text))
    looks = sim.model.appearance()
    assert len(looks["light_pos"]) == int(lights)
    np.testing.assert_array_equal(picture(sim, appearance=looks), picture(sim))


@drawn
def test_environments_have_their_own_colours() -> None:
    batch = clench.Batch(clench.Model.from_xml(LIT), 4)
    plain = picture(batch, None)
    colors = np.tile(batch.model.appearance()["geom_rgba"], (4, 1, 1))
    colors[2, 2] = [0.9, 0.1, 0.1, 1]
    states = batch.state
    changed = picture(batch, None, appearance={"geom_rgba": colors})
    assert batch.state == states
    np.testing.assert_array_equal(changed[[0, 1, 3]], plain[[0, 1, 3]])
    ball = picture(batch, 2, kind="geom") == 2
    assert (changed[2, ball].mean(0) - plain[2, ball].mean(0))[[0, 2]] @ [1, -1] > 100
    np.testing.assert_array_equal(changed[2, :6], plain[2, :6])
    # Of some environments, of one, and of a simulation.
    np.testing.assert_array_equal(picture(batch, [2, 0], appearance={"geom_rgba": colors}), changed[[2, 0]])
    np.testing.assert_array_equal(picture(batch, 2, appearance={"geom_rgba": colors}), changed[2])
    np.testing.assert_array_equal(picture(batch.sim(2), appearance={"geom_rgba": colors[2]}), changed[2])
    # The same for all.
    np.testing.assert_array_equal(picture(batch, None, appearance={"geom_rgba": colors[2]})[0], changed[2])
    # No looks are kept.
    np.testing.assert_array_equal(picture(batch, None), plain)


@drawn
@pytest.mark.parametrize(
    "field", ["light_pos", "light_dir", "light_ambient", "light_diffuse", "light_specular"]
    + ["headlight_ambient", "headlight_diffuse", "headlight_specular", "site_rgba"],
)
def test_each_field_changes_pictures(field: str) -> None:
    batch = clench.Batch(clench.Model.from_xml(LIT), 3)
    own = batch.model.appearance()[field]
    values = np.tile(own, (3, *[1] * own.ndim))
    values[1] = np.array([0.5, 0.2, -0.9]) if field == "light_dir" else 1 - own
    before, after = picture(batch, None), picture(batch, None, appearance={field: values})
    np.testing.assert_array_equal(after[[0, 2]], before[[0, 2]])
    changed = np.abs(after[1].astype(int) - before[1]).max(-1)
    assert (changed > 5).sum() >= {"site_rgba": 1, "headlight_specular": 3}.get(field, 30)


@drawn
def test_light_moves_its_shadow_and_its_direction_needs_no_length() -> None:
    sim = clench.Sim(clench.Model.from_xml(LIT))
    left, right = (picture(sim, appearance={"light_pos": [[x, 0, 3.0]]}).mean(-1) for x in (-2, 2))
    # The camera looks along y: the ball's shadow falls to the other side.
    near_floor = slice(20, 30)
    half = slice(None, 24), slice(24, None)
    assert left[near_floor, half[0]].mean() > right[near_floor, half[0]].mean()
    assert left[near_floor, half[1]].mean() < right[near_floor, half[1]].mean()
    tilted = picture(sim, appearance={"light_dir": [[0.3, 0, -1]]})
    np.testing.assert_array_equal(picture(sim, appearance={"light_dir": [[1.5, 0, -5]]}), tilted)
    assert (tilted != picture(sim)).any()


@pytest.mark.parametrize("device", ["cpu", pytest.param("gpu", marks=drawn)])
def test_opacity_hides_geoms(device: Any) -> None:
    batch = clench.Batch(clench.Model.from_xml(LIT), 3)
    colors = np.tile(batch.model.appearance()["geom_rgba"], (3, 1, 1))
    colors[1, 2, 3], colors[2, 2, 3] = 0, 0.2
    seen = picture(batch, None, kind="geom", device=device, appearance={"geom_rgba": colors})
    assert (seen[0] == 2).any() and (seen[1] != 2).all()
    np.testing.assert_array_equal(seen[0], seen[2])


@drawn
def test_geoms_of_several_models_are_those_of_the_layout() -> None:
    def posts(count: int) -> clench.Model:
        geoms = "".join(f'<geom size="0.3" pos="{x} 0 0.3"/>' for x in range(count))
        body = '<body pos="0 0 2"><freejoint/><geom type="box" size=".3 .3 .3" rgba="0 0 1 1"/></body>'
        return clench.Model.from_xml(f"<mujoco><worldbody>{geoms}{body}</worldbody></mujoco>")

    batch = clench.Batch([posts(3), posts(1)], 2)
    colors = np.tile(batch.model.appearance()["geom_rgba"], (2, 1, 1))
    box = batch.geoms_of(1)[-1]
    colors[1, box] = [1, 0, 0, 1]
    camera = clench.FreeCamera([0, 0, 1], 6, elevation=0)
    before = batch.render(None, 48, 48, camera=camera)
    after = batch.render(None, 48, 48, camera=camera, appearance={"geom_rgba": colors})
    np.testing.assert_array_equal(before[0], after[0])
    geoms = batch.render(1, 48, 48, camera=camera, kind="geom")
    np.testing.assert_array_equal((before[1] != after[1]).any(-1) & (geoms != -1), geoms == 1)


def test_bad_looks_are_errors() -> None:
    batch = clench.Batch(clench.Model.from_xml(LIT), 2)
    sim = batch.sim(0)
    wrong: list[tuple[Any, type[Exception], str]] = [
        ({"geom_color": np.zeros((3, 4))}, ValueError, "geom_rgba"),
        ({"geom_rgba": np.zeros((2, 4))}, ValueError, r"\(2, 4\).*\(3, 4\)"),
        ({"geom_rgba": np.zeros((3, 3, 4))}, ValueError, r"\(3, 3, 4\)"),
        ({"geom_rgba": np.full((3, 4), 1.5)}, ValueError, "from 0 to 1"),
        ({"geom_rgba": np.full((3, 4), np.nan)}, ValueError, "not finite"),
        ({"light_diffuse": [[-0.1, 0, 0]]}, ValueError, "at least 0"),
        ({"light_dir": [[0, 0, 0]]}, ValueError, "no length"),
        ({"light_pos": "middle"}, TypeError, "light_pos"),
        ({1: 2}, TypeError, "str"),
        ([1], TypeError, "dict"),
    ]
    for looks, error, text in wrong:
        for owner in (sim, batch):
            with pytest.raises(error, match=text):
                owner.render(width=8, height=8, kind="depth", device="cpu", appearance=looks)
    with pytest.raises(ValueError, match=r"must have \(3, 4\)$"):
        sim.render(8, 8, kind="depth", device="cpu", appearance={"geom_rgba": np.zeros((1, 3, 4))})


@drawn
def test_environments_of_gymnasium_have_looks() -> None:
    gymnasium = pytest.importorskip("gymnasium")
    import clench.gymnasium as _

    envs = gymnasium.make_vec("clench/Hopper-v5", 2, render_mode="rgb_array", render_size=(32, 32))
    envs.reset(seed=0)
    before = envs.render()
    colors = np.tile(envs.batch.model.appearance()["geom_rgba"], (2, 1, 1))
    colors[1, :, :3] = [1, 0, 1]
    envs.render_appearance = {"geom_rgba": colors}
    after = envs.render()
    np.testing.assert_array_equal(before[0], after[0])
    assert (before[1] != after[1]).any(-1).mean() > 0.2
    envs.close()
