"""The random generators of a batch of environments: one each, so that what happens in one never depends on the others."""

from __future__ import annotations

import operator
from collections.abc import Sequence
from typing import SupportsIndex

import numpy as np
from gymnasium.utils import seeding


class Generators:
    """As in gymnasium's ``SyncVectorEnv`` there is one generator an environment; its base class knows one for all."""

    num_envs: int
    _generators: list[np.random.Generator | None]
    _seeds: list[int | None]

    @property
    def np_random(self) -> tuple[np.random.Generator, ...]:
        """The random generators, one an environment; :meth:`generator` gives out one of them."""
        return tuple(self.generator(env) for env in range(self.num_envs))

    @np_random.setter
    def np_random(self, generators: Sequence[np.random.Generator]) -> None:
        if len(generators) != self.num_envs:
            raise ValueError(f"expected {self.num_envs} generators, one an environment, got {len(generators)}")
        self._generators, self._seeds = list(generators), [None] * self.num_envs

    @property
    def np_random_seed(self) -> tuple[int | None, ...]:
        """What they were seeded with."""
        self.np_random
        return tuple(self._seeds)

    def generator(self, env: SupportsIndex) -> np.random.Generator:
        """The random generator of one environment; one that was never seeded takes a seed from the system.

        Parameters
        ----------
        env : int
            Which environment.
        """
        index = operator.index(env)
        generator = self._generators[index]
        if generator is None:
            generator, self._seeds[index] = seeding.np_random()
            self._generators[index] = generator
        return generator

    def _seed(self, env: int, seed: int) -> None:
        self._generators[env], self._seeds[env] = seeding.np_random(seed)
