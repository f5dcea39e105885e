"""Answers of many numbers, as arrays that travel between machines: the fields of `clench.RayHits` and `clench.IkResult`."""

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
        """Copies of the arrays of an answer of `clench.Batch`."""
        return cls(*(np.asarray(getattr(answer, field.name)) for field in fields(cls)))  # type: ignore[arg-type]

    @classmethod
    def joined(cls, parts: Sequence[Self]) -> Self:
        """The rows of one part below those of the other."""
        names = [field.name for field in fields(cls)]  # type: ignore[arg-type]
        return cls(*(np.concatenate([getattr(part, name) for part in parts]) for name in names))


@dataclass(frozen=True)
class RayHits(_Rows):
    """What rays hit first, in each environment.

    Attributes
    ----------
    geom : ndarray
        The geom (n, k), int64; −1 where a ray hits nothing.
    distance : ndarray
        From the ray's origin, in lengths of its direction (n, k); infinite where it hits nothing.
    normal : ndarray
        Unit vectors out of the geom there, in world coordinates (n, k, 3).
    """

    geom: NDArray[np.int64]
    distance: Array
    normal: Array


@dataclass(frozen=True)
class IkResult(_Rows):
    """What inverse kinematics found, in each environment.

    Attributes
    ----------
    qpos : ndarray
        The positions (n, nq).
    errors : ndarray
        What is left of each goal (n, goals), m and rad.
    iterations : ndarray
        How many iterations it took (n).
    status : ndarray
        Why each ended (n), codes of `clench.IkStatus`.
    reached : ndarray
        Whether every goal but postures is within the tolerance (n), bool.
    """

    qpos: Array
    errors: Array
    iterations: Array
    status: Array
    reached: NDArray[np.bool_]
