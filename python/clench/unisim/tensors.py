"""The boundary to Torch. Physics runs on the processor, so views are copies on the device that the caller names."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from unisim.backend.base import (
    SelectedResetPublication,
    TensorDataPlane,
    TensorExecution,
    TensorLifecycleCapabilities,
    TensorProcessTopology,
    TrackedBodyStateViews,
    validate_torch_device,
)
from unisim.backend.packed_reset import PackedResetTransaction
from unisim.dr.types import TensorResetRandomizationPayload, validate_tensor_reset_payload

from clench.unisim.model_queries import FLOAT, Array
from clench.unisim.randomization import Randomization
from clench.unisim.scene import WORLD_SENSORS

STATE_FIELDS = ("qpos", "qvel", "ctrl")
_DEVICES = ("cpu", "cuda")


class TensorLifecycle(Randomization):
    """The part of the contract in Torch tensors: views, steps and resets."""

    _tracked: tuple[str, ...]

    def get_tensor_execution(self) -> Any:
        return TensorExecution.HOST_BRIDGE

    def get_tensor_capabilities(self) -> Any:
        terms = self.get_dr_capabilities().supported_reset_terms
        return TensorLifecycleCapabilities(
            execution=TensorExecution.HOST_BRIDGE,
            state_views=True,
            state_fields=frozenset(STATE_FIELDS),
            sensor_views=True,
            stepping=True,
            selected_reset=True,
            reset_randomization=True,
            device_reset_randomization=True,
            packed_reset=True,
            packed_reset_fields=frozenset(terms),
            packed_reset_mocap=self._model.nmocap > 0,
            host_pre_step_control=True,
            process_topology=TensorProcessTopology.IN_PROCESS,
            data_plane=TensorDataPlane.HOST_BRIDGE,
            stream_event_ownership="caller's stream, synchronized by each copy to the host",
            torch_devices=_DEVICES,
            selected_reset_publication=SelectedResetPublication.AUTHORITATIVE_VIEWS,
            tracked_body_views=bool(self._tracked),
            mask_selected_reset=True,
            mask_selected_reset_full_refresh=True,
        )

    def bind_packed_reset(self, *, device: Any | None = None) -> Any:
        return PackedResetTransaction(self, device=device)

    # Reads.

    def get_state_views(
        self, fields: tuple[str, ...] | str | None = None, device: Any | None = None
    ) -> Mapping[str, Any]:
        return {name: _on_device(values, device) for name, values in self._host_get_state(fields).items()}

    def get_sensor_view(self, name: str, device: Any | None = None) -> Any:
        return _on_device(self._host_read_sensor(name), device)

    def get_tracked_body_views(self, body_names: Sequence[str] | None = None, device: Any | None = None) -> Any:
        if not self._tracked:
            raise NotImplementedError("no body is tracked; construct the backend with body_state_required=True")
        names = self._tracked if body_names is None else tuple(body_names)
        unknown = [name for name in names if name not in self._tracked]
        if unknown:
            raise ValueError(f"body {unknown[0]!r} is not tracked; tracked bodies are {', '.join(self._tracked)}")
        views = []
        for prefix in WORLD_SENSORS:
            values = [self._host_read_sensor(f"{prefix}_{name}") for name in names]
            views.append(_on_device(np.stack(values, axis=1), device))
        return TrackedBodyStateViews(names, *views)

    # Writes.

    def step_tensor(self, ctrl: Any, nsteps: int = 1) -> dict[str, Any]:
        started = time.perf_counter()
        _check_tensor("ctrl", ctrl, (self._num_envs, self.num_actuators), "float32")
        host = _on_host(ctrl)
        copied = (time.perf_counter() - started) * 1000
        result = self._host_step(host, nsteps)
        return {"timing": {**result["timing"], "tensor_control_d2h_ms": copied}}

    def set_state_tensor(
        self, env_indices: Any, qpos: Any, qvel: Any, randomization: Any | None = None
    ) -> dict[str, Any]:
        _check_tensor("env_indices", env_indices, (None,), "int64")
        count = int(env_indices.shape[0])
        _check_tensor("qpos", qpos, (count, self.nq), "float32", like=env_indices)
        _check_tensor("qvel", qvel, (count, self.nv), "float32", like=env_indices)
        if randomization is not None:
            validate_tensor_reset_payload(randomization, device=env_indices.device)
        return self._host_set_state(_on_host(env_indices), _on_host(qpos), _on_host(qvel), randomization)

    def set_state_tensor_mask(
        self,
        reset_mask: Any,
        qpos: Any,
        qvel: Any,
        randomization: Any | None = None,
        *,
        full_refresh: bool = False,
    ) -> dict[str, Any]:
        if not isinstance(full_refresh, bool):
            raise TypeError(f"full_refresh must be a bool, not {type(full_refresh).__name__}")
        _check_tensor("reset_mask", reset_mask, (self._num_envs,), "bool")
        _check_tensor("qpos", qpos, (self._num_envs, self.nq), "float32", like=reset_mask)
        _check_tensor("qvel", qvel, (self._num_envs, self.nv), "float32", like=reset_mask)
        rows = reset_mask.nonzero().flatten()
        if randomization is not None:
            validate_tensor_reset_payload(randomization, device=reset_mask.device)
            terms = {term: getattr(randomization, term) for term in randomization.requested_terms()}
            for term, table in terms.items():
                if table.shape[:1] != reset_mask.shape:
                    raise ValueError(f"reset field {term!r} must have {self._num_envs} rows, not {table.shape[0]}")
            randomization = TensorResetRandomizationPayload(**{term: table[rows] for term, table in terms.items()})
        result = self._host_set_state(_on_host(rows), _on_host(qpos[rows]), _on_host(qvel[rows]), randomization)
        if full_refresh:
            self._refresh()
        return result

    def set_mocap_pose_tensor(self, body_name: str, env_indices: Any, poses: Any) -> None:
        _check_tensor("env_indices", env_indices, (None,), "int64")
        _check_tensor("poses", poses, (int(env_indices.shape[0]), 7), "float32", like=env_indices)
        self.bind_mocap_pose(body_name).write(_on_host(env_indices), _on_host(poses))

    # The host's side, of the derived class.

    def _host_get_state(self, fields: tuple[str, ...] | str | None = None) -> Mapping[str, Array]:
        raise NotImplementedError

    def _host_read_sensor(self, name: str) -> Array:
        raise NotImplementedError

    def _host_step(self, ctrl: Array, nsteps: int = 1) -> dict[str, Any]:
        raise NotImplementedError

    def _host_set_state(
        self, env_indices: Array, qpos: Array, qvel: Array, randomization: Any | None = None
    ) -> dict[str, Any]:
        raise NotImplementedError


def _on_device(values: Array, device: Any | None) -> Any:
    """Copies an array to a Torch device, by default the processor."""
    import torch

    target = torch.device("cpu" if device is None else device)
    validate_torch_device(_DEVICES, target, label="clench")
    return torch.from_numpy(np.array(values, dtype=FLOAT, order="C")).to(target)


def _on_host(tensor: Any) -> Array:
    """Returns the values of a tensor, without a copy where it is on the processor."""
    array: Array = tensor.detach().cpu().numpy()
    return array


def _check_tensor(
    name: str, tensor: Any, shape: tuple[int | None, ...], dtype: str, *, like: Any | None = None
) -> None:
    """Checks a contiguous tensor, which must be on the device of another one."""
    import torch

    if not isinstance(tensor, torch.Tensor):
        raise TypeError(f"{name} must be a torch.Tensor, not {type(tensor).__name__}")
    if len(tensor.shape) != len(shape) or any(n not in (None, m) for n, m in zip(shape, tensor.shape, strict=True)):
        raise ValueError(f"{name} must have shape {shape}, not {tuple(tensor.shape)}")
    if tensor.dtype != getattr(torch, dtype):
        raise TypeError(f"{name} must be {dtype}, not {tensor.dtype}")
    if not tensor.is_contiguous():
        raise ValueError(f"{name} must be contiguous")
    validate_torch_device(_DEVICES, tensor.device, label=name)
    if like is not None and tensor.device != like.device:
        raise ValueError(f"{name} is on {tensor.device}, but the environments are chosen on {like.device}")
