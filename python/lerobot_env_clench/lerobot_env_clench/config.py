"""The configuration of the environment for LeRobot, on its command line ``--env.type=clench``."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from lerobot.configs.types import FeatureType, PolicyFeature
from lerobot.envs.configs import EnvConfig
from lerobot.utils.constants import ACTION, OBS_ENV_STATE, OBS_IMAGE, OBS_STATE

from lerobot_env_clench.push_box import JOINTS, OBJECTS, check_obs_type

_FEATURES = {
    "agent_pos": lambda config: PolicyFeature(type=FeatureType.STATE, shape=(JOINTS,)),
    "environment_state": lambda config: PolicyFeature(type=FeatureType.ENV, shape=(OBJECTS,)),
    "pixels": lambda config: PolicyFeature(
        type=FeatureType.VISUAL, shape=(config.observation_height, config.observation_width, 3)
    ),
}


@EnvConfig.register_subclass("clench")
@dataclass
class ClenchEnvConfig(EnvConfig):
    """Settings of ``PushBox-v0``: see `lerobot_env_clench.push_box.PushBoxVectorEnv`."""

    task: str | None = "PushBox-v0"
    fps: int = 25
    episode_length: int = 200
    obs_type: str = "pixels_agent_pos"
    observation_height: int = 128
    observation_width: int = 128
    visualization_width: int = 640
    visualization_height: int = 480
    render_mode: str = "rgb_array"
    features: dict[str, Any] = field(
        default_factory=lambda: {ACTION: PolicyFeature(type=FeatureType.ACTION, shape=(JOINTS,))}
    )
    features_map: dict[str, str] = field(
        default_factory=lambda: {
            ACTION: ACTION,
            "agent_pos": OBS_STATE,
            "environment_state": OBS_ENV_STATE,
            "pixels": OBS_IMAGE,
        }
    )

    def __post_init__(self) -> None:
        for key in check_obs_type(self.obs_type):
            self.features[key] = _FEATURES[key](self)

    @property
    def package_name(self) -> str:
        return "lerobot_env_clench"

    @property
    def gym_kwargs(self) -> dict[str, Any]:
        return {
            "obs_type": self.obs_type,
            "observation_size": (self.observation_width, self.observation_height),
            "render_size": (self.visualization_width, self.visualization_height),
            "render_mode": self.render_mode,
            "max_episode_steps": self.episode_length,
        }
