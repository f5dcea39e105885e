"""Runs `clench simulate`, one process per run, which times itself."""

import json
import os
import pathlib
import subprocess
import tempfile

import numpy as np

from scene import ROOT, Unmeasured

CLENCH = os.environ.get("CLENCH", str(ROOT / "target/dist/clench"))


class Clench:
    """Runs of one command; `summary` is the summary of the last run."""

    def __init__(self, path, arrays, flags):
        self.folder = tempfile.TemporaryDirectory()
        self.command = [CLENCH, "simulate", str(path), "--json", *map(str, flags)]
        for flag, array in arrays.items():
            file = pathlib.Path(self.folder.name) / f"{flag}.npy"
            np.save(file, array)
            self.command += [f"--{flag}", str(file)]
        self.summary = {}

    def run(self):
        """Returns the seconds of stepping alone."""
        done = subprocess.run(self.command, capture_output=True, text=True)
        if done.returncode != 0:
            raise Unmeasured(f"{' '.join(self.command)}\n{done.stderr}")
        self.summary = json.loads(done.stdout.splitlines()[-1])
        return self.summary["seconds"]

    @property
    def contacts(self):
        return self.summary["contacts_mean"]

    @property
    def iterations(self):
        return self.summary["iterations_mean"]
