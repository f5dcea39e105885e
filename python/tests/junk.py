"""Invalid and nearly valid values, which `fuzz.py` passes as arguments."""

from __future__ import annotations

import array
import collections
import datetime
import decimal
import fractions
import pathlib
from collections.abc import Callable
from typing import Any

import numpy as np

NUMBERS = (0.0, -0.0, 1.0, -1.0, 0.5, 1e-320, 1e-9, 1e30, -1e308, 1.8e308, np.nan, np.inf, -np.inf)
# Counts between these would run forever.
INTEGERS = (0, 1, 2, 3, 7, 30, -1, -2, -(2**31), -(2**63), -(2**64), 2**64, 2**65, 10**40)
TEXTS = ("", " ", "qpos", "auto", "64", "é", "\0", "\ud800", "a" * 5000, "body_mass", "__class__", "ball", "-1", "nan")
DTYPES = (
    *("f8", "f4", "f2", "g", ">f8", ">f4", "i8", "i4", "i2", "i1", "u8", "u4", "u1", ">i4", "?"),
    *("c8", "c16", "S3", "U3", ">U2", "O", "M8[s]", "m8[ms]", "V4", "f8,i4"),
)


class Odd(Exception):
    """An exception that objects of the fuzzer raise; calls may propagate it."""


class Rude:
    """An object whose special methods raise an exception or return an arbitrary value."""

    def __init__(self, answer: Callable[[], Any]) -> None:
        self._answer = answer

    def _reply(self, *_: Any, **__: Any) -> Any:
        return self._answer()

    __array__ = __index__ = __int__ = __float__ = __bool__ = __len__ = __iter__ = __getitem__ = __next__ = _reply
    __str__ = __repr__ = __fspath__ = __eq__ = __hash__ = __dlpack__ = __buffer__ = _reply


class Subclass(np.ndarray):
    """A subclass of arrays."""


class Junk:
    """Random values. Rude objects may call methods of `owners`."""

    def __init__(self, rng: np.random.Generator, owners: list[Any]) -> None:
        self.rng = rng
        self.owners = owners

    def chance(self, probability: float) -> bool:
        return bool(self.rng.random() < probability)

    def choose(self, values: Any) -> Any:
        return values[int(self.rng.integers(len(values)))]

    def number(self) -> Any:
        kind = self.rng.integers(7)
        if kind == 0:
            return self.choose(INTEGERS)
        if kind == 1:
            return self.choose((np.float32, np.float64, np.float16, np.longdouble))(self.choose(NUMBERS))
        if kind == 2:
            return self.choose((np.int8, np.uint16, np.int64))(self.rng.integers(0, 4))
        if kind == 3:
            return self.choose((True, False, np.True_, np.False_))
        if kind == 4:
            return self.choose((1j, fractions.Fraction(1, 3), decimal.Decimal("0.5"), datetime.timedelta(1)))
        return float(self.rng.normal()) if self.chance(0.5) else self.choose(NUMBERS)

    def shape(self) -> tuple[int, ...]:
        return tuple(int(self.choose((0, 1, 2, 3, 6, 7, 12))) for _ in range(self.rng.integers(0, 4)))

    def array(self, shape: tuple[int, ...] | None = None) -> Any:
        """Returns an array of any dtype and layout."""
        shape = self.shape() if shape is None else shape
        dtype = np.dtype(self.choose(DTYPES) if self.chance(0.5) else "f8")
        values = self.rng.normal(size=shape) * self.choose((0, 0.1, 1, 1e6))
        if self.chance(0.2) and values.size:
            values.flat[self.rng.integers(values.size)] = self.choose(NUMBERS)
        with np.errstate(all="ignore"):
            try:
                made = values.astype(dtype)
            except (TypeError, ValueError):
                made = np.zeros(shape, dtype)
        if not shape and dtype.kind in "iu":  # It would be valid as a count.
            made = np.array(self.rng.integers(0, 4), dtype)
        return self.layout(made)

    def layout(self, values: Any) -> Any:
        """Returns the same numbers with another memory layout or type."""
        kind = self.rng.integers(10)
        if kind == 0:
            return np.asfortranarray(values)
        if kind == 1:
            return values[::-1] if values.ndim else values
        if kind == 2:
            return np.repeat(values, 2, axis=-1)[..., ::2] if values.ndim else values
        if kind == 3:
            values.flags.writeable = False
            return values
        if kind == 4 and not values.dtype.hasobject:
            raw = np.zeros(values.nbytes + 1, np.uint8)[1:]
            raw[:] = np.frombuffer(values.tobytes(), np.uint8)
            return raw.view(values.dtype).reshape(values.shape) if values.size else values
        if kind == 5:
            return np.broadcast_to(values[:1], values.shape) if values.ndim and len(values) else values
        if kind == 6:
            return values.view(Subclass)
        if kind == 7:
            return np.ma.masked_array(values)
        if kind == 8:
            return values.tolist()
        return values

    def rude(self) -> Rude:
        def fail() -> Any:
            raise Odd("of the fuzzer")

        def call_back() -> Any:
            if self.owners:
                owner = self.choose(self.owners)
                getattr(owner, self.choose(("step", "forward", "reset", "state", "qpos")))
                owner.step(1)
                owner.forward()
            return self.number()

        return Rude(self.choose((fail, call_back, lambda: self.number(), lambda: None, lambda: 1)))

    def any(self, depth: int = 0) -> Any:
        """Returns an arbitrary object."""
        kind = int(self.rng.integers(14))
        if kind < 3:
            return self.number()
        if kind < 7:
            return self.array()
        if kind == 7:
            return self.choose(TEXTS)
        if kind == 8:
            return self.choose((None, Ellipsis, NotImplemented, object(), int, np, len, np.float64, b"", b"abc", bytearray(9)))
        if kind == 9:
            return self.rude()
        if kind == 10:
            others: tuple[Any, ...] = (
                array.array("d", [1, 2]), memoryview(b"abcdefgh"), pathlib.Path("none"), slice(1), range(3), set(), {"qpos": 1},
                collections.deque([1.0]), iter([1, 2]), (x for x in (1.0, 2.0)), frozenset(), "\x00", np.random, np.void(b"ab"),
                np.datetime64("2020"), np.array("x"), np.matrix([[1.0]]),
            )  # fmt: skip
            return self.choose(others)
        if kind == 11 and self.owners:
            owner = self.choose(self.owners)
            return self.choose((owner, owner.qpos, owner.time, owner.eq_active, owner.model))
        if depth < 3:
            values = [self.any(depth + 1) for _ in range(self.rng.integers(0, 4))]
            return self.choose((list, tuple))(values)
        return None
