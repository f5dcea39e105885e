"""The random generators of a batch of environments: one for each, so that environments are independent of each
other."""

from __future__ import annotations

import operator
from collections.abc import Sequence
from typing import SupportsIndex

import numpy as np
from gymnasium.utils import seeding


class Generators:
    """One generator per environment, as in gymnasium's ``SyncVectorEnv``; its base class has one for all."""

    num_envs: int
    _generators: list[np.random.Generator | None]
    _seeds: list[int | None]

    @property
    def np_random(self) -> tuple[np.random.Generator, ...]:
        """The random generators, one per environment; :meth:`generator` returns one of them."""
        return tuple(self.generator(env) for env in range(self.num_envs))

    @np_random.setter
    def np_random(self, generators: Sequence[np.random.Generator]) -> None:
        if len(generators) != self.num_envs:
            raise ValueError(f"expected {self.num_envs} generators, one per environment, got {len(generators)}")
        self._generators, self._seeds = list(generators), [None] * self.num_envs

    @property
    def np_random_seed(self) -> tuple[int | None, ...]:
        """The seeds of the generators."""
        self.np_random
        return tuple(self._seeds)

    def generator(self, env: SupportsIndex) -> np.random.Generator:
        """Returns the random generator of one environment; if it was never seeded, the system seeds it.

        Parameters
        ----------
        env : int
            The index of the environment.
        """
        index = operator.index(env)
        generator = self._generators[index]
        if generator is None:
            generator, self._seeds[index] = seeding.np_random()
            self._generators[index] = generator
        return generator

    def _seed(self, env: int, seed: int) -> None:
        self._generators[env], self._seeds[env] = seeding.np_random(seed)
