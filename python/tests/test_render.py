"""Pictures without a window."""

from __future__ import annotations

import clench
import numpy as np
import pytest
from scenes import ball, example


@pytest.fixture(autouse=True)
def device() -> None:
    """Skips the tests if no device can draw."""
    try:
        clench.Sim(ball()).render(8, 8)
    except clench.ClenchError as error:
        assert "mesa-vulkan-drivers" in str(error)
        pytest.skip(str(error))


def test_picture_shows_where_geoms_are() -> None:
    sim = clench.Sim(example("humanoid"))
    picture = sim.render(160, 120)
    assert picture.shape == (120, 160, 3) and picture.dtype == np.uint8
    geoms = sim.render(160, 120, kind="geom")
    depth = sim.render(160, 120, kind="depth")
    assert geoms.shape == depth.shape == (120, 160)
    assert geoms.dtype == np.int32 and depth.dtype == np.float32
    np.testing.assert_array_equal(np.isinf(depth), geoms == -1)
    # The robot, in the centre, has another colour than its background.
    robot = sim.model.geom_bodyid[np.maximum(geoms, 0)] > 0
    assert robot[30:90, 60:100].mean() > 0.2 and robot[:, :20].mean() < 0.1
    assert np.abs(picture[robot].mean(0) - picture[~robot].mean(0)).max() > 10


def test_picture_is_of_the_present_state() -> None:
    sim = clench.Sim(ball())
    camera = clench.FreeCamera([0, 0, sim.qpos[2]], 3, elevation=0)
    before = sim.render(65, 65, camera=camera, kind="geom")
    assert sim.model.geom_bodyid[before[32, 32]] == 1
    sim.qpos[2] += 5
    assert sim.render(65, 65, camera=camera, kind="geom")[32, 32] != before[32, 32]


@pytest.mark.parametrize("precision", ["64", "32"])
def test_environment_looks_as_a_simulation_alone(precision: str) -> None:
    batch = clench.Batch(ball(), 3, "32" if precision == "32" else "64")
    batch.qpos[1, 0] = 0.3
    camera = clench.FreeCamera([0, 0, 0], 4)
    alone = batch.sim(1).render(40, 30, camera=camera)
    np.testing.assert_array_equal(batch.render(1, 40, 30, camera=camera), alone)
    assert (batch.render(0, 40, 30, camera=camera) != alone).any()


def test_bad_arguments_are_named() -> None:
    sim = clench.Sim(ball())
    with pytest.raises(ValueError, match="pixels"):
        sim.render(0, 10)
    with pytest.raises(ValueError, match="camera"):
        sim.render(10, 10, camera="none")
    with pytest.raises(ValueError, match="kind"):
        sim.render(10, 10, kind="heat")  # type: ignore[arg-type]
    with pytest.raises(IndexError):
        clench.Batch(ball(), 2).render(2, 10, 10)
    with pytest.raises(ValueError, match="camera needs"):
        clench.FreeCamera([0, 0, 0], -1)


def test_environments_of_gymnasium_are_drawn() -> None:
    gymnasium = pytest.importorskip("gymnasium")
    import clench.gymnasium as _

    env = gymnasium.make("clench/Hopper-v5", render_mode="rgb_array", width=64, height=48)
    env.reset(seed=0)
    picture = env.render()
    assert picture.shape == (48, 64, 3) and picture.std() > 5
    assert env.metadata["render_fps"] == round(1 / env.unwrapped.dt)
    env.close()
    envs = gymnasium.make_vec("clench/Hopper-v5", 3, render_mode="rgb_array", render_size=(32, 32))
    envs.reset(seed=0)
    pictures = envs.render()
    assert len(pictures) == 3 and pictures[0].shape == (32, 32, 3)
    envs.close()
    assert gymnasium.make("clench/Hopper-v5").render_mode is None
