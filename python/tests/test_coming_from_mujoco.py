"""The pairs of scripts in `docs/coming-from-mujoco.md` give the same numbers."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest
from scenes import ROOT

PAGE = (ROOT / "docs/coming-from-mujoco.md").read_text(encoding="utf-8")
SECTIONS = [section for section in PAGE.split("\n## ")[1:]]


def result(script: str) -> list[Any]:
    names: dict[str, Any] = {}
    exec(compile(script, "docs/coming-from-mujoco.md", "exec"), names)
    return list(names["result"])


@pytest.mark.parametrize("section", SECTIONS, ids=lambda section: section.splitlines()[0])
def test_both_scripts_give_the_same(section: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    first, second = re.findall(r"```python\n(.*?)```", section, re.S)
    assert first.startswith("# MuJoCo\n") and second.startswith("# Clench\n")
    expected, found = result(first), result(second)
    assert len(found) == len(expected) > 0
    for one, other in zip(found, expected):
        np.testing.assert_allclose(one, other, rtol=1e-6, atol=1e-6)
