"""An environment of Clench for LeRobot: an arm pushes a box onto a mark.

Importing this package registers ``lerobot_env_clench/PushBox-v0`` with gymnasium and, if LeRobot is installed, the
environment type ``clench`` with LeRobot.
"""

from importlib.util import find_spec

import gymnasium

__all__ = ["ID"]

ID = "lerobot_env_clench/PushBox-v0"

if ID not in gymnasium.registry:
    gymnasium.register(
        id=ID,
        entry_point="lerobot_env_clench.push_box:PushBoxEnv",
        vector_entry_point="lerobot_env_clench.push_box:PushBoxVectorEnv",
        max_episode_steps=200,
    )
# A folder of that name, such as a clone of its repository, is found too, but is no package and has no origin.
_lerobot = find_spec("lerobot")
if _lerobot is not None and _lerobot.origin is not None:
    from lerobot_env_clench import config as config
