"""Times heaps of many bodies and measures their penetration at the end."""

import json
import pathlib
import subprocess
import tempfile
import time

import mujoco
import numpy as np

from program import CLENCH, Clench
from scene import ROOT, describe, load
from timing import alternate, table

SCENES = [ROOT / "models/towers.xml", ROOT / "models/pile.xml"]


def compare(path, args):
    """Times both engines from the first state to rest, prints speeds and depths, and returns the rows."""
    steps = args.heap_steps
    engines = {"mujoco newton": Steps(path, steps), "clench": Steppers(path, steps)}
    print(f"\n{describe(engines['mujoco newton'].model, path)}; {steps} steps")
    rows = table(engines, alternate(engines, args.repeat), "mujoco newton", steps)
    print(f"  {'penetration at the end':<23}{'mean mm':>9}{'max mm':>9}{'fastest':>10}")
    for row, (name, engine) in zip(rows, engines.items(), strict=True):
        depths, fastest = engine.end()
        row |= {"depth_mean": float(np.mean(depths)), "depth_max": float(np.max(depths)), "fastest": fastest}
        print(f"  {name:<23}{1e3 * row['depth_mean']:>9.3f}{1e3 * row['depth_max']:>9.3f}{fastest:>10.4f}")
    return [{"model": path.stem, "envs": 1, "threads": 1, "steps": steps} | row for row in rows]


class Steps:
    """A run of MuJoCo's `mj_step`."""

    def __init__(self, path, steps):
        self.model, self.steps = load(path), steps
        self.data = mujoco.MjData(self.model)
        self.contacts = self.iterations = 0.0

    def run(self):
        mujoco.mj_resetData(self.model, self.data)
        contacts = iterations = 0
        seconds = 0.0
        for _ in range(self.steps):
            begin = time.perf_counter()
            mujoco.mj_step(self.model, self.data)
            seconds += time.perf_counter() - begin
            contacts += self.data.ncon
            iterations += int(self.data.solver_niter[: max(1, self.data.nisland)].sum())
        self.contacts, self.iterations = contacts / self.steps, iterations / self.steps
        return seconds

    def end(self):
        """Returns the depths of penetrating contacts, m, and the largest linear speed, m/s."""
        mujoco.mj_forward(self.model, self.data)
        return depths(self.data.contact.dist), fastest(self.data.qvel)


class Steppers(Clench):
    """A run of `clench simulate`."""

    def __init__(self, path, steps):
        super().__init__(path, {}, ["--steps", steps])
        self.path, self.steps = path, steps

    def end(self):
        """Returns the same as `Steps.end`, from the final state of one more run."""
        with tempfile.TemporaryDirectory() as folder:
            out = pathlib.Path(folder) / "out.npz"
            subprocess.run([*self.command, "--record", str(out), "--every", str(self.steps)], check=True, capture_output=True)
            with np.load(out) as record:
                state = {name: record[name][-1].tolist() for name in ("qpos", "qvel")}
        command = [CLENCH, "forward", str(self.path)]
        done = subprocess.run(command, input=json.dumps(state) + "\n", check=True, capture_output=True, text=True)
        contacts = json.loads(done.stdout.splitlines()[0])["contacts"]
        return depths(np.array([contact["dist"] for contact in contacts])), fastest(np.array(state["qvel"]))


def depths(distances):
    return -distances[distances < 0]


def fastest(qvel):
    """Returns the largest linear speed of bodies with free joints."""
    return float(np.linalg.norm(qvel.reshape(-1, 6)[:, :3], axis=1).max())
