"""The base class of gymnasium's MuJoCo v5 tasks."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from clench.gymnasium.batch_env import BatchEnv
from clench.gymnasium.models import gymnasium_model

Array = NDArray[Any]

# Arguments of gymnasium's window. They are accepted so that its keyword arguments can be used, and ignored.
_WINDOW = ("default_camera_config", "max_geom", "visual_options")


class Task(BatchEnv):
    """A task of gymnasium: one of its model files, and noise on the initial state.

    Parameters
    ----------
    num_envs : int
        Number of environments.
    xml_file : str
        A model file of gymnasium, or a path that starts with ``/``, ``.`` or ``~``.
    reset_noise_scale : float
        Scale of the noise on the initial state.
    **kwargs
        Arguments of :class:`BatchEnv`. Gymnasium's rendering arguments have no effect.
    """

    normal_velocity_noise = False
    """True if the noise of velocities is normal, false if it is uniform, like that of positions."""

    def __init__(self, num_envs: int, *, xml_file: str, reset_noise_scale: float = 0.0, **kwargs: Any) -> None:
        for name in _WINDOW:
            kwargs.pop(name, None)
        kwargs.setdefault("render_size", (kwargs.pop("width", 480), kwargs.pop("height", 480)))
        by_name, by_index = kwargs.pop("camera_name", None), kwargs.pop("camera_id", None)
        kwargs.setdefault("render_camera", by_index if by_name is None else by_name)
        super().__init__(num_envs, model=gymnasium_model(xml_file), **kwargs)
        self.reset_noise_scale = reset_noise_scale

    def initial_state(self, rng: np.random.Generator) -> tuple[Array, Array]:
        """Returns the model's initial state with noise, drawn in gymnasium's order."""
        scale, nv = self.reset_noise_scale, self.init_qvel.size
        qpos = self.init_qpos + rng.uniform(-scale, scale, self.init_qpos.size)
        noise = scale * rng.standard_normal(nv) if self.normal_velocity_noise else rng.uniform(-scale, scale, nv)
        return qpos, self.init_qvel + noise


def row_squares(rows: Array) -> Array:
    """Computes the sum of squares of each row."""
    squares: Array = np.einsum("ij,ij->i", rows, rows)
    return squares


def row_norms(rows: Array) -> Array:
    """Computes the Euclidean norm of each row."""
    norms: Array = np.sqrt(row_squares(rows))
    return norms


def between(values: Array, bounds: tuple[float, float]) -> Array:
    """Returns true for values strictly between the bounds."""
    inside: Array = (bounds[0] < values) & (values < bounds[1])
    return inside
