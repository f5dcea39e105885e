"""States that can be kept: in memory, or as bytes that survive a restart."""

from __future__ import annotations

import io
import math
import operator
import zipfile
from collections.abc import Sequence
from dataclasses import dataclass, fields, make_dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from clench._core import _STATE_FIELDS

__all__ = ["State"]

# What the bytes hold is said by this number: readers refuse what is newer than they know. Before version 2, times were of
# the precision of all other numbers; before version 3, nothing was delayed and nothing slept; before version 4,
# nothing was tied together at run time; before version 5, no spring yielded.
_VERSION = 5
# What came with version 4, and how many numbers an element of it has.
_SINCE_4 = {
    "dynamic_kind": (),
    "dynamic_serial": (),
    "dynamic_body1": (),
    "dynamic_body2": (),
    "dynamic_anchor1": (3,),
    "dynamic_anchor2": (3,),
    "dynamic_quat": (4,),
}
# The most entries of an archive that are looked at: more than any version has.
_MAX_ENTRIES = 100

if TYPE_CHECKING:
    from clench._core import _StateArrays
else:
    _names = ("time", *(name for name, *_ in _STATE_FIELDS))
    _StateArrays = make_dataclass("_StateArrays", [(name, np.ndarray) for name in _names], kw_only=True, eq=False, repr=False)

# The types of all fields but those that have the precision of the simulation.
_DTYPES: dict[str, np.dtype[Any]] = {
    "time": np.dtype(np.float64),
    **{name: np.dtype(kind) for name, kind, *_ in _STATE_FIELDS if kind != "number"},
}


@dataclass(kw_only=True, eq=False, repr=False)
class State(_StateArrays):
    """A copy of everything that the next step depends on, parameters apart.

    `Sim.state` and `Batch.state` make one, and assigning it brings the simulation back there, to the bit. The arrays are the
    same as those of the simulation, with the environments as first axis for a `Batch`; they can be changed freely.

    Two states are equal if all their arrays are, in type, shape and every bit: a NaN equals itself, 0.0 is not -0.0. What can be
    changed has no hash.

    Parameters
    ----------
    time : numpy.ndarray
        s, float64 in every precision.
    {fields}

    Raises
    ------
    TypeError
        Arrays of other types.
    """

    def __post_init__(self) -> None:
        self._arrays()

    def _arrays(self) -> dict[str, NDArray[Any]]:
        """The fields by name, their types checked: fields can be replaced."""
        arrays = {field.name: getattr(self, field.name) for field in fields(self)}
        numbers = np.dtype(np.float32 if getattr(self.qpos, "dtype", None) == np.float32 else np.float64)
        for name, array in arrays.items():
            wanted = _DTYPES.get(name, numbers)
            found = getattr(array, "dtype", type(array).__name__)
            if not isinstance(array, np.ndarray) or found != wanted:
                raise TypeError(f"{name} of a state must be an array of {wanted}, not {found}")
        return arrays

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, State):
            return NotImplemented
        own, others = self._arrays(), other._arrays()
        return all(_same_bits(array, others[name]) for name, array in own.items())

    __hash__ = None  # type: ignore[assignment]

    def __len__(self) -> int:
        """How many environments it is of."""
        if self.qpos.ndim == 1:
            raise TypeError("the state of one environment has no length")
        return len(self.qpos)

    def __bool__(self) -> bool:
        return True

    def __getitem__(self, envs: Any) -> State:
        """The state of one environment, or of several.

        Parameters
        ----------
        envs : int, slice or array_like
            Which, as NumPy selects rows.

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
        """The states of several environments side by side.

        Parameters
        ----------
        states : sequence of State
            One an environment, at least one.

        Returns
        -------
        State
        """
        rows = [state._arrays() for state in states]
        return State(**{name: np.stack([arrays[name] for arrays in rows]) for name in rows[0]})

    def to_bytes(self) -> bytes:
        """Pack the state into bytes.

        Returns
        -------
        bytes
            A NumPy ``.npz`` archive with an array a field and the number of its format, ``version``.
        """
        buffer = io.BytesIO()
        arrays: dict[str, Any] = {"version": np.int64(_VERSION), **self._arrays()}
        np.savez(buffer, **arrays)
        return buffer.getvalue()

    @staticmethod
    def from_bytes(data: bytes) -> State:
        """Unpack what `to_bytes` packed, in this or an earlier version.

        Parameters
        ----------
        data : bytes
            What `to_bytes` returned.

        Returns
        -------
        State
            The same state, to the bit.

        Raises
        ------
        ValueError
            Bytes that are damaged, of something else, or of a later version.
        TypeError
            What is not bytes.
        """
        if not isinstance(data, bytes | bytearray | memoryview):
            raise TypeError(f"a state is unpacked from bytes, not from {type(data).__name__}")
        stream = io.BytesIO(data)
        if not zipfile.is_zipfile(stream):
            raise ValueError("these bytes hold no state: they are no whole archive of NumPy's")
        try:
            with zipfile.ZipFile(stream) as archive:
                _require_plain(archive, stream.getbuffer().nbytes)
                version = operator.index(_entry(archive, "version.npy")[()])
                # Nothing else is looked at before it is known to be understood.
                if 1 <= version <= _VERSION:
                    arrays = {name.removesuffix(".npy"): _entry(archive, name) for name in archive.namelist()}
        except Exception as error:  # Readers of damaged archives raise whatever they stumble over.
            raise ValueError(f"these bytes hold no state: {error}") from error
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
        try:
            return State(**arrays)
        except TypeError as error:
            raise ValueError(f"these bytes hold no whole state: {error}") from error

    def __repr__(self) -> str:
        envs = "" if self.qpos.ndim == 1 else f" of {len(self.qpos)} environments"
        return f"<clench.State{envs}, {self.qpos.dtype}>"


def _describe(name: str, kind: str, shape: str, doc: str) -> str:
    """An entry of the documentation's list of parameters."""
    dtype = "float64 or float32" if kind == "number" else kind
    return f"{name} : numpy.ndarray\n        {shape} of {dtype}. {doc}"


_described = "\n    ".join(_describe(*field) for field in _STATE_FIELDS)
State.__doc__ = (State.__doc__ or "").replace("{fields}", _described)


def _same_bits(one: NDArray[Any], other: NDArray[Any]) -> bool:
    return one.dtype == other.dtype and one.shape == other.shape and one.tobytes() == other.tobytes()


def _require_plain(archive: zipfile.ZipFile, size: int) -> None:
    """Refuse an archive, of so many bytes, that would take more memory unpacked than it has itself."""
    entries = archive.infolist()
    if len(entries) > _MAX_ENTRIES:
        raise ValueError(f"the archive has {len(entries)} entries, and at most {_MAX_ENTRIES} are looked at")
    if len({entry.filename for entry in entries}) < len(entries):
        raise ValueError("the archive has two entries of one name")
    for entry in entries:
        if entry.compress_type != zipfile.ZIP_STORED:
            raise ValueError(f"{entry.filename} is compressed, and states never are")
    total = sum(entry.file_size for entry in entries)
    if total > size:
        raise ValueError(f"the archive claims to hold {total} bytes, and has {size}")


def _entry(archive: zipfile.ZipFile, name: str) -> NDArray[Any]:
    """An array of an archive, as large as its bytes are and no larger."""
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
        raise ValueError(f"{name} claims {claimed} bytes of numbers, and has {found}")
    array = np.frombuffer(stream.getbuffer()[stream.tell() :], dtype)
    return array.reshape(shape, order="F" if fortran_order else "C").copy()
