"""Attributes that Clench accepts and ignores do not affect MuJoCo's motion either.

Each such attribute is set in a scene, whose motion must not change."""

import copy
import functools
import xml.etree.ElementTree as ET

import mujoco
import numpy as np
import pytest

from random_models import harmless, rules
from random_models.preamble import ASSETS

STEPS = 100
SAME = 1e-9  # metres or radians: the order of a sum may change

# This selects MuJoCo's algorithm for contacts of convex shapes. Clench has one algorithm, which finds the exact
# contacts that MuJoCo approximates.
OF_THE_NARROW_PHASE = {("flag", "nativeccd")}


def scene():
    root = ET.parse(harmless.SCENE).getroot()
    root.find("compiler").set("assetdir", str(ASSETS))
    return root


def motion(root):
    """Returns every position of the model's motion from its initial state under constant controls."""
    model = mujoco.MjModel.from_xml_string(ET.tostring(root, encoding="unicode"))
    data = mujoco.MjData(model)
    data.ctrl = np.linspace(0.2, 1, model.nu)
    path = []
    for _ in range(STEPS):
        mujoco.mj_step(model, data)
        path.append(data.qpos.copy())
    assert np.isfinite(path).all()
    return np.array(path)


@functools.lru_cache(maxsize=None)
def undisturbed():
    return motion(scene())


def ignored():
    """Returns pairs of an element and an attribute that Clench accepts and ignores."""
    pairs = [(element, name) for element, rule in rules.rules().items() for name in rule["ignored"]]
    return [pair for pair in pairs if pair not in harmless.UNTRIED]


def placed(root, key):
    """Returns the elements of a kind. The last one is in the model, even if others are in a default class."""
    found = [root] if key == root.tag else []
    found += [element for parent in root.iter() for element in parent if rules.key(parent, element) == key]
    assert found, f"there is no {key} in {harmless.SCENE.name}: add one"
    return found


def changed(key, name, everywhere):
    root = scene()
    for element in placed(root, key)[0 if everywhere else -1 :]:
        element.attrib.update({**harmless.COMPANIONS.get((key, name), {}), name: harmless.VALUES[key][name]})
    return root


def changed_motion(key, name):
    """Returns the motion with the attribute on all elements of the kind, or on the last if only one may have it."""
    try:
        return motion(changed(key, name, everywhere=True))
    except ValueError:
        return motion(changed(key, name, everywhere=False))


def test_each_ignored_attribute_has_a_value_to_try():
    missing = [pair for pair in ignored() if pair[1] not in harmless.VALUES.get(pair[0], {})]
    assert not missing, f"give {missing} a value in harmless.py"


def test_the_scene_moves_and_touches():
    path = undisturbed()
    assert (np.abs(path[-1] - path[0]) > 1e-3).sum() > 20


@pytest.mark.parametrize(("key", "name"), ignored(), ids=lambda word: word)
def test_an_ignored_attribute_moves_nothing(key, name):
    path = changed_motion(key, name)
    error = np.abs(path - undisturbed()).max()
    if (key, name) in OF_THE_NARROW_PHASE:
        return
    assert error <= SAME, f"{key} {name}=\"{harmless.VALUES[key][name]}\" moves the scene by {error:.1e}: support or refuse it"


def test_an_element_that_is_ignored_moves_nothing():
    """The motion is the same without all elements of which Clench reads nothing."""
    root = copy.deepcopy(scene())
    silent = [key for key, rule in rules.rules().items() if rule["ignored"] and not rule["read"]]
    for parent in list(root.iter()):
        for child in list(parent):
            if rules.key(parent, child) in silent and child.tag not in ("texture",):
                parent.remove(child)
    assert np.abs(motion(root) - undisturbed()).max() <= SAME
