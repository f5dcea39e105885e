"""`ClenchBackend`: UniSim's contract over one batch."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from unisim.backend.base import HeightScanner, SensorDescriptor
from unisim.errors import BackendError

from clench import Batch, RigidOptions
from clench.unisim import scene as scenes
from clench.unisim.model_queries import FLOAT, Array
from clench.unisim.playback import Playback
from clench.unisim.randomization import add_wrench, checked
from clench.unisim.tensors import STATE_FIELDS


class ClenchBackend(Playback):
    """UniSim's backend over a `clench.Batch`.

    After a step, sensors are those of the start of its last substep, as in MuJoCo and in UniSim's adapter for it; with
    ``body_state_required`` they are those of its end. After a reset they are those of the new state.

    Parameters
    ----------
    scene : unisim.scene.SceneCfg
        The scene: an MJCF or URDF file, and fragments. Entities, fixed variants and generated terrain are errors.
    num_envs : int
        Number of environments.
    sim_dt : float
        Duration of a substep, s; it replaces the file's timestep.
    base_name : str, optional
        The body of base poses, mass and velocity randomization.
    push_body_name : str, optional
        The body of the interval term ``push``.
    body_state_required : bool
        True to track poses and velocities of bodies. Every step then also computes sensors of its final state, which
        takes about as long as a substep.
    tracked_body_names : sequence of str, optional
        The tracked bodies; by default all named ones.
    position_actuator_gains : mapping, optional
        ``kp`` and ``kd`` of position servos, and optionally ``actuator_ids``.
    iterations : int, optional
        Limit of solver iterations.
    precision : {"32", "64"}
        Bits of the simulator's numbers. Tensors are float32 in either case.
    threads : int, optional
        Number of threads; by default that of the machine.
    options : clench.RigidOptions, optional
        Options of the simulation. By default an environment whose motion diverges is reset, as in MuJoCo.

    Raises
    ------
    clench.LoadError
        If the model cannot be loaded.
    ValueError
        If a name is unknown or a number out of range.
    NotImplementedError
        If the scene has parts that are not supported.
    """

    def __init__(
        self,
        scene: Any,
        num_envs: int,
        sim_dt: float,
        *,
        base_name: str | None = None,
        push_body_name: str | None = None,
        body_state_required: bool = False,
        tracked_body_names: Sequence[str] | None = None,
        position_actuator_gains: Mapping[str, Any] | None = None,
        iterations: int | None = None,
        precision: Literal["32", "64"] = "32",
        threads: int | None = None,
        options: RigidOptions | None = None,
    ) -> None:
        self._batch: Batch | None = None
        scenes.check_scene(scene)
        if isinstance(num_envs, bool) or not isinstance(num_envs, (int, np.integer)) or num_envs < 1:
            raise ValueError(f"num_envs must be a positive integer, not {num_envs!r}")
        if tracked_body_names is not None and not body_state_required:
            raise ValueError("tracked_body_names requires body_state_required=True")
        if options is not None and iterations is not None:
            raise ValueError("give the iterations in the options")
        self._scene, self._num_envs = scene, int(num_envs)
        spec = scenes.spec_of_scene(scene)
        scenes.set_timestep(spec, sim_dt)
        self._tracked: tuple[str, ...] = ()
        if body_state_required:
            self._tracked = scenes.add_tracking_sensors(spec, tracked_body_names, base_name)
        self._model = spec.build()
        self._base_body = -1 if base_name is None else int(self.get_body_ids([base_name])[0])
        self._push_body = -1 if push_body_name is None else int(self.get_body_ids([push_body_name])[0])
        self._wrench: NDArray[np.float64] = np.zeros((self._num_envs, self._model.nbody, 6))
        self._sensors = {
            name: slice(int(start), int(start + width))
            for name, start, width in zip(
                self._model.names("sensor"), self._model.sensor_adr, self._model.sensor_dim, strict=True
            )
            if name
        }
        options = options or RigidOptions(autoreset=True, iterations=iterations)
        self._batch = Batch(
            self._model, self._num_envs, precision, threads, options=options, record=["sensordata", "xpos"]
        )
        if position_actuator_gains is not None:
            tables = scenes.position_gains(self._model, position_actuator_gains)
            for field, table in zip(("actuator_gainprm", "actuator_biasprm"), tables, strict=True):
                self._batch.randomize(field, np.broadcast_to(table, (self._num_envs, *table.shape)))
        self._refresh()

    @property
    def batch(self) -> Batch:
        """The simulation. ``torch.from_dlpack(backend.batch.qpos)`` shares its memory."""
        if self._batch is None:
            raise BackendError("the backend is closed")
        return self._batch

    def materialize(self) -> None:
        """Does nothing: the constructor prepares all."""

    def close(self) -> None:
        """Frees the simulation; a second call does nothing."""
        self._batch = None
        self.cleanup_scene_assets()

    def _refresh(self, envs: Array | None = None) -> None:
        mask = None
        if envs is not None:
            mask = np.zeros(self._num_envs, dtype=bool)
            mask[envs] = True
        self._check(self.batch.forward(mask))

    def _check(self, failed: int) -> None:
        if failed:
            env = int(np.flatnonzero(~self.batch.running)[0])
            raise BackendError(f"{failed} environments cannot be simulated; environment {env}: {self.batch.fault(env)}")

    # Reads.

    def _host_get_state(self, fields: tuple[str, ...] | str | None = None) -> Mapping[str, Array]:
        names = ("qpos", "qvel") if fields is None else (fields,) if isinstance(fields, str) else tuple(fields)
        for name in names:
            if name not in STATE_FIELDS:
                raise KeyError(f"no state field {name!r}; fields are {', '.join(STATE_FIELDS)}")
        return {name: np.array(getattr(self.batch, name), dtype=FLOAT) for name in names}

    def get_sensor_names(self) -> tuple[str, ...]:
        return tuple(self._sensors)

    def get_sensor_inventory(self) -> tuple[Any, ...]:
        return tuple(SensorDescriptor(name, where.stop - where.start) for name, where in self._sensors.items())

    def _host_read_sensor(self, name: str) -> Array:
        if name not in self._sensors:
            raise KeyError(f"no sensor {name!r}; sensors are {', '.join(self._sensors) or 'none'}")
        return self.batch.sensordata[:, self._sensors[name]]

    def _bind_sensor_data_reader(self, names: tuple[str, ...]) -> Any:
        for name in names:
            self._host_read_sensor(name)  # An unknown name is an error now.
        columns = np.concatenate([np.arange(self._sensors[name].start, self._sensors[name].stop) for name in names])
        return lambda: self.batch.sensordata[:, columns].astype(FLOAT)

    def get_site_jacobian_w(self, site_id: int, dof_indices: Array) -> tuple[Array, Array]:
        columns = np.asarray(dof_indices).reshape(-1)
        if columns.dtype.kind not in "iu" or ((columns < 0) | (columns >= self.nv)).any():
            raise ValueError(f"dof_indices must be integers in [0, {self.nv})")
        if not 0 <= site_id < self._model.nsite:
            raise ValueError(f"site {site_id} is not in [0, {self._model.nsite})")
        jacobians = self.batch.jacobian(site=int(site_id))[..., columns].astype(FLOAT)
        return jacobians[:, 0], jacobians[:, 1]

    def bind_height_scanner(
        self, *, hfield_geom_id: int, offsets: Array, frame_body_id: int, alignment: str = "yaw", output: str = "height"
    ) -> Any:
        return _Heights(self, hfield_geom_id, offsets, frame_body_id, alignment, output)

    # Writes.

    def _host_step(self, ctrl: Array, nsteps: int = 1) -> dict[str, Any]:
        controls = checked("ctrl", ctrl, (self._num_envs, self.num_actuators))
        if isinstance(nsteps, bool) or not isinstance(nsteps, (int, np.integer)) or nsteps < 1:
            raise ValueError(f"nsteps must be a positive integer, not {nsteps!r}")
        started = time.perf_counter()
        batch, with_callback = self.batch, self._pre_step_control_fn is not None
        try:
            if with_callback:
                for substep in range(int(nsteps)):
                    self._substep(controls.astype(FLOAT), first=substep == 0)
            else:
                batch.ctrl[:], batch.xfrc_applied[:] = controls, self._wrench
                self._check(batch.step(nsteps))
        finally:
            # Wrenches are for one call, also for one that fails.
            self._wrench[:] = 0
            batch.xfrc_applied[:] = 0
        stepped = time.perf_counter()
        if self._tracked:
            self._refresh()
        refreshed = time.perf_counter()
        return {
            "timing": {"physics_ms": (stepped - started) * 1000, "refresh_cache_ms": (refreshed - stepped) * 1000},
        }

    def _substep(self, controls: Array, *, first: bool) -> None:
        """Requests controls and forces from the task, and steps once with them."""
        batch = self.batch
        if self._tracked and not first:
            self._refresh()
        self._pre_step_control_active = True
        try:
            output = self._convert_pre_step_control(controls)
        finally:
            self._pre_step_control_active = False
        wrench = self._wrench.copy()
        if output.body_ids is not None:
            add_wrench(wrench, self._body_indices(output.body_ids), output.force, output.torque)
        batch.ctrl[:], batch.xfrc_applied[:] = output.ctrl, wrench
        self._check(batch.step())

    def _host_reset(self, env_ids: Array | None = None) -> None:
        self._host_reset_default(env_ids)

    def _host_set_state(
        self, env_indices: Array, qpos: Array, qvel: Array, randomization: Any | None = None
    ) -> dict[str, Any]:
        started = time.perf_counter()
        envs = self._validate_env_ids(env_indices)
        if np.unique(envs).size != envs.size:
            raise ValueError("env_indices must be unique")
        positions = checked("qpos", qpos, (envs.size, self.nq))
        velocities = checked("qvel", qvel, (envs.size, self.nv))
        fields = self._prepared(randomization, envs)
        if envs.size:
            self._write_parameters(fields, envs)
            batch, mask = self.batch, np.zeros(self._num_envs, dtype=bool)
            mask[envs] = True
            batch.reset(mask)
            batch.qpos[envs], batch.qvel[envs] = positions, velocities
            self._wrench[envs] = 0
            self._check(batch.forward(mask))
        return {"timing": {"set_state_ms": (time.perf_counter() - started) * 1000}}


class _Heights(HeightScanner):
    """Heights of a height field below points that move with a body."""

    def __init__(
        self, backend: ClenchBackend, geom: int, offsets: Array, body: int, alignment: str, output: str
    ) -> None:
        points = np.asarray(offsets, dtype=np.float64)
        if points.ndim != 2 or points.shape[1] != 2 or not np.isfinite(points).all():
            raise ValueError(f"offsets must be finite, of shape (k, 2), not {points.shape}")
        if (output, alignment) != ("height", "yaw"):
            raise NotImplementedError(
                f"height scans have output 'height' and alignment 'yaw', not {output!r}, {alignment!r}"
            )
        self._backend, self._geom, self._body, self._points = backend, int(geom), int(body), points
        self.scan()  # Wrong indices are errors now.

    def scan(self) -> Array:
        """Returns heights (n, k) in the world frame, m."""
        heights = self._backend.batch.heights(self._geom, self._points, body=self._body)
        return heights.astype(FLOAT)


def create_backend(scene: Any, num_envs: int = 1, sim_dt: float = 0.01, **arguments: Any) -> ClenchBackend:
    """Creates a backend, with the arguments of `ClenchBackend`.

    Parameters
    ----------
    scene : unisim.scene.SceneCfg
        The scene.
    num_envs : int
        Number of environments.
    sim_dt : float
        Duration of a substep, s.
    **arguments
        Other arguments of `ClenchBackend`.

    Returns
    -------
    ClenchBackend
    """
    return ClenchBackend(scene, num_envs, sim_dt, **arguments)
