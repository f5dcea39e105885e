"""The common part of Humanoid and HumanoidStandup: a body with a free root, of which nearly everything is observed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clench.gymnasium.tasks.task import Task

Array = NDArray[Any]


class Person(Task):
    """Observes positions, velocities, inertias, spatial velocities, actuator forces and external forces.

    Parameters
    ----------
    num_envs : int
        Number of environments.
    exclude_current_positions_from_observation : bool
        True to omit x and y.
    include_cinert_in_observation : bool
        True to observe ``cinert`` of all bodies except the world.
    include_cvel_in_observation : bool
        True to observe ``cvel`` of all bodies except the world.
    include_qfrc_actuator_in_observation : bool
        True to observe ``qfrc_actuator`` of all dofs except the root's.
    include_cfrc_ext_in_observation : bool
        True to observe ``cfrc_ext`` of all bodies except the world; zero before the first step.
    outputs : tuple of str
        Additional outputs that the task needs.
    **kwargs
        Arguments of :class:`Task`.
    """

    def __init__(
        self,
        num_envs: int,
        *,
        exclude_current_positions_from_observation: bool,
        include_cinert_in_observation: bool,
        include_cvel_in_observation: bool,
        include_qfrc_actuator_in_observation: bool,
        include_cfrc_ext_in_observation: bool,
        outputs: tuple[str, ...] = (),
        **kwargs: Any,
    ) -> None:
        observed = {
            "cinert": include_cinert_in_observation,
            "cvel": include_cvel_in_observation,
            "qfrc_actuator": include_qfrc_actuator_in_observation,
            "cfrc_ext": include_cfrc_ext_in_observation,
        }
        wanted = [name for name, included in observed.items() if included]
        always = ["cfrc_ext", "ten_length", "ten_velocity", *outputs]
        super().__init__(num_envs, outputs=tuple(dict.fromkeys([*wanted, *always])), **kwargs)
        batch = self.batch
        skipped = 2 if exclude_current_positions_from_observation else 0
        self._parts = [batch.qpos[:, skipped:], batch.qvel]
        for name in wanted:
            values = batch.output(name)
            self._parts.append(values[:, 6:] if name == "qfrc_actuator" else values[:, 1:].reshape(num_envs, -1))
        self._forces = batch.cfrc_ext[:, 1:].reshape(num_envs, -1)
        self._observed_forces = self._forces.shape[1] if include_cfrc_ext_in_observation else 0

    def observe(self) -> Array:
        """Returns all parts, concatenated."""
        observation = np.concatenate(self._parts, axis=1)
        if self._observed_forces:
            observation[self.fresh, -self._observed_forces :] = 0.0
        return observation

    def tendon_info(self) -> Mapping[str, Array]:
        """Returns the lengths and velocities of the tendons."""
        return {"tendon_length": self.batch.ten_length, "tendon_velocity": self.batch.ten_velocity}
