"""Arrays are shared with other libraries through DLPack, without a copy.

The package does not need these libraries; each test runs if its library is installed.
"""

from __future__ import annotations

import tracemalloc
from collections.abc import Callable, Iterator
from typing import Any

import clench
import numpy as np
import pytest
from clench._core import _STATE_FIELDS
from scenes import address, example, puppet

FIELDS = ("time", *(name for name, *_ in _STATE_FIELDS))
PRECISIONS = pytest.mark.parametrize("precision", ["64", "32"])
KINDS = pytest.mark.parametrize("kind", ["batch", "sim"])

# Parts that other models lack: plastic springs, sensors, cameras, trees that sleep.
SCENE = """
<mujoco>
  <option><flag sleep="enable"/></option>
  <worldbody>
    <camera name="eye" pos="0 -1 1"/>
    <body pos="0 0 1">
      <joint name="bent" axis="0 1 0" stiffness="5" springyield="0.2"/>
      <geom type="capsule" fromto="0 0 0 0.3 0 0" size="0.02"/>
    </body>
  </worldbody>
  <sensor><jointpos joint="bent"/><jointvel joint="bent"/></sensor>
</mujoco>"""


@pytest.fixture(name="torch")
def _torch() -> Any:
    return pytest.importorskip("torch", reason="PyTorch is not installed")


@pytest.fixture(name="jax")
def _jax() -> Any:
    jax = pytest.importorskip("jax", reason="JAX is not installed")
    jax.config.update("jax_enable_x64", True)
    return jax


@pytest.fixture(name="make", params=["torch", "jax"])
def _make(request: pytest.FixtureRequest) -> Any:
    """A function that makes an array of each library."""
    library = request.getfixturevalue(request.param)
    return library.from_numpy if request.param == "torch" else library.numpy.asarray


def simulations(kind: str, precision: Any) -> list[Any]:
    """Simulations that have moved, with all outputs: together they have every field of the state and every output."""
    options = clench.RigidOptions(stiction=True)
    models = (puppet(), example("arm_and_box"), clench.Model.from_xml(SCENE))
    if kind == "sim":
        made: list[Any] = [clench.Sim(model, options, precision=precision) for model in models]
    else:
        made = [clench.Batch(model, 16, precision, options=options, record=clench.OUTPUTS) for model in models]
    for simulation in made:
        simulation.step(3)
    return made


def arrays(kind: str, precision: Any, names: tuple[str, ...]) -> Iterator[tuple[str, Any]]:
    """Arrays of these names that are not empty, and checks that each name has one."""
    # Single numbers of a simulation are not arrays.
    seen = {"time", "actuator_power", "contact_count", "solver_iterations"} if kind == "sim" else set()
    for simulation in simulations(kind, precision):
        for name in names:
            array = getattr(simulation, name)
            if isinstance(array, np.ndarray) and array.size:
                seen.add(name)
                yield name, array
    assert seen >= set(names), set(names) - seen


@KINDS
@PRECISIONS
def test_torch_shares_the_whole_state(torch: Any, kind: str, precision: Any) -> None:
    for name, array in arrays(kind, precision, FIELDS):
        tensor = torch.from_dlpack(array)
        assert tensor.data_ptr() == address(array) and tuple(tensor.shape) == array.shape, name
        assert tensor.device.type == "cpu" and tensor.numpy().dtype == array.dtype, name
        tensor.fill_(1)
        assert (array == 1).all(), name
        array[...] = 0
        assert not tensor.any(), name


@KINDS
@PRECISIONS
@pytest.mark.filterwarnings("ignore:The given NumPy array is not writable")
def test_torch_shares_every_output(torch: Any, kind: str, precision: Any) -> None:
    for name, array in arrays(kind, precision, clench.OUTPUTS):
        tensor = torch.from_dlpack(array)
        assert tensor.data_ptr() == address(array) and tuple(tensor.shape) == array.shape, name
        assert tensor.numpy().dtype == array.dtype, name


@KINDS
@PRECISIONS
def test_jax_shares_the_whole_state(jax: Any, kind: str, precision: Any) -> None:
    for name, array in arrays(kind, precision, FIELDS):
        taken = jax.dlpack.from_dlpack(array, copy=False)
        assert taken.unsafe_buffer_pointer() == address(array), name
        assert taken.shape == array.shape and taken.dtype == array.dtype, name
        array[...] = 1
        assert np.asarray(taken).all(), name


@PRECISIONS
def test_jax_shares_every_output(jax: Any, precision: Any) -> None:
    share: Any = pytest.importorskip("clench.jax").view
    for name, array in arrays("batch", precision, (*clench.OUTPUTS, *FIELDS)):
        taken = share(array)
        assert taken.unsafe_buffer_pointer() == address(array), name
        assert taken.shape == array.shape and taken.dtype == array.dtype, name
        assert (np.asarray(taken) == array).all(), name


@PRECISIONS
def test_what_is_shared_follows_the_steps_and_outlives_the_batch(torch: Any, jax: Any, precision: Any) -> None:
    batch = clench.Batch(puppet(), 16, precision, record=["xpos"])
    qpos = torch.from_dlpack(batch.qpos), jax.dlpack.from_dlpack(batch.qpos, copy=False)
    xpos = pytest.importorskip("clench.jax").view(batch.xpos)
    batch.step(5)
    expected = batch.qpos.copy(), batch.xpos.copy()
    torch.from_dlpack(batch.ctrl).copy_(torch.full((16, 2), 0.25))
    assert (batch.ctrl == 0.25).all()
    del batch
    assert all((np.asarray(taken) == expected[0]).all() for taken in qpos)
    assert (np.asarray(xpos) == expected[1]).all()


def test_what_jax_cannot_share(jax: Any) -> None:
    share: Any = pytest.importorskip("clench.jax").view
    batch = clench.Batch(puppet(), 4)
    with pytest.raises(TypeError, match="array of NumPy, not list"):
        share([1.0])
    with pytest.raises(ValueError, match="contiguous"):
        share(batch.qpos[:, :2])
    with pytest.raises(ValueError, match="not aligned"):
        share(batch.qpos[1])  # JAX shares what starts at a multiple of 64 bytes; outputs of a `Sim` need not.
    jax.config.update("jax_enable_x64", False)
    try:
        with pytest.raises(ValueError, match="jax_enable_x64"):
            share(batch.qpos)
        assert share(clench.Batch(puppet(), 4, "32").qpos).dtype == np.float32
    finally:
        jax.config.update("jax_enable_x64", True)


# The other direction.


def least_copied(call: Callable[[], object]) -> int:
    """Returns how many bytes NumPy allocates for a call that was made before."""
    call()
    tracemalloc.start()
    call()
    allocated = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return allocated


@PRECISIONS
def test_tensors_are_taken_without_an_intermediate_copy(make: Any, precision: Any) -> None:
    batch = clench.Batch(example("humanoid"), 500, precision, 1)
    numbers = np.random.default_rng(0).random((500, 4, batch.model.nu)).astype(batch.qpos.dtype)
    ctrl, plan = make(numbers[:, 0].copy()), make(numbers)

    def assign() -> None:
        batch.ctrl = ctrl

    def roll() -> dict[str, Any]:
        return batch.rollout(None, plan, record=[])

    assert least_copied(assign) < batch.ctrl.nbytes / 50 and least_copied(roll) < numbers.nbytes / 50
    assign()
    assert (batch.ctrl == numbers[:, 0]).all()
    sim = clench.Sim(batch.model, precision=precision)
    sim.ctrl = plan[3][0]
    assert (sim.ctrl == numbers[3, 0]).all()


@PRECISIONS
def test_tensors_go_wherever_arrays_go(make: Any, precision: Any) -> None:
    batches = [clench.Batch(example("arm_and_box"), 8, precision, 1) for _ in range(2)]
    random = np.random.default_rng(1)
    start = np.concatenate([batches[0].time[:, None], batches[0].qpos, batches[0].qvel], axis=1)
    plan, mass = random.random((8, 5, 6)), batches[0].param("body_mass") * 1.5
    results = []

    def controls(given: Callable[[Any], Any]) -> Callable[[int], Any]:
        return lambda step: given(plan[:, step].copy())

    for batch, given in zip(batches, (np.asarray, make), strict=True):
        batch.randomize("body_mass", given(mass[:2].copy()), given(np.array([0, 5])), consistent=True)
        recorded = batch.rollout(given(start), given(plan), record=["qpos"])
        batch.rollout(None, controls(given), record=[], steps=2)
        batch.reset(given(np.arange(8) < 3))
        rays = batch.rays(given(np.array([[0.0, 0.0, 2.0]])), given(np.array([[0.0, 0.0, -1.0]])))
        results.append((recorded["qpos"], batch.qpos.copy(), rays.distance))
    for expected, result in zip(*results, strict=True):
        assert (expected == result).all()


def test_torch_refuses_what_has_no_array(torch: Any) -> None:
    batch = clench.Batch(puppet(), 4)
    with pytest.raises(RuntimeError, match="detach"):
        batch.ctrl = torch.zeros(4, 2, requires_grad=True)
    with pytest.raises(TypeError, match="BFloat16"):
        batch.ctrl = torch.zeros(4, 2, dtype=torch.bfloat16)
    with pytest.raises(ValueError, match="shape"):
        batch.ctrl = torch.zeros(3, 2)


@PRECISIONS
def test_results_are_written_to_tensors(torch: Any, precision: Any) -> None:
    sim = clench.Sim(example("arm_and_box"), precision=precision)
    out = torch.zeros((2, 3, sim.model.nv), dtype=torch.float64 if precision == "64" else torch.float32)
    written: Any = sim.jacobian(body="hand", out=out)
    assert written is out
    assert (out.numpy() == sim.jacobian(body="hand")).all() and out.any()
    with pytest.raises(TypeError, match="out must be an array of float"):
        sim.jacobian(body="hand", out=out.half())
    with pytest.raises(ValueError, match="out has shape"):
        sim.jacobian(body="hand", out=out[:1])
