"""`clench.terrain`: terrain has the heights that it says, here and in MuJoCo, and carries robots."""

from __future__ import annotations

import dataclasses
import doctest
import inspect
import sys
from collections.abc import Callable
from typing import Any

import clench
import mujoco  # type: ignore[import-untyped]
import numpy as np
import pytest
from clench import terrain
from numpy.typing import NDArray
from scenes import ROOT

BOXES: list[terrain.Kind] = [
    terrain.Flat(),
    terrain.Stairs(),
    terrain.Stairs(down=True),
    terrain.SteppingStones(),
    terrain.Obstacles(),
]
KINDS = [*BOXES, terrain.Slope(), terrain.Slope(down=True), terrain.Waves(), terrain.Noise()]
DOWN = np.array([0.0, 0.0, -1.0])


def points(ground: terrain.Terrain, count: int = 400) -> NDArray[np.float64]:
    """Returns random points of a terrain and its border."""
    half = ground.border + 0.5 * np.array([ground.rows * ground.size[0], ground.columns * ground.size[1]])
    return np.random.default_rng(0).uniform(-half, half, (count, 2))


def seen(model: clench.Model, places: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns the heights at which rays from above hit."""
    sim = clench.Sim(model)
    hits = [sim.ray([*place, 9.0], DOWN) for place in places]
    return np.array([9.0 - hit.distance for hit in hits if hit is not None])


def seen_in_mujoco(text: str, places: NDArray[np.float64]) -> NDArray[np.float64]:
    model = mujoco.MjModel.from_xml_string(text)
    data, geom = mujoco.MjData(model), np.zeros(1, np.int32)
    mujoco.mj_forward(model, data)
    return np.array(
        [9.0 - mujoco.mj_ray(model, data, np.array([*place, 9.0]), DOWN, None, 1, -1, geom) for place in places]
    )


@pytest.mark.parametrize(("boxes", "kinds"), [(False, KINDS), (True, BOXES)], ids=["field", "boxes"])
def test_heights_are_as_they_are_seen_here_and_in_mujoco(boxes: bool, kinds: list[terrain.Kind]) -> None:
    ground = terrain.grid(kinds, rows=3, size=(6.0, 5.0), border=1.0, boxes=boxes, seed=3)
    spec = clench.ModelSpec()
    ground.add_to(spec, friction=[0.8, 0.01, 0.001], rgba=[0.4, 0.5, 0.4, 1], group=1)
    model, places = spec.build(), points(ground)
    heights = seen(model, places)
    np.testing.assert_allclose(heights, seen_in_mujoco(spec.to_xml(), places), rtol=0, atol=1e-9)
    # The samples of a height field have single precision.
    np.testing.assert_allclose(heights, ground.height(*places.T), rtol=0, atol=1e-12 if boxes else 1e-6)
    np.testing.assert_array_equal(model.geom_friction, np.tile([0.8, 0.01, 0.001], (model.ngeom, 1)))
    assert model.geom_group.tolist() == [1] * model.ngeom
    assert np.ptp(heights) > 1.0
    assert np.isnan(ground.height([100.0, np.nan], 0.0)).all() and ground.height(0.0, 0.0).shape == ()


def test_boxes_and_height_fields_agree_away_from_risers() -> None:
    kinds = [terrain.Stairs(step_width=0.5), terrain.Stairs(step_width=0.5, down=True), terrain.SteppingStones()]
    field, boxes = (terrain.grid(kinds, rows=2, resolution=0.05, boxes=boxes) for boxes in (False, True))
    np.testing.assert_array_equal(field.origins, boxes.origins)
    x, y = points(boxes, 5000).T
    # The greatest and least height of the boxes within a cell of the field are equal except near their sides.
    shifts = np.linspace(-0.0501, 0.0501, 5)
    near = np.array(
        [boxes.height(np.clip(x + dx, -9.9, 9.9), np.clip(y + dy, -13.9, 13.9)) for dx in shifts for dy in shifts]
    )
    is_away = (np.ptp(near, axis=0) == 0) & (np.abs(x) < 9.9) & (np.abs(y) < 13.9)
    assert is_away.mean() > 0.5
    np.testing.assert_allclose(field.height(x, y)[is_away], boxes.height(x, y)[is_away], rtol=0, atol=1e-6)


def test_stairs_have_the_stated_steps() -> None:
    stairs = terrain.Stairs(step_height=(0.1, 0.2), step_width=0.5, platform=1.0, border=0.5)
    rng = np.random.default_rng(0)
    profile = stairs.heights(0.5, rng, (6.0, 6.0), 0.25)[:, 12]
    rise = np.repeat([0.0, 0.15, 0.3, 0.45, 0.6], [2, 2, 2, 2, 4])
    np.testing.assert_allclose(profile, [*rise, 0.6, *rise[::-1]])
    down = terrain.Stairs(step_height=(0.1, 0.2), step_width=0.5, platform=1.0, border=0.5, down=True)
    assert down.heights(1.0, rng, (6.0, 6.0), 0.25).min() == pytest.approx(-0.8)


def test_difficulty_rises_and_seeds_repeat() -> None:
    ground = terrain.grid(KINDS, rows=4, border=0.0)
    assert ground.heights is not None and ground.heights.shape == (321, 721)
    tiles = ground.heights[:-1, :-1].reshape(4, 80, 9, 80)
    roughness = tiles.std(axis=(1, 3))
    # Stepping stones get lower on the average instead.
    roughness[:, 3] = -tiles.mean(axis=(1, 3))[:, 3]
    assert (np.diff(roughness[:, 1:], axis=0) > 0).all() and (roughness[:, 0] == 0).all()
    again, other = terrain.grid(KINDS, rows=4, border=0.0), terrain.grid(KINDS, rows=4, border=0.0, seed=1)
    np.testing.assert_array_equal(ground.heights, again.heights)
    assert other.heights is not None and (ground.heights != other.heights).any()
    first, second = (terrain.grid(KINDS, 1, seed=np.random.default_rng(5)).heights for _ in range(2))
    np.testing.assert_array_equal(first, second)
    # Edges of tiles are flat.
    assert (ground.heights[::80] == 0).all() and (ground.heights[:, ::80] == 0).all()


def test_a_tile_is_a_terrain_and_models_of_tiles_have_the_same_joints() -> None:
    robot = clench.ModelSpec.from_file(ROOT / "models/quadruped.xml")
    robot.geom("floor").remove()
    plain = robot.build()
    for boxes, kinds in ((False, KINDS), (True, BOXES)):
        ground = terrain.grid(kinds, rows=2, boxes=boxes, seed=np.random.default_rng(1))
        for column in range(ground.columns):
            tile, spec = ground.cell(1, column), robot.copy()
            tile.add_to(spec)
            model = spec.build()
            assert model.names("body") == plain.names("body") and model.names("joint") == plain.names("joint")
            assert tile.origins[0, 0].tolist() == [0.0, 0.0, ground.origins[1, column, 2]]
            x, y, _ = ground.origins[1, column]
            np.testing.assert_allclose(tile.height(0.3, 1.1), ground.height(x + 0.3, y + 1.1), atol=1e-12)
    with pytest.raises(IndexError, match=r"no tile \(2, 0\): there are 2 rows and"):
        ground.cell(2, 0)


@pytest.mark.parametrize(("boxes", "kinds"), [(False, KINDS), (True, BOXES)], ids=["field", "boxes"])
def test_a_robot_that_falls_on_an_origin_comes_to_rest(boxes: bool, kinds: list[terrain.Kind]) -> None:
    spec = clench.ModelSpec.from_file(ROOT / "models/quadruped.xml")
    spec.geom("floor").remove()
    ground = terrain.grid(kinds, rows=2, boxes=boxes)
    ground.add_to(spec)
    batch = clench.Batch(spec.build(), ground.rows * ground.columns)
    batch.qpos[:, :3] += ground.origins.reshape(-1, 3)
    assert batch.step(1200) == 0
    x, y, z = batch.qpos[:, :3].T
    above = z - ground.height(x, y)
    # Half of the trunk is 0.05 m high: one that lies on it has fallen over.
    assert (above > 0.3).mean() > 0.8 and (above > 0.04).all() and (above < 0.45).all(), above
    assert np.abs(batch.qvel[:, :3]).max() < 0.05


def test_examples_and_documentation() -> None:
    found = doctest.testmod(sys.modules["clench.terrain.grid"])
    assert found.attempted == 3 and found.failed == 0
    for name in terrain.__all__:
        member = getattr(terrain, name)
        assert inspect.getdoc(member), name
        if dataclasses.is_dataclass(member):
            documented = inspect.getdoc(member) or ""
            assert all(f"\n{field.name} : " in documented for field in dataclasses.fields(member)), name


def test_a_kind_of_your_own() -> None:
    class Ditch(terrain.Kind):
        def heights(
            self, difficulty: float, rng: Any, size: tuple[float, float] = (8.0, 8.0), resolution: float = 0.1
        ) -> NDArray[np.float64]:
            heights = np.zeros((round(size[0] / resolution) + 1, round(size[1] / resolution) + 1))
            heights[10:15] = -difficulty
            return heights

    ground = terrain.grid([Ditch()], rows=2)
    assert ground.height(ground.origins[1, 0, 0] - 2.8, 0.0) == -1.0


MISTAKES: list[tuple[Callable[[], object], str]] = [
    (lambda: terrain.Stairs(step_height=-0.1), "Stairs: step_height is -0.1, not a number of at least 0"),
    (lambda: terrain.Stairs(step_width=0), "Stairs: step_width is 0, not a number greater than 0"),
    (lambda: terrain.Noise(amplitude=(0.1, np.nan)), "Noise: amplitude is .*nan"),
    (lambda: terrain.Waves(wavelength=(1, 2, 3)), "Waves: wavelength"),  # type: ignore[arg-type]
    (lambda: terrain.Slope(slope="steep"), "Slope: slope is 'steep'"),  # type: ignore[arg-type]
    (lambda: terrain.grid([]), "kinds are"),
    (lambda: terrain.grid([terrain.Stairs], 2), "kinds are"),  # type: ignore[list-item]
    (lambda: terrain.grid(BOXES, 0), "rows is 0"),
    (lambda: terrain.grid(BOXES, size=(8, -8)), "the size of a tile is"),
    (lambda: terrain.grid(BOXES, size=(np.nan, 8)), "the size of a tile is"),
    (lambda: terrain.grid(BOXES, size=(8, 7.95)), "the size of a tile is 7.95 m, not a multiple of the resolution"),
    (lambda: terrain.grid(BOXES, border=0.25), "the border is 0.25 m, not a multiple"),
    (lambda: terrain.grid(BOXES, border=-1), "the border is -1"),
    (lambda: terrain.grid(BOXES, resolution=0), "the resolution is 0"),
    (lambda: terrain.grid(BOXES, difficulty=(0, 1.5)), "the difficulty is"),
    (lambda: terrain.grid(KINDS, boxes=True), "Slope does not consist of boxes"),
    (lambda: terrain.grid([terrain.Stairs(platform=3)], size=(3, 8)), "Stairs: a middle of 3 m and a border of 0.25 m"),
    (lambda: terrain.grid([terrain.Stairs(step_width=4)]), "no step of 4 m fits"),
    (lambda: terrain.Slope().heights(2, np.random.default_rng()), "the difficulty is 2"),
    (lambda: terrain.grid(BOXES, 1).add_to(clench.ModelSpec(), thickness=0), "the thickness is 0"),
    (lambda: terrain.grid(BOXES, 1).add_to(clench.ModelSpec(), pos=[0, 0, 1]), "pos is not an attribute to choose"),
]


@pytest.mark.parametrize(
    ("mistake", "message"), MISTAKES, ids=lambda value: value[:30] if isinstance(value, str) else ""
)
def test_mistakes_are_refused(mistake: Callable[[], object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        mistake()


@pytest.mark.parametrize("boxes", [False, True])
def test_a_model_stays_as_it_is_if_terrain_is_refused(boxes: bool) -> None:
    spec = clench.ModelSpec()
    spec.world.add_geom(name="terrain_3" if boxes else "terrain", size=1)
    ground = terrain.grid(BOXES, 1, boxes=boxes)
    before = spec.names("geom"), spec.names("hfield")
    refused: list[dict[str, Any]] = [{}, {"frction": 1}]
    for attributes in refused:
        with pytest.raises(ValueError, match="frction|already a geom"):
            ground.add_to(spec, **attributes)
        assert (spec.names("geom"), spec.names("hfield")) == before
    ground.add_to(spec, "other")
