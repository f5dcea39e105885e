"""One element of a model that is built in Python."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterator
from typing import Protocol

from clench._check import check, limit
from clench._document import Document, Value, file_of, written


class Attachable(Protocol):
    """A model that can be attached, such as a `ModelSpec`."""

    @property
    def _source(self) -> Document:
        """The document that is attached."""
        ...


class SpecElement:
    """An element of a `ModelSpec`: its attributes by name, as MJCF calls them, and what can be added below it.

    Attributes are read as text, ``element["pos"]``, and set from text, truth values, numbers or arrays of them; ``del`` leaves one at its
    default. Keywords of Python take an underscore: ``class_="visual"``.

    Parameters
    ----------
    document : Document
        What it is an element of.
    node : xml.etree.ElementTree.Element
        The element in the document.
    ancestors : tuple of xml.etree.ElementTree.Element, optional
        What it stands in, the section first; if not given, it is looked for when it is first needed.
    """

    def __init__(self, document: Document, node: ET.Element, ancestors: tuple[ET.Element, ...] | None = None) -> None:
        self._document = document
        self._node = node
        self._ancestors = ancestors

    @property
    def tag(self) -> str:
        """What MJCF calls it, such as "geom" or "motor"."""
        return self._node.tag

    @property
    def name(self) -> str:
        """Its name, possibly empty."""
        return self._node.get("name", "")

    @property
    def attributes(self) -> dict[str, str]:
        """A copy of its attributes."""
        return dict(self._node.attrib)

    def __getitem__(self, attribute: str) -> str:
        try:
            return self._node.attrib[attribute]
        except KeyError:
            raise KeyError(f"{self._described()} does not say {attribute!r}") from None

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
        """The elements directly below it; of an ``attach`` those that it puts there."""
        document, nodes = self._document, list(self._node)
        if self._node.tag == "attach" and self._node.get("model") in document.attached:
            document, nodes = document.shown_in(self._node)
        return (SpecElement(document, node) for node in nodes)

    def add(self, tag: str, /, **attributes: Value) -> SpecElement:
        """Add an element below this one.

        Parameters
        ----------
        tag : str
            What MJCF calls it.
        **attributes : str, bool or array_like
            Its attributes; an underscore at the end of a name does not count.

        Returns
        -------
        SpecElement

        Raises
        ------
        ValueError
            A name that another element of its kind has.
        LoadError
            A tag or an attribute that MJCF does not have here, a value that cannot be, a name that leads nowhere.
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
        """The section that it stands in, or is."""
        path = self._path()
        return path[0].tag if path else self._node.tag

    def _path(self) -> tuple[ET.Element, ...]:
        """What it stands in, the section first; nothing for a section."""
        if self._ancestors is None:
            parents, path, node = self._document.parents(), [], self._node
            while parents.get(node, self._document.root) is not self._document.root:
                node = parents[node]
                path.append(node)
            self._ancestors = tuple(reversed(path))
        return self._ancestors

    def _check_or_restore(self, before: dict[str, str]) -> None:
        """Refuse what is wrong with the element, which then is as it was before. What a range implies is switched on."""
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
        """Add a body below this body or frame.

        Parameters
        ----------
        **attributes : str, bool or array_like
            Its attributes, as MJCF calls them.
        """
        return self.add("body", **attributes)

    def add_joint(self, **attributes: Value) -> SpecElement:
        """Add a joint to this body.

        Parameters
        ----------
        **attributes : str, bool or array_like
            Its attributes, as MJCF calls them.
        """
        return self.add("joint", **attributes)

    def add_freejoint(self, **attributes: Value) -> SpecElement:
        """Add a free joint to this body, below the world.

        Parameters
        ----------
        **attributes : str, bool or array_like
            Its attributes, as MJCF calls them.
        """
        return self.add("freejoint", **attributes)

    def add_geom(self, **attributes: Value) -> SpecElement:
        """Add a geom to this body or frame.

        Parameters
        ----------
        **attributes : str, bool or array_like
            Its attributes, as MJCF calls them.
        """
        return self.add("geom", **attributes)

    def add_site(self, **attributes: Value) -> SpecElement:
        """Add a site to this body or frame.

        Parameters
        ----------
        **attributes : str, bool or array_like
            Its attributes, as MJCF calls them.
        """
        return self.add("site", **attributes)

    def add_camera(self, **attributes: Value) -> SpecElement:
        """Add a camera to this body or frame.

        Parameters
        ----------
        **attributes : str, bool or array_like
            Its attributes, as MJCF calls them.
        """
        return self.add("camera", **attributes)

    def add_frame(self, **attributes: Value) -> SpecElement:
        """Add a frame to this body or frame: what is added to it is placed in its coordinates.

        Parameters
        ----------
        **attributes : str, bool or array_like
            Its attributes, as MJCF calls them.
        """
        return self.add("frame", **attributes)

    def attach(self, other: Attachable, *, prefix: str, body: str | None = None) -> SpecElement:
        """Attach another model below this body or frame.

        Its elements become elements of this model, whose names begin with `prefix`: they are found, changed, renamed, removed and
        referred to as all others are. They are read with the units, classes and rules for inertia of their own model.

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
            The model. A copy of it as it is now is attached: it may be changed and attached again, which does not change this model.
        prefix : str
            What the names of its elements begin with here; no other attached model may have it.
        body : str, optional
            The body of it that is attached, with all below and what refers to no other part of the tree; if not given, all that its
            world holds.

        Returns
        -------
        SpecElement
            The ``attach`` element. To remove it is to remove all that it brought.

        Raises
        ------
        ValueError
            A prefix or a name that is taken; files of the same name and other contents; a body that the model does not have.
        """
        document = self._document
        name = document.attach(other._source, prefix, body)
        assets = document.root.find("asset")
        section = ET.SubElement(document.root, "asset") if assets is None else assets
        SpecElement(document, section).add("model", name=name, file=file_of(name))
        # The names have their prefix already.
        return self.add("attach", model=name, prefix="", **({} if body is None else {"body": prefix + body}))

    def remove(self) -> None:
        """Remove this element, all below it, and what refers to any of them: sensors of a joint go with the joint."""
        if self._node not in self._document.parents():
            raise ValueError(f"{self._described()} is removed already, or is the document itself")
        self._document.remove(self._node)

    def rename(self, name: str) -> None:
        """Give it another name, here and wherever it is referred to.

        Parameters
        ----------
        name : str
            The name.

        Raises
        ------
        ValueError
            A name that another element of its kind has.
        """
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
