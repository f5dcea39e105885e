"""Arrays are shared with other libraries through DLPack, without a copy.

The package does not need these libraries; each test runs if its library is installed.
"""

from __future__ import annotations

from typing import Any

import clench
import numpy as np
import pytest
from scenes import address, puppet


def batch_of(precision: Any = "32") -> clench.Batch:
    batch = clench.Batch(puppet(), 16, precision, record=["xpos"])
    batch.step(3)
    return batch


@pytest.mark.parametrize("precision", ["64", "32"])
def test_torch_sees_the_same_memory(precision: Any) -> None:
    torch = pytest.importorskip("torch", reason="PyTorch is not installed")
    batch = batch_of(precision)
    for name in ("qpos", "qvel", "ctrl", "time", "xfrc_applied", "eq_active", "xpos"):
        array = getattr(batch, name)
        tensor = torch.from_dlpack(array)
        assert tensor.data_ptr() == address(array), name
        assert tuple(tensor.shape) == array.shape and tensor.device.type == "cpu", name
        assert tensor.numpy().dtype == array.dtype, name
    tensor = torch.from_dlpack(batch.qpos)
    batch.step(5)
    assert (tensor.numpy() == batch.qpos).all()
    torch.from_dlpack(batch.ctrl).copy_(torch.full((16, 2), 0.25))
    assert (batch.ctrl == 0.25).all()
    kept = tensor.clone()
    del batch
    assert torch.equal(tensor, kept)


@pytest.mark.parametrize("precision", ["64", "32"])
def test_jax_sees_the_same_memory(precision: Any) -> None:
    jax = pytest.importorskip("jax", reason="JAX is not installed")
    jax.config.update("jax_enable_x64", True)
    batch = batch_of(precision)
    # JAX does not accept outputs, as they are read-only arrays.
    for name in ("qpos", "qvel", "ctrl", "time", "xfrc_applied"):
        array = getattr(batch, name)
        taken = jax.dlpack.from_dlpack(array, copy=False)
        assert taken.unsafe_buffer_pointer() == address(array), name
        assert taken.shape == array.shape and taken.dtype == array.dtype, name
    taken = jax.dlpack.from_dlpack(batch.qpos, copy=False)
    batch.qpos[3, 2] = 7
    assert np.asarray(taken)[3, 2] == 7
    del batch
    assert np.asarray(taken)[3, 2] == 7
