"""The notebooks of the documentation run from top to bottom, without Jupyter."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from scenes import ROOT

NOTEBOOKS = sorted((ROOT / "docs/notebooks").glob("*.ipynb"))


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(path.parent)
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    code = ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]
    assert len(code) >= 3
    names: dict[str, object] = {"__name__": path.stem}
    for place, source in enumerate(code):
        exec(compile(source, f"{path.name}, code {place + 1}", "exec"), names)
