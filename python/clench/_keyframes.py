"""Keyframes of a document whose joints, actuators, tendons or mocap bodies become more or fewer.

A keyframe lists the numbers of all elements in order. The order is that of the built model, so the document is built
before and after a change, with names for the elements that have none.
"""

from __future__ import annotations

import copy
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
from numpy.typing import NDArray

from clench._core import Model
from clench._document import Document, file_of
from clench.errors import LoadError

# The attributes of a keyframe that have numbers of elements.
_VECTORS = ("qpos", "qvel", "act", "plastic", "ctrl", "mpos", "mquat")
_WIDTHS = {"qpos": (7, 4, 1, 1), "qvel": (6, 3, 1, 1)}
# A keyframe without numbers, which the loader completes.
_INITIAL = "the initial state"
# The kind and the name of an element, and the index of a number among its numbers.
_Label = tuple[str, str, int]


@contextmanager
def kept(document: Document) -> Iterator[None]:
    """Changes the keyframes of a document, and of those that it is attached to, so that each element retains its
    numbers when elements are added or removed.

    New elements between others get their initial values. Nothing is changed if a document cannot be built yet.
    """
    texts = [(other, _files(other)) for other in document.enclosing() if _vectors(other)]
    yield
    for other, before in texts:
        after = _files(other)
        if _vectors(other) and _counted(before) != _counted(after):
            _move(other, before, after)


def _vectors(document: Document) -> list[tuple[ET.Element, str]]:
    """Returns the keyframes of a document with the names of their vectors."""
    keys = document.root.iterfind("keyframe/key")
    return [(key, name) for key in keys for name in _VECTORS if name in key.attrib]


def _numbered(section: ET.Element) -> Iterator[ET.Element]:
    """Iterates over the elements of a section that can have numbers in a keyframe."""
    if section.tag == "worldbody":
        yield from (node for node in section.iter() if node.tag in ("body", "joint", "freejoint", "attach"))
    elif section.tag in ("actuator", "tendon"):
        yield from section


def _named(document: Document) -> ET.Element:
    """Returns a copy of a document without keyframes, and with names for unnamed elements."""
    root = copy.deepcopy(document.root)
    for section, twin in zip(document.root, root):
        for node, named in zip(_numbered(section), _numbered(twin)):
            if node.tag != "attach" and not node.get("name"):
                # It has the same name after the change.
                named.set("name", f"unnamed {id(node)} ")
    for section in root.findall("keyframe"):
        root.remove(section)
    return root


def _files(document: Document) -> dict[str, bytes]:
    """Returns the text of a document, under an empty name, and those of the documents attached to it."""
    attached = {file_of(name): inner for other in document.family() for name, inner in other.attached.items()}
    roots = {name: _named(other) for name, other in {"": document, **attached}.items()}
    ET.SubElement(ET.SubElement(roots[""], "keyframe"), "key", name=_INITIAL)
    return {name: ET.tostring(root) for name, root in roots.items()}


def _counted(files: dict[str, bytes]) -> list[tuple[str, str, str | None, str | None]]:
    """Returns what determines the numbers of elements, unless the elements themselves change."""
    return [
        (name, node.tag, node.get("name"), node.get("model"))
        for name, text in files.items()
        for section in ET.fromstring(text)
        for node in _numbered(section)
    ]


def _built(document: Document, files: dict[str, bytes]) -> Model | None:
    """Builds a document from its texts; returns None if that is impossible."""
    assets = {**document.first().assets, **{name: text for name, text in files.items() if name}}
    try:
        return Model.from_xml(files[""].decode(), assets=assets, ignore_unsupported=True)
    except LoadError:
        return None


def _move(document: Document, before: dict[str, bytes], after: dict[str, bytes]) -> None:
    """Moves the numbers of the keyframes of a document to the new places of their elements."""
    old, new = _built(document, before), _built(document, after)
    if old is None or new is None:
        return
    for key, name in _vectors(document):
        numbers, found = key.attrib[name].split(), _labels(old, name)
        if len(numbers) > len(found):
            continue
        values = dict(zip(found, numbers))
        initial: NDArray[np.float64] = getattr(new.keyframe(_INITIAL), name).ravel()
        labels = _labels(new, name)
        # Numbers at the end may be missing.
        last = max((k for k, label in enumerate(labels) if label in values), default=-1)
        text = [values.get(label, repr(float(initial[k]))) for k, label in enumerate(labels[: last + 1])]
        if text:
            key.set(name, " ".join(text))
        else:
            del key.attrib[name]


def _labels(model: Model, vector: str) -> list[_Label]:
    """Returns the element of each number of a vector of a keyframe, in order."""
    joints, actuators, bodies = model.names("joint"), model.names("actuator"), model.names("body")
    parts: list[tuple[int, int, str, str]] = []
    if vector in _WIDTHS:
        starts = model.jnt_qposadr if vector == "qpos" else model.jnt_dofadr
        widths = [_WIDTHS[vector][kind] for kind in model.jnt_type]
        parts += zip(starts, widths, ["joint"] * len(joints), joints)
    elif vector in ("ctrl", "act"):
        starts = model.actuator_ctrladr if vector == "ctrl" else model.actuator_actadr
        widths = [*(model.actuator_ctrlnum if vector == "ctrl" else model.actuator_actnum)]
        parts += zip(starts, widths, ["actuator"] * len(actuators), actuators)
    elif vector == "plastic":
        widths = [_WIDTHS["qpos"][kind] for kind in model.jnt_type]
        parts += zip(model.jnt_plasticadr, widths, ["joint"] * len(joints), joints)
        tendons = model.names("tendon")
        parts += zip(model.tendon_plasticadr, [2] * len(tendons), ["tendon"] * len(tendons), tendons)
    else:
        width = 3 if vector == "mpos" else 4
        parts += ((index * width, width, "body", name) for index, name in zip(model.body_mocapid, bodies))
    return [(kind, name, k) for start, width, kind, name in sorted(parts) if start >= 0 for k in range(width)]
