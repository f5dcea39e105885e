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
from clench._document import Document, text_of
from clench._element import SpecElement
from clench._files import is_urdf
from clench._spec_sections import SpecSections
from clench.errors import LoadError

__all__ = ["ModelSpec", "SpecElement"]


class ModelSpec(SpecSections):
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
        self._document = Document(ET.Element("mujoco", model=text_of(name)))

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
        self._document.root.set("model", text_of(name))

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

    def __copy__(self) -> ModelSpec:
        """Returns a copy that shares no element, as `copy` does."""
        return self.copy()

    def __repr__(self) -> str:
        return f'<clench.ModelSpec "{self.name}": {len(self._document.elements("body"))} bodies>'
