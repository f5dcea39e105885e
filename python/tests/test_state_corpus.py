"""The committed inputs of the fuzz target of `State.from_bytes`: see `fuzz/state_bytes.py`."""

from __future__ import annotations

import importlib.util
import pathlib
from typing import Any

import pytest

FUZZ = pathlib.Path(__file__).resolve().parents[2] / "fuzz"
SEEDS = sorted((FUZZ / "seeds/state_bytes").iterdir())
REGRESSIONS = sorted((FUZZ / "regressions/state_bytes").glob("*"))


def target() -> Any:
    spec = importlib.util.spec_from_file_location("state_bytes", FUZZ / "state_bytes.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("path", SEEDS, ids=lambda path: path.name)
def test_seeds_are_read_unless_they_are_bad(path: pathlib.Path) -> None:
    assert target().read(path.read_bytes()) is not path.name.startswith("bad-")


@pytest.mark.parametrize("path", REGRESSIONS, ids=lambda path: path.name)
def test_what_broke_the_reader_once_breaks_it_no_more(path: pathlib.Path) -> None:
    target().read(path.read_bytes())
