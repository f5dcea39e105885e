"""Pictures of environments."""

from __future__ import annotations

from typing import Any

from numpy.typing import NDArray

from clench import Batch, FreeCamera

Array = NDArray[Any]


class Drawn:
    """Renders the environments of a batch, in the mode ``rgb_array``."""

    num_envs: int
    batch: Batch
    render_mode: str | None
    render_size: tuple[int, int] = (480, 480)
    render_camera: str | int | FreeCamera | None = None
    render_appearance: dict[str, Array] | None = None
    metadata: dict[str, Any] = {"render_modes": ["rgb_array"]}

    def render(self) -> tuple[Array, ...] | None:
        """Renders every environment in its current state.

        Returns
        -------
        tuple of ndarray or None
            The pictures (height, width, 3), uint8; None if ``render_mode`` is None.
        """
        if self.render_mode is None:
            return None
        camera = self.render_camera
        if camera is None and "track" in self.batch.model.names("camera"):
            camera = "track"
        width, height = self.render_size
        return tuple(self.batch.render(None, width, height, camera=camera, appearance=self.render_appearance))
