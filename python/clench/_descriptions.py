"""Robots of the package ``robot_descriptions``."""

from __future__ import annotations

import difflib
import importlib
import os
import pkgutil
from types import ModuleType

from clench._core import Model
from clench.errors import LoadError

__all__ = ["load_description"]

_PACKAGE = "robot_descriptions"


def load_description(name: str, *, floating: bool = False, ignore_unsupported: bool = False) -> Model:
    """Loads a robot of the package ``robot_descriptions``, which downloads its files on first use and caches them.

    >>> model = clench.load_description("go2_mj_description")  # doctest: +SKIP

    If a description has an MJCF and a URDF file, the MJCF file is loaded.

    Parameters
    ----------
    name : str
        The module of the description, such as ``"go2_mj_description"`` (MJCF) or ``"go2_description"`` (URDF).
    floating : bool
        True to free the base of a URDF robot; see `Model.from_file`.
    ignore_unsupported : bool
        True to omit what Clench does not compute; see `Model.from_file`.

    Returns
    -------
    Model

    Raises
    ------
    ModuleNotFoundError
        If ``robot_descriptions`` is not installed.
    LoadError
        If the description does not exist, its files cannot be downloaded, it has neither an MJCF nor a URDF file, or
        the file cannot be loaded.
    """
    module = _description(name)
    path = getattr(module, "MJCF_PATH", None)
    if path is not None:
        return Model.from_file(path, floating=floating, ignore_unsupported=ignore_unsupported)
    path = getattr(module, "URDF_PATH", None)
    if path is None:
        kind = "a xacro file, which must be expanded first" if hasattr(module, "XACRO_PATH") else "neither an MJCF nor a URDF file"
        raise LoadError(f'the description "{name}" has {kind}')
    folders = [module.PACKAGE_PATH, module.REPOSITORY_PATH]
    roots = [*folders, *map(os.path.dirname, folders)]
    return Model.from_file(path, package_path=roots, floating=floating, ignore_unsupported=ignore_unsupported)


def _description(name: str) -> ModuleType:
    """Imports the module of a description, which downloads its files."""
    try:
        package = importlib.import_module(_PACKAGE)
    except ModuleNotFoundError as error:
        raise ModuleNotFoundError(
            f"load_description needs the package {_PACKAGE}: pip install {_PACKAGE}", name=_PACKAGE
        ) from error
    names = [module.name for module in pkgutil.iter_modules(package.__path__) if module.name.endswith("_description")]
    if name not in names:
        near = difflib.get_close_matches(name, names, 3)
        hint = f"; did you mean {' or '.join(map(repr, near))}?" if near else ""
        raise LoadError(f'{_PACKAGE} has no description "{name}"{hint}')
    try:
        return importlib.import_module(f"{_PACKAGE}.{name}")
    except Exception as error:  # Git, the network and the disk have their own exceptions.
        raise LoadError(f'the files of the description "{name}" cannot be fetched: {error}') from error
