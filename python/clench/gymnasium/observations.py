"""Observations: an array, or arrays by name, with one row per environment."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypeAlias

import numpy as np
from gymnasium.spaces import Box, Dict, Space
from numpy.typing import NDArray

from clench.gymnasium.checks import Named, rows

Array = NDArray[Any]

Observation: TypeAlias = Array | Mapping[str, Array]
"""The observation of a task: an array (n, ...), or arrays (n, ...) by name."""

# Dtypes that are not converted: floats of either precision, and bytes of pictures. All others become float64.
_KEPT = frozenset(map(np.dtype, (np.float64, np.float32, np.uint8)))


def checked(values: Any, count: int, env: Named, what: str) -> Any:
    """Copies the observation of a task.

    Parameters
    ----------
    values : ndarray or mapping of str to ndarray
        The observation that the task returned.
    count : int
        Number of environments.
    env : Named
        The environments, for errors.
    what : str
        The name of the values in errors.

    Returns
    -------
    ndarray or dict of str to ndarray
        The same values in separate arrays, float64, float32 or uint8.

    Raises
    ------
    ValueError
        If an array does not have one row per environment, or its rows are single numbers.
    """
    if isinstance(values, Mapping):
        return {str(key): _array(value, count, env, f"{what}, `{key}`,") for key, value in values.items()}
    return _array(values, count, env, what)


def _array(values: Any, count: int, env: Named, what: str) -> Array:
    array = rows(values, count, env, what).copy()
    if array.ndim < 2:
        raise ValueError(f"{env._name}: {what} must give each environment an array, not one number")
    return array if array.dtype in _KEPT else array.astype(np.float64)


def space(sample: Any) -> Space[Any]:
    """Creates the space of one environment's part of an observation: without bounds, except for bytes.

    Parameters
    ----------
    sample : ndarray or dict of str to ndarray
        The result of `checked`.

    Returns
    -------
    gymnasium.spaces.Box or gymnasium.spaces.Dict
    """
    if isinstance(sample, Mapping):
        return Dict({key: space(value) for key, value in sample.items()})
    low, high = (0, 255) if sample.dtype == np.uint8 else (-np.inf, np.inf)
    return Box(low, high, sample.shape[1:], sample.dtype.type)


def of_one(observation: Any, env: int) -> Any:
    """Returns one environment's part of an observation, as views."""
    if isinstance(observation, Mapping):
        return {key: value[env] for key, value in observation.items()}
    return observation[env]
