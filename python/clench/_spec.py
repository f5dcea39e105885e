"""Models that are built and edited in Python, before they are models.

A `ModelSpec` is an MJCF document: what is added, changed and removed is what a file would say, and `ModelSpec.build` hands it to the
loader that reads files. So a model that is built steps like the one from such a file, to the bit, and all that a file can say can be
said here. What a name refers to is known from one table of MJCF's attributes, in `_document.py`.
"""

from __future__ import annotations

import copy
import xml.etree.ElementTree as ET
from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from clench._check import located
from clench._document import Document, Value, is_urdf, written
from clench._element import SpecElement
from clench.errors import LoadError

if TYPE_CHECKING:
    from clench._core import Model
    from clench._state import State

__all__ = ["ModelSpec", "SpecElement"]


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
        self._document = Document(ET.Element("mujoco", model=name))

    @property
    def assets(self) -> dict[str, bytes]:
        """Files that the document names, by name without folders, such as meshes and height fields."""
        return self._document.assets

    @property
    def _source(self) -> Document:
        """The document that a model takes in to which this one is attached."""
        # Names of what a file attaches come into being when that is built.
        return ModelSpec.from_xml(self.build().to_xml())._document if self._document.attaches_files() else self._document

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
        spec._document = Document.from_text(text, assets or {})
        return spec

    @staticmethod
    def from_file(path: str | PathLike[str], *, floating: bool = False) -> ModelSpec:
        """Begin with a file, MJCF or URDF. Files that it names are read now.

        Parameters
        ----------
        path : str or os.PathLike
            The file. What it includes becomes part of the document; URDF becomes MJCF.
        floating : bool
            Free the base of a URDF robot, as `Model.from_file` does.

        Returns
        -------
        ModelSpec

        Raises
        ------
        LoadError
            A file that cannot be read or is not well-formed, a robot that has no base to free, an MJCF file that is to float.
        """
        from clench._core import Model

        path = Path(path)
        if floating or is_urdf(path):
            return ModelSpec.from_xml(Model.from_file(path, floating=floating).to_xml())
        spec = ModelSpec()
        spec._document = Document.from_file(path)
        return spec

    @property
    def name(self) -> str:
        """Name of the model."""
        return self._document.root.get("model", "")

    @name.setter
    def name(self, name: str) -> None:
        self._document.root.set("model", name)

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
        node = self._document.root.find(tag)
        if node is None:
            return SpecElement(self._document, self._document.root, ()).add(tag)
        return SpecElement(self._document, node, ())

    def add_actuator(self, tag: str, /, **attributes: Value) -> SpecElement:
        """Add an actuator: "motor", "position", "general" and so on.

        Parameters
        ----------
        tag : str
            What MJCF calls it.
        **attributes : str, bool or array_like
            Its attributes, as MJCF calls them.
        """
        return self.section("actuator").add(tag, **attributes)

    def add_sensor(self, tag: str, /, **attributes: Value) -> SpecElement:
        """Add a sensor: "jointpos", "gyro", "touch" and so on.

        Parameters
        ----------
        tag : str
            What MJCF calls it.
        **attributes : str, bool or array_like
            Its attributes, as MJCF calls them.
        """
        return self.section("sensor").add(tag, **attributes)

    def add_equality(self, tag: str, /, **attributes: Value) -> SpecElement:
        """Add an equality constraint: "weld", "connect", "joint" or "tendon".

        Parameters
        ----------
        tag : str
            What MJCF calls it.
        **attributes : str, bool or array_like
            Its attributes, as MJCF calls them.
        """
        return self.section("equality").add(tag, **attributes)

    def add_tendon(self, tag: str, /, **attributes: Value) -> SpecElement:
        """Add a tendon, "fixed" or "spatial"; what it runs through is added to it.

        Parameters
        ----------
        tag : str
            What MJCF calls it.
        **attributes : str, bool or array_like
            Its attributes, as MJCF calls them.
        """
        return self.section("tendon").add(tag, **attributes)

    def add_keyframe(self, state: State | None = None, /, **attributes: Value) -> SpecElement:
        """Add a keyframe.

        Parameters
        ----------
        state : State, optional
            The state that it brings a simulation of this model to, such as ``sim.state``; else its attributes say all of it.
        **attributes : str, bool or array_like
            Its attributes, as MJCF calls them.

        Returns
        -------
        SpecElement

        Raises
        ------
        ValueError
            The state of a batch: a keyframe is of one environment.

        Examples
        --------
        >>> spec = clench.ModelSpec.from_xml(
        ...     "<mujoco><worldbody><body><joint type='slide'/><geom size='1'/></body></worldbody></mujoco>")
        >>> sim = clench.Sim(spec.build())
        >>> sim.qpos[0] = 0.25
        >>> spec.add_keyframe(sim.state, name="here")["qpos"]
        '0.25'
        """
        kept: dict[str, Value] = {}
        if state is not None:
            if state.qpos.ndim != 1:
                raise ValueError("a keyframe is of one environment: take the state of batch.sim(env)")
            fields = {"mpos": state.mocap_pos, "mquat": state.mocap_quat}
            fields.update({name: getattr(state, name) for name in ("time", "qpos", "qvel", "act", "plastic", "ctrl")})
            kept = {name: values for name, values in fields.items() if values.size}
        return self.section("keyframe").add("key", **{**kept, **attributes})

    def add_asset(self, tag: str, /, data: bytes | None = None, **attributes: Value) -> SpecElement:
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
            self._document.add_files({written(attributes["file"]): data})
        return self.section("asset").add(tag, **attributes)

    def names(self, kind: str) -> list[str]:
        """Names of all elements of a kind, in the order of the document; those without one are left out.

        Parameters
        ----------
        kind : str
            "body", "joint", "geom", "site", "actuator", "sensor" and so on.
        """
        return [name for node in self._document.elements(kind) if (name := node.get("name"))]

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
        found = self._document.find(kind, name)
        if found is None:
            known = ", ".join(self.names(kind)[:10])
            raise ValueError(f'there is no {kind} "{name}"' + (f": there are {known}" if known else ""))
        return SpecElement(*found)

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

    def keyframe(self, name: str) -> SpecElement:
        """The keyframe of that name.

        Parameters
        ----------
        name : str
            The name.
        """
        return self.find("keyframe", name)

    def to_xml(self) -> str:
        """The document as MJCF text, which loads together with the files in `assets`.

        Where models are attached it is `Model.to_xml` of what is built: one document, which stands alone.

        Raises
        ------
        LoadError
            Models are attached, and the whole cannot be built.
        """
        return self.build().to_xml() if self._document.attached else self._document.text()

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
            What asks for something that cannot be; it names the element by its path, such as ``body "tip" / geom 2``, the third geom of
            that body.
        """
        from clench._core import Model

        try:
            return Model.from_xml(self._document.text(), assets=self._document.files(), **options)
        except LoadError as error:
            raise located(self._document, error) from None

    def copy(self) -> ModelSpec:
        """Another one that says the same."""
        return copy.deepcopy(self)

    def __repr__(self) -> str:
        return f'<clench.ModelSpec "{self.name}": {len(self._document.elements("body"))} bodies>'
