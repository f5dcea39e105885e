"""MJCF documents: named elements, and references to them.

Tables of MJCF's tags and attributes define what can be named and what refers to names. The files that a document names
are read in `_files.py`. The user's API of a document is in `_spec.py`.

An attached model remains a document of its own, since its elements are read with its own units and classes. Its names
already have the prefix. A document and all documents attached to it, directly or indirectly, are a family, in which no
two elements of a kind have the same name.
"""

from __future__ import annotations

import copy
import re
import xml.etree.ElementTree as ET
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from clench._files import Files, named, parsed, read

Value: TypeAlias = str | bool | ArrayLike

# Attributes that name an element of a fixed kind.
_REFERENCES = {
    "body": ("body", "body1", "body2", "subtree1", "subtree2", "target"),
    "joint": ("joint", "joint1", "joint2", "jointinparent"),
    "geom": ("geom", "geom1", "geom2"),
    "site": ("site", "site1", "site2", "refsite", "sidesite", "cranksite", "slidersite"),
    "tendon": ("tendon", "tendon1", "tendon2"),
    "actuator": ("actuator",),
    "camera": ("camera",),
    "mesh": ("mesh",),
    "hfield": ("hfield",),
    "material": ("material",),
    "texture": ("texture",),
    "model": ("model",),
    "frame": ("frame",),
}
# Attributes that name an element whose kind is the value of another attribute.
_TYPED = {"objname": "objtype", "refname": "reftype"}
# Kinds that are not the tag of their elements: all elements of these sections.
_SECTIONS = {"tendon": "tendon", "actuator": "actuator", "sensor": "sensor", "equality": "equality"}
_TAGS = {
    "joint": ("joint", "freejoint"),
    "keyframe": ("key",),
    "frame": ("frame",),
    "pair": ("pair",),
    **{kind: (kind,) for kind in ("body", "geom", "site", "camera", "mesh", "hfield", "material", "texture", "model")},
}
# Characters that no XML document contains.
_NOT_IN_XML = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
# Sections without names.
_SETTINGS = ("compiler", "option", "size", "statistic", "visual")
# Sections whose names refer to nothing that can be renamed or removed, except assets that default classes name.
_NO_REFERENCES = ("default", "custom", *_SETTINGS)
_ASSETS = ("mesh", "hfield", "material", "texture")
# Attributes that name a default class, and the outermost class if it has no other name. It always exists.
_CLASSES = ("class", "childclass")
MAIN = "main"
# Kinds without which an element remains what it is.
_LOOKS = ("material", "texture")


def written(value: Value) -> str:
    """Formats an attribute as in MJCF."""
    if isinstance(value, str):
        return text_of(value)
    array = np.asarray(value)
    if array.dtype.kind == "b":
        if array.ndim > 0:
            raise TypeError("MJCF has no lists of truth values")
        return "true" if array else "false"
    if array.dtype.kind == "U":
        return text_of(" ".join(array.ravel().tolist()))
    if array.dtype.kind not in "iuf":
        raise TypeError(f"an attribute is a str, a bool or numbers, not {type(value).__name__}")
    # The shortest text that parses to the same number.
    return " ".join(repr(number) for number in array.ravel().tolist())


def text_of(text: str) -> str:
    """Returns a text. Rejects one with characters that XML does not allow, and what is no text."""
    if not isinstance(text, str):
        raise TypeError(f"a name is a str, not {type(text).__name__}")
    if found := _NOT_IN_XML.search(text):
        raise ValueError(f"{text!r} has the character {found[0]!r}, which XML does not allow")
    return text


class Document(Files):
    """A document with the files that it names, which the first document of a family stores."""

    def __init__(self, root: ET.Element) -> None:
        super().__init__(root)
        # The attached documents by the names of their `model` elements, and the document that this one is attached to.
        self.attached: dict[str, Document] = {}
        self._outer: Document | None = None
        # Elements that are omitted if a single body is attached.
        self._hidden: set[ET.Element] = set()
        # The elements of the family by kind and name; None if the index must be rebuilt.
        self._names: dict[tuple[str, str], tuple[Document, ET.Element]] | None = None
        self._has_copies = False

    @staticmethod
    def from_text(text: str, assets: Mapping[str, bytes]) -> Document:
        """Creates a document from its text and the files that it includes or names."""
        document = Document(parsed(text, ""))
        document.add_files(assets)
        document.expand(Path(), "")
        return document

    @staticmethod
    def from_file(path: Path) -> Document:
        """Reads a document from a file, with everything that it includes and names."""
        document = Document(parsed(read(path, str(path)).decode("utf-8", "replace"), str(path)))
        origins = document.expand(path.parent, str(path))
        for name, model in document.read_assets(path.parent, origins).items():
            other = Document.from_file(model)
            document.add_files(other.assets)
            document.assets[name] = other.text().encode()
        return document

    def text(self) -> str:
        """Returns its text, without the text of attached documents."""
        root = copy.deepcopy(self.root)
        ET.indent(root)
        return ET.tostring(root, encoding="unicode")

    def files(self) -> dict[str, bytes]:
        """Returns the files that its text names, including attached documents."""
        texts = {file_of(name): document.text().encode() for document in self.family() for name, document in document.attached.items()}
        return {**self.first().assets, **texts}

    # The family.

    def first(self) -> Document:
        """Returns the root document of the family."""
        return self if self._outer is None else self._outer.first()

    def enclosing(self) -> Iterator[Document]:
        """Iterates over this document, the one that it is attached to, and so on."""
        yield self
        if self._outer is not None:
            yield from self._outer.enclosing()

    def family(self) -> Iterator[Document]:
        """Iterates over this document and all documents attached to it."""
        yield self
        for document in self.attached.values():
            yield from document.family()

    def attach(self, other: Document, prefix: str, body: str | None) -> str:
        """Attaches a copy of a document with a prefix on its names; if a body is given, only that body and what belongs
        to it.

        Returns the name of the copy in `attached`.
        """
        name = f"{prefix}model"
        if any(name in document.attached for document in self.first().family()):
            raise ValueError(f"a model is already attached with the prefix {prefix!r}")
        own = other._prefixed(prefix)
        if body is not None:
            found = own.find("body", f"{prefix}{body}")
            if found is None:
                raise ValueError(f'the attached model has no body "{body}"')
            found[0]._hide_all_but(found[1])
        for kind, taken in own._index():
            if self.find(kind, taken) is not None:
                raise ValueError(_taken(kind, taken))
        self.first().add_files(own.assets)
        self.first().folders.update(own.folders)
        own.assets, own.folders, own._outer = {}, {}, self
        self.attached[name] = own
        self.changed()
        return name

    def attaches_files(self) -> bool:
        """Returns true if an element of the family attaches a file, or a part of its own document."""
        return any(
            node.tag == "attach" and node.get("model") not in document.attached
            for document in self.family()
            for node, _ in document.nodes()
        )

    def _prefixed(self, prefix: str) -> Document:
        own = copy.deepcopy(self)
        for document in own.family():
            for section in document.root:
                if section.tag not in _SETTINGS:
                    for node in section.iter():
                        _prefix(node, prefix)
            document.attached = {prefix + name: attached for name, attached in document.attached.items()}
            for name in document.attached:
                for model in document.root.iterfind(f"asset/model[@name='{name}']"):
                    model.set("file", file_of(name))
        own.changed()
        return own

    def _hide_all_but(self, body: ET.Element) -> None:
        """Hides all other bodies, and everything that refers to them."""
        less = copy.deepcopy(self)
        copies = dict(zip(self.root.iter(), less.root.iter(), strict=True))
        less.parents()[copies[body]].remove(copies[body])
        for world in less.root.findall("worldbody"):
            while len(world):  # Removing a body also removes cameras and lights that follow it.
                less.remove(world[0])
        left = {*less.root.iter(), *copies[body].iter()}
        self._hidden |= {node for node, other in copies.items() if other not in left}

    def shown_in(self, attachment: ET.Element) -> tuple[Document, list[ET.Element]]:
        """Returns the elements that replace an attachment, with their document."""
        own = self.attached[attachment.get("model", "")]
        if (body := attachment.get("body")) is not None:
            return own, [node for node in own.elements("body") if node.get("name") == body]
        return own, [node for world in own.root.findall("worldbody") for node in world]

    def _detach(self, name: str) -> list[tuple[str, str]]:
        """Removes an attached document. Returns the kinds and names of its elements."""
        own = self.attached.pop(name, None)
        if own is None:
            return []
        for section in self.root.findall("asset"):
            for model in section.findall(f"model[@name='{name}']"):
                section.remove(model)
        gone = [(document, node, section) for document in own.family() for node, section in document.nodes()]
        return [(kind, named(node)) for _, node, section in gone if (kind := _kind(node, section))]

    # Names and references.

    def nodes(self) -> Iterator[tuple[ET.Element, str]]:
        """Iterates over all elements, with their sections."""
        for section in self.root:
            for node in section.iter():
                if node not in self._hidden:
                    yield node, section.tag

    def elements(self, kind: str) -> list[ET.Element]:
        """Returns the elements of a kind in this document and those attached to it."""
        return [node for document in self.family() for node, section in document.nodes() if _kind(node, section) == kind]

    def _index(self) -> dict[tuple[str, str], tuple[Document, ET.Element]]:
        first = self.first()
        if first._names is None:
            first._names, first._has_copies = {}, False
            for document in first.family():
                for node, section in document.nodes():
                    document.added(section, node)
        return first._names

    def added(self, section: str, node: ET.Element) -> None:
        """Updates the index after a node was added to a section or got its first name."""
        first = self.first()
        if first._names is None:
            return
        first._has_copies |= node.tag == "replicate" or (node.tag == "attach" and node.get("model") not in self.attached)
        kind = _kind(node, section)
        if kind and (name := named(node)):
            first._names.setdefault((kind, name), (self, node))

    def changed(self) -> None:
        """Invalidates the index after a node was removed or renamed."""
        self.first()._names = None

    def has_copies(self) -> bool:
        """Returns true if some names are created when the model is built: those of replicas, and of models that a file
        attaches."""
        self._index()
        return self.first()._has_copies

    def kind_of(self, node: ET.Element) -> str | None:
        """Returns the kind of a node that can have a name; None for references, defaults and the like."""
        section = next((tag for other, tag in self.nodes() if other is node), None)
        return _kind(node, section)

    def find(self, kind: str, name: str) -> tuple[Document, ET.Element] | None:
        """Returns the element with this kind and name, with its document."""
        check_kind(kind)
        return self._index().get((kind, name))

    def check_name(self, section: str, node: ET.Element, attribute: str, value: Value) -> None:
        """Rejects a name that another element of its kind has."""
        if attribute != "name":
            return
        kind = _kind(node, section)
        taken = self.find(kind, written(value)) if kind else None
        if taken is not None and taken[1] is not node:
            raise ValueError(_taken(kind, written(value)))

    def parents(self) -> dict[ET.Element, ET.Element]:
        return {child: parent for parent in self.root.iter() for child in parent}

    def references(self, kind: str, name: str) -> list[tuple[Document, ET.Element, str]]:
        """Returns the attributes in the family that refer to an element."""
        found = []
        for document in self.first().family():
            for node, section in document.nodes():
                in_class = section == "default" and kind in _ASSETS
                if section in _NO_REFERENCES and node.tag != "element" and not in_class:
                    continue
                # A model that a file attaches has its own names.
                if node.tag == "attach" and kind != "model" and node.get("model", "") not in ("", *document.attached):
                    continue
                found += [(document, node, attribute) for attribute in _REFERENCES.get(kind, ()) if node.get(attribute) == name]
                for attribute, typed in _TYPED.items():
                    of_kind = node.get(typed) in ((kind, "xbody") if kind == "body" else (kind,))
                    if of_kind and node.get(attribute) == name:
                        found.append((document, node, attribute))
        return found

    def class_references(self, name: str) -> list[tuple[ET.Element, str]]:
        """Returns the attributes that refer to a default class of this document."""
        users = (node for node in self.root.iter() if node.tag != "default")
        return [(node, attribute) for node in users for attribute in _CLASSES if node.get(attribute) == name]

    def rename_class(self, node: ET.Element, name: str) -> None:
        """Renames a default class and the references to it."""
        taken = {part.get("class", MAIN) for part in self.root.iter("default") if part is not node}
        if name in taken:
            raise ValueError(f'there is already a default class "{name}"')
        for user, attribute in self.class_references(node.get("class", MAIN)):
            user.set(attribute, name)
        node.set("class", name)

    def remove(self, node: ET.Element) -> None:
        """Removes a node, its descendants, and all references to them. If it is an attachment, the attached document is
        removed too."""
        parent = self.parents()[node]
        gone = [(kind, named(part)) for part in node.iter() for kind in [self.kind_of(part)] if kind]
        gone += [name for part in node.iter("attach") for name in self._detach(part.get("model", ""))]
        classes = {part.get("class", MAIN) for part in node.iter("default")} - {MAIN}
        parent.remove(node)
        self.changed()
        for name in classes - {part.get("class") for part in self.root.iter("default")}:
            for user, attribute in self.class_references(name):
                del user.attrib[attribute]
        for kind, name in gone:
            if name:
                self._remove_references(kind, name)

    def _remove_references(self, kind: str, name: str) -> None:
        for document, node, attribute in self.references(kind, name):
            parents = document.parents()
            if node not in parents:
                continue
            section = next((tag for other, tag in document.nodes() if other is node), None)
            if section == "default" or (kind in _LOOKS and node.tag != "layer"):
                del node.attrib[attribute]
                continue
            # A tendon that loses a part would be a different tendon, so the whole tendon is removed.
            while parents[node].tag in ("spatial", "fixed") or (parents[node].tag == "tuple" and len(parents[node]) == 1):
                node = parents[node]
            document.remove(node)


def check_kind(kind: str) -> None:
    """Rejects an unknown kind of element."""
    if kind not in _TAGS and kind not in _SECTIONS:
        raise ValueError(f'there is no kind of element "{kind}": there are {", ".join([*_TAGS, *_SECTIONS])}')


def _taken(kind: str | None, name: str) -> str:
    """Returns the message that another element of a kind has a name."""
    return f'there is already {"an" if kind in ("actuator", "equality") else "a"} {kind} "{name}"'


def reference_kind(section: str, node: ET.Element, attribute: str) -> str | None:
    """Returns the kind of element that an attribute refers to; None if it refers to none, or to none that is
    indexed."""
    if (section in _NO_REFERENCES and node.tag != "element") or attribute == "model":
        return None
    if attribute in _TYPED:
        kind = node.get(_TYPED[attribute])
        return "body" if kind == "xbody" else kind if kind in _REFERENCES else None
    if _kind(node, section) == attribute:
        return None
    return next((kind for kind, attributes in _REFERENCES.items() if attribute in attributes), None)


def described(document: Document, node: ET.Element) -> str:
    """Describes an element by its path below its section: ``body "tip" / geom 2`` is the third geom of that body."""
    parents = document.parents()
    parts: list[str] = []
    while node in parents and parents[node] in parents:
        alike = [other for other in parents[node] if other.tag == node.tag]
        name = node.get("name")
        parts.append(f'{node.tag} "{name}"' if name else f"{node.tag} {alike.index(node)}")
        if name and parts[1:]:
            break
        node = parents[node]
    return " / ".join(reversed(parts)) or node.tag


def file_of(name: str) -> str:
    """Returns the file name of an attached document."""
    return f"{name}.xml"


def _prefix(node: ET.Element, prefix: str) -> None:
    """Adds a prefix to the name of an element and to the names that it refers to."""
    if node.tag in ("mesh", "hfield", "texture") and node.get("file"):
        node.set("name", named(node))
    for attribute, name in node.attrib.items():
        kind = node.get(_TYPED[attribute]) if attribute in _TYPED else next((k for k, of in _REFERENCES.items() if attribute in of), None)
        is_class = attribute in _CLASSES
        is_shared = name == (MAIN if is_class else "world" if kind in ("body", "xbody") else "")
        if (attribute == "name" or is_class or kind) and not is_shared:
            node.set(attribute, prefix + name)


def _kind(node: ET.Element, section: str | None) -> str | None:
    """Returns the kind of an element in a section of the document."""
    if section is None or section in _NO_REFERENCES:
        return None
    for kind, of in _SECTIONS.items():
        if section == of:
            # Elements deeper in a section are references, such as those of a tendon to its sites.
            return kind if "name" in node.attrib or node.tag not in ("site", "geom", "joint", "pulley", of) else None
    if section in ("worldbody", "asset", "keyframe", "contact"):
        return next((kind for kind, tags in _TAGS.items() if node.tag in tags), None)
    return None
