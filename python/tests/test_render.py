"""Pictures without a window."""

from __future__ import annotations

import os
import signal
from concurrent.futures import ThreadPoolExecutor
from typing import Literal, TypeAlias

import clench
import numpy as np
import pytest
from scenes import ROOT, ball, example

Kind: TypeAlias = Literal["rgb", "depth", "geom"]


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


KINDS = {"rgb": (np.uint8, (3,)), "depth": (np.float32, ()), "geom": (np.int32, ())}


def watched() -> clench.Model:
    """Returns the humanoid with two cameras and a light."""
    spec = clench.ModelSpec.from_file(ROOT / "models/humanoid.xml")
    spec.world.add_camera(name="side", pos=[3, -2, 1.2], xyaxes=[0.6, 0.8, 0, -0.25, 0.19, 0.95])
    spec.body("torso").add_camera(name="track", mode="trackcom", pos=[0, -3, 0], xyaxes=[1, 0, 0, 0, 0, 1])
    spec.world.add("light", pos=[1, 1, 3], dir=[0, 0, -1])
    return spec.build()


def spread(n_envs: int, precision: Literal["64", "32"] = "64") -> clench.Batch:
    """Returns humanoids in different poses."""
    batch = clench.Batch(watched(), n_envs, precision)
    rng = np.random.default_rng(0)
    batch.qpos[:] = batch.model.integrate_pos(batch.qpos, rng.normal(0, 0.2, (n_envs, batch.model.nv)))
    return batch


@pytest.mark.parametrize("kind", ["rgb", "depth", "geom"])
@pytest.mark.parametrize("precision", ["64", "32"])
def test_pictures_of_all_are_those_of_each(kind: Kind, precision: Literal["64", "32"]) -> None:
    # More than one dispatch, and a width whose rows are padded on the device.
    batch = spread(70, precision)
    dtype, channels = KINDS[kind]
    pictures = batch.render(None, 50, 36, kind=kind)
    assert pictures.shape == (70, 36, 50, *channels) and pictures.dtype == dtype
    for env in range(0, 70, 3):
        np.testing.assert_array_equal(pictures[env], batch.render(env, 50, 36, kind=kind))
    assert (pictures[0] != pictures[1]).any()
    np.testing.assert_array_equal(pictures[69], batch.sim(69).render(50, 36, kind=kind))


@pytest.mark.parametrize("kind", ["rgb", "depth", "geom"])
def test_chosen_environments_and_several_cameras_are_axes(kind: Kind) -> None:
    batch = spread(9)
    cameras: list[str | int | clench.FreeCamera | None] = ["track", 1, clench.FreeCamera([0, 0, 1], 3), None]
    envs = np.array([7, 2, 7])
    pictures = batch.render(envs, 24, 16, camera=cameras, kind=kind)
    assert pictures.shape[:4] == (3, 4, 16, 24)
    for row, env in zip(pictures, envs, strict=True):
        for picture, camera in zip(row, cameras, strict=True):
            np.testing.assert_array_equal(picture, batch.render(env, 24, 16, camera=camera, kind=kind))
    np.testing.assert_array_equal(batch.render([7], 24, 16, camera="track", kind=kind), pictures[:1, 0])
    np.testing.assert_array_equal(batch.render(7, 24, 16, camera=["track"], kind=kind), pictures[0, :1])
    np.testing.assert_array_equal(batch.sim(2).render(24, 16, camera=cameras, kind=kind), pictures[1])
    assert batch.render([], 24, 16, kind=kind).shape[:3] == (0, 16, 24)
    assert batch.render(None, 24, 16, camera=[], kind=kind).shape[:4] == (9, 0, 16, 24)


def test_environments_have_their_own_parameters() -> None:
    batch = clench.Batch(watched(), 3)
    poses = batch.param("cam_pos")
    poses[1] += [0.3, 0, 0]
    batch.randomize("cam_pos", poses)
    pictures = batch.render(None, 32, 32, camera=0)
    assert (pictures[0] == pictures[2]).all() and (pictures[0] != pictures[1]).any()
    np.testing.assert_array_equal(pictures[1], batch.render(1, 32, 32, camera=0))


@pytest.mark.parametrize("kind", ["rgb", "depth", "geom"])
def test_pictures_are_written_to_given_memory(kind: Kind) -> None:
    batch = spread(5)
    dtype, channels = KINDS[kind]
    memory = np.full((7, 12, 20, *channels), 77, dtype)
    assert batch.render(None, 20, 12, kind=kind, out=memory[1:6]) is not None
    np.testing.assert_array_equal(memory[1:6], batch.render(None, 20, 12, kind=kind))
    assert (memory[[0, 6]] == 77).all()
    np.testing.assert_array_equal(batch.render(3, 20, 12, kind=kind, out=memory[0]), memory[4])
    np.testing.assert_array_equal(memory[0], memory[4])


def test_unusable_memory_is_an_error() -> None:
    batch = spread(2)
    for wrong in (np.zeros((2, 8, 9, 3), np.uint8), np.zeros((8, 8, 3), np.uint8)):
        with pytest.raises(ValueError, match="out has shape"):
            batch.render(None, 8, 8, out=wrong)
    with pytest.raises(TypeError, match="uint8"):
        batch.render(None, 8, 8, out=np.zeros((2, 8, 8, 3), np.float32))
    with pytest.raises(TypeError, match="float32"):
        batch.render(None, 8, 8, kind="depth", out=[0.0])  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="contiguous"):
        batch.render(None, 8, 8, out=np.zeros((2, 8, 8, 6), np.uint8)[..., ::2])
    with pytest.raises(ValueError, match="contiguous"):
        batch.render(None, 8, 8, kind="depth", out=np.zeros((2, 8, 8), np.float32, "F"))
    fixed = np.zeros((2, 8, 8, 3), np.uint8)
    fixed.flags.writeable = False
    with pytest.raises(TypeError, match="writ"):
        batch.render(None, 8, 8, out=fixed)
    # An error leaves a renderer that works.
    assert batch.render(None, 8, 8).shape == (2, 8, 8, 3)


def test_environments_that_do_not_exist_are_errors() -> None:
    batch = spread(2)
    for wrong in (2, -1, [0, 2], [-1], 1 << 70):
        with pytest.raises(IndexError):
            batch.render(wrong, 8, 8)
    for unusable in ("0", [0.5], [[0], [1]]):
        with pytest.raises((TypeError, ValueError)):
            batch.render(unusable, 8, 8)
    with pytest.raises(ValueError, match="camera"):
        batch.render(None, 8, 8, camera=["track", "none"])
    with pytest.raises(ValueError, match="pixels"):
        batch.render(None, 1 << 20, 1 << 20)


def test_threads_draw_at_once() -> None:
    # Of one model, whose renderer they take in turn, and of two.
    batches = [spread(8), spread(8), clench.Batch(ball(), 8)]
    batches[1] = clench.Batch(batches[0].model, 8)
    expected = [batch.render(None, 24, 24) for batch in batches]

    def draw(index: int) -> None:
        for _ in range(5):
            np.testing.assert_array_equal(batches[index].render(None, 24, 24), expected[index])

    with ThreadPoolExecutor(3) as pool:
        list(pool.map(draw, range(3)))


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork here")
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_a_forked_process_draws_and_releases_what_it_inherits() -> None:
    sims = [clench.Sim(ball()) for _ in range(2)]
    before = [sim.render(24, 24) for sim in sims]
    child = os.fork()
    if child == 0:
        signal.alarm(60)
        try:
            del sims[1]
            os._exit(0 if (sims[0].render(24, 24) == before[0]).all() else 1)
        finally:
            os._exit(2)
    assert os.waitpid(child, 0)[1] == 0
    assert (sims[1].render(24, 24) == before[1]).all()


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
