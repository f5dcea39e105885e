"""Environments of one batch for the algorithms of Stable-Baselines3, which must be installed (``pip install
'clench[sb3]'``).

::

    from clench.gymnasium.sb3 import BatchVecEnv
    from stable_baselines3 import PPO

    envs = Balance(num_envs=64, autoreset_mode="SameStep")
    PPO("MlpPolicy", BatchVecEnv(envs)).learn(100_000)

All environments step in one call, whereas its ``DummyVecEnv`` steps single environments one after the other.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray

try:
    from stable_baselines3.common.vec_env import VecEnv
except ModuleNotFoundError as error:
    raise ModuleNotFoundError(
        "clench.gymnasium.sb3 needs Stable-Baselines3: pip install 'clench[sb3]'", name=error.name
    ) from error

from clench.gymnasium.batch_env import BatchEnv

Array = NDArray[Any]

__all__ = ["BatchVecEnv"]


class BatchVecEnv(VecEnv):
    """An adapter from a Gymnasium vector environment to Stable-Baselines3.

    When an episode ends, the next begins in the same step, and ``info`` has ``terminal_observation`` and
    ``TimeLimit.truncated``, as that package requires. Its wrappers, such as ``VecMonitor`` and ``VecNormalize``, can be
    applied to it.

    Parameters
    ----------
    envs : BatchEnv
        The environments, made with ``autoreset_mode="SameStep"``.

    Raises
    ------
    ValueError
        If the environments have another ``autoreset_mode``, or discrete actions that do not start at 0.
    """

    def __init__(self, envs: BatchEnv) -> None:
        mode = envs.metadata["autoreset_mode"]
        if mode is not AutoresetMode.SAME_STEP:
            raise ValueError(f'make the environments with autoreset_mode="SameStep", not "{mode.value}"')
        if np.any(getattr(envs.single_action_space, "start", 0)):
            raise ValueError(f"Stable-Baselines3 counts discrete actions from 0; these are {envs.single_action_space}")
        self.envs = envs
        self._actions: Array = np.zeros(0)
        self.render_mode = envs.render_mode
        super().__init__(envs.num_envs, envs.single_observation_space, envs.single_action_space)

    def reset(self) -> Any:
        """Starts episodes.

        Returns
        -------
        ndarray or dict of str to ndarray
            Observations (n, ...).
        """
        seeds = [None if seed is None else int(seed) for seed in self._seeds]
        observations, infos = self.envs.reset(seed=seeds)
        self.reset_infos = self._each(infos)
        self._reset_seeds()
        self._reset_options()
        return observations

    def step_async(self, actions: Array) -> None:
        """Stores the actions (n, ...) of the next step."""
        self._actions = actions

    def step_wait(self) -> tuple[Any, Array, Array, list[dict[str, Any]]]:
        """Steps all environments.

        Returns
        -------
        observations : ndarray or dict of str to ndarray
            (n, ...)
        rewards : ndarray
            (n,) float32.
        dones : ndarray
            (n,) bool.
        infos : list of dict
            One per environment.
        """
        observations, rewards, terminations, truncations, infos = self.envs.step(self._actions)
        final = infos.pop("final_obs", None)
        last = infos.pop("final_info", {})
        each = self._each(infos)
        dones = terminations | truncations
        for env in np.flatnonzero(dones).tolist():
            begun, each[env] = each[env], self._of(last, env)
            each[env]["terminal_observation"] = final[env]
            each[env]["TimeLimit.truncated"] = bool(truncations[env] and not terminations[env])
            self.reset_infos[env] = begun
        return observations, rewards.astype(np.float32), dones, each

    def close(self) -> None:
        """Releases the batch."""
        self.envs.close()

    def get_images(self) -> Sequence[Array | None]:
        """Renders pictures of all environments (height, width, 3), uint8; None if ``render_mode`` is None."""
        return self.envs.render() or [None] * self.num_envs

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """Returns an attribute of the environments, which is the same for all."""
        return [getattr(self.envs, attr_name) for _ in self._get_indices(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Sets an attribute of the environments.

        Raises
        ------
        ValueError
            If only some of the environments are chosen: they share their attributes.
        """
        if len(list(self._get_indices(indices))) != self.num_envs:
            raise ValueError("environments of a batch share their attributes: set the attribute of all")
        setattr(self.envs, attr_name, value)

    def env_method(self, method_name: str, *method_args: Any, indices: Any = None, **method_kwargs: Any) -> list[Any]:
        """Raises an error: methods of a batch apply to all environments at once; call them on `envs`."""
        raise NotImplementedError(f"environments of a batch have no individual methods: call `envs.{method_name}`")

    def env_is_wrapped(self, wrapper_class: type[Any], indices: Any = None) -> list[bool]:
        """Returns False for each environment: none is wrapped separately."""
        return [False for _ in self._get_indices(indices)]

    def _each(self, infos: dict[str, Any]) -> list[dict[str, Any]]:
        return [self._of(infos, env) for env in range(self.num_envs)]

    @staticmethod
    def _of(infos: dict[str, Any], env: int) -> dict[str, Any]:
        """Returns the infos of one environment."""
        return {key: value[env] for key, value in infos.items() if f"_{key}" in infos and infos[f"_{key}"][env]}
