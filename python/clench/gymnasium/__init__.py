"""Gymnasium environments over one batch.

Importing this module registers gymnasium's eleven MuJoCo v5 tasks under the prefix ``clench/``. In a vector
environment, all copies are simulated by one :class:`clench.Batch`::

    import clench.gymnasium
    import gymnasium

    envs = gymnasium.make_vec("clench/Humanoid-v5", num_envs=1024)
    observations, infos = envs.reset(seed=0)
    observations, rewards, terminations, truncations, infos = envs.step(envs.action_space.sample())

    env = gymnasium.make("clench/Humanoid-v5")

Observations, rewards, infos, random initial states and keyword arguments are gymnasium's. The model files are read from
the installed gymnasium package; its own ``mujoco`` extra is not needed. In addition to gymnasium's arguments each task
takes ``precision``, ``device``, ``threads``, ``options`` and ``autoreset_mode`` of :class:`BatchEnv`. Friction by
Coulomb's law, without creep, is ``options={"contact_model": "coulomb", "stiction": True}``. With
``render_mode="rgb_array"``, ``render`` returns pictures, drawn without a window; there is no other mode.

A custom task is a class that defines, over all environments at once, the observation, the reward, and the end of an
episode::

    import numpy as np
    from clench.gymnasium import BatchEnv

    class Balance(BatchEnv):
        model = "cart_pole.xml"
        frame_skip = 2
        max_episode_steps = 500

        def observe(self):
            return np.concatenate([self.batch.qpos, self.batch.qvel], axis=1)

        def reward(self, action):
            return 1.0 - self.batch.qpos[:, 1] ** 2 - 0.01 * np.square(action).sum(axis=1)

        def terminated(self):
            return np.abs(self.batch.qpos[:, 1]) > 0.5

        def initial_state(self, rng):
            return self.init_qpos + rng.normal(0.0, 0.02, self.init_qpos.shape), self.init_qvel

    envs = Balance(num_envs=256)

Spaces are derived from the model and from the result of ``observe``. Derived quantities, such as positions of bodies,
are named in ``outputs`` and read from ``self.batch``; see :class:`BatchEnv` for the rest. A single environment of the
same task takes two lines, and names are registered as in gymnasium::

    class BalanceEnv(clench.gymnasium.SingleEnv):
        task = Balance

    gymnasium.register("Balance-v0", "my_tasks:BalanceEnv", vector_entry_point="my_tasks:Balance")
"""

from clench.gymnasium.batch_env import BatchEnv
from clench.gymnasium.registration import register_tasks
from clench.gymnasium.single_env import SingleEnv

__all__ = ["BatchEnv", "SingleEnv", "register_tasks"]

register_tasks()
