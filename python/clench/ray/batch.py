"""The driver's side of a batch that is distributed over a cluster."""

from __future__ import annotations

import dataclasses
import operator
import pickle
from collections.abc import Callable, Sequence
from typing import Any, Literal, SupportsIndex

import numpy as np
from numpy.typing import ArrayLike, NDArray
from typing_extensions import Self

import clench
from clench.ray.queries import Queries
from clench.ray.mirror import Mirror
from clench.ray.dynamic_constraints import DynamicConstraints
from clench.ray.worker import Worker, ray_module

Array = NDArray[Any]

_STATE = tuple(field.name for field in dataclasses.fields(clench.State))


class Batch(Queries, DynamicConstraints):
    """Many environments of one model, on the machines of a Ray cluster.

    The API is that of `clench.Batch`, except `ray`, derivatives, GPUs and several models. Arrays of the state
    (``qpos``, ``ctrl``, ...) are read and written in the same way: changes are sent to the workers with the next call,
    and arrays that were ever read are returned by each call. Recorded outputs are fetched on demand, and are copies.
    The environments are split into consecutive parts; the number of workers, or the death of one, does not change a bit
    of the result.

    Parameters
    ----------
    model : clench.Model
        The model of all environments. If it was loaded from a file, every worker reads the same path; if the workers
        have no such path, use ``clench.ModelSpec.from_file(path).build()``, a model that includes its files.
    n_envs : int
        Number of environments.
    precision : {"64", "32"}
        Bits of every number.
    threads : int, optional
        Threads of each worker, for which Ray reserves as many CPUs; by default an equal share of the cluster's CPUs.
    options : clench.RigidOptions, optional
        Options that take precedence over those of the model.
    record : sequence of str
        Outputs to record; see `record`.
    workers : int, optional
        Number of workers; by default one per machine of the cluster.
    snapshot_every : int
        Time steps between snapshots, from which a lost worker is restored. A smaller number costs more time, but fewer
        steps are repeated after a failure. None is taken of a worker with a failed environment.

    Attributes
    ----------
    model : clench.Model
        The model, without the parameters that are set per environment.
    n_envs : int
        Number of environments.
    precision : str
        Bits of every number, "64" or "32".

    Raises
    ------
    ImportError
        If Ray is not installed.
    ValueError
        If `clench.Batch` rejects an argument, or there is less than one worker.
    clench.ClenchError
        If workers die immediately after their start.
    """

    def __init__(
        self,
        model: clench.Model,
        n_envs: SupportsIndex,
        precision: Literal["64", "32"] = "64",
        threads: SupportsIndex | None = None,
        *,
        options: clench.RigidOptions | None = None,
        record: Sequence[str] = (),
        workers: SupportsIndex | None = None,
        snapshot_every: SupportsIndex = 1000,
    ) -> None:
        ray = ray_module()
        if not ray.is_initialized():
            ray.init()
        count = operator.index(n_envs)
        machines = sum(node["Alive"] for node in ray.nodes())
        parts = min(machines if workers is None else operator.index(workers), max(count, 1))
        if parts < 1 or operator.index(snapshot_every) < 1:
            raise ValueError("there must be at least one worker, and a step between snapshots")
        own = max(1, int(ray.cluster_resources().get("CPU", 1)) // parts) if threads is None else operator.index(threads)
        # Invalid arguments are reported here, before any worker starts.
        self._one = clench.Batch(model, 1, precision, 1, options=options, record=record)
        self.model = model
        self.n_envs = count
        self.precision = self._one.precision
        ends = [count * part // parts for part in range(parts + 1)]
        self._parts = [slice(*pair) for pair in zip(ends, ends[1:])]
        self._mirror = Mirror(self._parts)
        self._workers = [
            Worker(pickle.dumps((model, part.stop - part.start, precision, own, options, tuple(record))), own, int(snapshot_every))
            for part in self._parts
        ]

    # Running.

    def step(self, n: SupportsIndex = 1) -> int:
        """Advances every running environment by `n` time steps.

        Returns
        -------
        int
            Number of environments that failed in this call.
        """
        steps = operator.index(n)
        return sum(self._call_workers(lambda worker, _: worker.send_steps(steps, "step", steps, watched=self._mirror.names)))

    def forward(self, mask: ArrayLike | None = None) -> int:
        """Computes the recorded outputs from the states; see `clench.Batch.forward`."""
        return sum(self._change("forward", self._split_mask(mask)))

    def reset(self, mask: ArrayLike | None = None, keyframe: str | SupportsIndex | None = None) -> None:
        """Resets environments to the initial state or to a keyframe; see `clench.Batch.reset`."""
        self._change("reset", [(*chosen, keyframe) for chosen in self._split_mask(mask)])

    def revive(self, mask: ArrayLike | None = None) -> None:
        """Sets environments running again from the states in their rows; see `clench.Batch.revive`."""
        self._change("revive", self._split_mask(mask))

    def rollout(
        self,
        initial: clench.State | ArrayLike | None = None,
        ctrl: ArrayLike | None = None,
        record: Sequence[str] = ("qpos", "qvel"),
        steps: SupportsIndex | None = None,
    ) -> dict[str, Array]:
        """Steps all running environments and records outputs after each step; see `clench.Batch.rollout`, which also
        accepts functions.

        Parameters
        ----------
        initial : State or array_like, optional
            Initial states: a `State`; or one row for all (1 + nq + nv + na) or a row each (n, ...).
        ctrl : array_like, optional
            Controls of each step, for all (steps, nu) or each (n, steps, nu) environment.
        record : sequence of str
            Outputs to record.
        steps : int, optional
            Number of steps; required only without `ctrl`.

        Returns
        -------
        dict of str to ndarray
            Each output (n, steps, ...).
        """
        if isinstance(initial, clench.State):
            self.set_state(initial)
            initial = None
        starts, controls = self._split(initial, 2, "initial"), self._split(ctrl, 3, "ctrl")
        length = 1 if steps is None else operator.index(steps)
        if ctrl is not None and steps is None:
            length = int(np.asarray(ctrl).shape[-2]) if np.ndim(ctrl) > 1 else 1
        arguments = [(start, control, tuple(record), steps) for start, control in zip(starts, controls)]
        each = self._call_workers(
            lambda worker, part: worker.send_steps(length, "rollout", *arguments[part], watched=self._mirror.names)
        )
        return {name: np.concatenate([recorded[name] for recorded in each]) for name in each[0]}

    # Parameters, options and states.

    def randomize(
        self, field: str, values: ArrayLike, envs: ArrayLike | None = None, *, consistent: bool | np.bool_ = False
    ) -> None:
        """Gives environments their own values of a parameter; see `clench.Batch.randomize`.

        Parameters
        ----------
        field : str
            A parameter of the model.
        values : array_like
            The whole field for each environment: its shape in the model after an axis of environments.
        envs : array_like of int, optional
            Indices of environments; by default all.
        consistent : bool, optional
            True to compute the dependent constants, as `set_constants` does.
        """
        chosen = self._chosen(envs)
        rows = np.asarray(values)
        if rows.shape[:1] != chosen.shape:
            raise ValueError(f"{field} has shape {rows.shape}, but must have a row for each of {chosen.size} environments")
        # The change is all or nothing, although the workers are independent.
        for row in rows:
            self._one.randomize(field, row[np.newaxis])
        arguments = []
        for part in self._parts:
            here = (part.start <= chosen) & (chosen < part.stop)
            arguments.append((field, rows[here], chosen[here] - part.start))
        self._change("randomize", arguments)
        if consistent:
            self.set_constants(np.isin(np.arange(self.n_envs), chosen))

    def set_constants(self, mask: ArrayLike | None = None) -> None:
        """Computes the constants that depend on the parameters of environments; see `clench.Batch.set_constants`.

        Parameters
        ----------
        mask : array_like of bool, optional
            Mask of environments (n); by default all.
        """
        self._change("set_constants", self._split_mask(mask))

    @property
    def options(self) -> clench.RigidOptions:
        """The options that were set. Assigned options take effect at the next step or forward."""
        return self._one.options

    @options.setter
    def options(self, options: clench.RigidOptions) -> None:
        self._one.options = options
        self._change("set_options", [(options,)] * len(self._workers))

    @property
    def state(self) -> clench.State:
        """A copy of everything that the next step of every environment depends on, except parameters. It can be
        assigned."""
        each = self._query("get_state")
        return clench.State(**{name: np.concatenate([getattr(state, name) for state in each]) for name in _STATE})

    @state.setter
    def state(self, state: clench.State) -> None:
        self.set_state(state)

    def set_state(self, state: clench.State, envs: ArrayLike | None = None) -> None:
        """Sets the state of some environments, and sets them running; see `clench.Batch.set_state`.

        Parameters
        ----------
        state : State
            A single state for all of them, such as ``sim.state``, or one with as many environments as there are in
            `envs`.
        envs : array_like of int, optional
            Indices of environments; by default all.
        """
        chosen = self._chosen(envs)
        one = state.qpos.ndim == 1
        if not one and any(len(values) != chosen.size for values in state._arrays().values()):
            raise ValueError(f"a state of {chosen.size} environments is needed")
        # The change is all or nothing, although the workers are independent.
        self._one.state = state if one else state[:1]
        arguments = []
        for part in self._parts:
            here = (part.start <= chosen) & (chosen < part.stop)
            arguments.append((state if one else state[here], (chosen[here] - part.start).tolist()))
        self._change("set_state", arguments)

    def sim(self, env: SupportsIndex) -> clench.Sim:
        """Returns a separate simulation of one environment, with its state and parameters.

        Raises
        ------
        IndexError
            If the environment does not exist.
        """
        sim: clench.Sim = self._of_env("sim", env)
        return sim

    # Outputs.

    def record(self, *names: str) -> None:
        """Records outputs from now on, in addition to those that are recorded already; see `clench.Batch.record`."""
        self._one.record(*names)
        self._change("record", [names] * len(self._workers))

    @property
    def outputs(self) -> tuple[str, ...]:
        """The outputs that are recorded."""
        return self._one.outputs

    def output(self, name: str) -> Array:
        """Returns a copy of a recorded output, with environments as first axis."""
        # It may be computed when it is read, from the controls of that moment: a new worker repeats the call.
        return np.concatenate(self._change("copied_output", [(name,)] * len(self._parts)))

    def sensor(self, which: str | SupportsIndex) -> Array:
        """Returns a copy of the values of one sensor in every environment, from ``sensordata``, which must be
        recorded."""
        sensor = self.model.sensor(which)
        return self.output("sensordata")[:, sensor.adr : sensor.adr + sensor.dim]

    def fault(self, env: SupportsIndex) -> str | None:
        """Returns the reason why an environment failed; None if it is running."""
        fault: str | None = self._of_env("fault", env)
        return fault

    # Workers.

    @property
    def workers(self) -> list[tuple[str, int]]:
        """The host name and the process id of each worker."""
        return self._query("where")

    @property
    def replaced(self) -> int:
        """The number of workers that died and were replaced."""
        return sum(worker.replaced for worker in self._workers)

    def close(self) -> None:
        """Terminates the workers. The batch can no longer be used."""
        for worker in self._workers:
            worker.close()
        self._workers = []

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_raised: object) -> None:
        self.close()

    def __len__(self) -> int:
        return self.n_envs

    def __repr__(self) -> str:
        return f"<clench.ray.Batch of {self.n_envs} x {self.model.name!r} on {len(self._workers)} workers>"

    # The arrays of the state.

    def __getattr__(self, name: str) -> Array:
        if name in _STATE:
            array = self._mirror.get(name)
            return self._mirror.add(name, self._field(name)) if array is None else array
        if name in clench.OUTPUTS:
            try:
                return self.output(name)
            except ValueError as error:
                raise AttributeError(str(error)) from None
        raise AttributeError(f'there is no attribute "{name}"')

    def __setattr__(self, name: str, value: Any) -> None:
        if name in _STATE:
            getattr(self, name)[...] = value
        else:
            object.__setattr__(self, name, value)

    def _field(self, name: str) -> Array:
        calls = [worker.send("read", watched=(name,)) for worker in self._open()]
        each = [worker.receive(call)[1][name] for worker, call in zip(self._workers, calls)]
        return np.concatenate(each)

    # Calls.

    def _open(self) -> list[Worker]:
        if not self._workers:
            raise clench.ClenchError("this batch is closed")
        return self._workers

    def _call_workers(self, send: Callable[[Worker, int], Any]) -> list[Any]:
        """Calls all workers, after sending local changes, and waits for them; returns their results, or raises the
        first error."""
        workers = self._open()
        calls = []
        for part, worker in enumerate(workers):
            written = self._mirror.written(part)
            if written:
                worker.send("write", written, changes=True)
            calls.append(send(worker, part))
        results = []
        for part, (worker, call) in enumerate(zip(workers, calls)):
            result, fields = worker.receive(call)
            self._mirror.update(part, fields)
            results.append(result)
        for result in results:
            if isinstance(result, Exception):
                raise result
        return results

    def _query(self, method: str, *arguments: Any, **chosen: Any) -> list[Any]:
        """Makes a query that changes nothing."""
        return self._query_each(method, [arguments] * len(self._parts), chosen)

    def _query_each(self, method: str, arguments: Sequence[tuple[Any, ...]], chosen: dict[str, Any]) -> list[Any]:
        """Makes a query with separate arguments for each worker."""
        return self._call_workers(lambda worker, part: worker.send(method, *arguments[part], chosen=chosen))

    def _change(self, method: str, arguments: Sequence[tuple[Any, ...]]) -> list[Any]:
        """Makes a call that changes the workers."""
        names = self._mirror.names
        return self._call_workers(lambda worker, part: worker.send(method, *arguments[part], changes=True, watched=names))

    def _of_env(self, method: str, env: SupportsIndex) -> Any:
        """Makes a query about one environment."""
        index = operator.index(env)
        if not 0 <= index < self.n_envs:
            raise IndexError(f"the environment must be at least 0 and below {self.n_envs}")
        here = next(part for part, rows in enumerate(self._parts) if index < rows.stop)
        inside = index - self._parts[here].start
        return self._call_workers(lambda worker, part: worker.send(method, inside) if part == here else worker.send("read"))[here]

    def _split_mask(self, mask: ArrayLike | None) -> list[tuple[Array | None]]:
        if mask is None:
            return [(None,)] * len(self._parts)
        array = np.asarray(mask)
        if array.dtype != np.bool_ or array.shape != (self.n_envs,):
            raise ValueError(f"mask must be {self.n_envs} booleans, not {array.dtype} of shape {array.shape}")
        return [(array[part],) for part in self._parts]

    def _split(self, values: ArrayLike | None, dimensions: int, name: str) -> list[Array | None]:
        """Splits rows among the workers if there is one per environment; else each worker gets the same."""
        if values is None:
            return [None] * len(self._parts)
        array = np.asarray(values)
        if array.ndim < dimensions:
            return [array] * len(self._parts)
        if len(array) != self.n_envs:
            raise ValueError(f"{name} has shape {array.shape}, but must have {self.n_envs} rows")
        return [array[part] for part in self._parts]
