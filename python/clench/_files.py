"""The files that an MJCF document includes or names."""

from __future__ import annotations

import os
import xml.etree.ElementTree as ET
from collections.abc import Mapping
from pathlib import Path

from clench._core import Model
from clench.errors import LoadError

# Attributes that name files of assets.
_FILES = ("file", "fileright", "fileleft", "fileup", "filedown", "filefront", "fileback")


class Files:
    """The root of a document, and the contents of files that it names."""

    def __init__(self, root: ET.Element) -> None:
        self.root = root
        # Contents by name without folders.
        self.assets: dict[str, bytes] = {}
        # The folders of those that were read from the disk.
        self.folders: dict[str, Path] = {}

    def add_files(self, files: Mapping[str, bytes]) -> None:
        for file, data in files.items():
            name = Path(file.replace("\\", "/")).name
            if self.assets.get(name, data) != data:
                raise ValueError(f"there are two files {name!r} of different contents")
        self.assets.update({Path(file.replace("\\", "/")).name: bytes(data) for file, data in files.items()})

    def expand(self, folder: Path, source: str) -> dict[ET.Element, Path]:
        """Inserts the included files, which lie in the model's folder or in that of the including file. Returns the folders
        of the files that inserted nodes were read from."""
        origins: dict[ET.Element, Path] = {}
        included: set[Path] = set()
        while (include := next(self.root.iter("include"), None)) is not None:
            parents = {child: parent for parent in self.root.iter() for child in parent}
            file = include.get("file", "")
            data = self.assets.get(Path(file).name)
            path = _first([folder / file, origins.get(include, folder) / file])
            if path.resolve() in included:
                raise LoadError(f'"{file}" is already included', source)
            included.add(path.resolve())
            tree = parsed((read(path, source) if data is None else data).decode("utf-8", "replace"), file)
            origins.update((node, path.parent) for node in tree.iter())
            parent = parents[include]
            place = list(parent).index(include)
            parent[place : place + 1] = list(tree)
        return origins

    def read_assets(self, folder: Path, origins: Mapping[ET.Element, Path]) -> dict[str, Path]:
        """Reads the files that the document names, also in the folder of the included file that names them. Returns the
        MJCF models among them by their names in `assets`."""
        compiler: dict[str, str] = {}
        for node in self.root.findall("compiler"):
            compiler.update(node.attrib)
        meshes, textures = (compiler.get(name, compiler.get("assetdir", "")) for name in ("meshdir", "texturedir"))
        places = {"mesh": meshes, "hfield": meshes, "skin": meshes, "texture": textures, "model": ""}
        models = {}
        for node in (node for section in self.root.findall("asset") for node in section if node.tag in places):
            place = folder / places[node.tag].replace("\\", "/")
            for attribute in _FILES:
                if file := node.get(attribute, "").replace("\\", "/"):
                    file = Path(file).name if compiler.get("strippath") == "true" else file
                    below = os.path.relpath(origins.get(node, folder), folder)
                    path = _first([place / file, place / below / file])
                    name = self._read_asset(node, attribute, path)
                    if node.tag == "model" and is_urdf(path):
                        self._read_meshes_of_urdf(path)
                    elif node.tag == "model":
                        models[name] = path
        return models

    def _read_asset(self, node: ET.Element, attribute: str, path: Path) -> str:
        """Reads a file that an attribute names. Returns its name in `assets`, which differs if another file has its own."""
        data, name = read(path, str(path)), path.name
        while self.assets.get(name, data) != data:
            name = f"_{name}"
        if name != path.name:
            node.set("name", named(node))
            node.set(attribute, name)
        self.assets[name], self.folders[name] = data, path.parent
        return name

    def _read_meshes_of_urdf(self, path: Path) -> None:
        """Reads the meshes that lie where an attached URDF file says, or beside it. The build reports others, and a file
        that is not XML."""
        try:
            root = _tree(self.assets[path.name].decode("utf-8", "replace"))
        except ET.ParseError:
            return
        for mesh in root.iter("mesh"):
            file = mesh.get("filename", "").replace("\\", "/")
            place = _first([path.parent / file, path.parent / Path(file).name])
            if place.is_file():
                self.add_files({file: read(place, str(place))})


def named(node: ET.Element) -> str:
    """Returns the name of an element, or that of its file if it has none, which is the default name of meshes and
    textures."""
    if name := node.get("name"):
        return name
    file = node.get("file", "").replace("\\", "/").rpartition("/")[2]
    return file.rpartition(".")[0] or file


def _first(places: list[Path]) -> Path:
    """Returns the first place that is a file, or the first if none is."""
    return next((place for place in places if place.is_file()), places[0])


def read(path: Path, source: str) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        what = "the file" if str(path) == source else str(path)
        raise LoadError(f"cannot read {what}: {error.strerror}", source) from None


def parsed(text: str, source: str) -> ET.Element:
    try:
        root = _tree(text)
    except ET.ParseError as error:
        raise LoadError(str(error), source, error.position[0]) from None
    if root.tag not in ("mujoco", "mujocoinclude"):
        raise LoadError(f"the root element is <{root.tag}>, and <mujoco> was expected", source, 1, root.tag)
    return root


def is_urdf(path: Path) -> bool:
    """Returns true if a file describes a robot in URDF."""
    try:
        return _tree(read(path, str(path)).decode("utf-8", "replace")).tag.lower() == "robot"
    except ET.ParseError:
        return False


def _tree(text: str) -> ET.Element:
    """Parses a text that strict parsers or the engine accept."""
    try:
        return ET.fromstring(text)
    except ET.ParseError as error:
        try:
            return ET.fromstring(Model._strict_xml(text))
        except ET.ParseError:
            raise error from None
