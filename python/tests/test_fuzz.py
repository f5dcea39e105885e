"""Runs `fuzz.py` in a separate process, so that a crash or a hang is an ordinary test failure."""

from __future__ import annotations

import inspect
import os
import pathlib
import subprocess
import sys

import clench
import fuzz
import pytest

CALLS = 10_000


@pytest.mark.long
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_nothing_but_exceptions_comes_back(seed: int) -> None:
    program = pathlib.Path(fuzz.__file__)
    # Without a display, Mesa's layer for selecting the device writes warnings to stderr.
    quiet = {**os.environ, "NODEVICE_SELECT": "1"}
    done = subprocess.run([sys.executable, program, str(seed), str(CALLS)], capture_output=True, text=True, timeout=280, env=quiet)
    assert (done.returncode, done.stderr) == (0, ""), f"{done.stderr}\nexit code {done.returncode}"
    assert "'returned'" in done.stdout


@pytest.mark.parametrize("cls", [clench.Model, clench.Sim, clench.Batch, clench.State])
def test_no_method_is_omitted(cls: type) -> None:
    source = inspect.getsource(fuzz)
    methods = {name for name in dir(cls) if not name.startswith("_") and callable(getattr(cls, name))}
    missing = {name for name in methods if name not in source and name not in fuzz.KINDS}
    assert methods and not missing
