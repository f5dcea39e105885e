"""Infos in the form of gymnasium's vector environments.

Each key stores an array with one row per environment, and the key with a leading underscore stores the mask of valid
rows. Invalid rows are zero, or None for objects.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from clench.gymnasium.observations import of_one

Array = NDArray[Any]

Group: TypeAlias = tuple[Mapping[str, Array], Array]
"""Arrays over all environments by name, and the mask of their valid environments."""


def add(infos: dict[str, Any], values: Mapping[str, Array], mask: Array) -> None:
    """Copies the rows in ``mask`` of each array into ``infos``, and replaces existing values; does nothing if ``mask``
    is empty.

    Parameters
    ----------
    infos : dict
        The infos to extend. They store copies, never the arrays themselves.
    values : mapping of str to ndarray
        Arrays (n, ...) over all environments.
    mask : ndarray
        Booleans (n,).
    """
    if mask.all():
        for key, value in values.items():
            infos[key], infos[f"_{key}"] = value.copy(), mask.copy()
    elif mask.any():
        for key, value in values.items():
            if key not in infos:
                infos[key] = np.full_like(value, None if value.dtype == np.object_ else 0)
                infos[f"_{key}"] = np.zeros_like(mask)
            infos[key][mask] = value[mask]
            infos[f"_{key}"] |= mask


def add_final(infos: dict[str, Any], observation: Any, groups: list[Group], done: Array) -> None:
    """Adds the last observations and infos of the episodes in ``done``: ``final_obs`` and ``final_info``.

    Parameters
    ----------
    infos : dict
        The infos to extend.
    observation : ndarray or dict of str to ndarray
        The last observations (n, ...). Rows of them are returned to the user, so they must not be shared.
    groups : list of Group
        The infos of the last steps.
    done : ndarray
        Booleans (n,): True for environments whose episode ended.
    """
    last = np.full(done.shape, None, dtype=np.object_)
    for env in np.flatnonzero(done).tolist():
        last[env] = of_one(observation, env)
    final: dict[str, Any] = {}
    for values, mask in groups:
        add(final, values, mask & done)
    infos["final_obs"], infos["_final_obs"] = last, done.copy()
    infos["final_info"], infos["_final_info"] = final, done.copy()
