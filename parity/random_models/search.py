"""Many random models: how many were compared, what of MJCF they used, and where the engines differ, cut down and kept."""

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


# Seconds. MuJoCo's compiler can look for the length range of a muscle for minutes where the muscle's model diverges, and cannot be
# interrupted: a process that takes longer is ended.
COMPARISON_TIME = 60
REDUCTION_TIME = 300


@dataclasses.dataclass
class Look:
    """What came of one seed: MuJoCo refused the model, or what it used of MJCF, and a difference, if there is one, with its model."""

    seed: int
    refused: bool = False
    used: set = dataclasses.field(default_factory=set)
    difference: compare.Difference | None = None
    text: str = ""


@dataclasses.dataclass
class Findings:
    """What a search has found so far."""

    compared: int = 0
    refused: int = 0
    too_slow: list = dataclasses.field(default_factory=list)
    used: collections.Counter = dataclasses.field(default_factory=collections.Counter)
    differences: dict = dataclasses.field(default_factory=dict)

    def add(self, look):
        self.refused += look.refused
        self.compared += not look.refused
        self.used.update(look.used)
        if look.difference:
            self.differences[look.seed] = look.difference

    def __str__(self):
        lines = [f"{self.compared} models compared, {self.refused} refused by MuJoCo, {len(self.differences)} differ"]
        if self.too_slow:
            lines.append(f"not compared within {COMPARISON_TIME} s: seeds {sorted(self.too_slow)}")
        return "\n".join(lines + [f"  seed {seed}: {difference}" for seed, difference in self.differences.items()])


def model(seed):
    """The model of a seed, with a keyframe now and then; raises `compare.Refused` where MuJoCo does not compile it."""
    root = generate(seed)
    draw = Draw(-seed - 1)
    model = compare.compiled(written(root))
    return with_keyframe(root, model, draw) if draw.chance(0.15) else root


def look(seed):
    """Compares the model of a seed."""
    try:
        root = model(seed)
        difference = compare.examine(written(root), seed)
    except compare.Refused:
        return Look(seed, refused=True)
    return Look(seed, False, set(rules.used(root)), difference, written(root) if difference else "")


def cut_down(look):
    """The same difference in a smaller model."""
    root, difference = reduced(model(look.seed), look.seed, look.difference, REDUCTION_TIME / 2)
    return dataclasses.replace(look, difference=difference, text=written(root))


def search(seeds, folder=FOLDER, report=lambda look: None):
    """Looks at the models of many seeds, on all processors; `report` hears of each that differs."""
    findings = Findings()
    with pebble.ProcessPool(os.cpu_count()) as pool:
        looks = {pool.schedule(look, (seed,), timeout=COMPARISON_TIME): seed for seed in seeds}
        smaller = {}
        for future in concurrent.futures.as_completed(looks):
            if isinstance(future.exception(), TimeoutError):
                findings.too_slow.append(looks[future])
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
