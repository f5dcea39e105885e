"""Times vector environments: `clench.gymnasium` and gymnasium's own, which run MuJoCo in sequence or in processes.

The overhead of our vector environment over the bare batch is measured too. Every engine resets with the same seed and
takes the same actions. Ours use Newton's method, gymnasium's the solver of the file (PGS for the humanoids).
"""

import contextlib
import os
import time

import clench.gymnasium  # registers the environments
import gymnasium
import numpy as np

from timing import alternate, ratio

BASELINE = "gymnasium sync"


def compare(task, args):
    """Times all engines on one task, prints its table and returns its rows."""
    ours = Vector(f"clench/{task}", args)
    engines = {
        BASELINE: Vector(task, args, vectorization_mode="sync"),
        "gymnasium async": Vector(task, args, vectorization_mode="async"),
        "clench": ours,
        "clench, 1 thread": Vector(f"clench/{task}", args, threads=1),
        "batch alone": Bare(ours.env.unwrapped, args),
        "batch alone, 1 thread": Bare(Vector(f"clench/{task}", args, threads=1).env.unwrapped, args),
    }
    seconds = alternate(engines, args.repeat)
    for engine in engines.values():
        engine.close()
    print(f"\n{task}: {args.envs} environments, {args.vector_steps} steps")
    print(f"  {'engine':<23}{'ms/step':>9}{'steps/s':>12}{'ratio':>8}")
    rows = []
    for name, times in seconds.items():
        best = min(times) / args.vector_steps
        row = {"task": task, "engine": name, "seconds": times, "ratio": ratio(seconds[BASELINE], times)}
        rows.append(row)
        print(f"  {name:<23}{1e3 * best:>9.2f}{args.envs / best:>12,.0f}{row['ratio']:>8.1f}", flush=True)
    for suffix in ("", ", 1 thread"):
        more = ratio(seconds[f"clench{suffix}"], seconds[f"batch alone{suffix}"])
        print(f"  observations, rewards and the rest{suffix}: a step takes {more:.2f} times that of the batch alone")
    return rows


@contextlib.contextmanager
def silenced():
    """Suppresses MuJoCo's deprecation warnings about gymnasium's files, one per environment."""
    kept = os.dup(2)
    try:
        with open(os.devnull, "w") as nowhere:
            os.dup2(nowhere.fileno(), 2)
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)


class Vector:
    """A vector environment under fixed actions."""

    def __init__(self, task, args, **kwargs):
        with silenced():
            self.env = gymnasium.make_vec(task, num_envs=args.envs, **kwargs)
        self.env.action_space.seed(0)
        self.actions = [self.env.action_space.sample() for _ in range(args.vector_steps)]

    def run(self):
        """Returns the seconds of stepping alone."""
        self.env.reset(seed=0)
        begin = time.perf_counter()
        for action in self.actions:
            self.env.step(action)
        return time.perf_counter() - begin

    def close(self):
        """Ends the worker processes, if any."""
        self.env.close()


class Bare:
    """The batch of a vector environment under the same actions: controls, then `step`."""

    def __init__(self, env, args):
        self.env = env
        env.action_space.seed(0)
        self.actions = [env.action_space.sample() for _ in range(args.vector_steps)]

    def run(self):
        """Returns the seconds of stepping alone."""
        self.env.reset(seed=0)
        batch, skip = self.env.batch, self.env.frame_skip
        begin = time.perf_counter()
        for action in self.actions:
            batch.ctrl[:] = action
            batch.step(skip)
        return time.perf_counter() - begin

    def close(self):
        """Does nothing: there is nothing to end."""
