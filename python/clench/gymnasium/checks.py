"""Validation of external data: actions, seeds, reset options, and results of tasks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Protocol

import numpy as np
from gymnasium.spaces import Box, Discrete, MultiBinary, MultiDiscrete, Space
from numpy.typing import NDArray

Array = NDArray[Any]


class Named(Protocol):
    """Environments with a name, for errors."""

    @property
    def _name(self) -> str: ...


def check_action_space(space: Any, name: str) -> None:
    """Rejects spaces whose actions are not arrays of numbers."""
    if not isinstance(space, (Box, Discrete, MultiDiscrete, MultiBinary)):
        what = type(space).__name__
        raise TypeError(f"{name}: single_action_space must be a Box, Discrete, MultiDiscrete or MultiBinary, not {what}")


def checked_action(action: Any, space: Space[Any], name: str) -> Array:
    """Converts an action to finite float64, or to int64 for a discrete space, of the shape of the space.

    Parameters
    ----------
    action : array_like
        The action.
    space : gymnasium.spaces.Space
        The space of actions, of one environment or of all. The bounds of a ``Box`` are ignored.
    name : str
        The name of the environment in messages.

    Returns
    -------
    ndarray
        The same numbers; the array itself if it has that dtype already.

    Raises
    ------
    ValueError
        If the shape differs, the dtype cannot hold such numbers, a number is not finite, or the action is not in a
        discrete space.
    """
    try:
        array = np.asarray(action)
    except ValueError as error:
        raise ValueError(f"{name}: the action is not an array: {error}") from error
    some = not isinstance(space, Box)
    if array.dtype.kind not in ("biu" if some else "fiu"):
        raise ValueError(f"{name}: an action of dtype {array.dtype}, expected {'integers' if some else 'real numbers'}")
    if array.shape != space.shape:
        raise ValueError(f"{name}: an action of shape {array.shape}, expected {space.shape}")
    if some:
        array = array.astype(np.int64, copy=False)
        if not space.contains(array.astype(space.dtype)):
            raise ValueError(f"{name}: an action that is not in {space}")
        return array
    array = array.astype(np.float64, copy=False)
    finite = np.isfinite(array)
    if not finite.all():
        first = tuple(int(index) for index in np.argwhere(~finite)[0])
        where = f"actuator {first[-1]}" + (f" of environment {first[0]}" if len(first) > 1 else "")
        raise ValueError(f"{name}: an action that is not finite: {array[first]} for {where}")
    return array


def checked_seeds(seed: int | Sequence[int | None] | None, count: int) -> list[int | None]:
    """Returns one seed per environment, as ``gymnasium.vector.SyncVectorEnv`` does: ``seed``, ``seed + 1``, ..."""
    if seed is None:
        return [None] * count
    if isinstance(seed, (int, np.integer)):
        return [int(seed) + env for env in range(count)]
    seeds = [None if one is None else int(one) for one in seed]
    if len(seeds) != count:
        raise ValueError(f"expected {count} seeds, one per environment, got {len(seeds)}")
    return seeds


def check_options(options: Mapping[str, Any] | None, known: Sequence[str]) -> None:
    """Rejects unknown reset options."""
    for name in options or ():
        if name not in known:
            raise ValueError(f"no reset option `{name}`; there is {', '.join(known) if known else 'none'}")


def checked_mask(options: Mapping[str, Any] | None, count: int) -> Array:
    """Returns the mask ``options["reset_mask"]``; by default it is True for all environments."""
    check_options(options, ("reset_mask",))
    if options is None or "reset_mask" not in options:
        return np.ones(count, dtype=np.bool_)
    mask = options["reset_mask"]
    if not isinstance(mask, np.ndarray):
        raise TypeError(f"options['reset_mask'] must be a NumPy array, got {type(mask).__name__}")
    if mask.dtype != np.bool_:
        raise TypeError(f"options['reset_mask'] must have dtype bool, got {mask.dtype}")
    if mask.shape != (count,):
        raise ValueError(f"options['reset_mask'] must have shape ({count},), got {mask.shape}")
    if not mask.any():
        raise ValueError("options['reset_mask'] selects no environment")
    return mask.copy()


def rows(values: Any, count: int, env: Named, what: str) -> Array:
    """Converts values to an array with one row per environment. Errors name the environments and the values."""
    array = np.asarray(values)
    if array.shape[:1] != (count,):
        raise ValueError(f"{env._name}: {what} is an array of shape {array.shape}, expected ({count}, ...)")
    return array


def one_each(values: Any, count: int, dtype: type[np.generic], env: Named, what: str) -> Array:
    """Copies values, one per environment, to an array with that dtype."""
    array = np.array(values, dtype=dtype)
    if array.shape != (count,):
        raise ValueError(f"{env._name}: {what} is an array of shape {array.shape}, expected ({count},)")
    return array


def one_or_all(values: Any, shape: tuple[int, int], env: Named, what: str) -> Array:
    """Returns rows of that shape: the given rows, or one row repeated."""
    array = np.asarray(values)
    if array.shape not in (shape, shape[1:]):
        raise ValueError(f"{env._name}: {what} is an array of shape {array.shape}, expected {shape} or {shape[1:]}")
    return array
