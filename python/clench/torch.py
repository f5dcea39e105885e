"""Steps with gradients for PyTorch, which must be installed (``pip install torch``).

::

    import clench.torch
    import torch

    sim = clench.Sim(model)
    ctrl = torch.zeros(100, model.nu, dtype=torch.float64, requires_grad=True)
    qpos, qvel, act = clench.torch.rollout(sim, clench.torch.state(sim), ctrl)
    qpos[-1, 0].backward()
    ctrl.grad                                   # (100, nu)

Gradients are exact: they are products with the matrices of `clench.Sim.linearize`. Double backward is not supported. A
simulation and its tensors have double precision, on the processor. All else that a step depends on, such as parameters,
mocap poses and applied forces, is that of the simulation and has no gradient.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import torch
from torch import Tensor
from torch.autograd.function import once_differentiable

from clench._core import Sim
from clench._tangent import Tangent, state_size

__all__ = ["rollout", "state", "step"]

_State = tuple[Tensor, Tensor, Tensor]


def state(sim: Sim) -> _State:
    """Returns copies of the positions (nq), velocities (nv) and activations (na) of a simulation.

    Parameters
    ----------
    sim : Sim
        The simulation.

    Returns
    -------
    tuple of torch.Tensor
    """
    return torch.tensor(sim.qpos), torch.tensor(sim.qvel), torch.tensor(sim.act)


def step(sim: Sim, state: _State, ctrl: Tensor) -> _State:
    """Steps once from a state.

    The simulation moves to the new state. The backward pass repeats the step, so parameters and options must not change
    before it.

    Parameters
    ----------
    sim : Sim
        A simulation in double precision.
    state : tuple of torch.Tensor
        Positions (nq), velocities (nv) and activations (na).
    ctrl : torch.Tensor
        (nu,) Controls.

    Returns
    -------
    tuple of torch.Tensor
        The next state.

    Raises
    ------
    ValueError
        If a shape is wrong, or the simulation has single precision.
    TypeError
        If a tensor is not one of float64 on the processor.
    SimulationError
        If the simulation cannot make the step.
    """
    qpos, qvel, act = rollout(sim, state, ctrl.unsqueeze(0))
    return qpos[0], qvel[0], act[0]


def rollout(sim: Sim, state: _State, ctrl: Tensor) -> _State:
    """Steps T times from a state.

    The simulation moves to the last state. The memory for gradients grows with √T: the backward pass restores every
    ⌈√T⌉th state and repeats the steps that follow it, so parameters and options must not change before it. The
    backward pass does not change the simulation's state.

    Parameters
    ----------
    sim : Sim
        A simulation in double precision.
    state : tuple of torch.Tensor
        Positions (nq), velocities (nv) and activations (na).
    ctrl : torch.Tensor
        (T, nu) Controls of each step.

    Returns
    -------
    tuple of torch.Tensor
        Positions (T, nq), velocities (T, nv) and activations (T, na) after each step.

    Raises
    ------
    ValueError
        If a shape is wrong, or the simulation has single precision.
    TypeError
        If a tensor is not one of float64 on the processor.
    SimulationError
        If the simulation cannot make a step.
    """
    if sim.precision != "64":
        raise ValueError('gradients need a simulation in double precision: create it with precision="64"')
    for tensor in (*state, ctrl):
        if tensor.dtype != torch.float64 or tensor.device.type != "cpu":
            raise TypeError(f"gradients need float64 on the processor, not {tensor.dtype} on {tensor.device}")
    if ctrl.ndim != 2 or ctrl.shape[1] != sim.model.nu:
        raise ValueError(f"controls have shape {tuple(ctrl.shape)}, not (steps, {sim.model.nu})")
    rows: _State = _Rollout.apply(sim, *state, ctrl)
    return rows


class _Rollout(torch.autograd.Function):
    """A rollout; its backward pass multiplies the gradients by the matrices of each step, the last one first."""

    @staticmethod
    def forward(ctx: Any, sim: Sim, qpos: Tensor, qvel: Tensor, act: Tensor, ctrl: Tensor) -> _State:
        sim.qpos, sim.qvel, sim.act = qpos.numpy(), qvel.numpy(), act.numpy()
        steps = len(ctrl)
        ctx.sim, ctx.every, ctx.saved = sim, math.isqrt(max(steps - 1, 0)) + 1, []
        ctx.save_for_backward(qpos, ctrl)
        rows = tuple(np.empty((steps, size)) for size in (sim.model.nq, sim.model.nv, sim.model.na))
        for k, controls in enumerate(ctrl.numpy()):
            if k % ctx.every == 0:
                ctx.saved.append(sim.state)
            sim.ctrl = controls
            sim.step()
            for row, values in zip(rows, (sim.qpos, sim.qvel, sim.act)):
                row[k] = values
        return torch.from_numpy(rows[0]), torch.from_numpy(rows[1]), torch.from_numpy(rows[2])

    @staticmethod
    @once_differentiable
    def backward(ctx: Any, *gradients: Tensor) -> tuple[Tensor | None, ...]:
        sim, (first, ctrl) = ctx.sim, ctx.saved_tensors
        by_qpos, by_qvel, by_act = (gradient.numpy() for gradient in gradients)
        nv, na, tangent, present = sim.model.nv, sim.model.na, Tangent(sim.model), sim.state
        by_state, by_ctrl = np.zeros(state_size(sim)), np.zeros(ctrl.shape)
        try:
            for segment, start in reversed([*enumerate(ctx.saved)]):
                sim.state = start
                begin, linear = segment * ctx.every, []
                for sim.ctrl in ctrl[begin : begin + ctx.every].numpy():
                    matrices = sim.linearize(memory=True, sensors=False)
                    sim.step()
                    linear.append((matrices.A, matrices.B, tangent.basis(sim.qpos)))
                for k, (a, b, basis) in reversed([*enumerate(linear, begin)]):
                    by_state[: 2 * nv + na] += np.concatenate([by_qpos[k] @ basis, by_qvel[k], by_act[k]])
                    by_ctrl[k] = by_state @ b
                    by_state = by_state @ a
        finally:
            sim.state = present
        by_first, by_qvel, by_act = np.split(by_state[: 2 * nv + na], [nv, 2 * nv])
        by_qpos = by_first @ tangent.inverse(first.numpy())
        return None, *(torch.from_numpy(array) for array in (by_qpos, by_qvel, by_act, by_ctrl))
