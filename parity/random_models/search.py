"""Compares many random models: counts them, records the MJCF that they use, and stores reduced models that differ."""

import collections
import concurrent.futures
import dataclasses
import os
import pathlib

import pebble

from random_models import compare, rules
from random_models.generate import generate, with_keyframe, written
from random_models.reduce import reduced
from random_models.values import Draw

FOLDER = pathlib.Path(__file__).resolve().parent.parent / "differences"


# Seconds. MuJoCo's compiler may search for the length range of a muscle for minutes if the model diverges, and cannot
# be interrupted, so a process that takes longer is ended.
COMPARISON_TIME = 60
REDUCTION_TIME = 300


@dataclasses.dataclass
class SeedResult:
    """The result of one seed: True if MuJoCo refused it, the MJCF in use, and a difference, if any, with its model."""

    seed: int
    refused: bool = False
    used: set = dataclasses.field(default_factory=set)
    difference: compare.Difference | None = None
    text: str = ""


@dataclasses.dataclass
class Findings:
    """The findings of a search so far."""

    compared: int = 0
    refused: int = 0
    too_slow: list = dataclasses.field(default_factory=list)
    used: collections.Counter = dataclasses.field(default_factory=collections.Counter)
    differences: dict = dataclasses.field(default_factory=dict)

    def add(self, result):
        self.refused += result.refused
        self.compared += not result.refused
        self.used.update(result.used)
        if result.difference:
            self.differences[result.seed] = result.difference

    def __str__(self):
        lines = [f"{self.compared} models compared, {self.refused} refused by MuJoCo, {len(self.differences)} differ"]
        if self.too_slow:
            lines.append(f"not compared within {COMPARISON_TIME} s: seeds {sorted(self.too_slow)}")
        return "\n".join(lines + [f"  seed {seed}: {difference}" for seed, difference in self.differences.items()])


def model(seed):
    """Returns the model of a seed, sometimes with a keyframe; raises `compare.Refused` if MuJoCo refuses it."""
    root = generate(seed)
    draw = Draw(-seed - 1)
    model = compare.compiled(written(root))
    return with_keyframe(root, model, draw) if draw.chance(0.15) else root


def compare_seed(seed):
    """Compares the model of a seed."""
    try:
        root = model(seed)
        difference = compare.examine(written(root), seed)
    except compare.Refused:
        return SeedResult(seed, refused=True)
    return SeedResult(seed, False, set(rules.used(root)), difference, written(root) if difference else "")


def cut_down(result):
    """Returns the same difference in a smaller model."""
    root, difference = reduced(model(result.seed), result.seed, result.difference, REDUCTION_TIME / 2)
    return dataclasses.replace(result, difference=difference, text=written(root))


def search(seeds, folder=FOLDER, report=lambda result: None):
    """Compares the models of many seeds, on all processors; calls `report` with each that differs."""
    findings = Findings()
    with pebble.ProcessPool(os.cpu_count()) as pool:
        results = {pool.schedule(compare_seed, (seed,), timeout=COMPARISON_TIME): seed for seed in seeds}
        smaller = {}
        for future in concurrent.futures.as_completed(results):
            if isinstance(future.exception(), TimeoutError):
                findings.too_slow.append(results[future])
                continue
            found = future.result()
            findings.add(found)
            if found.difference:
                smaller[pool.schedule(cut_down, (found,), timeout=REDUCTION_TIME)] = found
        for future in concurrent.futures.as_completed(smaller):
            found = smaller[future] if isinstance(future.exception(), TimeoutError) else future.result()
            findings.differences[found.seed] = found.difference
            compare.keep(folder, f"{found.seed}", found.text, found.difference)
            report(found)
    return findings
