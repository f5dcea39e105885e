"""Steps with gradients for PyTorch, which must be installed (``pip install torch``).

::

    import clench.torch
    import torch

    batch = clench.Batch(model, 64)
    ctrl = torch.zeros(100, 64, model.nu, dtype=torch.float64, requires_grad=True)
    qpos, qvel, act = clench.torch.rollout(batch, clench.torch.state(batch), ctrl)
    qpos[-1, :, 0].sum().backward()
    ctrl.grad                                   # (100, 64, nu)

A simulation works like a batch, without the dimension of environments. Tensors have the precision of the simulation or
batch, on the processor. Gradients are exact, those of steps in double precision: `clench.Sim.rollout_vjp` computes them. Double
backward is not supported. All else that a step depends on, such as parameters, mocap poses and applied forces, is that
of the simulation and has no gradient.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
try:
    import torch
except ModuleNotFoundError as error:
    raise ModuleNotFoundError("clench.torch needs PyTorch: pip install 'clench[torch]'", name=error.name) from error
from torch import Tensor
from torch.autograd.function import once_differentiable

from clench._core import Batch, Sim
from clench._gradients import advance_all
from clench._tangent import state_size, tangent_of

__all__ = ["rollout", "state", "step"]

_State = tuple[Tensor, Tensor, Tensor]


def state(sim: Sim | Batch) -> _State:
    """Returns copies of the positions (nq), velocities (nv) and activations (na) of a simulation, or of a batch.

    Parameters
    ----------
    sim : Sim or Batch
        The simulation.

    Returns
    -------
    tuple of torch.Tensor
        With a row for each environment of a batch.
    """
    return torch.tensor(sim.qpos), torch.tensor(sim.qvel), torch.tensor(sim.act)


def step(sim: Sim | Batch, state: _State, ctrl: Tensor) -> _State:
    """Steps once from a state.

    The simulation moves to the new state. The backward pass repeats the step, so parameters and options must not change
    before it.

    Parameters
    ----------
    sim : Sim or Batch
        The simulation.
    state : tuple of torch.Tensor
        Positions (nq), velocities (nv) and activations (na), with a row for each environment of a batch.
    ctrl : torch.Tensor
        (nu,) or (n, nu) Controls.

    Returns
    -------
    tuple of torch.Tensor
        The next state.

    Raises
    ------
    ValueError
        If a shape is wrong.
    TypeError
        If a tensor has another precision than the simulation, or is not on the processor.
    SimulationError
        If the simulation, or an environment, cannot make the step.
    """
    qpos, qvel, act = rollout(sim, state, ctrl.unsqueeze(0))
    return qpos[0], qvel[0], act[0]


def rollout(sim: Sim | Batch, state: _State, ctrl: Tensor) -> _State:
    """Steps T times from a state.

    The simulation moves to the last state. The memory for gradients grows with √T: the backward pass restores every
    ⌈√T⌉th state and repeats the steps that follow it, so parameters and options must not change before it. The
    backward pass does not change the simulation's state.

    Parameters
    ----------
    sim : Sim or Batch
        The simulation.
    state : tuple of torch.Tensor
        Positions (nq), velocities (nv) and activations (na), with a row for each environment of a batch.
    ctrl : torch.Tensor
        (T, nu) or (T, n, nu) Controls of each step.

    Returns
    -------
    tuple of torch.Tensor
        Positions (T, nq), velocities (T, nv) and activations (T, na) after each step; of a batch (T, n, nq) and so on.

    Raises
    ------
    ValueError
        If a shape is wrong.
    TypeError
        If a tensor has another precision than the simulation, or is not on the processor.
    SimulationError
        If the simulation, or an environment, cannot make a step.
    """
    precision = torch.from_numpy(sim.qpos).dtype
    qpos, qvel, act = state
    for tensor in (qpos, qvel, act, ctrl):
        if tensor.dtype != precision or tensor.device.type != "cpu":
            raise TypeError(f"the simulation has {precision} on the processor, not {tensor.dtype} on {tensor.device}")
    if ctrl.shape[1:] != sim.ctrl.shape:
        raise ValueError(f"controls have shape {tuple(ctrl.shape)}, not {('steps', *sim.ctrl.shape)}")
    for name, given, needed in zip(("qpos", "qvel", "act"), state, (sim.qpos, sim.qvel, sim.act)):
        if given.shape != needed.shape:
            raise ValueError(f"{name} of the state has shape {tuple(given.shape)}, not {needed.shape}")
    after: _State = _Rollout.apply(sim, qpos, qvel, act, ctrl)
    return after


class _Rollout(torch.autograd.Function):
    """A rollout; its backward pass computes the gradients of each step, the last one first."""

    @staticmethod
    def forward(ctx: Any, sim: Sim | Batch, qpos: Tensor, qvel: Tensor, act: Tensor, ctrl: Tensor) -> _State:
        sim.qpos, sim.qvel, sim.act = qpos.numpy(), qvel.numpy(), act.numpy()
        ctx.sim, ctx.every, ctx.saved = sim, math.isqrt(max(len(ctrl) - 1, 0)) + 1, []
        after = tuple(torch.empty((len(ctrl), *part.shape), dtype=part.dtype) for part in (qpos, qvel, act))
        for k, controls in enumerate(ctrl):
            if k % ctx.every == 0:
                ctx.saved.append(sim.state)
            sim.ctrl = controls.numpy()
            advance_all(sim)
            for values, part in zip(after, (sim.qpos, sim.qvel, sim.act)):
                values[k] = torch.from_numpy(part)
        ctx.save_for_backward(qpos, ctrl, after[0])
        return after[0], after[1], after[2]

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, *gradients: Tensor) -> tuple[Tensor | None, ...]:
        sim, (first, ctrl, after) = ctx.sim, ctx.saved_tensors
        nv, tangent, present = sim.model.nv, tangent_of(sim.model), sim.state
        by_qpos, by_qvel, by_act = (gradient.double().numpy() for gradient in gradients)
        by_motion = tangent.by_motion(after.double().numpy(), by_qpos)
        known = np.concatenate([by_motion, by_qvel, by_act], axis=-1)
        # A function depends on no other fields than these.
        by_rows = np.zeros((*known.shape[:-1], state_size(sim)))
        by_rows[..., : known.shape[-1]] = known
        by_state, by_ctrl = np.zeros(by_rows.shape[1:]), np.zeros(ctrl.shape)
        try:
            for segment, start in reversed([*enumerate(ctx.saved)]):
                steps = slice(segment * ctx.every, (segment + 1) * ctx.every)
                sim.state = start
                by_rows[steps][-1] += by_state
                by_state, by_ctrl[steps] = sim.rollout_vjp(ctrl[steps].numpy(), by_rows[steps], memory=True)
        finally:
            sim.state = present
        by_first, by_qvel, by_act = np.split(by_state[..., : known.shape[-1]], [nv, 2 * nv], axis=-1)
        by_qpos = tangent.by_coordinates(first.double().numpy(), by_first)
        arrays = (by_qpos, by_qvel, by_act, by_ctrl)
        return None, *(torch.from_numpy(array).to(first.dtype) for array in arrays)
