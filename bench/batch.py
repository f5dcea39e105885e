"""Times batches of environments from equal states with equal controls: Clench's in both precisions, and MuJoCo's.

MuJoCo's batch has one MjData per thread (one per environment, `persistent`, was slower) and binds and records nothing.
It is timed with the faster of two methods, found by trying both: one `step` call per step, after writing the controls,
or one `rollout` call for the whole run with the controls of every step. Clench takes 50 steps per call. MuJoCo's
contacts and iterations come from a separate run that records every environment and step and is not timed.
"""

import time

import mujoco
import numpy as np
from mujoco import batch as mujoco_batch

from program import Clench
from scene import Unmeasured, describe, load, perturbed_states, smooth_controls
from timing import alternate, ratio, table

BASELINE = "mujoco batch"
TRIALS = 3  # of each method of using MuJoCo's batch


def compare(path, args):
    """Times all engines on one model, prints its table and returns its rows."""
    model = load(path)
    arrays = {
        "ctrl": smooth_controls(model, args.batch_steps),
        "states": perturbed_states(model, args.envs, args.noise),
    }
    engines = {BASELINE: Batch(model, **arrays)}
    threads = {BASELINE: 1}
    for bits in (64, 32):
        for count in sorted({1, args.threads}):
            name = f"clench f{bits}" + (f", {count} threads" if count > 1 else "")
            flags = ["--envs", args.envs, "--threads", count, "--precision", bits, *args.clench.split()]
            engines[name], threads[name] = Clench(path, arrays, flags), count
    seconds = alternate(engines, args.repeat)
    print(f"\n{describe(model, path)}; {args.envs} environments, {args.batch_steps} steps, one thread unless stated otherwise")
    print(f"  (MuJoCo by `{engines[BASELINE].method}`)")
    rows = table(engines, seconds, BASELINE, args.envs * args.batch_steps)
    for bits in (64, 32):
        print_lanes(bits, engines[f"clench f{bits}"].summary)
        if args.threads > 1:
            one, more = seconds[f"clench f{bits}"], seconds[f"clench f{bits}, {args.threads} threads"]
            best = min(one) / min(more)
            print(f"  f{bits}: {args.threads} threads are {ratio(one, more):.2f} times as fast as one (best runs: {best:.2f})")
    common = {"model": path.stem, "envs": args.envs, "steps": args.batch_steps}
    return [common | {"threads": threads[row["engine"]]} | row for row in rows]


def print_lanes(bits, summary):
    """Prints the work that SIMD lanes lose because environments differ."""
    divergence = summary["divergence"]
    print(
        f"  f{bits}: {summary['lanes']} lanes ({summary['instructions']}) need "
        f"{divergence['iterations_per_group']:.1f} iterations and {divergence['slots_per_group']:.1f} contact slots per step; "
        f"{100 * divergence['live_share']:.0f}% of lanes active"
    )


class Batch:
    """MuJoCo's batch on the calling thread."""

    def __init__(self, model, ctrl, states):
        # Sleep needs a separate state per environment, which MuJoCo stores in one MjData each.
        asleep = model.opt.enableflags & mujoco.mjtEnableBit.mjENBL_SLEEP
        self.batch = mujoco_batch.Batch(model, nsim=len(states), nthread=1, persistent=bool(asleep))
        self.batch.qpos = states[:, : model.nq]
        self.batch.qvel = states[:, model.nq :]
        self.start = self.batch.state.copy()
        self.steps = len(ctrl)
        self.ctrl = np.ascontiguousarray(np.broadcast_to(ctrl, (len(states), *ctrl.shape)))
        self.contacts, self.iterations = self.statistics()
        self.method = min(("rollout", "step"), key=lambda method: min(self.run(method) for _ in range(TRIALS)))

    def statistics(self):
        """Returns the mean contacts and iterations of a step (of RK4 the last stage); checks that MuJoCo is stable."""
        records = self.batch.rollout(self.steps, self.ctrl, record=("ncon", "solver_niter", "nisland"))
        if self.batch.warning.any():
            raise Unmeasured("MuJoCo warns of an unstable motion: these controls are useless for measurements")
        parts = np.maximum(records["nisland"], 1)[..., None]
        solved = np.arange(records["solver_niter"].shape[-1]) < parts
        return records["ncon"].mean(), (records["solver_niter"] * solved).sum(axis=-1).mean()

    def run(self, method=None):
        """Returns the seconds of stepping, including writing the controls."""
        self.batch.state[:] = self.start
        ctrl = self.batch.bind("ctrl")
        begin = time.perf_counter()
        if (method or self.method) == "rollout":
            self.batch.rollout(self.steps, self.ctrl, record=())
        else:
            for row in self.ctrl[0]:
                ctrl[:] = row
                self.batch.step()
        return time.perf_counter() - begin
