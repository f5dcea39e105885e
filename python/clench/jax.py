"""Steps with gradients for JAX, and JAX arrays on a simulation's memory. JAX must be installed (``pip install jax``).

::

    import clench.jax
    import jax

    jax.config.update("jax_enable_x64", True)
    step = clench.jax.step(clench.Sim(model))
    state = clench.jax.state(sim)

    def height(ctrl):                            # (100, nu)
        (qpos, qvel, act), _ = jax.lax.scan(lambda state, u: (step(state, u), None), state, ctrl)
        return qpos[2]

    jax.grad(height)(ctrl)

`view` shares outputs with JAX without a copy: ``clench.jax.view(batch.xpos)``.

A batch works like a simulation, with a row for each environment. Gradients are exact, those of steps in double precision:
`clench.Sim.vjp` computes them. Only reverse mode is supported, once. Steps run on the processor.
"""

from __future__ import annotations

from typing import Any

try:
    import jax
except ModuleNotFoundError as error:
    raise ModuleNotFoundError("clench.jax needs JAX: pip install 'clench[jax]'", name=error.name) from error
import numpy as np
from numpy.typing import NDArray

from clench._core import Batch, Sim
from clench._gradients import advance_all
from clench._tangent import tangent_of

__all__ = ["state", "step", "view"]

_State = tuple[Any, Any, Any]


def state(sim: Sim | Batch) -> _State:
    """Returns copies of the positions (nq), velocities (nv) and activations (na) of a simulation, or of a batch.

    Parameters
    ----------
    sim : Sim or Batch
        The simulation.

    Returns
    -------
    tuple of jax.Array
        With a row for each environment of a batch.
    """
    return jax.numpy.array(sim.qpos), jax.numpy.array(sim.qvel), jax.numpy.array(sim.act)


def step(sim: Sim | Batch) -> Any:
    """Returns a pure function that steps, with a gradient: ``step(state, ctrl)`` is the next state.

    A state has positions (nq), velocities (nv) and activations (na), with a row for each environment of a batch. All
    else that a step depends on, such as parameters, mocap poses and applied forces, is that of the simulation now. The
    function works in `jax.jit` and `jax.lax.scan`; `jax.vmap` calls it one element at a time. It uses the simulation,
    so that one thread at a time may call it. It raises `ValueError` if a shape is wrong.

    Parameters
    ----------
    sim : Sim or Batch
        A simulation.

    Returns
    -------
    callable

    Raises
    ------
    ValueError
        If the simulation has double precision, and JAX is not set to it.
    """
    if sim.precision == "64" and not jax.config.jax_enable_x64:
        raise ValueError('the simulation needs double precision: call jax.config.update("jax_enable_x64", True) first')
    model, base, tangent = sim.model, sim.state, tangent_of(sim.model)
    parts = tuple(jax.ShapeDtypeStruct(part.shape, part.dtype) for part in (sim.qpos, sim.qvel, sim.act, sim.ctrl))

    def write(qpos: Any, qvel: Any, act: Any, ctrl: Any) -> None:
        sim.state = base
        sim.qpos, sim.qvel, sim.act, sim.ctrl = (np.asarray(part) for part in (qpos, qvel, act, ctrl))

    def advance(*arguments: Any) -> tuple[Any, ...]:
        write(*arguments)
        advance_all(sim)
        return sim.qpos.copy(), sim.qvel.copy(), sim.act.copy()

    def multiply(qpos: Any, qvel: Any, act: Any, ctrl: Any, after: Any, *gradients: Any) -> tuple[Any, ...]:
        by_qpos, by_qvel, by_act = (np.asarray(gradient, dtype=np.float64) for gradient in gradients)
        by_motion = tangent.by_motion(np.asarray(after, dtype=np.float64), by_qpos)
        write(qpos, qvel, act, ctrl)
        by_state, by_ctrl, _ = sim.vjp(np.concatenate([by_motion, by_qvel, by_act], axis=-1))
        by_motion, by_qvel, by_act = np.split(by_state, [model.nv, 2 * model.nv], axis=-1)
        by_qpos = tangent.by_coordinates(np.asarray(qpos, dtype=np.float64), by_motion)
        return tuple(part.astype(sim.qpos.dtype) for part in (by_qpos, by_qvel, by_act, by_ctrl))

    def call(state: _State, ctrl: Any) -> Any:
        return jax.pure_callback(advance, parts[:3], *state, ctrl, vmap_method="sequential")

    def forward(state: _State, ctrl: Any) -> tuple[Any, Any]:
        following = call(state, ctrl)
        return following, (*state, ctrl, following[0])

    def backward(saved: Any, gradients: Any) -> tuple[Any, Any]:
        products = jax.pure_callback(multiply, parts, *saved, *gradients, vmap_method="sequential")
        return tuple(products[:3]), products[3]

    differentiable: Any = jax.custom_vjp(call)
    differentiable.defvjp(forward, backward)

    def function(state: _State, ctrl: Any) -> Any:
        qpos, qvel, act = state
        for name, given, needed in zip(("qpos", "qvel", "act", "ctrl"), (qpos, qvel, act, ctrl), parts):
            if jax.numpy.shape(given) != needed.shape:
                raise ValueError(f"{name} has shape {jax.numpy.shape(given)}, not {needed.shape}")
        return differentiable((qpos, qvel, act), ctrl)

    return function


class _Writable:
    """The memory of a read-only array, for NumPy as if it could be written to. It keeps the array alive."""

    def __init__(self, array: NDArray[Any]) -> None:
        self.array = array
        interface = array.__array_interface__
        self.__array_interface__ = {**interface, "data": (interface["data"][0], False)}


def view(array: NDArray[Any]) -> Any:
    """Returns a JAX array on the memory of an array of a simulation or batch, without a copy.

    ``jax.dlpack.from_dlpack`` refuses outputs such as ``batch.xpos``, because they are read-only; this function takes
    them too. JAX does not expect that its arrays change: the values are those of the next step once it is made, also for
    computations that JAX has not completed. Copy values that you store, and call ``block_until_ready`` before a step.

    Parameters
    ----------
    array : numpy.ndarray
        A part of the state, or an output of a batch. Outputs of a simulation are copies already; JAX takes them with
        ``jax.numpy.asarray``.

    Returns
    -------
    jax.Array

    Raises
    ------
    TypeError
        If it is no array.
    ValueError
        If JAX cannot share it: it is not contiguous, its start is no multiple of 64 bytes, or it has double precision
        and JAX is not set to that.
    """
    if not isinstance(array, np.ndarray):
        raise TypeError(f"view takes an array of NumPy, not {type(array).__name__}")
    if array.dtype == np.float64 and not jax.config.jax_enable_x64:
        raise ValueError('JAX would copy doubles to floats: call jax.config.update("jax_enable_x64", True) first')
    if not array.flags.c_contiguous:
        raise ValueError("view takes a contiguous array")
    # DLPack's first version, the one that JAX reads, has no read-only arrays. JAX itself writes to none.
    writable = array if array.flags.writeable else np.asarray(_Writable(array))
    return jax.dlpack.from_dlpack(writable, copy=False)
