"""Convex decomposition of meshes, by CoACD (``pip install 'clench[decompose]'``).

A mesh collides as its convex hull: a cup is filled. `ModelSpec.decompose` replaces it for collisions by convex pieces.
As a program, this does so for a file, and writes a self-contained one::

    python -m clench.decompose robot.xml pieces.xml --mesh cup bowl

Without ``--mesh`` it decomposes all meshes that collide. The method is that of Wei, Liu, Ling and Su, "Approximate
Convex Decomposition for 3D Meshes with Collision-Aware Concavity and Tree Search", 2022.
"""

from __future__ import annotations

import argparse
import contextlib
import copy
import hashlib
import os
import re
import sys
import warnings
import xml.etree.ElementTree as ET
from collections.abc import Callable, Sequence
from os import PathLike
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from clench._document import Document, Value
from clench._element import SpecElement

if TYPE_CHECKING:
    from clench._core import Model
    from clench._spec import ModelSpec

__all__ = ["hulls", "main"]

# MuJoCo's number of geoms that are meshes.
_MESH = 7
# Attributes of a geom that its pieces do not have: those of its appearance and its mass, which remain its own.
_NOT_OF_PIECES = ("name", "type", "size", "mesh", "mass", "density", "shellinertia", "material", "rgba", "fluidcoef")
# Changes whenever hulls of equal input and options are stored differently.
_CACHE_VERSION = 1


def hulls(
    vertices: ArrayLike,
    faces: ArrayLike,
    *,
    threshold: float = 0.05,
    max_hulls: int | None = None,
    cache: str | PathLike[str] | None = None,
    **options: Any,
) -> list[NDArray[np.float64]]:
    """Returns the vertices of convex hulls that cover a mesh approximately.

    Parameters
    ----------
    vertices : array_like
        (n, 3) Vertices.
    faces : array_like
        (m, 3) Indices of the vertices of triangles, counterclockwise seen from the outside.
    threshold : float
        Concavity at which a piece is divided no further, 0.01 to 1, as a fraction of the size of the mesh.
    max_hulls : int, optional
        Greatest number of hulls; by default there is no limit.
    cache : str or os.PathLike, optional
        A folder that stores the result under a hash of vertices, faces and options. A stored result needs no CoACD.
    **options : Any
        Further arguments of ``coacd.run_coacd``, such as ``preprocess_resolution`` or ``seed``.

    Returns
    -------
    list of numpy.ndarray
        (k, 3) The vertices of each hull. A convex mesh has one hull.

    Raises
    ------
    ModuleNotFoundError
        If CoACD is not installed.
    ValueError
        If the threshold or number is out of range, the mesh is not one, or CoACD finds no hull.
    OSError
        If the folder cannot be written.
    """
    points, triangles = np.array(vertices, np.float64), np.array(faces, np.int32)
    if points.ndim != 2 or points.shape[1:] != (3,) or not np.isfinite(points).all():
        raise ValueError(f"vertices of shape {points.shape} are not (n, 3) finite numbers")
    if triangles.ndim != 2 or triangles.shape[1:] != (3,) or not ((triangles >= 0) & (triangles < len(points))).all():
        raise ValueError(f"faces of shape {triangles.shape} are not (m, 3) indices of {len(points)} vertices")
    settings = _settings(threshold, max_hulls, options)
    return _cached(points, triangles, settings, None if cache is None else Path(cache))


def _settings(threshold: float, max_hulls: int | None, options: dict[str, Any]) -> dict[str, Any]:
    """Returns the arguments of CoACD."""
    if not 0.01 <= threshold <= 1.0:
        raise ValueError(f"the threshold is {threshold!r}, not between 0.01 and 1")
    if max_hulls is not None and max_hulls < 1:
        raise ValueError(f"max_hulls is {max_hulls!r}, not a number of at least 1")
    return {"threshold": float(threshold), "max_convex_hull": -1 if max_hulls is None else int(max_hulls), **options}


def _cached(
    vertices: NDArray[np.float64],
    faces: NDArray[np.int32],
    settings: dict[str, Any],
    folder: Path | None,
    name: str = "mesh",
    can_fail: bool = False,
) -> list[NDArray[np.float64]]:
    """Returns the hulls that a folder stores; computes and stores them if it has none. If the folder can fail, it need
    not be writable."""
    if folder is None:
        return _run(vertices, faces, settings)
    digest = hashlib.sha256(vertices.astype("<f4").tobytes() + faces.astype("<i4").tobytes())
    digest.update(f"{_CACHE_VERSION} {sorted(settings.items())}".encode())
    file = folder / f"{re.sub('[^A-Za-z0-9_.-]', '_', name)}-{digest.hexdigest()[:24]}.hulls.npz"
    found = _stored(file)
    if found is None:
        found = _run(vertices, faces, settings)
        try:
            folder.mkdir(parents=True, exist_ok=True)
            ends = np.cumsum([len(points) for points in found])
            _replace_file(file, lambda partial: np.savez_compressed(partial, vertices=np.concatenate(found), ends=ends))
        except OSError:
            if not can_fail:
                raise
    return found


def _run(
    vertices: NDArray[np.float64], faces: NDArray[np.int32], settings: dict[str, Any]
) -> list[NDArray[np.float64]]:
    try:
        import coacd
    except ModuleNotFoundError as error:
        raise ModuleNotFoundError(
            "decomposition needs the package coacd: pip install 'clench[decompose]'", name="coacd"
        ) from error
    coacd.set_log_level("error")
    parts = coacd.run_coacd(coacd.Mesh(vertices, faces), **settings)
    # Single precision, as in files of meshes. A flat piece has no hull, and no volume to collide with.
    found = [np.asarray(part[0], np.float32).astype(np.float64) for part in parts]
    solid = [points for points in found if _is_solid(points)]
    if not solid:
        raise ValueError("CoACD finds no convex hull of the mesh")
    return solid


def _is_solid(points: NDArray[np.float64]) -> bool:
    """Returns true unless the points are on a plane."""
    if len(points) < 4:
        return False
    extents = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    return bool(extents[2] > 1e-5 * extents[0])


def _stored(file: Path) -> list[NDArray[np.float64]] | None:
    """Returns the hulls of a file; None if there is no such file, or it is broken."""
    try:
        with np.load(file, allow_pickle=False) as stored:
            points, ends = np.asarray(stored["vertices"], np.float64), np.asarray(stored["ends"], np.int64)
    except Exception:  # Broken files raise errors of zip files, of NumPy and of the disk.
        return None
    is_whole = points.ndim == 2 and points.shape[1] == 3 and ends.ndim == 1 and ends.size and ends[-1] == len(points)
    return np.split(points, ends[:-1]) if is_whole else None


def _replace_file(path: Path, write: Callable[[IO[bytes]], object]) -> None:
    """Writes a file, which replaces an older one only when it is complete. A link stays, and its target is replaced;
    what is no regular file, such as a pipe, is written to."""
    if path.exists() and not path.is_file():
        with path.open("wb") as file:
            write(file)
        return
    path = path.resolve()
    partial = path.with_name(f".{path.name}.{os.getpid()}.partial")
    try:
        with partial.open("wb") as file:
            write(file)
        os.replace(partial, path)
    finally:
        with contextlib.suppress(OSError):
            partial.unlink()


def replace(
    spec: ModelSpec,
    mesh: str,
    *,
    threshold: float,
    max_hulls: int | None,
    group: int,
    cache: bool | str | PathLike[str],
    **options: Any,
) -> list[SpecElement]:
    """Replaces the geoms of a mesh that collide; see `ModelSpec.decompose`."""
    asset = spec.find("mesh", mesh)
    document, element = asset._document, asset._node
    model, geoms = _mesh_geoms(spec)
    users = [(owner, node, collides) for owner, node, name, collides in geoms if name == mesh]
    if not any(collides for _, _, collides in users):
        raise ValueError(f'the mesh "{mesh}" is used by no geom' + (" that collides" if users else ""))
    points, triangles = _shape(model, mesh)
    settings = _settings(threshold, max_hulls, options)
    if isinstance(cache, bool):
        # The folder of the file need not be writable: it may be that of an installed package.
        folder = _folder(document, element) if cache else None
        pieces = _cached(points, triangles, settings, folder, Path(element.get("file", "mesh")).stem, can_fail=True)
    else:
        pieces = _cached(points, triangles, settings, Path(cache))
    replaced = [(owner, node) for owner, node, collides in users if collides]
    if len(pieces) == 1:
        return [SpecElement(owner, node) for owner, node in replaced]
    meshes = _numbered(document, "mesh", mesh, len(pieces))
    names = [_numbered(owner, "geom", node.get("name", ""), len(pieces)) for owner, node in replaced]
    _add_meshes(document, element, meshes, pieces)
    added: list[SpecElement] = []
    for (owner, node), own in zip(replaced, names):
        added += _add_pieces(owner, node, own, meshes, group)
    return added


def _numbered(document: Document, kind: str, name: str, count: int) -> list[str]:
    """Returns names of the pieces of an element, which no other element has; empty ones if it has no name."""
    names = [f"{name}_hull{index}" if name else "" for index in range(count)]
    if taken := [name for name in names if name and document.find(kind, name)]:
        raise ValueError(f'there is already a {kind} "{taken[0]}"')
    return names


def colliding_meshes(spec: ModelSpec) -> list[str]:
    """Returns the names of the meshes of geoms that collide, in the order of their first geoms."""
    return list(dict.fromkeys(mesh for _, _, mesh, collides in _mesh_geoms(spec)[1] if collides))


def _mesh_geoms(spec: ModelSpec) -> tuple[Model, list[tuple[Document, ET.Element, str, bool]]]:
    """Returns the built model and its geoms that are meshes, with the name of the mesh, and true if they collide."""
    # Classes define attributes too, so the geoms are those of the built model, where each one needs a name.
    named_all = spec.copy()
    pairs = []
    for own, other in zip(spec._document.family(), named_all._document.family(), strict=True):
        geoms = [[node for node, section in document.nodes() if _is_geom(node, section)] for document in (own, other)]
        pairs += [(own, node, twin) for node, twin in zip(*geoms, strict=True)]
    for index, (_, _, twin) in enumerate(pairs):
        if not twin.get("name"):
            twin.set("name", f"clench.decompose {index} ")
    named_all._document.changed()
    model = named_all.build()
    index_of = {name: index for index, name in enumerate(model.names("geom"))}
    in_pairs = {*np.ravel(model.pair_geom1).tolist(), *np.ravel(model.pair_geom2).tolist()}
    names = {twin.get("name", "") for _, _, twin in pairs}
    copies: dict[str, int] = {}
    if spec._document.has_copies():
        # Replicas have the name of the element and a number. Of two names that begin a third, it is the longer one.
        for full, index in index_of.items():
            ends = range(len(full) if full not in names else 0, 0, -1)
            copies.setdefault(next((full[:end] for end in ends if full[:end] in names), ""), index)
    found = []
    for document, node, twin in pairs:
        name = twin.get("name", "")
        # Geoms that the compiler discards do not collide.
        geom = index_of.get(name, copies.get(name))
        if geom is not None and model.geom_type[geom] == _MESH:
            collides = bool(model.geom_contype[geom] or model.geom_conaffinity[geom] or geom in in_pairs)
            found.append((document, node, model.names("mesh")[model.geom_dataid[geom]], collides))
    return model, found


def _is_geom(node: ET.Element, section: str) -> bool:
    return section == "worldbody" and node.tag == "geom"


def _shape(model: Model, mesh: str) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Returns the vertices and faces of a mesh in the frame of its geoms, before it is moved to its centre of mass."""
    element = model.mesh(mesh)
    w, *xyz = np.asarray(element.quat, np.float64)
    vertices = np.asarray(element.vert, np.float64)
    twice = 2.0 * np.cross(xyz, vertices)
    return vertices + w * twice + np.cross(xyz, twice) + element.pos, np.asarray(element.face, np.int32)


def _folder(document: Document, node: ET.Element) -> Path | None:
    """Returns the folder of the file of a mesh; None if the mesh has none on the disk."""
    file = node.get("file", "").replace("\\", "/")
    folder = document.first().folders.get(file.rpartition("/")[2])
    return folder if folder is not None else Path(file).parent if file and Path(file).is_file() else None


def _add_meshes(
    document: Document, node: ET.Element, names: Sequence[str], pieces: Sequence[NDArray[np.float64]]
) -> None:
    """Adds the pieces of a mesh to the assets of a document."""
    section = SpecElement(document, document.parents()[node])
    # Vertices are those of the scaled mesh; a class would scale them again.
    frame: dict[str, Value] = {"scale": [1, 1, 1], "refpos": [0, 0, 0], "refquat": [1, 0, 0, 0], "inertia": "convex"}
    if "maxhullvert" in node.attrib:
        frame["maxhullvert"] = node.attrib["maxhullvert"]
    for name, points in zip(names, pieces):
        vertex = " ".join(f"{number:.9g}" for number in points.ravel().tolist())
        section.add("mesh", name=name, vertex=vertex, **frame)


def _add_pieces(
    document: Document, node: ET.Element, names: Sequence[str], meshes: Sequence[str], group: int
) -> list[SpecElement]:
    """Adds the pieces of a geom, which then only has its mass and its appearance."""
    parent = SpecElement(document, document.parents()[node])
    same: dict[str, Value] = {key: value for key, value in node.attrib.items() if key not in _NOT_OF_PIECES}
    pieces = []
    for name, mesh in zip(names, meshes):
        own: dict[str, Value] = {"type": "mesh", "mesh": mesh, "mass": 0, "group": group, "fluidshape": "none"}
        if name:
            own["name"] = name
        pieces.append(parent.add("geom", **{**same, **own}))
    original = SpecElement(document, node)
    original["contype"], original["conaffinity"] = 0, 0
    if original.name:
        _redirect(document, original.name, names)
    return pieces


def _redirect(document: Document, geom: str, pieces: Sequence[str]) -> None:
    """Replaces contact pairs of a geom by pairs of its pieces."""
    for other, node, attribute in document.references("geom", geom):
        if node.tag == "contact":
            warnings.warn(f'a contact sensor names the geom "{geom}", which no longer collides', stacklevel=5)
        if node.tag != "pair":
            continue
        section = other.parents()[node]
        for index, piece in enumerate(pieces):
            pair = copy.deepcopy(node)
            pair.set(attribute, piece)
            if pair.get("name"):
                pair.set("name", f"{pair.get('name')}_hull{index}")
            section.append(pair)
        section.remove(node)
        other.changed()


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the program ``python -m clench.decompose``.

    Parameters
    ----------
    arguments : sequence of str, optional
        The arguments of the command; by default those of this process.

    Returns
    -------
    int
        The exit status: 0, or 1 after an error.
    """
    from clench._spec import ModelSpec

    parser = argparse.ArgumentParser("python -m clench.decompose", description=(__doc__ or "").partition("\n")[0].replace("``", "`"))
    parser.add_argument("model", type=Path, help="the MJCF or URDF file to read")
    parser.add_argument("output", type=Path, help="the self-contained MJCF file to write")
    parser.add_argument(
        "--mesh", nargs="+", default=[], metavar="NAME", help="meshes to decompose; else all that collide"
    )
    parser.add_argument("--threshold", type=float, default=0.05, help="concavity that remains, 0.01 to 1")
    parser.add_argument("--max-hulls", type=int, metavar="N", help="greatest number of pieces of a mesh")
    parser.add_argument("--cache", metavar="FOLDER", help="stores the pieces there instead of next to the mesh files")
    parser.add_argument("--no-cache", action="store_true", help="does not store the pieces")
    given = parser.parse_args(arguments)
    try:
        if given.output.exists() and given.output.samefile(given.model):
            raise ValueError("MODEL and OUTPUT are the same file")
        spec = ModelSpec.from_file(given.model)
        cache = False if given.no_cache else given.cache or True
        for mesh in dict.fromkeys(given.mesh or colliding_meshes(spec)):
            pieces = spec.decompose(mesh, threshold=given.threshold, max_hulls=given.max_hulls, cache=cache)
            count = len({piece["mesh"] for piece in pieces if "mesh" in piece})
            print(f"{mesh}: {count} pieces" if count > 1 else f"{mesh}: convex, unchanged")
        text = spec.build().to_xml().encode()
        _replace_file(given.output, lambda file: file.write(text))
    except (ImportError, OSError, ValueError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
