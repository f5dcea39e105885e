"""What gymnasium's MuJoCo v5 tasks have in common."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from clench.gymnasium.batch_env import BatchEnv
from clench.gymnasium.models import gymnasium_model

Array = NDArray[Any]

# How gymnasium's window is set up. Taken, so that its arguments can be passed on as they are; there is no window here.
_WINDOW = ("default_camera_config", "max_geom", "visual_options")


class Task(BatchEnv):
    """A task of gymnasium's: a file among its models, and noise on the initial state.

    Parameters
    ----------
    num_envs : int
        How many environments.
    xml_file : str
        A file that gymnasium brings, or a path that starts with ``/``, ``.`` or ``~``.
    reset_noise_scale : float
        How much initial states vary.
    **kwargs
        What :class:`BatchEnv` takes. Gymnasium's arguments about drawing have no effect.
    """

    normal_velocity_noise = False
    """Whether the noise of velocities is normal; else it is uniform, as that of positions."""

    def __init__(self, num_envs: int, *, xml_file: str, reset_noise_scale: float = 0.0, **kwargs: Any) -> None:
        for name in _WINDOW:
            kwargs.pop(name, None)
        kwargs.setdefault("render_size", (kwargs.pop("width", 480), kwargs.pop("height", 480)))
        by_name, by_index = kwargs.pop("camera_name", None), kwargs.pop("camera_id", None)
        kwargs.setdefault("render_camera", by_index if by_name is None else by_name)
        super().__init__(num_envs, model=gymnasium_model(xml_file), **kwargs)
        self.reset_noise_scale = reset_noise_scale

    def initial_state(self, rng: np.random.Generator) -> tuple[Array, Array]:
        """The model's initial state with noise, in gymnasium's order of draws."""
        scale, nv = self.reset_noise_scale, self.init_qvel.size
        qpos = self.init_qpos + rng.uniform(-scale, scale, self.init_qpos.size)
        noise = scale * rng.standard_normal(nv) if self.normal_velocity_noise else rng.uniform(-scale, scale, nv)
        return qpos, self.init_qvel + noise


def row_squares(rows: Array) -> Array:
    """The sum of squares of each row."""
    squares: Array = np.einsum("ij,ij->i", rows, rows)
    return squares


def row_norms(rows: Array) -> Array:
    """The Euclidean norm of each row."""
    norms: Array = np.sqrt(row_squares(rows))
    return norms


def between(values: Array, bounds: tuple[float, float]) -> Array:
    """Which values lie strictly between the bounds."""
    inside: Array = (bounds[0] < values) & (values < bounds[1])
    return inside
