"""URDF files of example-robot-data and genesis-world, which `cargo xtask test python` puts into .venv/models.

`urdf.txt` lists all of them. MuJoCo does not resolve packages, so it gets copies with full paths of meshes, while
Clench reads the files themselves. If MuJoCo refuses a file for unphysical masses and inertias, both read a copy in
which MuJoCo's own extension of URDF repairs them.
"""

import functools
import pathlib
import tempfile
import types
import xml.etree.ElementTree as ElementTree

import public

HERE = pathlib.Path(__file__).resolve().parent
SHARE = public.FOLDER / "cmeel.prefix/share"  # contains the package of example-robot-data
FOLDERS = (SHARE / "example-robot-data/robots", public.FOLDER / "genesis/assets")
REPAIR = {"balanceinertia": "true", "boundmass": "1e-6", "boundinertia": "1e-9"}
FLAGS = ("--package-path", SHARE)


def found():
    """Returns all files by their names in `urdf.txt`."""
    return sorted(str(path.relative_to(public.FOLDER)) for folder in FOLDERS for path in folder.rglob("*.urdf"))


def listed():
    """Yields each listed file: its name, `how` it is compared (as written, repaired, refused), and MuJoCo's error."""
    for line in (HERE / "urdf.txt").read_text().splitlines():
        if not line.startswith("#"):
            name, _, rest = line.partition(": ")
            how, _, reason = rest.partition(": ")
            yield types.SimpleNamespace(name=name, how=how or "as written", reason=reason)


def compared():
    return [entry for entry in listed() if entry.how != "refused"]


def refused():
    return [entry for entry in listed() if entry.how == "refused"]


@functools.lru_cache(maxsize=None)
def folder():
    return tempfile.TemporaryDirectory()


def copy(name, repair):
    """Writes a copy that MuJoCo can read and returns its path."""
    source = public.path(name)
    tree = ElementTree.parse(source)
    for mesh in tree.iter("mesh"):
        mesh.set("filename", str(whole(mesh.get("filename"), source)))
    if repair:
        for child, values in (("mujoco", {}), ("compiler", REPAIR)):
            parent = tree.getroot() if child == "mujoco" else tree.getroot().find("mujoco")
            element = parent.find(child)
            element = ElementTree.SubElement(parent, child) if element is None else element
            element.attrib.update(values)
    path = pathlib.Path(folder().name) / f"{name.replace('/', '-').removesuffix('.urdf')}{'-repaired' * repair}.urdf"
    tree.write(path)
    return path


def whole(written, source):
    """Returns the file of a mesh. A package is in SHARE or encloses the file that names it."""
    inside = written.removeprefix("package:").lstrip("/") if written.startswith("package:") else written
    parents = [source.parent] if inside == written else [SHARE, *source.parents]
    places = [parent / inside for parent in parents]
    return next((place for place in places if place.is_file()), written)
