"""Elements of a model that is built in Python."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterator
from typing import Protocol

from clench._check import check, limit
from clench._document import Document, Value, file_of, text_of, written
from clench._files import named
from clench._keyframes import kept


class Attachable(Protocol):
    """A model that can be attached, such as a `ModelSpec`."""

    @property
    def _source(self) -> Document:
        """Returns the document to attach."""
        ...


class SpecElement:
    """An element of a `ModelSpec`: its attributes with MJCF's names, and methods that add elements below it.

    Attributes are read as text, ``element["pos"]``, and set from text, booleans, numbers or arrays of them; ``del``
    restores the default. Names that are Python keywords take an underscore: ``class_="visual"``.

    Parameters
    ----------
    document : Document
        The document that contains it.
    node : xml.etree.ElementTree.Element
        The element in the document.
    ancestors : tuple of xml.etree.ElementTree.Element, optional
        The enclosing elements, the section first; by default they are looked up when first needed.
    """

    # Without a dictionary of attributes, ``element.pos = ...`` raises an error.
    __slots__ = ("_ancestors", "_document", "_node")

    def __init__(self, document: Document, node: ET.Element, ancestors: tuple[ET.Element, ...] | None = None) -> None:
        self._document = document
        self._node = node
        self._ancestors = ancestors

    @property
    def tag(self) -> str:
        """MJCF's name of the element, such as "geom" or "motor"."""
        return self._node.tag

    @property
    def name(self) -> str:
        """Its name, possibly empty; meshes, height fields and textures without one have that of their file."""
        return named(self._node) if self.tag in ("mesh", "hfield", "texture") else self._node.get("name", "")

    @property
    def attributes(self) -> dict[str, str]:
        """A copy of its attributes."""
        return dict(self._node.attrib)

    def __getitem__(self, attribute: str) -> str:
        try:
            return self._node.attrib[attribute]
        except KeyError:
            raise KeyError(f"{self._described()} has no attribute {attribute!r}") from None

    def __setitem__(self, attribute: str, value: Value) -> None:
        self._document.check_name(self._section(), self._node, attribute, value)
        before = dict(self._node.attrib)
        self._node.set(attribute, written(value))
        self._check_or_restore(before)
        if attribute in ("name", "file"):
            self._document.changed()

    def __delitem__(self, attribute: str) -> None:
        self[attribute]
        del self._node.attrib[attribute]
        self._document.changed()

    def __contains__(self, attribute: str) -> bool:
        return attribute in self._node.attrib

    def __iter__(self) -> Iterator[SpecElement]:
        """Iterates over the elements directly below it; for an ``attach`` element, over those that it inserts."""
        document, nodes = self._document, list(self._node)
        if self._node.tag == "attach" and self._node.get("model") in document.attached:
            document, nodes = document.shown_in(self._node)
        return (SpecElement(document, node) for node in nodes)

    def add(self, tag: str, /, **attributes: Value) -> SpecElement:
        """Adds an element below this one.

        Parameters
        ----------
        tag : str
            MJCF's name of the element.
        **attributes : str, bool or array_like
            Its attributes; an underscore at the end of a name is ignored.

        Returns
        -------
        SpecElement

        Raises
        ------
        ValueError
            If another element of its kind has the name.
        LoadError
            If MJCF does not have the tag or attribute here, a value is invalid, or a name is undefined.
        """
        node = ET.Element(tag)
        self._node.append(node)
        ancestors = (*self._path(), self._node) if self._node is not self._document.root else ()
        element = SpecElement(self._document, node, ancestors)
        try:
            for name, value in attributes.items():
                name = name.removesuffix("_")
                self._document.check_name(element._section(), node, name, value)
                node.set(name, written(value))
            element._check_or_restore({})
        except (TypeError, ValueError):
            self._node.remove(node)
            raise
        self._document.added(element._section(), node)
        return element

    def _section(self) -> str:
        """Returns the tag of the section that contains it, or of itself if it is a section."""
        path = self._path()
        return path[0].tag if path else self._node.tag

    def _path(self) -> tuple[ET.Element, ...]:
        """Returns the enclosing elements, the section first; empty for a section."""
        if self._ancestors is None:
            parents, path, node = self._document.parents(), [], self._node
            while parents.get(node, self._document.root) is not self._document.root:
                node = parents[node]
                path.append(node)
            self._ancestors = tuple(reversed(path))
        return self._ancestors

    def _check_or_restore(self, before: dict[str, str]) -> None:
        """Rejects an invalid element and restores its attributes. Switches on the limits whose ranges are set."""
        node = self._node
        node.attrib.update(limit(self._document, node))
        try:
            check(self._document, self._path(), node)
        except ValueError:
            node.attrib.clear()
            node.attrib.update(before)
            self._document.changed()
            raise

    def add_body(self, **attributes: Value) -> SpecElement:
        """Adds a body below this body or frame.

        Parameters
        ----------
        **attributes : str, bool or array_like
            Its attributes, with MJCF's names.

        Returns
        -------
        SpecElement

        Raises
        ------
        ValueError
            If another element of its kind has the name.
        LoadError
            If MJCF does not have a body here or an attribute, a value is invalid, or a name is undefined.
        """
        return self.add("body", **attributes)

    def add_joint(self, **attributes: Value) -> SpecElement:
        """Adds a joint to this body.

        Parameters
        ----------
        **attributes : str, bool or array_like
            Its attributes, with MJCF's names.

        Returns
        -------
        SpecElement

        Raises
        ------
        ValueError
            If another element of its kind has the name.
        LoadError
            If MJCF does not have a joint here or an attribute, a value is invalid, or a name is undefined.
        """
        return self.add("joint", **attributes)

    def add_freejoint(self, **attributes: Value) -> SpecElement:
        """Adds a free joint to this body, which must be a child of the world.

        Parameters
        ----------
        **attributes : str, bool or array_like
            Its attributes, with MJCF's names.

        Returns
        -------
        SpecElement

        Raises
        ------
        ValueError
            If another element of its kind has the name.
        LoadError
            If MJCF does not have a free joint here or an attribute, a value is invalid, or a name is undefined.
        """
        return self.add("freejoint", **attributes)

    def add_geom(self, **attributes: Value) -> SpecElement:
        """Adds a geom to this body or frame.

        Parameters
        ----------
        **attributes : str, bool or array_like
            Its attributes, with MJCF's names.

        Returns
        -------
        SpecElement

        Raises
        ------
        ValueError
            If another element of its kind has the name.
        LoadError
            If MJCF does not have a geom here or an attribute, a value is invalid, or a name is undefined.
        """
        return self.add("geom", **attributes)

    def add_site(self, **attributes: Value) -> SpecElement:
        """Adds a site to this body or frame.

        Parameters
        ----------
        **attributes : str, bool or array_like
            Its attributes, with MJCF's names.

        Returns
        -------
        SpecElement

        Raises
        ------
        ValueError
            If another element of its kind has the name.
        LoadError
            If MJCF does not have a site here or an attribute, a value is invalid, or a name is undefined.
        """
        return self.add("site", **attributes)

    def add_camera(self, **attributes: Value) -> SpecElement:
        """Adds a camera to this body or frame.

        Parameters
        ----------
        **attributes : str, bool or array_like
            Its attributes, with MJCF's names.

        Returns
        -------
        SpecElement

        Raises
        ------
        ValueError
            If another element of its kind has the name.
        LoadError
            If MJCF does not have a camera here or an attribute, a value is invalid, or a name is undefined.
        """
        return self.add("camera", **attributes)

    def add_frame(self, **attributes: Value) -> SpecElement:
        """Adds a frame to this body or frame: elements below it are placed in its coordinates.

        Parameters
        ----------
        **attributes : str, bool or array_like
            Its attributes, with MJCF's names.

        Returns
        -------
        SpecElement

        Raises
        ------
        ValueError
            If another element of its kind has the name.
        LoadError
            If MJCF does not have a frame here or an attribute, a value is invalid, or a name is undefined.
        """
        return self.add("frame", **attributes)

    def attach(self, other: Attachable, *, prefix: str, body: str | None = None) -> SpecElement:
        """Attaches another model below this body or frame.

        Its elements become elements of this model, with names that begin with `prefix`: they are found, changed,
        renamed, removed and referred to like all others. They are read with the units, classes and inertia rules of
        their own model. Keyframes of this model retain the numbers of its joints, if it can be built; attached joints
        before them get their initial positions. Actuators, sensors, tendons and constraints of this model come before
        those of attached models, which have the order of the body tree; in MuJoCo, the order is that of the calls.

        >>> hand = clench.ModelSpec("hand")
        >>> _ = hand.world.add_body(name="palm").add_geom(size=0.1)
        >>> arm = clench.ModelSpec("arm")
        >>> _ = arm.world.add_body(name="tip", pos=[0, 0, 1]).attach(hand, prefix="g_")
        >>> arm.body("g_palm")["pos"] = [0, 0, 0.1]
        >>> arm.build().body("g_palm").name
        'g_palm'

        Parameters
        ----------
        other : ModelSpec
            The model. A copy of its current version is attached: later changes to it do not affect this model, and it
            may be attached again.
        prefix : str
            The prefix of the names of its elements; no other attached model may have it.
        body : str, optional
            The body to attach, with its subtree and everything that refers to no other part of the tree; by default all
            contents of the world.

        Returns
        -------
        SpecElement
            The ``attach`` element. Removing it removes everything that it attached.

        Raises
        ------
        ValueError
            If the prefix or a name is taken, files have the same name but different contents, the model does not have
            the body, or this element is neither a body nor a frame.
        LoadError
            If the other model attaches files and cannot be built.
        """
        document = self._document
        if self.tag not in ("worldbody", "body", "frame", "replicate"):
            raise ValueError(f"nothing can be attached to {self._described()}, only to a body or frame")
        with kept(document):
            name = document.attach(other._source, text_of(prefix), body)
            assets = document.root.find("asset")
            section = ET.SubElement(document.root, "asset") if assets is None else assets
            SpecElement(document, section).add("model", name=name, file=file_of(name))
            # The names already have their prefix.
            return self.add("attach", model=name, prefix="", **({} if body is None else {"body": prefix + body}))

    def remove(self) -> None:
        """Removes this element, its descendants, and everything that refers to them: removing a joint removes its
        sensors. Elements with a removed material, texture or default class remain without it. If the model can be
        built, its keyframes lose the numbers of joints, actuators and mocap bodies that are removed.

        Raises
        ------
        ValueError
            If it was already removed, or is the document itself.
        """
        if self._node not in self._document.parents():
            raise ValueError(f"{self._described()} was already removed, or is the document itself")
        with kept(self._document):
            self._document.remove(self._node)

    def rename(self, name: str) -> None:
        """Renames this element and all references to it; for a ``default`` element, the class.

        Parameters
        ----------
        name : str
            The name.

        Raises
        ------
        ValueError
            If another element of its kind has the name, or it is empty.
        LoadError
            If the element cannot have a name.
        """
        if not name:
            raise ValueError("a new name must not be empty")
        if self.tag == "default":
            self._document.rename_class(self._node, text_of(name))
            return
        old = self.name
        kind = self._document.kind_of(self._node)
        self["name"] = name
        if kind and old:
            for _, node, attribute in self._document.references(kind, old):
                node.set(attribute, name)
            self._document.changed()

    def _described(self) -> str:
        return f'{self.tag} "{self.name}"' if self.name else f"a {self.tag}"

    def __repr__(self) -> str:
        return f"<clench.SpecElement: {self._described()}>"
