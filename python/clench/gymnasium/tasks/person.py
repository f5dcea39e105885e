"""What Humanoid and HumanoidStandup share: a body with a free root, of which nearly everything is observed."""

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
        How many environments.
    exclude_current_positions_from_observation : bool
        Whether x and y are left out.
    include_cinert_in_observation : bool
        Whether ``cinert`` is observed, of all bodies but the world.
    include_cvel_in_observation : bool
        Whether ``cvel`` is, likewise.
    include_qfrc_actuator_in_observation : bool
        Whether ``qfrc_actuator`` is, of all dofs but the root's.
    include_cfrc_ext_in_observation : bool
        Whether ``cfrc_ext`` is, of all bodies but the world; zero before the first step.
    outputs : tuple of str
        What the task needs besides.
    **kwargs
        What :class:`Task` takes.
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
        """All parts side by side."""
        observation = np.concatenate(self._parts, axis=1)
        if self._observed_forces:
            observation[self.fresh, -self._observed_forces :] = 0.0
        return observation

    def tendon_info(self) -> Mapping[str, Array]:
        """Lengths and velocities of the tendons."""
        return {"tendon_length": self.batch.ten_length, "tendon_velocity": self.batch.ten_velocity}
