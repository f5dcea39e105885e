"""Snapshots of states, and pictures for playback. Pictures need a build of the package that draws."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from os import PathLike
from typing import Any

import numpy as np
from unisim.backend.base import (
    CameraCfg,
    PhysicsStateLayout,
    PlayCapabilities,
    PlayRenderPlan,
    normalize_play_render_mode,
)
from unisim.backend.playback import apply_on_frame_callback, env_cfg_value, write_playback_video

from clench import FreeCamera
from clench.unisim.model_queries import Array
from clench.unisim.tensors import TensorLifecycle

_NO_WINDOW = "clench opens no window here: record a video, or use clench.view(backend.batch)"


class Playback(TensorLifecycle):
    """The part of the contract that saves, restores and draws states."""

    _renderer: tuple[int, int, Any] | None = None  # Width, height, unisim's CameraCfg.

    def get_play_capabilities(self) -> Any:
        return PlayCapabilities(
            supports_physics_state_playback=True,
            supports_native_video_capture=True,
            supports_mocap_playback=self._model.nmocap > 0,
        )

    def get_physics_state_layout(self) -> Any:
        return PhysicsStateLayout(nq=self.nq, nv=self.nv, nmocap=self._model.nmocap)

    def get_physics_state(self) -> Array:
        batch = self.batch
        parts = [batch.time[:, None], batch.qpos, batch.qvel]
        if self._model.nmocap:
            parts += [batch.mocap_pos.reshape(self._num_envs, -1), batch.mocap_quat.reshape(self._num_envs, -1)]
        return np.concatenate(parts, axis=1, dtype=np.float64)

    def set_physics_state(self, state: Array) -> None:
        """Restores a snapshot; activations and forces keep their values.

        Parameters
        ----------
        state : ndarray
            (n, width) The result of `get_physics_state`.

        Raises
        ------
        ValueError
            If the shape is wrong or a number is not finite.
        """
        values = np.asarray(state, dtype=np.float64)
        shape = (self._num_envs, self.get_physics_state_layout().state_width)
        if values.shape != shape or not np.isfinite(values).all():
            raise ValueError(f"a snapshot must be finite, of shape {shape}; this has shape {values.shape}")
        parts = self.get_physics_state_layout().split_state(values)
        batch = self.batch
        batch.revive()
        batch.time, batch.qpos, batch.qvel = parts.time, parts.qpos, parts.qvel
        if self._model.nmocap:
            batch.mocap_pos, batch.mocap_quat = parts.mocap_pos, parts.mocap_quat
        batch.qacc_warmstart[:] = 0
        self._refresh()

    def get_playback_mocap_state(self, env_index: int = 0) -> tuple[Array, Array]:
        if not self._model.nmocap:
            raise NotImplementedError("the model has no mocap bodies")
        env = self._env_index(env_index)
        return self.batch.mocap_pos[env].copy(), self.batch.mocap_quat[env].copy()

    def get_playback_model(self, env_index: int | None = None) -> str:
        """Returns the path of the file to draw."""
        if env_index is not None:
            self._env_index(env_index)
        return str(self.get_scene_visual_model_file())

    def _env_index(self, env: int) -> int:
        if not 0 <= env < self._num_envs:
            raise IndexError(f"environment {env} is not in [0, {self._num_envs})")
        return int(env)

    # Pictures.

    def resolve_play_render_plan(
        self, *, play_render_mode: str | None, play_steps: int | None, output_video: str | PathLike[str] | None
    ) -> Any:
        mode = normalize_play_render_mode(play_render_mode)
        if mode == "interactive":
            raise NotImplementedError(_NO_WINDOW)
        if mode == "none":
            return PlayRenderPlan("none", headless=True, record_video=False, num_steps=None, output_video=None)
        if play_steps is None or output_video is None:
            raise ValueError("recording needs a number of steps and the path of the video")
        return PlayRenderPlan(
            "record",
            headless=True,
            record_video=True,
            num_steps=int(play_steps),
            output_video=output_video,
            renderer="clench",
        )

    def bind_renderer(
        self,
        spacing: float = 1.0,
        *,
        offset_mode: str = "grid",
        headless: bool = False,
        capture: bool = False,
        width: int = 1280,
        height: int = 720,
        camera_kwargs: Any = None,
    ) -> None:
        """Prepares pictures of one environment; see `capture_video_frame`."""
        if not headless:
            raise NotImplementedError(_NO_WINDOW)
        camera = CameraCfg.from_kwargs(camera_kwargs)
        self._env_index(camera.cam_tracking_env_idx)
        self._renderer = (int(width), int(height), camera)

    def capture_video_frame(self) -> Array:
        """Returns a picture (height, width, 3), uint8, of the camera's environment."""
        if self._renderer is None:
            raise RuntimeError("bind_renderer(headless=True, capture=True) must come before capture_video_frame")
        width, height, camera = self._renderer
        env = camera.cam_tracking_env_idx
        lookat = camera.cam_lookat
        if lookat is None:
            # The first moving body, or the origin of a model without one.
            body = max(self._base_body, min(1, self._model.nbody - 1))
            lookat = self.batch.xpos[env, body]
        free = FreeCamera(
            lookat,
            camera.cam_distance,
            camera.cam_azimuth,
            camera.cam_elevation,
            fovy=45.0 if camera.cam_fov is None else camera.cam_fov,
        )
        return self.batch.render(env, width, height, camera=free)

    def run_playback(
        self,
        *,
        env: Any,
        initialize: Callable[[], Any],
        step: Callable[[Any], Any],
        num_steps: int | None,
        output_video: str | PathLike[str] | None = None,
        render_spacing: float | None = None,
        render_offset_mode: str | None = None,
        headless: bool | None = None,
        record_video: bool | None = None,
        frame_state_getter: Callable[[], Array] | None = None,
        camera_kwargs: Any | Mapping[str, Any] | None = None,
        debug_overlay_getter: Any | None = None,
        on_frame: Callable[[int, Array], Array | None] | None = None,
    ) -> str | None:
        """Steps a task and writes a video of the camera's environment, with ``imageio``."""
        if debug_overlay_getter is not None:
            raise NotImplementedError("clench draws no debug overlays")
        if headless is False:
            raise NotImplementedError(_NO_WINDOW)
        if num_steps is None or num_steps < 1:
            raise ValueError(f"num_steps must be a positive number, not {num_steps}")
        record = output_video is not None if record_video is None else record_video
        if record and output_video is None:
            raise ValueError("recording needs the path of the video")
        self.bind_renderer(headless=True, capture=True, camera_kwargs=camera_kwargs)
        observation, frames = initialize(), []
        for _ in range(num_steps):
            observation = step(observation)
            if record:
                frames.append(self.capture_video_frame())
        if not record:
            return None
        frames = apply_on_frame_callback(frames, on_frame, backend_label="clench")
        write_playback_video(str(output_video), frames, fps=round(1 / env_cfg_value(env, "ctrl_dt", 1 / 60)))
        return str(output_video)
