"""Runs pairs of scripts in pages, for another package and for Clench, which must have the same numbers in `result`."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
from scenes import ROOT


def sections(page: str) -> list[str]:
    """Returns the sections of a page of `docs/`."""
    return (ROOT / "docs" / page).read_text(encoding="utf-8").split("\n## ")[1:]


def title(section: str) -> str:
    return section.splitlines()[0]


def assert_both_give_the_same(section: str, other: str) -> None:
    """Runs both scripts of a section; `other` is the package of the first."""
    first, second = re.findall(r"```python\n(.*?)```", section, re.S)
    assert first.startswith(f"# {other}\n") and second.startswith("# Clench\n")
    expected, found = _result(first), _result(second)
    assert len(found) == len(expected) > 0
    for one, value in zip(found, expected):
        np.testing.assert_allclose(one, value, rtol=1e-6, atol=1e-6)


def _result(script: str) -> list[Any]:
    names: dict[str, Any] = {}
    exec(compile(script, "docs", "exec"), names)
    return list(names["result"])
