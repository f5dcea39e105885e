"""Measures the overhead of stepping a batch from Python: the same calls, one step each, from Python and from Rust.

The final states must be bitwise equal.
"""

import os
import subprocess
import sys
import time

import clench
import numpy as np

from scene import ROOT
from timing import alternate, ratio

RUST = os.environ.get("BATCH_STEP", str(ROOT / "target/dist/examples/batch_step"))
WARM = 100  # steps before the clock starts


def compare(path, args):
    """Times both on one model, on one thread and on several; prints the ratios and returns them as rows."""
    rows = []
    for threads in sorted({1, args.threads}):
        engines = {
            "rust": Rust(path, args.envs, threads, args.batch_steps),
            "python": Python(path, args.envs, threads, args.batch_steps),
        }
        seconds = alternate(engines, args.repeat)
        if engines["rust"].bits != engines["python"].bits:
            sys.exit(f"{path}: Python and Rust moved differently")
        more = ratio(seconds["python"], seconds["rust"])
        best = min(seconds["python"]) / min(seconds["rust"])
        micro = 1e6 * min(seconds["rust"]) / args.batch_steps
        print(
            f"  {path.stem}, {args.envs} environments, {threads} threads: batch.step() from Python takes {more:.3f} times what it "
            f"takes from Rust (best runs: {best:.3f} of {micro:.0f} µs)"
        )
        rows.append({"model": path.stem, "engine": "python calls", "threads": threads, "over_rust": more, "best": best})
    return rows


def wave(values, size):
    """Fills an array with the numbers that the Rust program uses."""
    flat = values.reshape(-1)
    flat[:] = size * ((7 * np.arange(flat.size)) % 101 / 50.0 - 1.0)


class Python:
    """`Batch.step` in a loop."""

    def __init__(self, path, envs, threads, steps):
        self.model, self.envs, self.threads, self.steps = clench.Model.from_file(path), envs, threads, steps
        self.bits = 0

    def run(self):
        """Returns the seconds of stepping alone."""
        batch = clench.Batch(self.model, self.envs, threads=self.threads)
        wave(batch.qvel, 0.1)
        wave(batch.ctrl, 0.5)
        for _ in range(WARM):
            batch.step()
        begin = time.perf_counter()
        for _ in range(self.steps):
            batch.step()
        seconds = time.perf_counter() - begin
        self.bits = int(np.bitwise_xor.reduce(batch.qpos.view(np.uint64), axis=None))
        return seconds


class Rust:
    """`crates/clench/examples/batch_step.rs`."""

    def __init__(self, path, envs, threads, steps):
        self.command = [RUST, *map(str, (path, envs, threads, steps))]
        self.bits = 0

    def run(self):
        """Returns the seconds of stepping alone, timed by the program."""
        done = subprocess.run(self.command, capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit(f"{' '.join(self.command)}\n{done.stderr}")
        seconds, bits = done.stdout.split()
        self.bits = int(bits)
        return float(seconds)
