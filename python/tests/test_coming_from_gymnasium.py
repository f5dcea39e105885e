"""The pairs of scripts in `docs/coming-from-gymnasium.md` give the same numbers."""

from __future__ import annotations

import pytest
from pairs import assert_both_give_the_same, sections, title
from scenes import ROOT


@pytest.mark.parametrize("section", sections("coming-from-gymnasium.md"), ids=title)
def test_both_scripts_give_the_same(section: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    assert_both_give_the_same(section, "Gymnasium")
