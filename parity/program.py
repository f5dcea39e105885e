"""Runs the `clench` program: one `forward` process for many states, and single runs of any command."""

import contextlib
import json
import os
import pathlib
import subprocess
import tempfile

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent
CLENCH = pathlib.Path(os.environ.get("CLENCH", ROOT / "target/release/clench"))

# Both engines run until no progress is possible, so that what remains is rounding.
EXACT = ("--tolerance", "0", "--ls-tolerance", "1e-10", "--ls-iterations", "200", "--no-warmstart")


class Failure(Exception):
    """The program ended instead of answering; the message is its standard error."""


def run(*args, stdin="", **options):
    """Runs the program to its end and returns the completed process, its output as text."""
    words = [str(CLENCH), *map(str, args)]
    return subprocess.run(words, input=stdin, capture_output=True, text=True, timeout=300, **options)


def simulate(model, *flags):
    """Runs `clench simulate` and returns its recorded arrays and its JSON summary."""
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "out.npz"
        done = run("simulate", model, "--record", out, "--json", *flags)
        if done.returncode != 0:
            raise Failure(done.stderr)
        with np.load(out) as record:
            return {name: record[name] for name in record.files}, json.loads(done.stdout.splitlines()[-1])


class Forward:
    """`clench forward MODEL FLAGS...`, as a function from state to result."""

    def __init__(self, model, *flags):
        self.errors = tempfile.TemporaryFile("w+")
        words = [str(CLENCH), "forward", str(model), *map(str, flags)]
        self.process = subprocess.Popen(
            words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self.errors, text=True
        )

    def __enter__(self):
        return self

    def __exit__(self, *_):
        with contextlib.suppress(BrokenPipeError):  # the program has ended and reported why
            self.process.stdin.close()
        self.process.wait(timeout=60)
        self.process.stdout.close()
        self.errors.close()

    def __call__(self, state):
        try:
            self.process.stdin.write(json.dumps(state) + "\n")
            self.process.stdin.flush()
            answer = self.process.stdout.readline()
        except BrokenPipeError:
            answer = ""
        if not answer:
            self.process.wait(timeout=60)
            self.errors.seek(0)
            raise Failure(f"exit code {self.process.returncode}: {self.errors.read()}")
        return json.loads(answer)


def rows(result, field):
    """Returns a field of all constraint rows as an array."""
    return np.array([row[field] for row in result["constraints"]], dtype=float)
