"""A thousand random models that use all of MJCF that Clench reads: what both engines compute of each on a few states agrees.

`soak_models.py` does the same with as many seeds as one has time for; its models and these differ in seeds alone.
"""

import pytest

from random_models import rules, search

SEEDS = range(1, 1701)  # of these MuJoCo compiles a thousand
MIN_COMPARED = 1000
# MuJoCo ends the process where touch is felt in a mesh; `models/sensors.xml` has such a site.
NEVER = {("site", "mesh")}


@pytest.mark.long
def test_the_engines_agree():
    findings = search.search(SEEDS)
    assert not findings.differences, f"{findings}\nThe models are in {search.FOLDER}."
    assert findings.compared >= MIN_COMPARED
    # Every attribute that is read occurs.
    missing = [
        (element, name) for element, rule in rules.rules().items() for name in rule["read"] if not findings.used[element, name]
    ]
    missing = [pair for pair in missing if pair not in NEVER]
    assert not missing, f"random models never have {missing}: see random_models/values.py"
