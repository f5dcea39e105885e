"""Pictures by rays on the processor, which need no graphics device."""

from __future__ import annotations

import os
import subprocess
import sys
from typing import Any, Literal

import clench
import numpy as np
import pytest
from numpy.typing import NDArray
from scenes import ROOT, ball, example

SHAPES = """<mujoco>
  <asset>
    <mesh name="wedge" vertex="0 0 0  0.4 0 0  0 0.3 0  0 0 0.5"/>
    <hfield name="hills" nrow="4" ncol="5" size="0.5 0.4 0.3 0.1"
            elevation="0 1 2 1 0  1 3 1 0 2  0 2 4 2 1  1 0 1 2 0"/>
  </asset>
  <worldbody>
    <geom type="plane" size="0 0 1"/>
    <geom type="hfield" hfield="hills" pos="0.9 0.9 0.2"/>
    <body pos="-0.8 -0.8 0.3"><freejoint/><geom size="0.25"/></body>
    <body pos="0 -0.8 0.4" euler="40 20 0"><freejoint/><geom type="capsule" size="0.12 0.25"/></body>
    <body pos="0.8 -0.8 0.3" euler="10 30 0"><freejoint/><geom type="box" size="0.2 0.15 0.25"/></body>
    <body pos="-0.8 0 0.3" euler="70 0 20"><freejoint/><geom type="cylinder" size="0.2 0.25"/></body>
    <body pos="0 0 0.4" euler="0 40 0"><freejoint/><geom type="ellipsoid" size="0.3 0.15 0.2"/></body>
    <body pos="0.7 0 0.3" euler="0 0 30"><freejoint/><geom type="mesh" mesh="wedge"/></body>
    <camera name="side" pos="2.5 -2 1.2" xyaxes="0.6 0.8 0 -0.25 0.19 0.95" fovy="50"/>
    <camera name="above" pos="0 0 3" fovy="3" projection="orthographic"/>
    <camera name="near" pos="-0.7 -0.8 0.32" xyaxes="1 0 0 0 0 1" fovy="110"/>
    <camera name="below" pos="0.1 0 -1.5" xyaxes="1 0 0 0 -1 0" fovy="60"/>
    <camera name="sensor" pos="2.5 -2 1.2" xyaxes="0.6 0.8 0 -0.25 0.19 0.95" resolution="30 20" sensorsize="0.03 0.02"
            focal="0.02 0.01" principal="0.003 -0.002"/>
  </worldbody>
</mujoco>"""


def has_device() -> bool:
    """Returns true if pictures can be compared with those of a graphics device."""
    return os.environ.get("CLENCH_GPU") != "skip" and clench.render_device() is not None


def by_single_rays(sim: clench.Sim, camera: str, width: int, height: int) -> tuple[NDArray[Any], NDArray[Any]]:
    """Returns the geom and the depth at each pixel by `Sim.rays`."""
    index = sim.model.names("camera").index(camera)
    parallel = camera == "above"
    fovy = sim.model.cam_fovy[index]
    half = fovy / 2 if parallel else np.tan(np.radians(fovy) / 2)
    x = half * (2 * np.arange(width) + 1 - width) / height
    y = half * (height - 1 - 2 * np.arange(height)) / height
    if camera == "sensor":
        # The sensor is 1.5 x 2 at distance 1, and its middle is aside of the optical axis, as MuJoCo draws it.
        x = 0.15 + 0.75 * (2 * np.arange(width) + 1 - width) / width
        y = y + 0.2
    grid = np.stack(np.broadcast_arrays(x[None, :], y[:, None], 0), -1).reshape(-1, 3)
    ahead = np.array([[0.0, 0.0, -1.0]])
    origins, directions = (grid, ahead) if parallel else (np.zeros((1, 3)), grid + ahead)
    # A camera in a ball looks out of it.
    exclude = 1 if camera == "near" else None
    hits = sim.rays(origins, directions, camera=camera, groups=[0, 1, 2], exclude_body=exclude)
    return hits.geom.reshape(height, width), hits.distance.reshape(height, width)


@pytest.mark.parametrize("camera", ["side", "above", "near", "sensor"])
def test_pixels_are_the_hits_of_rays(camera: str) -> None:
    sim = clench.Sim(clench.Model.from_xml(SHAPES))
    # A width that fills no register.
    geoms, depth = by_single_rays(sim, camera, 123, 90)
    drawn = sim.render(123, 90, camera=camera, kind="geom", device="cpu")
    assert drawn.dtype == np.int32 and len(np.unique(drawn)) == {"side": 9, "above": 8, "near": 6, "sensor": 9}[camera]
    # Cameras are in single precision, so that a ray at an edge may miss.
    same = drawn == geoms
    assert same.mean() > 0.998
    picture = sim.render(123, 90, camera=camera, kind="depth", device="cpu")
    assert picture.dtype == np.float32
    # A device draws no ground beyond 300 sizes of the model.
    near = same & (depth < 100)
    np.testing.assert_allclose(picture[near], depth[near], rtol=1e-5)
    np.testing.assert_array_equal(np.isinf(picture), drawn == -1)


def assert_alike(sim: clench.Sim, camera: str | int | clench.FreeCamera | None, size: int, few: float) -> None:
    """Asserts that rays and a device see the same, except at silhouettes."""
    rays, device = (sim.render(size, size, camera=camera, kind="geom", device=by) for by in ("cpu", "gpu"))
    differ = rays != device
    assert differ.mean() < few, differ.mean()
    # Another pixel beside it on the device has what the ray sees.
    padded = np.pad(device, 1, mode="edge")
    around = [padded[i : i + size, k : k + size] for i in range(3) for k in range(3)]
    assert np.any([rays == shifted for shifted in around], 0).all()
    mine, other = (sim.render(size, size, camera=camera, kind="depth", device=by) for by in ("cpu", "gpu"))
    close = np.isclose(mine, other, rtol=1e-2, atol=1e-2)
    assert (~close & ~differ).mean() < few, (~close & ~differ).mean()
    assert close.mean() > 1 - 2 * few


@pytest.mark.skipif(not has_device(), reason="no graphics device draws here")
@pytest.mark.parametrize("camera", ["side", "above", "near", "below", "sensor", None])
def test_rays_see_what_a_device_draws(camera: str | None) -> None:
    assert_alike(clench.Sim(clench.Model.from_xml(SHAPES)), camera, 120, 0.004)


@pytest.mark.skipif(not has_device(), reason="no graphics device draws here")
@pytest.mark.parametrize("name", ["humanoid", "quadruped", "grasp"])
def test_rays_see_models_as_a_device_does(name: str) -> None:
    sim = clench.Sim(example(name))
    sim.step(50)
    assert_alike(sim, None, 128, 0.01)


STRUNG = """<mujoco>
  <worldbody>
    <geom name="glass" size="0.2" pos="0 0 0.5" rgba="1 1 1 0"/>
    <geom name="hidden" size="0.2" pos="0.6 0 0.5" group="4"/>
    <geom name="clear" size="0.2" pos="-0.6 0 0.5" rgba="1 1 1 0.3"/>
    <site name="a" pos="-1 0 0" size="0.2"/>
    <body pos="1 0 0"><freejoint/><geom name="end" size="0.05"/><site name="b"/></body>
  </worldbody>
  <tendon><spatial width="0.04"><site site="a"/><site site="b"/></spatial></tendon>
</mujoco>"""


def test_rays_see_what_is_visible() -> None:
    sim = clench.Sim(clench.Model.from_xml(STRUNG))
    camera = clench.FreeCamera([0, 0, 0.3], 4, elevation=0)
    geoms = sim.render(160, 120, camera=camera, kind="geom", device="cpu")
    assert set(np.unique(geoms)) == {-1, 2, 3}
    with_hidden = sim.render(160, 120, camera=camera, kind="geom", groups=[4], device="cpu")
    assert set(np.unique(with_hidden)) == {-1, 1}
    # Tendons are no geoms but have a distance; sites, in the same groups, are omitted.
    depth = sim.render(160, 120, camera=camera, kind="depth", device="cpu")
    strings = np.isfinite(depth) & (geoms == -1)
    assert strings.sum() > 100
    np.testing.assert_allclose(depth[strings], 4, atol=0.05)
    if has_device():
        assert_alike(sim, camera, 128, 0.01)


def test_geoms_have_their_present_sizes() -> None:
    batch = clench.Batch(ball(), 2)
    sizes = batch.param("geom_size")
    sizes[1, :, 0] *= 2
    batch.randomize("geom_size", sizes)
    camera = clench.FreeCamera([0, 0, batch.qpos[0, 2]], 4, elevation=0)
    seen = batch.render(None, 64, 64, camera=camera, kind="geom", device="cpu")
    areas = (batch.model.geom_bodyid[np.maximum(seen, 0)] == 1).sum((1, 2))
    assert 3 < areas[1] / areas[0] < 5


@pytest.mark.skipif(not has_device(), reason="no graphics device draws here")
def test_a_device_draws_the_present_sizes() -> None:
    model = clench.Model.from_xml(SHAPES.replace('size="0 0 1"', 'size="3 2.5 1"'))
    batch = clench.Batch(model, 2)
    sizes = batch.param("geom_size")
    stretched = [g for g in range(model.ngeom) if g not in (1, model.ngeom - 1)]  # the terrain and the mesh
    sizes[1, stretched] *= [1.4, 0.7, 1.2]
    batch.randomize("geom_size", sizes)
    batch.set_constants()
    seen = [batch.render(None, 120, 90, camera="side", kind="geom", device=by) for by in ("gpu", "cpu")]
    assert (seen[0][0] != seen[0][1]).mean() > 0.05
    assert (seen[0] != seen[1]).mean() < 0.004


@pytest.mark.parametrize("kind", ["depth", "geom"])
@pytest.mark.parametrize("precision", ["64", "32"])
def test_pictures_of_all_are_those_of_each(kind: Literal["depth", "geom"], precision: Literal["64", "32"]) -> None:
    # More than the environments that are drawn at once, with more threads than processors.
    batch = clench.Batch(example("humanoid"), 70, precision, threads=5)
    rng = np.random.default_rng(0)
    batch.qpos[:] = batch.model.integrate_pos(batch.qpos, rng.normal(0, 0.2, (70, batch.model.nv)))
    cameras = [None, clench.FreeCamera([0, 0, 1], 3)]
    envs = np.append(np.arange(69, -1, -1), 4)
    pictures = batch.render(envs, 50, 40, camera=cameras, kind=kind, device="cpu")
    assert pictures.shape == (71, 2, 40, 50) and (pictures[0] != pictures[1]).any()
    for row, env in zip(pictures[::6], envs[::6], strict=True):
        np.testing.assert_array_equal(row[1], batch.render(env, 50, 40, camera=cameras[1], kind=kind, device="cpu"))
        np.testing.assert_array_equal(row, batch.sim(env).render(50, 40, camera=cameras, kind=kind, device="cpu"))
    out = np.zeros_like(pictures)
    assert batch.render(envs, 50, 40, camera=cameras, kind=kind, out=out, device="cpu") is out
    np.testing.assert_array_equal(out, pictures)
    assert batch.render([], 8, 8, kind=kind, device="cpu").shape == (0, 8, 8)
    assert batch.render(None, 8, 8, camera=[], kind=kind, device="cpu").shape == (70, 0, 8, 8)


def test_large_pictures_are_drawn_in_bands() -> None:
    # A picture of many bands of rows.
    sim = clench.Sim(example("humanoid"))
    camera = clench.FreeCamera([0, 0, 1], 3, elevation=-10)
    small = sim.render(200, 150, camera=camera, kind="geom", device="cpu")
    large = sim.render(1000, 750, camera=camera, kind="geom", device="cpu")
    # The middle of a pixel is that of one of its 25 parts.
    np.testing.assert_array_equal(large[2::5, 2::5], small)
    assert sim.render(8192, 1, camera=camera, kind="depth", device="cpu").shape == (1, 8192)


def test_environments_of_several_models_have_their_geoms() -> None:
    def posts(count: int) -> clench.Model:
        geoms = "".join(f'<geom size="0.1" pos="{x} 0 0"/>' for x in range(count))
        return clench.Model.from_xml(f"<mujoco><worldbody>{geoms}<body><freejoint/><geom size='.1'/></body>"
                                     "</worldbody></mujoco>")

    batch = clench.Batch([posts(1), posts(3)], 4)
    camera = clench.FreeCamera([1, 0, 0], 6, elevation=0)
    seen = batch.render(None, 96, 64, camera=camera, kind="geom", device="cpu")
    np.testing.assert_array_equal(seen[0], seen[2])
    np.testing.assert_array_equal(seen[1], batch.sim(3).render(96, 64, camera=camera, kind="geom", device="cpu"))
    assert (seen[1] != -1).sum() > 2.5 * (seen[0] != -1).sum()


def test_bad_arguments_are_errors() -> None:
    sim = clench.Sim(ball())
    with pytest.raises(ValueError, match="no colours"):
        sim.render(8, 8, device="cpu")
    with pytest.raises(ValueError, match='"gpu" or "cpu"'):
        sim.render(8, 8, kind="depth", device="cp")  # type: ignore[arg-type]
    for size in ((0, 8), (8, 1 << 20), (1 << 31, 1 << 31)):
        with pytest.raises(ValueError, match="pixels"):
            sim.render(*size, kind="depth", device="cpu")
    with pytest.raises(ValueError, match="camera"):
        sim.render(8, 8, kind="depth", camera="none", device="cpu")
    with pytest.raises(ValueError, match="out has shape"):
        sim.render(8, 8, kind="depth", out=np.zeros((8, 9), np.float32), device="cpu")
    sim.qpos[0] = np.nan
    with pytest.raises((ValueError, clench.ClenchError)):
        sim.render(8, 8, kind="depth", device="cpu")


WITHOUT = """
import clench, numpy as np
sim = clench.Sim(clench.Model.from_file("models/humanoid.xml"))
assert clench.render_device() is None
for kind in ("depth", "geom"):
    np.testing.assert_array_equal(sim.render(32, 32, kind=kind), sim.render(32, 32, kind=kind, device="cpu"))
for arguments in ({"kind": "rgb"}, {"kind": "depth", "device": "gpu"}):
    try:
        sim.render(32, 32, **arguments)
    except clench.ClenchError as error:
        assert "mesa-vulkan-drivers" in str(error)
    else:
        raise AssertionError(arguments)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="only Vulkan's drivers can be hidden")
def test_rays_replace_a_missing_device() -> None:
    nothing = {name: "/nonexistent.json" for name in ("VK_DRIVER_FILES", "VK_ICD_FILENAMES")}
    run = subprocess.run(
        [sys.executable, "-c", WITHOUT], cwd=ROOT, env=os.environ | nothing, capture_output=True, text=True, check=False
    )
    assert run.returncode == 0, run.stderr
