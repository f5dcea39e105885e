"""States that can be stored: in memory, or as bytes that survive a restart."""

from __future__ import annotations

import io
import math
import operator
import zipfile
from collections.abc import Sequence
from dataclasses import dataclass, make_dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from clench._core import _STATE_FIELDS

__all__ = ["State"]

# The version of the byte format; readers reject newer versions. Before version 2, times had the precision of all other
# numbers; before version 3, there were no delays and no sleeping; before version 4, no constraints were added at run
# time; before version 5, there were no plastic springs; before version 6, no stick references.
_VERSION = 6
# The fields that were added in version 4, with the number of values per element.
_SINCE_4 = {
    "dynamic_kind": (),
    "dynamic_serial": (),
    "dynamic_body1": (),
    "dynamic_body2": (),
    "dynamic_anchor1": (3,),
    "dynamic_anchor2": (3,),
    "dynamic_quat": (4,),
}
# The maximum number of entries that are read from an archive: more than any version has.
_MAX_ENTRIES = 100

_NAMES = ("time", *(name for name, *_ in _STATE_FIELDS))
if TYPE_CHECKING:
    from clench._core import _StateArrays
else:
    _StateArrays = make_dataclass("_StateArrays", [(name, np.ndarray) for name in _NAMES], kw_only=True, eq=False, repr=False)

_SINGLE: np.dtype[Any] = np.dtype(np.float32)
_DOUBLE: np.dtype[Any] = np.dtype(np.float64)
# The dtypes of all fields except those with the precision of the simulation.
_DTYPES: dict[str, np.dtype[Any]] = {
    "time": _DOUBLE,
    **{name: np.dtype(kind) for name, kind, *_ in _STATE_FIELDS if kind != "number"},
}


@dataclass(kw_only=True, eq=False, repr=False)
class State(_StateArrays):
    """A copy of everything that the next step depends on, except parameters.

    `Sim.state` and `Batch.state` return one, and assigning it restores the simulation. The arrays have the names and
    shapes of those of the simulation, with the environments as first axis for a `Batch`; they can be changed freely.

    Two states are equal if all their arrays are, in dtype, shape and every bit: a NaN equals itself, and 0.0 differs
    from -0.0. States are mutable and have no hash.

    Parameters
    ----------
    time : numpy.ndarray
        s, float64 in either precision.
    {fields}

    Raises
    ------
    TypeError
        If an array has another dtype.
    """

    def __post_init__(self) -> None:
        self._arrays()

    def _arrays(self) -> dict[str, NDArray[Any]]:
        """Returns the fields by name. Their dtypes are checked, since fields can be replaced."""
        arrays = {name: getattr(self, name) for name in _NAMES}
        numbers = _SINGLE if getattr(self.qpos, "dtype", None) == _SINGLE else _DOUBLE
        for name, array in arrays.items():
            wanted = _DTYPES.get(name, numbers)
            if not isinstance(array, np.ndarray) or array.dtype != wanted:
                found = getattr(array, "dtype", type(array).__name__)
                raise TypeError(f"{name} of a state must be an array of {wanted}, not {found}")
        return arrays

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, State):
            return NotImplemented
        own, others = self._arrays(), other._arrays()
        return all(_same_bits(array, others[name]) for name, array in own.items())

    __hash__ = None  # type: ignore[assignment]

    def __len__(self) -> int:
        """Returns the number of environments."""
        if self.qpos.ndim == 1:
            raise TypeError("the state of one environment has no length")
        return len(self.qpos)

    def __bool__(self) -> bool:
        return True

    def __getitem__(self, envs: Any) -> State:
        """Returns the state of one environment, or of several.

        Parameters
        ----------
        envs : int, slice or array_like
            Their indices, as NumPy selects rows.

        Returns
        -------
        State
            A copy.

        Examples
        --------
        >>> batch = clench.Batch(clench.Model.from_file("models/pendulum.xml"), 3)
        >>> sim = clench.Sim(batch.model)
        >>> sim.state = batch.state[2]
        """
        if self.qpos.ndim == 1:
            raise TypeError("the state of one environment has no rows")
        return State(**{name: np.array(array[envs]) for name, array in self._arrays().items()})

    @staticmethod
    def stack(states: Sequence[State]) -> State:
        """Stacks the states of several environments.

        Parameters
        ----------
        states : sequence of State
            At least one state, one for each environment.

        Returns
        -------
        State
        """
        rows = [state._arrays() for state in states]
        return State(**{name: np.stack([arrays[name] for arrays in rows]) for name in rows[0]})

    def to_bytes(self) -> bytes:
        """Packs the state into bytes.

        Returns
        -------
        bytes
            A NumPy ``.npz`` archive with one array per field, and the version of the format as ``version``.
        """
        buffer = io.BytesIO()
        arrays: dict[str, Any] = {"version": np.int64(_VERSION), **self._arrays()}
        np.savez(buffer, **arrays)
        return buffer.getvalue()

    @staticmethod
    def from_bytes(data: bytes) -> State:
        """Unpacks bytes of `to_bytes`, of this or an earlier version.

        Parameters
        ----------
        data : bytes
            The result of `to_bytes`.

        Returns
        -------
        State
            The same state, to the bit.

        Raises
        ------
        ValueError
            If the bytes are damaged, of another format, or of a later version.
        TypeError
            If the argument is not bytes.
        """
        if not isinstance(data, bytes | bytearray | memoryview):
            raise TypeError(f"a state is unpacked from bytes, not from {type(data).__name__}")
        stream = io.BytesIO(data)
        if not zipfile.is_zipfile(stream):
            raise ValueError("these bytes are not a state: they are not a complete NumPy archive")
        try:
            with zipfile.ZipFile(stream) as archive:
                _require_plain(archive, stream.getbuffer().nbytes)
                version = operator.index(_entry(archive, "version.npy")[()])
                # The version is checked before anything else is read.
                if 1 <= version <= _VERSION:
                    arrays = {name.removesuffix(".npy"): _entry(archive, name) for name in archive.namelist()}
        except Exception as error:  # Readers of damaged archives raise arbitrary exceptions.
            raise ValueError(f"these bytes are not a state: {error}") from error
        if not 1 <= version <= _VERSION:
            raise ValueError(f"this state has version {version}, and this clench reads versions 1 to {_VERSION}")
        del arrays["version"]
        if version == 1 and "time" in arrays:
            arrays["time"] = arrays["time"].astype(np.float64)
        if version < 3 and "qpos" in arrays:
            empty = np.zeros((*arrays["qpos"].shape[:-1], 0), arrays["qpos"].dtype)
            arrays.update(history=empty, tree_asleep=empty.astype(np.int32), pose_asleep=empty)
        if version < 4 and "qpos" in arrays:
            for name, width in _SINCE_4.items():
                dtype = _DTYPES.get(name, arrays["qpos"].dtype)
                arrays[name] = np.zeros((*arrays["qpos"].shape[:-1], 0, *width), dtype)
        if version < 5 and "qpos" in arrays:
            arrays["plastic"] = np.zeros((*arrays["qpos"].shape[:-1], 0), arrays["qpos"].dtype)
        if version < 6 and "qpos" in arrays:
            arrays["stick_references"] = np.zeros((*arrays["qpos"].shape[:-1], 0, 9), arrays["qpos"].dtype)
            arrays["stick_friction"] = np.zeros((*arrays["qpos"].shape[:-1], 0), arrays["qpos"].dtype)
        try:
            return State(**arrays)
        except TypeError as error:
            raise ValueError(f"these bytes are not a complete state: {error}") from error

    def __repr__(self) -> str:
        envs = "" if self.qpos.ndim == 1 else f" of {len(self.qpos)} environments"
        return f"<clench.State{envs}, {self.qpos.dtype}>"


def _describe(name: str, kind: str, shape: str, doc: str) -> str:
    """Formats an entry of the parameter list of the docstring."""
    dtype = "float64 or float32" if kind == "number" else kind
    return f"{name} : numpy.ndarray\n        {shape} of {dtype}. {doc}"


_described = "\n    ".join(_describe(*field) for field in _STATE_FIELDS)
State.__doc__ = (State.__doc__ or "").replace("{fields}", _described)


def _same_bits(one: NDArray[Any], other: NDArray[Any]) -> bool:
    return one.dtype == other.dtype and one.shape == other.shape and one.tobytes() == other.tobytes()


def _require_plain(archive: zipfile.ZipFile, size: int) -> None:
    """Rejects an archive of the given size that would take more memory unpacked than packed."""
    entries = archive.infolist()
    if len(entries) > _MAX_ENTRIES:
        raise ValueError(f"the archive has {len(entries)} entries, more than the maximum of {_MAX_ENTRIES}")
    if len({entry.filename for entry in entries}) < len(entries):
        raise ValueError("the archive has two entries with the same name")
    for entry in entries:
        if entry.compress_type != zipfile.ZIP_STORED:
            raise ValueError(f"{entry.filename} is compressed, but states are not")
    total = sum(entry.file_size for entry in entries)
    if total > size:
        raise ValueError(f"the archive declares {total} bytes, but has {size}")


def _entry(archive: zipfile.ZipFile, name: str) -> NDArray[Any]:
    """Reads an array of an archive; its size must equal that of its bytes."""
    stream = io.BytesIO(archive.read(name))
    read_header = {
        (1, 0): np.lib.format.read_array_header_1_0,
        (2, 0): np.lib.format.read_array_header_2_0,
    }[np.lib.format.read_magic(stream)]
    shape, fortran_order, dtype = read_header(stream)
    if dtype.hasobject:
        raise ValueError(f"{name} holds Python objects")
    claimed, found = math.prod(shape) * dtype.itemsize, stream.getbuffer().nbytes - stream.tell()
    if claimed != found:
        raise ValueError(f"{name} declares {claimed} bytes of numbers, but has {found}")
    array = np.frombuffer(stream.getbuffer()[stream.tell() :], dtype)
    return array.reshape(shape, order="F" if fortran_order else "C").copy()
