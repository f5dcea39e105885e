"""Models that are built and edited in Python, before they are models.

A `ModelSpec` is an MJCF document: what is added, changed and removed is what a file would say, and `ModelSpec.build` hands it to the
loader that reads files. So a model that is built steps like the one from such a file, to the bit, and all that a file can say can be
said here. What a name refers to is known from one table of MJCF's attributes.
"""

from __future__ import annotations

import copy
import xml.etree.ElementTree as ET
from collections.abc import Iterator, Mapping
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from clench.errors import LoadError

if TYPE_CHECKING:
    from clench._core import Model

__all__ = ["ModelSpec", "SpecElement"]

_Value: TypeAlias = str | bool | ArrayLike

# Attributes that name an element of a kind.
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
}
# Attributes that name an element whose kind stands in another attribute.
_TYPED = {"objname": "objtype", "refname": "reftype"}
# Elements of each kind where the tag is not the kind: whatever stands in these sections.
_SECTIONS = {"tendon": "tendon", "actuator": "actuator", "sensor": "sensor", "equality": "equality"}
_TAGS = {
    "joint": ("joint", "freejoint"),
    "keyframe": ("key",),
    "frame": ("frame",),
    "pair": ("pair",),
    **{kind: (kind,) for kind in ("body", "geom", "site", "camera", "mesh", "hfield", "material", "texture", "model")},
}
# Where names refer to nothing that can be renamed or removed.
_NO_REFERENCES = ("default", "custom", "compiler", "option", "size", "statistic", "visual")


def _text(value: _Value) -> str:
    """An attribute as MJCF writes it."""
    if isinstance(value, str):
        return value
    array = np.asarray(value)
    if array.dtype.kind == "b":
        if array.ndim > 0:
            raise TypeError("MJCF has no lists of truth values")
        return "true" if array else "false"
    if array.dtype.kind == "U":
        return " ".join(array.ravel().tolist())
    if array.dtype.kind not in "iuf":
        raise TypeError(f"an attribute is a str, a bool or numbers, not {type(value).__name__}")
    # The shortest text that reads as the same number.
    return " ".join(repr(number) for number in array.ravel().tolist())


class SpecElement:
    """An element of a `ModelSpec`: its attributes by name, as MJCF calls them, and what can be added below it.

    Attributes are read as text, ``element["pos"]``, and set from text, truth values, numbers or arrays of them; ``del`` leaves one at its
    default. Keywords of Python take an underscore: ``class_="visual"``.

    Parameters
    ----------
    spec : ModelSpec
        What it is an element of.
    node : xml.etree.ElementTree.Element
        The element in the document.
    """

    def __init__(self, spec: ModelSpec, node: ET.Element) -> None:
        self._spec = spec
        self._node = node

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

    def __setitem__(self, attribute: str, value: _Value) -> None:
        self._spec._check_name(self._node, attribute, value)
        self._node.set(attribute, _text(value))

    def __delitem__(self, attribute: str) -> None:
        self[attribute]
        del self._node.attrib[attribute]

    def __contains__(self, attribute: str) -> bool:
        return attribute in self._node.attrib

    def __iter__(self) -> Iterator[SpecElement]:
        """The elements directly below it."""
        return (SpecElement(self._spec, node) for node in list(self._node))

    def add(self, tag: str, /, **attributes: _Value) -> SpecElement:
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
        """
        node = ET.Element(tag)
        self._node.append(node)
        element = SpecElement(self._spec, node)
        try:
            for name, value in attributes.items():
                element[name.removesuffix("_")] = value
        except (TypeError, ValueError):
            self._node.remove(node)
            raise
        return element

    def add_body(self, **attributes: _Value) -> SpecElement:
        """Add a body below this body or frame.

        Parameters
        ----------
        **attributes : str, bool or array_like
            Its attributes, as MJCF calls them.
        """
        return self.add("body", **attributes)

    def add_joint(self, **attributes: _Value) -> SpecElement:
        """Add a joint to this body.

        Parameters
        ----------
        **attributes : str, bool or array_like
            Its attributes, as MJCF calls them.
        """
        return self.add("joint", **attributes)

    def add_freejoint(self, **attributes: _Value) -> SpecElement:
        """Add a free joint to this body, below the world.

        Parameters
        ----------
        **attributes : str, bool or array_like
            Its attributes, as MJCF calls them.
        """
        return self.add("freejoint", **attributes)

    def add_geom(self, **attributes: _Value) -> SpecElement:
        """Add a geom to this body or frame.

        Parameters
        ----------
        **attributes : str, bool or array_like
            Its attributes, as MJCF calls them.
        """
        return self.add("geom", **attributes)

    def add_site(self, **attributes: _Value) -> SpecElement:
        """Add a site to this body or frame.

        Parameters
        ----------
        **attributes : str, bool or array_like
            Its attributes, as MJCF calls them.
        """
        return self.add("site", **attributes)

    def add_camera(self, **attributes: _Value) -> SpecElement:
        """Add a camera to this body or frame.

        Parameters
        ----------
        **attributes : str, bool or array_like
            Its attributes, as MJCF calls them.
        """
        return self.add("camera", **attributes)

    def add_frame(self, **attributes: _Value) -> SpecElement:
        """Add a frame to this body or frame: what is added to it is placed in its coordinates.

        Parameters
        ----------
        **attributes : str, bool or array_like
            Its attributes, as MJCF calls them.
        """
        return self.add("frame", **attributes)

    def attach(self, other: ModelSpec, *, prefix: str, body: str | None = None) -> SpecElement:
        """Attach another model below this body or frame, as MJCF's ``attach``.

        Parameters
        ----------
        other : ModelSpec
            The model; as it is now, later changes do not count.
        prefix : str
            What the names of its elements begin with here; no other attached model may have it.
        body : str, optional
            The body of it that is attached, with all below; if not given, all that its world holds.

        Returns
        -------
        SpecElement
            The ``attach`` element.

        Raises
        ------
        ValueError
            A prefix that is taken; files of the same name and other contents.
        """
        spec = self._spec
        name = f"{prefix}model"
        if spec._find("model", name) is not None:
            raise ValueError(f"a model is attached with the prefix {prefix!r} already")
        file = f"{name}.xml"
        spec._add_files({**other.assets, file: other.to_xml().encode()})
        spec.add_asset("model", name=name, file=file)
        return self.add("attach", model=name, prefix=prefix, **({} if body is None else {"body": body}))

    def remove(self) -> None:
        """Remove this element, all below it, and what refers to any of them: sensors of a joint go with the joint."""
        spec = self._spec
        parent = spec._parents().get(self._node)
        if parent is None:
            raise ValueError(f"{self._described()} is removed already, or is the document itself")
        gone = [(kind, node.get("name", "")) for node in self._node.iter() for kind in [spec._kind_of(node)] if kind]
        parent.remove(self._node)
        for kind, name in gone:
            if name:
                spec._remove_references(kind, name)

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
        kind = self._spec._kind_of(self._node)
        self["name"] = name
        if kind and old:
            for node, attribute in self._spec._references(kind, old):
                node.set(attribute, name)

    def _described(self) -> str:
        return f'{self.tag} "{self.name}"' if self.name else f"a {self.tag}"

    def __repr__(self) -> str:
        return f"<clench.SpecElement: {self._described()}>"


class ModelSpec:
    """A model that is built or edited, and becomes a `Model` by `build`.

    Examples
    --------
    >>> spec = clench.ModelSpec("pendulum")
    >>> pole = spec.world.add_body(name="pole", pos=[0, 0, 1])
    >>> _ = pole.add_joint(name="hinge", axis=[0, 1, 0])
    >>> _ = pole.add_geom(type="capsule", fromto=[0, 0, 0, 0, 0, -0.5], size=0.05)
    >>> _ = spec.add_actuator("motor", joint="hinge")
    >>> spec.build().nu
    1

    Parameters
    ----------
    name : str
        Name of the model.
    """

    def __init__(self, name: str = "model") -> None:
        self._root = ET.Element("mujoco", model=name)
        self.assets: dict[str, bytes] = {}
        """Files that the document names, by name without folders: meshes, height fields, attached models."""

    @staticmethod
    def from_xml(text: str, assets: Mapping[str, bytes] | None = None) -> ModelSpec:
        """Begin with the text of an MJCF file.

        Parameters
        ----------
        text : str
            The text; what it includes must be in `assets`.
        assets : dict of str to bytes, optional
            Files that the text names.

        Returns
        -------
        ModelSpec

        Raises
        ------
        LoadError
            A text that is not well-formed, or is of another format.
        """
        spec = ModelSpec()
        spec._add_files(assets or {})
        spec._root = _parsed(text, "")
        spec._expand(Path(), "")
        return spec

    @staticmethod
    def from_file(path: str | PathLike[str]) -> ModelSpec:
        """Begin with a file, MJCF or URDF. Files that it names are read now.

        Parameters
        ----------
        path : str or os.PathLike
            The file. What it includes becomes part of the document; URDF becomes MJCF.

        Returns
        -------
        ModelSpec

        Raises
        ------
        LoadError
            A file that cannot be read or is not well-formed.
        """
        from clench._core import Model

        path = Path(path)
        spec = ModelSpec()
        text = _read(path, str(path)).decode("utf-8", "replace")
        root = ET.fromstring(text) if "<robot" in text else None
        if root is not None and root.tag == "robot":
            return ModelSpec.from_xml(Model.from_file(path).to_xml())
        spec._root = _parsed(text, str(path))
        spec._expand(path.parent, str(path))
        spec._read_assets(path.parent)
        return spec

    @property
    def name(self) -> str:
        """Name of the model."""
        return self._root.get("model", "")

    @name.setter
    def name(self, name: str) -> None:
        self._root.set("model", name)

    @property
    def world(self) -> SpecElement:
        """The world, to which bodies and what stands still are added."""
        return self.section("worldbody")

    def section(self, tag: str) -> SpecElement:
        """A section of the document, such as "option", "default" or "contact"; made if there is none.

        Parameters
        ----------
        tag : str
            What MJCF calls it.

        Returns
        -------
        SpecElement
        """
        node = self._root.find(tag)
        return SpecElement(self, ET.SubElement(self._root, tag) if node is None else node)

    def add_actuator(self, tag: str, /, **attributes: _Value) -> SpecElement:
        """Add an actuator: "motor", "position", "general" and so on.

        Parameters
        ----------
        tag : str
            What MJCF calls it.
        **attributes : str, bool or array_like
            Its attributes, as MJCF calls them.
        """
        return self.section("actuator").add(tag, **attributes)

    def add_sensor(self, tag: str, /, **attributes: _Value) -> SpecElement:
        """Add a sensor: "jointpos", "gyro", "touch" and so on.

        Parameters
        ----------
        tag : str
            What MJCF calls it.
        **attributes : str, bool or array_like
            Its attributes, as MJCF calls them.
        """
        return self.section("sensor").add(tag, **attributes)

    def add_equality(self, tag: str, /, **attributes: _Value) -> SpecElement:
        """Add an equality constraint: "weld", "connect", "joint" or "tendon".

        Parameters
        ----------
        tag : str
            What MJCF calls it.
        **attributes : str, bool or array_like
            Its attributes, as MJCF calls them.
        """
        return self.section("equality").add(tag, **attributes)

    def add_tendon(self, tag: str, /, **attributes: _Value) -> SpecElement:
        """Add a tendon, "fixed" or "spatial"; what it runs through is added to it.

        Parameters
        ----------
        tag : str
            What MJCF calls it.
        **attributes : str, bool or array_like
            Its attributes, as MJCF calls them.
        """
        return self.section("tendon").add(tag, **attributes)

    def add_keyframe(self, **attributes: _Value) -> SpecElement:
        """Add a keyframe.

        Parameters
        ----------
        **attributes : str, bool or array_like
            Its attributes, as MJCF calls them.
        """
        return self.section("keyframe").add("key", **attributes)

    def add_asset(self, tag: str, /, data: bytes | None = None, **attributes: _Value) -> SpecElement:
        """Add an asset: "mesh", "hfield", "material" and so on.

        Parameters
        ----------
        tag : str
            What MJCF calls it.
        data : bytes, optional
            What its ``file`` holds, if that is not on the disk.
        **attributes : str, bool or array_like
            Its attributes.

        Returns
        -------
        SpecElement
        """
        if data is not None:
            if "file" not in attributes:
                raise ValueError("data without the name of a file")
            self._add_files({_text(attributes["file"]): data})
        return self.section("asset").add(tag, **attributes)

    def names(self, kind: str) -> list[str]:
        """Names of all elements of a kind, in the order of the document; those without one are left out.

        Parameters
        ----------
        kind : str
            "body", "joint", "geom", "site", "actuator", "sensor" and so on.
        """
        return [name for node in self._elements(kind) if (name := node.get("name"))]

    def find(self, kind: str, name: str) -> SpecElement:
        """The element of that kind and name.

        Parameters
        ----------
        kind : str
            "body", "joint", "geom", "site", "camera", "tendon", "actuator", "sensor", "equality", "keyframe", "frame", "mesh" and so on.
        name : str

        Returns
        -------
        SpecElement

        Raises
        ------
        ValueError
            A name that none has.
        """
        node = self._find(kind, name)
        if node is None:
            known = ", ".join(self.names(kind)[:10])
            raise ValueError(f'there is no {kind} "{name}"' + (f": there are {known}" if known else ""))
        return SpecElement(self, node)

    def body(self, name: str) -> SpecElement:
        """The body of that name; "world" is the world.

        Parameters
        ----------
        name : str
            The name.
        """
        return self.world if name == "world" else self.find("body", name)

    def joint(self, name: str) -> SpecElement:
        """The joint of that name.

        Parameters
        ----------
        name : str
            The name.
        """
        return self.find("joint", name)

    def geom(self, name: str) -> SpecElement:
        """The geom of that name.

        Parameters
        ----------
        name : str
            The name.
        """
        return self.find("geom", name)

    def site(self, name: str) -> SpecElement:
        """The site of that name.

        Parameters
        ----------
        name : str
            The name.
        """
        return self.find("site", name)

    def actuator(self, name: str) -> SpecElement:
        """The actuator of that name.

        Parameters
        ----------
        name : str
            The name.
        """
        return self.find("actuator", name)

    def sensor(self, name: str) -> SpecElement:
        """The sensor of that name.

        Parameters
        ----------
        name : str
            The name.
        """
        return self.find("sensor", name)

    def to_xml(self) -> str:
        """The document as MJCF text. What it names is in `assets`; `Model.to_xml` of what is built stands alone."""
        root = copy.deepcopy(self._root)
        ET.indent(root)
        return ET.tostring(root, encoding="unicode")

    def build(self, **options: Any) -> Model:
        """The model.

        Parameters
        ----------
        **options : Any
            As of `Model.from_xml`, such as ``budget`` or ``max_dynamic_constraints``.

        Returns
        -------
        Model

        Raises
        ------
        LoadError
            What asks for something that cannot be; its line is that of `to_xml`.
        """
        from clench._core import Model

        return Model.from_xml(self.to_xml(), assets=self.assets, **options)

    def copy(self) -> ModelSpec:
        """Another one that says the same."""
        return copy.deepcopy(self)

    def __repr__(self) -> str:
        return f'<clench.ModelSpec "{self.name}": {len(self._elements("body"))} bodies>'

    # Names, and what refers to them.

    def _nodes(self) -> Iterator[tuple[ET.Element, str]]:
        """Every element with the section that it stands in."""
        for section in self._root:
            for node in section.iter():
                yield node, section.tag

    def _elements(self, kind: str) -> list[ET.Element]:
        return [node for node, _ in self._nodes() if self._kind_of(node) == kind]

    def _kind_of(self, node: ET.Element) -> str | None:
        """What kind of element a node is that can have a name; None for references, defaults and the like."""
        section = next((tag for other, tag in self._nodes() if other is node), None)
        return _kind(node, section)

    def _find(self, kind: str, name: str) -> ET.Element | None:
        if kind not in _TAGS and kind not in _SECTIONS:
            raise ValueError(f'there is no kind of element "{kind}": there are {", ".join([*_TAGS, *_SECTIONS])}')
        found = (node for node, section in self._nodes() if node.get("name") == name and _kind(node, section) == kind)
        return next(found, None)

    def _check_name(self, node: ET.Element, attribute: str, value: _Value) -> None:
        if attribute != "name":
            return
        kind = self._kind_of(node)
        taken = self._find(kind, _text(value)) if kind else None
        if taken is not None and taken is not node:
            raise ValueError(f'there is a {kind} "{_text(value)}" already')

    def _parents(self) -> dict[ET.Element, ET.Element]:
        return {child: parent for parent in self._root.iter() for child in parent}

    def _references(self, kind: str, name: str) -> list[tuple[ET.Element, str]]:
        """Attributes that name an element of a kind."""
        found = []
        for node, section in self._nodes():
            if section in _NO_REFERENCES and node.tag != "element":
                continue
            found += [(node, attribute) for attribute in _REFERENCES.get(kind, ()) if node.get(attribute) == name]
            for attribute, typed in _TYPED.items():
                of_kind = node.get(typed) in ((kind, "xbody") if kind == "body" else (kind,))
                if of_kind and node.get(attribute) == name:
                    found.append((node, attribute))
        return found

    def _remove_references(self, kind: str, name: str) -> None:
        parents = self._parents()
        for node, _ in self._references(kind, name):
            if node in parents:
                # Where only a part of a tendon is named, the tendon is no longer what it was.
                while parents[node].tag in ("spatial", "fixed"):
                    node = parents[node]
                SpecElement(self, node).remove()
                parents = self._parents()

    # Files.

    def _add_files(self, files: Mapping[str, bytes]) -> None:
        for file, data in files.items():
            name = Path(file.replace("\\", "/")).name
            if self.assets.get(name, data) != data:
                raise ValueError(f"there are two files {name!r} of different contents")
        self.assets.update({Path(file.replace("\\", "/")).name: bytes(data) for file, data in files.items()})

    def _expand(self, folder: Path, source: str) -> None:
        """Puts in what the document includes."""
        for _ in range(100):
            parents = self._parents()
            include = next(self._root.iter("include"), None)
            if include is None:
                return
            file = include.get("file", "")
            data = self.assets.get(Path(file).name)
            included = _parsed((_read(folder / file, source) if data is None else data).decode("utf-8", "replace"), file)
            parent = parents[include]
            place = list(parent).index(include)
            parent[place : place + 1] = list(included)
        raise LoadError("files include each other without end", source)

    def _read_assets(self, folder: Path) -> None:
        compiler: dict[str, str] = {}
        for node in self._root.findall("compiler"):
            compiler.update(node.attrib)
        assets = compiler.get("assetdir", "")
        places = {tag: compiler.get("meshdir", assets) for tag in ("mesh", "hfield", "skin", "model")}
        for node, section in self._nodes():
            file = node.get("file")
            if section != "asset" or file is None or node.tag not in places:
                continue
            place = Path(file) if node.tag == "model" else Path(places[node.tag]) / file
            self._add_files({file: _read(folder / place, str(folder / place))})
            if node.tag == "model":
                other = ModelSpec.from_file(folder / place)
                self._add_files(other.assets)
                self.assets[Path(file).name] = other.to_xml().encode()


def _kind(node: ET.Element, section: str | None) -> str | None:
    """The kind of an element in a section of the document."""
    if section is None or section in _NO_REFERENCES:
        return None
    for kind, of in _SECTIONS.items():
        if section == of:
            # Deeper in a section stand references, as of a tendon to its sites.
            return kind if "name" in node.attrib or node.tag not in ("site", "geom", "joint", "pulley", of) else None
    if section in ("worldbody", "asset", "keyframe", "contact"):
        return next((kind for kind, tags in _TAGS.items() if node.tag in tags), None)
    return None


def _read(path: Path, source: str) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        raise LoadError(f"{path}: {error.strerror}", source) from None


def _parsed(text: str, source: str) -> ET.Element:
    try:
        root = ET.fromstring(text)
    except ET.ParseError as error:
        raise LoadError(str(error), source, error.position[0]) from None
    if root.tag not in ("mujoco", "mujocoinclude"):
        raise LoadError(f"the root element is <{root.tag}>, and <mujoco> was expected", source, 1, root.tag)
    return root
