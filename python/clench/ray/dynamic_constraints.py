"""Constraints that are added to and removed from a batch on a cluster: each worker handles its own environments."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, SupportsIndex

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[Any]
Which = str | SupportsIndex


class DynamicConstraints:
    """Implements dynamic constraints as in `clench.Batch`; but if one worker fails, the changes of the others
    remain."""

    n_envs: int
    _parts: list[slice]

    def _change(self, method: str, arguments: Sequence[tuple[Any, ...]]) -> list[Any]:
        """Makes a call that changes the workers."""
        raise NotImplementedError

    def add_weld(self, body1: Which, body2: Which, envs: ArrayLike | None = None) -> NDArray[np.int64]:
        """Welds two bodies in their current relative pose, in some environments; returns codes for `remove`
        (len(envs)). See `clench.Batch.add_weld`."""
        return self._constrain("add_weld", envs, lambda _: (body1, body2))

    def add_connect(
        self, body1: Which, body2: Which, anchor: ArrayLike, envs: ArrayLike | None = None
    ) -> NDArray[np.int64]:
        """Connects a point of the first body (3) to the second, in some environments. See
        `clench.Batch.add_connect`."""
        return self._constrain("add_connect", envs, lambda _: (body1, body2, anchor))

    def remove(self, constraints: ArrayLike, envs: ArrayLike | None = None) -> None:
        """Removes dynamic constraints, one for each of some environments."""
        codes = np.asarray(constraints)
        if codes.shape != self._chosen(envs).shape:
            raise ValueError(f"constraints has shape {codes.shape}, but must have one for each of the environments")
        self._constrain("remove", envs, lambda here: (codes[here],))

    def weld_here(self, which: Which, envs: ArrayLike | None = None) -> None:
        """Makes a weld or connect of the model hold its bodies in their current relative pose, in some environments."""
        self._constrain("weld_here", envs, lambda _: (which,))

    def set_equality(self, which: Which, active: bool | np.bool_ | ArrayLike) -> None:
        """Switches an equality on or off, in all environments or each (n)."""
        switch = np.asarray(active)
        if switch.ndim and switch.shape != (self.n_envs,):
            raise ValueError(f"active has shape {switch.shape}, but must be one boolean or {self.n_envs}")
        self._change("set_equality", [(which, switch[part] if switch.ndim else active) for part in self._parts])

    def _chosen(self, envs: ArrayLike | None) -> Array:
        """Returns the indices of environments."""
        chosen = np.arange(self.n_envs) if envs is None else np.asarray(envs)
        if chosen.ndim != 1 or chosen.dtype.kind not in "iu":
            raise ValueError("envs must be a list of indices")
        if chosen.size and not 0 <= int(chosen.min()) <= int(chosen.max()) < self.n_envs:
            raise IndexError(f"the environment must be at least 0 and below {self.n_envs}")
        return chosen

    def _constrain(
        self, method: str, envs: ArrayLike | None, arguments: Callable[[Array], tuple[Any, ...]]
    ) -> NDArray[np.int64]:
        """Makes a call for chosen environments, on any worker; returns the result for each, in their order."""
        chosen = self._chosen(envs)
        heres = [(part.start <= chosen) & (chosen < part.stop) for part in self._parts]
        inside = [chosen[here] - part.start for here, part in zip(heres, self._parts)]
        each = self._change(method, [(*arguments(here), envs) for here, envs in zip(heres, inside)])
        answers = np.zeros(chosen.shape, np.int64)
        for here, answer in zip(heres, each):
            if answer is not None:
                answers[here] = answer
        return answers
