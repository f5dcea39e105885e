"""Reduces a model to the parts that a difference needs: removes elements, unwraps containers, removes attributes."""

import copy
import time

from random_models.compare import Refused, examine
from random_models.generate import written

MAX_TRIALS = 600
UNWRAPPED = ("frame", "replicate", "body", "default")


def reduced(root, seed, difference, seconds):
    """Returns the smallest model found within `seconds` that has the same kind of difference, and its difference."""
    root, trials = copy.deepcopy(root), 0
    deadline = time.monotonic() + seconds

    def still(candidate):
        nonlocal trials, difference
        trials += 1
        try:
            found = examine(written(candidate), seed)
        except Refused:
            return False
        if found is None or found.kind != difference.kind:
            return False
        difference = found
        return True

    spent = lambda: trials >= MAX_TRIALS or time.monotonic() > deadline
    progress = True
    while progress and not spent():
        progress = False
        for change in changes(root):
            if spent():
                break
            undo = change()
            if undo is None:
                continue
            if still(root):
                progress = True
            else:
                undo()
    return root, difference


def changes(root):
    """Yields the possible changes, large ones first. A change returns its undo function, or None if not applicable."""
    pairs = [(parent, child) for parent in root.iter() for child in parent]
    for parent, child in pairs:
        yield lambda parent=parent, child=child: remove(parent, child)
    for parent, child in pairs:
        if child.tag in UNWRAPPED:
            yield lambda parent=parent, child=child: unwrap(parent, child)
    for element in list(root.iter()):
        for name in list(element.attrib):
            yield lambda element=element, name=name: drop(element, name)


def remove(parent, child):
    if child not in list(parent):
        return None
    position = list(parent).index(child)
    parent.remove(child)
    return lambda: parent.insert(position, child)


def unwrap(parent, child):
    if child not in list(parent):
        return None
    position, inner = list(parent).index(child), list(child)
    parent.remove(child)
    for offset, grandchild in enumerate(inner):
        parent.insert(position + offset, grandchild)

    def undo():
        for grandchild in inner:
            parent.remove(grandchild)
        parent.insert(position, child)

    return undo


def drop(element, name):
    if name not in element.attrib:
        return None
    before = dict(element.attrib)
    del element.attrib[name]

    def undo():
        element.attrib.clear()
        element.attrib.update(before)

    return undo
