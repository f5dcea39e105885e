"""Many random models: how many were compared, what of MJCF they used, and where the engines differ, cut down and kept."""

import collections
import dataclasses
import multiprocessing
import os
import pathlib

from random_models import compare, rules
from random_models.generate import generate, with_keyframe, written
from random_models.reduce import reduced
from random_models.values import Draw

FOLDER = pathlib.Path(__file__).resolve().parent.parent / "differences"


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
        return "\n".join(lines + [f"  seed {seed}: {difference}" for seed, difference in self.differences.items()])


def model(seed):
    """The model of a seed, with a keyframe now and then; raises `compare.Refused` where MuJoCo does not compile it."""
    root = generate(seed)
    draw = Draw(-seed - 1)
    model = compare.compiled(written(root))
    return with_keyframe(root, model, draw) if draw.chance(0.15) else root


def look(seed):
    """Compares the model of a seed, and cuts it down if the engines differ on it."""
    try:
        root = model(seed)
        difference = compare.examine(written(root), seed)
    except compare.Refused:
        return Look(seed, refused=True)
    used = set(rules.used(root))
    if difference is None:
        return Look(seed, used=used)
    root, difference = reduced(root, seed, difference)
    return Look(seed, False, used, difference, written(root))


def search(seeds, folder=FOLDER, report=lambda look: None):
    """Looks at the models of many seeds, on all processors; `report` hears of each that differs."""
    findings = Findings()
    with multiprocessing.Pool(os.cpu_count()) as pool:
        for found in pool.imap_unordered(look, seeds, chunksize=4):
            findings.add(found)
            if found.difference:
                compare.keep(folder, f"{found.seed}", found.text, found.difference)
                report(found)
    return findings
