"""Measures pictures a second: one call for many environments, a call for each, and MuJoCo's renderer.

All draw the same states by MuJoCo's default free camera, with their own lights, shadows and samples. MuJoCo needs
PyOpenGL and the environment variable MUJOCO_GL, which `cargo xtask bench` sets to "egl" on Linux. Without a graphics
device both draw by Mesa on the processor.
"""

import os
import statistics
import time

import clench
import mujoco
import numpy as np

from scene import load, perturbed_states
from timing import alternate, ratio

SIZES = [64, 128, 256]
COUNTS = [1, 64, 256]
KINDS = ["rgb", "depth"]


def compare(path, args):
    """Times a model in each size, number and kind; prints the pictures a second and returns them as rows."""
    model = load(path)
    camera = mujoco.MjvCamera()
    mujoco.mjv_defaultFreeCamera(model, camera)
    print(f"\npictures a second of {path.stem}")
    print(f"  {'kind':<7}{'side':>5}{'number':>8}{'one call':>10}{'a call each':>13}{'MuJoCo':>9}{'ratio':>8}")
    rows = []
    for kind in KINDS:
        for size in SIZES:
            for count in COUNTS:
                rows.append(row(path, model, camera, (kind, size, count), args))
    return rows


def row(path, model, camera, case, args):
    """Times one case; prints it and returns it."""
    kind, size, count = case
    states = perturbed_states(model, count, args.noise)
    own = {"all": True, "each": False}
    engines = {name: Clench(path, model, camera, states, case, together) for name, together in own.items()}
    if "MUJOCO_GL" in os.environ:
        engines["mujoco"] = Mujoco(model, camera, states, case)
    seconds = alternate(engines, args.repeat)
    if "mujoco" in engines:
        engines["mujoco"].renderer.close()
    rates = {name: count / statistics.median(times) for name, times in seconds.items()}
    result = {"model": path.stem, "engine": "clench pictures", "kind": kind, "side": size, "number": count}
    result["rates"] = rates
    result["ratio"] = ratio(seconds["mujoco"], seconds["all"]) if "mujoco" in engines else float("nan")
    print(
        f"  {kind:<7}{size:>5}{count:>8}{rates['all']:>10.0f}{rates['each']:>13.0f}"
        f"{rates.get('mujoco', float('nan')):>9.0f}{result['ratio']:>8.2f}",
        flush=True,
    )
    return result


class Clench:
    """`Batch.render`, once for all environments or once for each."""

    def __init__(self, path, model, camera, states, case, together):
        (self.kind, self.size, self.count), self.together = case, together
        self.batch = clench.Batch(clench.Model.from_file(path), self.count)
        self.batch.qpos[:] = states[:, : model.nq]
        fovy = float(model.vis.global_.fovy)
        self.camera = clench.FreeCamera(camera.lookat, camera.distance, camera.azimuth, camera.elevation, fovy=fovy)
        self.out = self.batch.render(None, self.size, self.size, camera=self.camera, kind=self.kind)

    def run(self):
        """Draws all environments; returns the seconds."""
        begin = time.perf_counter()
        if self.together:
            self.draw(None, self.out)
        else:
            for env in range(self.count):
                self.draw(env, self.out[env])
        return time.perf_counter() - begin

    def draw(self, env, out):
        self.batch.render(env, self.size, self.size, camera=self.camera, kind=self.kind, out=out)


class Mujoco:
    """`mujoco.Renderer`, with the poses of all environments computed before the clock starts."""

    def __init__(self, model, camera, states, case):
        kind, size, _ = case
        self.camera = camera
        self.data = [mujoco.MjData(model) for _ in states]
        for data, state in zip(self.data, states, strict=True):
            data.qpos[:] = state[: model.nq]
            mujoco.mj_forward(model, data)
        self.renderer = mujoco.Renderer(model, size, size)
        if kind == "depth":
            self.renderer.enable_depth_rendering()
        self.out = np.empty_like(self.renderer.render())

    def run(self):
        """Draws all environments; returns the seconds."""
        begin = time.perf_counter()
        for data in self.data:
            self.renderer.update_scene(data, self.camera)
            self.renderer.render(out=self.out)
        return time.perf_counter() - begin
