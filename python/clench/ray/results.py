"""Query results that are sent between machines as arrays: the fields of `clench.RayHits` and `clench.IkResult`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray
from typing_extensions import Self

Array = NDArray[Any]


class _Rows:
    """Arrays whose first axis is environments."""

    @classmethod
    def of(cls, answer: Any) -> Self:
        """Copies the arrays of a result of `clench.Batch`."""
        return cls(*(np.asarray(getattr(answer, field.name)) for field in fields(cls)))  # type: ignore[arg-type]

    @classmethod
    def joined(cls, parts: Sequence[Self]) -> Self:
        """Concatenates the rows of all parts."""
        names = [field.name for field in fields(cls)]  # type: ignore[arg-type]
        return cls(*(np.concatenate([getattr(part, name) for part in parts]) for name in names))


@dataclass(frozen=True)
class RayHits(_Rows):
    """The first hits of rays, in each environment.

    Attributes
    ----------
    geom : ndarray
        The geom (n, k), int64; −1 if a ray hits nothing.
    distance : ndarray
        From the ray's origin, in lengths of its direction (n, k); infinite if it hits nothing.
    normal : ndarray
        Outward unit normals of the geom there, in world coordinates (n, k, 3).
    """

    geom: NDArray[np.int64]
    distance: Array
    normal: Array


@dataclass(frozen=True)
class IkResult(_Rows):
    """The results of inverse kinematics, in each environment.

    Attributes
    ----------
    qpos : ndarray
        The positions (n, nq).
    errors : ndarray
        The remaining error of each goal (n, goals), m and rad.
    iterations : ndarray
        The number of iterations (n).
    status : ndarray
        The outcome (n), codes of `clench.IkStatus`.
    reached : ndarray
        True if all goals except postures are within the tolerance (n), bool.
    """

    qpos: Array
    errors: Array
    iterations: Array
    status: Array
    reached: NDArray[np.bool_]
