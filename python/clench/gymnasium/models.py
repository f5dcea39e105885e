"""Models of environments, and their action spaces."""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike
from pathlib import Path

import gymnasium
import numpy as np
from gymnasium.spaces import Box

from clench import Model


Source = Model | str | PathLike[str]


def loaded(model: Source | Sequence[Source]) -> Model | list[Model]:
    """Returns the model itself, or loads it from a path or from the text of an MJCF file, which begins with ``<``.
    Several models become a list."""
    if isinstance(model, Sequence) and not isinstance(model, str):
        return [_loaded(one) for one in model]
    return _loaded(model)


def _loaded(model: Source) -> Model:
    if isinstance(model, Model):
        return model
    if isinstance(model, str) and model.lstrip().startswith("<"):
        return Model.from_xml(model)
    return Model.from_file(model)


def action_space(model: Model) -> Box:
    """Returns the space of a model's controls, float32 as in gymnasium; a control without a range is unbounded."""
    limited = model.actuator_ctrllimited.astype(np.bool_)
    low = np.where(limited, model.actuator_ctrlrange[:, 0], -np.inf)
    high = np.where(limited, model.actuator_ctrlrange[:, 1], np.inf)
    return Box(low.astype(np.float32), high.astype(np.float32), dtype=np.float32)


def gymnasium_model(xml_file: str) -> Path:
    """Finds the file of a task's ``xml_file``, as gymnasium does.

    Parameters
    ----------
    xml_file : str
        A path that starts with ``/``, ``.`` or ``~``, or the name of a model file of gymnasium.

    Raises
    ------
    FileNotFoundError
        If the file does not exist.
    """
    path = Path(xml_file).expanduser()
    if not (path.is_absolute() or xml_file.startswith(".")):
        path = Path(gymnasium.__file__).parent / "envs" / "mujoco" / "assets" / xml_file
    if not path.is_file():
        raise FileNotFoundError(f"there is no model file {path}; a path to your own file starts with / . or ~")
    return path
