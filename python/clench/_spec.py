"""Models that are built and edited in Python.

A `ModelSpec` is an MJCF document: adding, changing and removing elements edits the document, and `ModelSpec.build`
passes it to the loader that reads files. The built model therefore steps like the one from such a file, to the bit, and
supports everything that a file can express. A table of MJCF's attributes in `_document.py` defines the references to
names.
"""

from __future__ import annotations

import copy
import xml.etree.ElementTree as ET
from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any

from clench._check import located
from clench._core import Model
from clench._document import Document, Value, written
from clench._element import SpecElement
from clench._files import is_urdf
from clench._state import State
from clench.errors import LoadError

__all__ = ["ModelSpec", "SpecElement"]


class ModelSpec:
    """A model that is built or edited in Python; `build` turns it into a `Model`.

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

    __slots__ = ("_document",)

    def __init__(self, name: str = "model") -> None:
        self._document = Document(ET.Element("mujoco", model=name))

    @property
    def assets(self) -> dict[str, bytes]:
        """Files that the document names, by name without folders, such as meshes and height fields."""
        return self._document.assets

    @property
    def _source(self) -> Document:
        """Returns the document to attach to another model."""
        # Names of attached files are created only when the model is built.
        return ModelSpec.from_xml(self.build().to_xml())._document if self._document.attaches_files() else self._document

    @staticmethod
    def from_xml(text: str, assets: Mapping[str, bytes] | None = None) -> ModelSpec:
        """Creates a spec from the text of an MJCF file.

        Parameters
        ----------
        text : str
            The text; files that it includes must be in `assets`.
        assets : dict of str to bytes, optional
            Files that the text names.

        Returns
        -------
        ModelSpec

        Raises
        ------
        LoadError
            If the text is not well-formed, or has another format.
        """
        spec = ModelSpec()
        spec._document = Document.from_text(text, assets or {})
        return spec

    @staticmethod
    def from_file(path: str | PathLike[str], *, floating: bool = False) -> ModelSpec:
        """Creates a spec from an MJCF or URDF file. Files that it names are read immediately.

        Parameters
        ----------
        path : str or os.PathLike
            The file. Included files become part of the document; URDF is converted to MJCF.
        floating : bool
            True to free the base of a URDF robot, as in `Model.from_file`.

        Returns
        -------
        ModelSpec

        Raises
        ------
        LoadError
            If the file cannot be read or is not well-formed, the robot has no base to free, or `floating` is used with
            an MJCF file.
        """
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
        """The world, to which bodies and static objects are added."""
        return self.section("worldbody")

    def section(self, tag: str) -> SpecElement:
        """Returns a section of the document, such as "option", "default" or "contact"; creates it if there is none.

        Parameters
        ----------
        tag : str
            MJCF's name of the section.

        Returns
        -------
        SpecElement
        """
        node = self._document.root.find(tag)
        if node is None:
            return SpecElement(self._document, self._document.root, ()).add(tag)
        return SpecElement(self._document, node, ())

    def add_actuator(self, tag: str, /, **attributes: Value) -> SpecElement:
        """Adds an actuator: "motor", "position", "general" and so on.

        Parameters
        ----------
        tag : str
            MJCF's name of the actuator type.
        **attributes : str, bool or array_like
            Its attributes, with MJCF's names.
        """
        return self.section("actuator").add(tag, **attributes)

    def add_sensor(self, tag: str, /, **attributes: Value) -> SpecElement:
        """Adds a sensor: "jointpos", "gyro", "touch" and so on.

        Parameters
        ----------
        tag : str
            MJCF's name of the sensor type.
        **attributes : str, bool or array_like
            Its attributes, with MJCF's names.
        """
        return self.section("sensor").add(tag, **attributes)

    def add_equality(self, tag: str, /, **attributes: Value) -> SpecElement:
        """Adds an equality constraint: "weld", "connect", "joint" or "tendon".

        Parameters
        ----------
        tag : str
            MJCF's name of the constraint type.
        **attributes : str, bool or array_like
            Its attributes, with MJCF's names.
        """
        return self.section("equality").add(tag, **attributes)

    def add_tendon(self, tag: str, /, **attributes: Value) -> SpecElement:
        """Adds a tendon, "fixed" or "spatial"; its path is added to it.

        Parameters
        ----------
        tag : str
            MJCF's name of the tendon type.
        **attributes : str, bool or array_like
            Its attributes, with MJCF's names.
        """
        return self.section("tendon").add(tag, **attributes)

    def add_keyframe(self, state: State | None = None, /, **attributes: Value) -> SpecElement:
        """Adds a keyframe.

        Parameters
        ----------
        state : State, optional
            A state of a simulation of this model, such as ``sim.state``; by default the attributes define the keyframe.
        **attributes : str, bool or array_like
            Its attributes, with MJCF's names.

        Returns
        -------
        SpecElement

        Raises
        ------
        ValueError
            If the state is that of a batch: a keyframe is of one environment.

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
                raise ValueError("a keyframe is the state of one environment: use that of batch.sim(env)")
            fields = {"mpos": state.mocap_pos, "mquat": state.mocap_quat}
            fields.update({name: getattr(state, name) for name in ("time", "qpos", "qvel", "act", "plastic", "ctrl")})
            kept = {name: values for name, values in fields.items() if values.size}
        return self.section("keyframe").add("key", **{**kept, **attributes})

    def add_asset(self, tag: str, /, data: bytes | None = None, **attributes: Value) -> SpecElement:
        """Adds an asset: "mesh", "hfield", "material" and so on.

        Parameters
        ----------
        tag : str
            MJCF's name of the asset type.
        data : bytes, optional
            The contents of its ``file``, if that is not on the disk.
        **attributes : str, bool or array_like
            Its attributes, with MJCF's names.

        Returns
        -------
        SpecElement
        """
        if data is not None:
            if "file" not in attributes:
                raise ValueError("data needs the name of a file")
            self._document.add_files({written(attributes["file"]): data})
        return self.section("asset").add(tag, **attributes)

    def decompose(
        self,
        mesh: str,
        *,
        threshold: float = 0.05,
        max_hulls: int | None = None,
        group: int = 3,
        cache: bool | str | PathLike[str] = True,
        **options: Any,
    ) -> list[SpecElement]:
        """Decomposes a mesh into convex pieces, since a mesh collides as its convex hull: a cup would be filled.

        Pieces without mass, with the attributes of the geom, collide instead of each geom of the mesh, which keeps its
        mass, inertia and appearance. CoACD computes them (``pip install 'clench[decompose]'``).

        Parameters
        ----------
        mesh : str
            Name of the mesh.
        threshold : float
            Concavity that remains, 0.01 to 1, as a fraction of the size of the mesh: less gives more pieces.
        max_hulls : int, optional
            Greatest number of pieces; by default there is no limit.
        group : int
            Group of the pieces.
        cache : bool, str or os.PathLike
            Folder that stores the pieces under a hash of mesh and options. True is that of the mesh's file, if any.
        **options : Any
            Further arguments of ``coacd.run_coacd``, such as ``preprocess_resolution`` or ``seed``.

        Returns
        -------
        list of SpecElement
            The pieces, named ``cup_hull0`` and so on for a geom ``cup``, or the unchanged geoms of a convex mesh.

        Raises
        ------
        ModuleNotFoundError
            If CoACD is needed and not installed.
        ValueError
            If there is no such mesh, no geom of it collides, a name is taken, or a number is out of range.
        LoadError
            If the model cannot be built.
        """
        from clench.decompose import replace

        return replace(self, mesh, threshold=threshold, max_hulls=max_hulls, group=group, cache=cache, **options)

    def names(self, kind: str) -> list[str]:
        """Returns the names of all elements of a kind, in the order of the document, without unnamed ones.

        Parameters
        ----------
        kind : str
            "body", "joint", "geom", "site", "actuator", "sensor" and so on.
        """
        return [name for node in self._document.elements(kind) if (name := node.get("name"))]

    def find(self, kind: str, name: str) -> SpecElement:
        """Returns the element with this kind and name.

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
            If no element has the name.
        """
        found = self._document.find(kind, name)
        if found is None:
            known = ", ".join(self.names(kind)[:10])
            raise ValueError(f'there is no {kind} "{name}"' + (f": there are {known}" if known else ""))
        return SpecElement(*found)

    def body(self, name: str) -> SpecElement:
        """Returns the body with this name; "world" is the world.

        Parameters
        ----------
        name : str
            The name.
        """
        return self.world if name == "world" else self.find("body", name)

    def joint(self, name: str) -> SpecElement:
        """Returns the joint with this name.

        Parameters
        ----------
        name : str
            The name.
        """
        return self.find("joint", name)

    def geom(self, name: str) -> SpecElement:
        """Returns the geom with this name.

        Parameters
        ----------
        name : str
            The name.
        """
        return self.find("geom", name)

    def site(self, name: str) -> SpecElement:
        """Returns the site with this name.

        Parameters
        ----------
        name : str
            The name.
        """
        return self.find("site", name)

    def actuator(self, name: str) -> SpecElement:
        """Returns the actuator with this name.

        Parameters
        ----------
        name : str
            The name.
        """
        return self.find("actuator", name)

    def sensor(self, name: str) -> SpecElement:
        """Returns the sensor with this name.

        Parameters
        ----------
        name : str
            The name.
        """
        return self.find("sensor", name)

    def keyframe(self, name: str) -> SpecElement:
        """Returns the keyframe with this name.

        Parameters
        ----------
        name : str
            The name.
        """
        return self.find("keyframe", name)

    def to_xml(self) -> str:
        """Returns the document as MJCF text, which loads together with the files in `assets`.

        If models are attached, it is the built model's `Model.to_xml`: one self-contained document.

        Raises
        ------
        LoadError
            If models are attached, and the whole cannot be built.
        """
        return self.build().to_xml() if self._document.attached else self._document.text()

    def build(self, **options: Any) -> Model:
        """Builds the model.

        Parameters
        ----------
        **options : Any
            As for `Model.from_xml`, such as ``budget`` or ``max_dynamic_constraints``.

        Returns
        -------
        Model

        Raises
        ------
        LoadError
            If the document requests something impossible; the error names the element by its path, such as ``body "tip"
            / geom 2``, the third geom of that body.
        """
        try:
            return Model.from_xml(self._document.text(), assets=self._document.files(), **options)
        except LoadError as error:
            raise located(self._document, error) from None

    def copy(self) -> ModelSpec:
        """Returns a copy."""
        return copy.deepcopy(self)

    def __repr__(self) -> str:
        return f'<clench.ModelSpec "{self.name}": {len(self._document.elements("body"))} bodies>'
