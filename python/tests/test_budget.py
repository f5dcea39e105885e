"""The budget that limits the size of a model file, and larger budgets on request."""

from pathlib import Path

import clench
import pytest

SCENE = """
<mujoco>
  <worldbody>
    <replicate count="600000"><site/></replicate>
  </worldbody>
</mujoco>
"""


def test_a_larger_budget_allows_a_larger_model(tmp_path: Path) -> None:
    path = tmp_path / "sites.xml"
    path.write_text(SCENE)
    with pytest.raises(clench.LoadError, match="500000 elements.*budget="):
        clench.Model.from_xml(SCENE)
    with pytest.raises(clench.LoadError, match="sites.xml:4: replicate.*500000 elements"):
        clench.Model.from_file(path)
    small = SCENE.replace("600000", "6")
    assert clench.Model.from_xml(small, budget=0.01).nsite == 6
    with pytest.raises(clench.LoadError, match="more than 50 elements"):
        clench.Model.from_xml(SCENE, budget=1e-4)


def test_a_budget_of_nothing_allows_nothing() -> None:
    for budget in (0, -1, float("nan")):
        with pytest.raises(clench.LoadError, match="more than 0 bytes"):
            clench.Model.from_xml("<mujoco/>", budget=budget)
