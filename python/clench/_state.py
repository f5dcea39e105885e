"""States that can be kept: in memory, or as bytes that survive a restart."""

from __future__ import annotations

import io
import operator
import zipfile
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["State"]

# What the bytes hold is said by this number: readers refuse what is newer than they know. Before version 2, times were of
# the precision of all other numbers.
_VERSION = 2


@dataclass(kw_only=True, eq=False, repr=False)
class State:
    """A copy of everything that the next step depends on, parameters apart.

    `Sim.state` and `Batch.state` make one, and assigning it brings the simulation back there, to the bit. The arrays are the
    same as those of the simulation, with the environments as first axis for a `Batch`; they can be changed freely.

    Parameters
    ----------
    time : numpy.ndarray
        s, float64 in every precision.
    qpos, qvel, act, ctrl, qfrc_applied, xfrc_applied, mocap_pos, mocap_quat, qacc_warmstart : numpy.ndarray
        Numbers, all float64 or all float32.
    eq_active : numpy.ndarray
        Switches of equality constraints, bool.

    Raises
    ------
    TypeError
        Arrays of other types.
    """

    time: NDArray[Any]
    qpos: NDArray[Any]
    qvel: NDArray[Any]
    act: NDArray[Any]
    ctrl: NDArray[Any]
    qfrc_applied: NDArray[Any]
    xfrc_applied: NDArray[Any]
    mocap_pos: NDArray[Any]
    mocap_quat: NDArray[Any]
    eq_active: NDArray[np.bool_]
    qacc_warmstart: NDArray[Any]

    def __post_init__(self) -> None:
        self._arrays()

    def _arrays(self) -> dict[str, NDArray[Any]]:
        """The fields by name, their types checked: fields can be replaced."""
        arrays = {field.name: getattr(self, field.name) for field in fields(self)}
        numbers = np.dtype(np.float32 if getattr(self.qpos, "dtype", None) == np.float32 else np.float64)
        special = {"time": np.dtype(np.float64), "eq_active": np.dtype(np.bool_)}
        for name, array in arrays.items():
            wanted = special.get(name, numbers)
            found = getattr(array, "dtype", type(array).__name__)
            if not isinstance(array, np.ndarray) or found != wanted:
                raise TypeError(f"{name} of a state must be an array of {wanted}, not {found}")
        return arrays

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
        stream = io.BytesIO(data)
        if not zipfile.is_zipfile(stream):
            raise ValueError("these bytes hold no state: they are no whole archive of NumPy's")
        stream.seek(0)
        try:
            with np.load(stream, allow_pickle=False) as archive:
                arrays = dict(archive)
            version = operator.index(arrays.pop("version")[()])
        except Exception as error:  # Readers of damaged archives raise whatever they stumble over.
            raise ValueError(f"these bytes hold no state: {error}") from error
        if not 1 <= version <= _VERSION:
            raise ValueError(f"this state has version {version}, and this clench reads versions 1 to {_VERSION}")
        if version == 1 and "time" in arrays:
            arrays["time"] = arrays["time"].astype(np.float64)
        try:
            return State(**arrays)
        except TypeError as error:
            raise ValueError(f"these bytes hold no whole state: {error}") from error

    def __repr__(self) -> str:
        envs = "" if self.qpos.ndim == 1 else f" of {len(self.qpos)} environments"
        return f"<clench.State{envs}, {self.qpos.dtype}>"
