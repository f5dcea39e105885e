"""Compares both engines on a thousand random models that use all of MJCF that Clench reads, on a few states each.

`soak_models.py` does the same for other and more seeds.
"""

import pytest

from random_models import rules, search

SEEDS = range(1, 1701)  # MuJoCo compiles a thousand of these
MIN_COMPARED = 1000
# MuJoCo aborts the process if a touch sensor's site is a mesh; `models/sensors.xml` has such a site.
NEVER = {("site", "mesh")}


@pytest.mark.long
def test_the_engines_agree():
    findings = search.search(SEEDS)
    assert not findings.differences, f"{findings}\nThe models are in {search.FOLDER}."
    assert findings.compared >= MIN_COMPARED
    # Every attribute that Clench reads occurs.
    missing = [
        (element, name) for element, rule in rules.rules().items() for name in rule["read"] if not findings.used[element, name]
    ]
    missing = [pair for pair in missing if pair not in NEVER]
    assert not missing, f"random models never have {missing}: see random_models/values.py"
