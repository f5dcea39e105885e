"""Models for environments: where they come from, and the actions that they take."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

import gymnasium
import numpy as np
from gymnasium.spaces import Box

from clench import Model


def loaded(model: Model | str | PathLike[str]) -> Model:
    """The model itself, or that of a file's path or of an MJCF file's text, which begins with ``<``."""
    if isinstance(model, Model):
        return model
    if isinstance(model, str) and model.lstrip().startswith("<"):
        return Model.from_xml(model)
    return Model.from_file(model)


def action_space(model: Model) -> Box:
    """The ranges of a model's controls, float32 as gymnasium's; no bounds where a control has none."""
    limited = model.actuator_ctrllimited.astype(np.bool_)
    low = np.where(limited, model.actuator_ctrlrange[:, 0], -np.inf)
    high = np.where(limited, model.actuator_ctrlrange[:, 1], np.inf)
    return Box(low.astype(np.float32), high.astype(np.float32), dtype=np.float32)


def gymnasium_model(xml_file: str) -> Path:
    """The file that a task's ``xml_file`` means, as gymnasium reads it.

    Parameters
    ----------
    xml_file : str
        A path that starts with ``/``, ``.`` or ``~``, or the name of a file among those that gymnasium brings.

    Raises
    ------
    FileNotFoundError
        There is no such file.
    """
    path = Path(xml_file).expanduser()
    if not (path.is_absolute() or xml_file.startswith(".")):
        path = Path(gymnasium.__file__).parent / "envs" / "mujoco" / "assets" / xml_file
    if not path.is_file():
        raise FileNotFoundError(f"no model file {path}; one of your own is named by a path that starts with / . or ~")
    return path
