"""Times scenes of manipulation and of many bodies: one environment, then 64 and 256, alternating with MuJoCo.

Batches run in both precisions. Heaps are timed once they are at rest (or, if they collapse, half-way): Clench steps
them there, and both engines start from that state. The table also has contacts, iterations, and the median over steps
of the final scaled gradient norm that each engine reports. All figures go to target/bench/families.json; `--docs` also
rewrites docs/families.md and its plots. `--filter NAME` measures some scenes and keeps that file's figures of the rest.
"""

import json
import math
import os
import pathlib
import platform
import subprocess
import sys
import tempfile
import time
from collections import defaultdict

import mujoco
import numpy as np

import generated
import plots
from single import Rollout
from batch import Batch
from program import CLENCH, Clench
from scene import NEWTON, ROOT, Unmeasured, load, perturbed_states, smooth_controls
from timing import alternate, processors, ratio

sys.path.insert(0, str(ROOT / "parity"))
import public

OUT = ROOT / "target/bench/families.json"
SECONDS = 0.3  # MuJoCo's time in a run
# The maximum seconds of five steps of MuJoCo, by number of environments; slower scenes are omitted.
LONGEST = {1: 20.0, 64: 3.0, 256: 3.0}
BATCHES = [64, 256]
GROWTH = [100, 200, 500, 1000]  # numbers of bodies of a pile
ENVS = [1, 8, 64, 256, 1024]
THREADED = plots.THREADED

# Name: family, MJCF text or a public file, steps before the clock starts.
SCENES = {
    "one arm with meshes": ("manipulation", public.path("genesis/assets/xml/franka_emika_panda/scene_no_tendon.xml"), 0),
    "two arms": ("manipulation", public.path("gym_aloha/assets/bimanual_viperx_transfer_cube.xml"), 0),
    "hand (no contacts)": ("manipulation", public.path("dm_control/third_party/kinova/jaco_hand.xml"), 0),
    "arm and box": ("manipulation", ROOT / "models/arm_and_box.xml", 0),
    "room of 1,000": ("manipulation", generated.room(1000), 0),
    "room of 2,000": ("manipulation", generated.room(2000), 0),
    **{f"pile of {count:,}": ("large", generated.pile(count), 600) for count in GROWTH},
    "rings of stones": ("large", generated.rings(4), 200),
    "wall of 500 boxes": ("large", generated.wall(500), 200),
    "22 humanoids": ("large", generated.humanoids(22), 500),
    "100 humanoids": ("large", generated.humanoids(100), 500),
    "chain of 200 links": ("large", generated.chain(200), 0),
    "1,000 asleep": ("large", generated.asleep(1000), 0),
}


def compare(_, args):
    """Prints a table, writes the figures and returns a row for each scene, number of environments and engine."""
    print(f"\n{'scene':<22}{'envs':>6} {'engine':<10}{'µs/step':>11}{'ratio':>7}{'contacts':>10}{'iterations':>12}{'gradient':>10}")
    rows, stages, omitted = [], {}, []
    with tempfile.TemporaryDirectory() as folder:
        for name, (family, source, before) in SCENES.items():
            if args.filter not in name:
                continue
            path = source
            if isinstance(source, str):
                path = pathlib.Path(folder) / "scene.xml"
                path.write_text(source)
            scene = Scene(name, family, path, before, args)
            rows += scene.alone(omitted)
            stages[name] = scene.stages()
            for envs in BATCHES:
                try:
                    rows += scene.batch(envs)
                except Unmeasured as reason:
                    omitted.append(f"{name}, {envs} environments: {str(reason).splitlines()[-1]}")
    rows += grow_environments(args) if not args.filter else []
    print("not measured:", *(omitted or ["none"]), sep="\n  ")
    record = {"machine": machine(), "rows": rows, "stages": stages, "not_measured": omitted}
    if args.filter and OUT.exists():
        record = with_others(record, json.loads(OUT.read_text()))
    OUT.parent.mkdir(parents=True, exist_ok=True)
    OUT.write_text(json.dumps(record, indent=1) + "\n")
    print(f"figures: {OUT.relative_to(ROOT)}")
    if args.docs:
        plots.draw(record, ROOT / "docs")
    return [row | {"model": row["scene"]} for row in rows if row["ratio"] is not None]


def with_others(record, earlier):
    """Adds an earlier run's figures of the scenes that this run did not measure."""
    measured = list(record["stages"])
    names = list(SCENES)
    kept = [row for row in earlier["rows"] if row["scene"] in names and (row["family"] == "environments" or row["scene"] not in measured)]
    rows = sorted([*kept, *record["rows"]], key=lambda row: (row["family"] == "environments", names.index(row["scene"])))
    stages = earlier["stages"] | record["stages"]
    stages = {name: stages[name] for name in names if name in stages}
    omitted = [reason for reason in earlier["not_measured"] if not reason.startswith(tuple(f"{name}{end}" for name in measured for end in ",:"))]
    return record | {"rows": rows, "stages": stages, "not_measured": omitted + record["not_measured"]}


class Scene:
    """A model file and the state from which it is timed."""

    def __init__(self, name, family, path, before, args):
        self.common = {"scene": name, "family": family}
        self.path, self.args = path, args
        self.model = load(path)
        self.state = settled(path, before) if before else None
        self.common["nv"] = int(self.model.nv)

    def alone(self, omitted):
        """Times one environment in both engines; large scenes on all threads too.

        If MuJoCo takes too long, only Clench runs, and `omitted` records it.
        """
        engines = ["mujoco", "clench", *[THREADED][: self.common["family"] == "large" and processors() > 1]]
        try:
            steps = self.affordable(1, 2000)
        except Unmeasured as reason:
            omitted.append(f"{self.common['scene']}: {reason}")
            engines, steps = engines[1:], 20
        controls = smooth_controls(self.model, steps)
        arrays = self.arrays(controls, self.state[None] if self.state is not None else None)
        make = {
            "mujoco": lambda: Rollout(self.path, NEWTON, controls, self.state),
            "clench": lambda: Clench(self.path, arrays, ["--steps", steps]),
            THREADED: lambda: Clench(self.path, arrays, ["--steps", steps, "--threads", processors()]),
        }
        gradients = defaultdict(lambda: lambda engine: recorded(engine, "gradient"), mujoco=lambda engine: engine.gradients)
        engines = {name: make[name]() for name in engines}
        seconds = alternate(engines, self.args.repeat)
        return [self.row(1, name, engine, seconds, steps, gradients[name](engine)) for name, engine in engines.items()]

    def batch(self, envs, threads=1):
        """Times `envs` environments in both engines, Clench in both precisions."""
        steps = self.affordable(envs, 200)
        controls = smooth_controls(self.model, steps)
        states = perturbed_states(self.model, envs, self.args.noise if self.state is None else 0.0)
        if self.state is not None:
            states[:] = self.state
        engines = {"mujoco": Batch(self.model, controls, states)}
        flags = ["--envs", envs, "--threads", threads, "--steps", steps]
        for bits in (64, 32):
            engines[f"clench f{bits}"] = Clench(self.path, self.arrays(controls, states), [*flags, "--precision", bits])
        seconds = alternate(engines, self.args.repeat)
        return [self.row(envs, name, engine, seconds, steps) | {"threads": threads} for name, engine in engines.items()]

    def arrays(self, controls, states):
        """Returns the arrays that `clench` reads from files."""
        arrays = {"ctrl": controls, "states": states}
        return {flag: array for flag, array in arrays.items() if array is not None and array.size}

    def row(self, envs, name, engine, seconds, steps, gradients=None):
        """Prints and returns the row of one engine."""
        micro = 1e6 * float(np.median(seconds[name])) / steps / envs
        gradient = None if gradients is None else float(np.median(gradients))
        faster = ratio(seconds["mujoco"], seconds[name]) if "mujoco" in seconds else None
        print(
            f"{self.common['scene']:<22}{envs:>6} {name:<10}{micro:>11.2f}{'' if faster is None else f'{faster:.2f}':>7}{engine.contacts:>10.1f}{engine.iterations:>12.1f}"
            + ("" if gradient is None else f"{gradient:>10.0e}"),
            flush=True,
        )
        numbers = {"microseconds": micro, "ratio": faster, "seconds": seconds[name], "steps": steps, "gradient_median": gradient}
        counts = {"contacts_mean": float(engine.contacts), "iterations_mean": float(engine.iterations)}
        return self.common | {"envs": envs, "engine": name} | numbers | counts

    def stages(self):
        """Returns the microseconds of each stage of a step of one environment."""
        steps = 20 if self.model.nv > 2000 else 300
        arrays = self.arrays(smooth_controls(self.model, steps), self.state[None] if self.state is not None else None)
        run = Clench(self.path, arrays, ["--steps", steps, "--profile"])
        run.run()
        return {stage["stage"]: stage["microseconds"] for stage in run.summary["profile"]}

    def affordable(self, envs, limit):
        """Returns the number of steps that MuJoCo takes with `envs` environments in SECONDS: 5 to `limit`."""
        data = mujoco.MjData(self.model)
        if self.state is not None:
            data.qpos[:], data.qvel[:] = np.split(self.state, [self.model.nq])
        begin = time.perf_counter()
        mujoco.mj_step(self.model, data, 5)
        five = time.perf_counter() - begin
        if five * envs > LONGEST.get(envs, math.inf):
            raise Unmeasured(f"five steps would take MuJoCo {five * envs:.0f} s")
        return min(limit, max(5, round(5 * SECONDS / five / envs)))


def settled(path, steps):
    """Returns positions and velocities after `steps` steps of Clench."""
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "out.npz"
        command = [CLENCH, "simulate", str(path), "--steps", str(steps), "--record", str(out), "--every", str(steps)]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode != 0:
            raise Unmeasured(done.stderr)
        with np.load(out) as record:
            return np.concatenate([record["qpos"][-1], record["qvel"][-1]])


def recorded(engine, name):
    """Runs the engine once more and returns an array of its record."""
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "out.npz"
        subprocess.run([*engine.command, "--record", str(out)], check=True, capture_output=True)
        with np.load(out) as record:
            return record[name]


def grow_environments(args):
    """Times a scene of manipulation with growing numbers of environments, on one thread and on all."""
    scene = Scene("arm and box", "environments", ROOT / "models/arm_and_box.xml", 0, args)
    counts = sorted({1, processors()})
    return [row for envs in ENVS for threads in counts for row in scene.batch(envs, threads)]


def machine():
    """Returns the machine and the version of MuJoCo that the figures are from."""
    return {"machine": platform.machine(), "processors": processors(), "load": os.getloadavg()[0], "mujoco": mujoco.__version__}
