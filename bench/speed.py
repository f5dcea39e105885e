"""Clench's and MuJoCo's speed side by side: one environment, one thread, the same controls, alternating in one run.

Each repetition steps every engine once from the model's default state under the same smooth random controls, Clench
through `clench simulate` (which reports the time of stepping alone) and MuJoCo through its own rollout in C. A figure
is the median over repetitions. Both read the same file with its integrator, tolerance and iterations; where the file
asks for PGS, MuJoCo is timed with Newton, which is what Clench uses, and with PGS as well.
"""

import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

import mujoco
import numpy as np
from mujoco import rollout

ROOT = pathlib.Path(__file__).resolve().parent.parent
GYMNASIUM = ROOT / ".cache/gymnasium-1.4.0/gymnasium/envs/mujoco/assets"
CLENCH = os.environ.get("CLENCH", str(ROOT / "target/release/clench"))
DEFAULT_MODELS = ["humanoid", "ant", "half_cheetah"]

NEWTON, PGS = mujoco.mjtSolver.mjSOL_NEWTON, mujoco.mjtSolver.mjSOL_PGS


def main():
    args = arguments()
    results = [result for name in args.models for result in compare(find(name), args)]
    if args.json:
        pathlib.Path(args.json).write_text(json.dumps(results, indent=2) + "\n")
    clench = [r for r in results if r["engine"] == "clench"]
    slower = [r["model"] for r in clench if r["ratio"] < 1]
    print(f"\nratio: MuJoCo's time with Newton over this engine's; medians of {args.repeat} runs of {args.steps} steps")
    if slower:
        print(f"slower than MuJoCo on: {', '.join(slower)}")
    sys.exit(1 if slower and args.check else 0)


def arguments():
    parser = argparse.ArgumentParser(prog="cargo xtask bench", description=__doc__.split("\n")[0])
    parser.add_argument("models", nargs="*", default=DEFAULT_MODELS, help="gymnasium's names, or files")
    parser.add_argument("--steps", type=int, default=5000, help="steps a run (default: %(default)s)")
    parser.add_argument("--repeat", type=int, default=7, help="runs of each engine (default: %(default)s)")
    parser.add_argument("--clench", default="", metavar="FLAGS", help="further flags for clench, as one string")
    parser.add_argument("--json", metavar="FILE", help="write the figures there as well")
    parser.add_argument("--check", action="store_true", help="exit code 1 if Clench is slower on any model")
    return parser.parse_args()


def find(name):
    path = pathlib.Path(name) if name.endswith(".xml") else GYMNASIUM / f"{name}.xml"
    if not path.is_file():
        sys.exit(f"{path} is missing; `cargo xtask test python` fetches gymnasium's models")
    return path


def compare(path, args):
    """Times all engines on one model, prints its table and returns its rows."""
    model = mujoco.MjModel.from_xml_path(str(path))
    controls = smooth_controls(model, args.steps)
    engines = {"mujoco newton": Mujoco(path, NEWTON, controls), "clench": Clench(path, controls, args.clench.split())}
    if model.opt.solver == PGS:
        engines["mujoco pgs"] = Mujoco(path, PGS, controls)
    seconds = {name: [] for name in engines}
    for engine in engines.values():
        engine.run()  # warm caches and clocks; not counted
    for _ in range(args.repeat):
        for name, engine in engines.items():
            seconds[name].append(engine.run())

    integrator = mujoco.mjtIntegrator(model.opt.integrator).name.removeprefix("mjINT_")
    print(f"\n{path.stem}: nv {model.nv}, {integrator}, time step {model.opt.timestep:g} s")
    print(f"  {'engine':<14}{'µs/step':>9}{'best':>9}{'ratio':>8}{'contacts':>10}{'iterations':>12}")
    baseline = statistics.median(seconds["mujoco newton"])
    micro = lambda total: total / args.steps * 1e6
    rows = []
    for name, engine in engines.items():
        median = statistics.median(seconds[name])
        row = {"model": path.stem, "engine": name, "steps": args.steps, "seconds": seconds[name]}
        row |= {"ratio": baseline / median, "contacts_mean": engine.contacts, "iterations_mean": engine.iterations}
        rows.append(row)
        print(
            f"  {name:<14}{micro(median):>9.2f}{micro(min(seconds[name])):>9.2f}{row['ratio']:>8.2f}"
            f"{engine.contacts:>10.2f}{engine.iterations:>12.2f}",
            flush=True,
        )
    return rows


def smooth_controls(model, steps):
    """Filtered noise within half of each control's range: motion that is lively and stays sane."""
    rng = np.random.default_rng(0)
    limited = model.actuator_ctrllimited.astype(bool)
    low = np.where(limited, model.actuator_ctrlrange[:, 0], -1.0)
    high = np.where(limited, model.actuator_ctrlrange[:, 1], 1.0)
    memory = 0.98
    noise, value = rng.standard_normal((steps, model.nu)), np.zeros(model.nu)
    controls = np.empty((steps, model.nu))
    for k in range(steps):
        value = memory * value + np.sqrt(1 - memory**2) * noise[k]
        controls[k] = (low + high) / 2 + (high - low) / 4 * np.clip(value, -2, 2)
    return controls


class Mujoco:
    """MuJoCo's rollout module on the calling thread."""

    def __init__(self, path, solver, controls):
        self.model = mujoco.MjModel.from_xml_path(str(path))
        self.model.opt.solver = solver
        self.data = mujoco.MjData(self.model)
        self.controls = controls[None]
        size = mujoco.mj_stateSize(self.model, mujoco.mjtState.mjSTATE_FULLPHYSICS)
        self.start = np.empty((1, size))
        mujoco.mj_getState(self.model, self.data, self.start[0], mujoco.mjtState.mjSTATE_FULLPHYSICS)
        self.states = np.empty((1, len(controls), size))
        self.sensors = np.empty((1, len(controls), self.model.nsensordata))
        self.pool = rollout.Rollout(nthread=0)
        self.contacts, self.iterations = self.statistics(controls)

    def statistics(self, controls):
        """Mean contacts and iterations a step (a Runge–Kutta step reports its last stage), and a sanity check."""
        data, contacts, iterations = mujoco.MjData(self.model), 0, 0
        for control in controls:
            data.ctrl[:] = control
            mujoco.mj_step(self.model, data)
            contacts += data.ncon
            iterations += int(data.solver_niter[: max(1, data.nisland)].sum())
        if any(w.number for w in data.warning):
            sys.exit("MuJoCo warns of an unstable motion: these controls measure nothing")
        return contacts / len(controls), iterations / len(controls)

    def run(self):
        begin = time.perf_counter()
        self.pool.rollout(
            [self.model], [self.data], self.start, self.controls, skip_checks=True, nstep=self.controls.shape[1],
            state=self.states, sensordata=self.sensors,
        )  # fmt: skip
        return time.perf_counter() - begin


class Clench:
    """`clench simulate`, a process a run, timed by itself."""

    def __init__(self, path, controls, flags):
        self.folder = tempfile.TemporaryDirectory()
        file = pathlib.Path(self.folder.name) / "ctrl.npy"
        np.save(file, controls)
        self.command = [CLENCH, "simulate", str(path), "--steps", str(len(controls)), "--ctrl", str(file), "--json"]
        self.command += flags
        self.contacts = self.iterations = float("nan")

    def run(self):
        done = subprocess.run(self.command, capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit(f"{' '.join(self.command)}\n{done.stderr}")
        summary = json.loads(done.stdout.splitlines()[-1])
        self.contacts, self.iterations = summary["contacts_mean"], summary["iterations_mean"]
        return summary["seconds"]


if __name__ == "__main__":
    main()
