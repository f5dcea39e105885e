"""Kinds of terrain: the heights of a tile, or its boxes, at a difficulty.

The coordinates of a tile have their origin in its middle. The ground at its edge has the height 0, so that tiles of
different kinds meet without a step.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import ClassVar, TypeAlias

import numpy as np
from numpy.typing import NDArray

Floats: TypeAlias = NDArray[np.float64]
Size: TypeAlias = tuple[float, float]
# A constant, or a pair of the values at the difficulties 0 and 1.
Range: TypeAlias = float | tuple[float, float]

# Lengths that differ by less are equal: sums of lengths of a tile have rounding errors.
EPSILON = 1e-9
# Waves and noise grow over this length from the border of their tile inwards, in metres.
_BLEND = 0.5
# Pieces of stepping stones at the edge that are narrower than this are omitted, in metres.
_NARROWEST = 0.01


@dataclass(frozen=True)
class Kind:
    """A kind of terrain. A subclass defines `heights`; fields of a subclass that is a dataclass are checked.

    Numbers are at least 0, and each may be a pair ``(easiest, hardest)``.
    """

    # Names of the fields that must exceed 0.
    _positive: ClassVar[tuple[str, ...]] = ()

    def __post_init__(self) -> None:
        for field in dataclasses.fields(self):
            value = getattr(self, field.name)
            if isinstance(value, bool):
                continue
            try:
                numbers = np.asarray(value, np.float64)
            except (TypeError, ValueError):
                numbers = np.array(np.nan)
            is_positive = field.name in self._positive
            valid = np.isfinite(numbers) & (numbers > 0 if is_positive else numbers >= 0)
            if numbers.shape not in ((), (2,)) or not valid.all():
                least = "greater than 0" if is_positive else "of at least 0"
                raise ValueError(
                    f"{type(self).__name__}: {field.name} is {value!r}, not a number {least} or a pair of them"
                )

    def heights(
        self, difficulty: float, rng: np.random.Generator, size: Size = (8.0, 8.0), resolution: float = 0.1
    ) -> Floats:
        """Returns the heights of a tile at the points of a lattice, its edges included.

        Parameters
        ----------
        difficulty : float
            The difficulty, 0 to 1.
        rng : numpy.random.Generator
            The source of all that is random.
        size : (float, float)
            Lengths of the tile along x and y, in metres.
        resolution : float
            Distance between samples, in metres.

        Returns
        -------
        numpy.ndarray
            (nx + 1, ny + 1) Heights in metres; x grows with the first index, y with the second.

        Raises
        ------
        ValueError
            If the difficulty is not between 0 and 1, the kind does not fit the tile, or the size is no multiple of the
            resolution.
        """
        raise NotImplementedError(f"{type(self).__name__} has no heights")

    def _named(self, name: str, difficulty: float) -> float:
        """Returns the value of a field at a difficulty."""
        if not 0.0 <= difficulty <= 1.0:
            raise ValueError(f"the difficulty is {difficulty!r}, not between 0 and 1")
        easiest, hardest = np.broadcast_to(np.asarray(getattr(self, name), np.float64), 2).tolist()
        return float(easiest + difficulty * (hardest - easiest))

    def _inside(self, difficulty: float, size: Size, middle: float) -> float:
        """Returns the width of the border, which must leave space for a square in the middle."""
        border, least = self._named("border", difficulty), float(np.min(size))
        # A size that is not a number fails both comparisons.
        if not (2.0 * border + middle <= least + EPSILON and 2.0 * border < least):
            raise ValueError(
                f"{type(self).__name__}: a middle of {middle:g} m and a border of {border:g} m do not fit a tile of "
                f"{size[0]:g} x {size[1]:g} m"
            )
        return border


class BoxKind(Kind):
    """A kind of terrain that consists of boxes. A subclass defines `boxes`."""

    def boxes(self, difficulty: float, rng: np.random.Generator, size: Size = (8.0, 8.0)) -> Floats:
        """Returns the boxes of a tile, without their lower ends. They cover the whole tile.

        Parameters
        ----------
        difficulty : float
            The difficulty, 0 to 1.
        rng : numpy.random.Generator
            The source of all that is random.
        size : (float, float)
            Lengths of the tile along x and y, in metres.

        Returns
        -------
        numpy.ndarray
            (n, 5) Least x and y, greatest x and y, and height of the top, in metres.

        Raises
        ------
        ValueError
            If the difficulty is not between 0 and 1, or the kind does not fit the tile.
        """
        raise NotImplementedError(f"{type(self).__name__} has no boxes")

    def heights(
        self, difficulty: float, rng: np.random.Generator, size: Size = (8.0, 8.0), resolution: float = 0.1
    ) -> Floats:
        """Returns the heights of the boxes at the points of a lattice; see `Kind.heights`. A side of a box is a slope
        of one lattice cell outside the box."""
        xs, ys = lattice(size, resolution)
        heights = np.full((xs.size, ys.size), -np.inf)
        for x0, y0, x1, y1, top in self.boxes(difficulty, rng, size).tolist():
            inside = np.ix_((x0 - EPSILON <= xs) & (xs <= x1 + EPSILON), (y0 - EPSILON <= ys) & (ys <= y1 + EPSILON))
            heights[inside] = np.maximum(heights[inside], top)
        return heights


@dataclass(frozen=True)
class Flat(BoxKind):
    """A plane."""

    def boxes(self, difficulty: float, rng: np.random.Generator, size: Size = (8.0, 8.0)) -> Floats:
        """Returns one box; see `BoxKind.boxes`."""
        return np.array([_inset(size, 0.0, 0.0)])


@dataclass(frozen=True)
class Stairs(BoxKind):
    """A pyramid of stairs, up to a platform in the middle, or down to it.

    Parameters
    ----------
    step_height : float or (float, float)
        Height of a step.
    step_width : float or (float, float)
        Horizontal length of a step.
    platform : float or (float, float)
        Least width of the platform: it is wider if the steps do not fill the tile.
    border : float or (float, float)
        Width of the flat edge of the tile.
    down : bool
        True for stairs that descend to the platform.
    """

    step_height: Range = (0.05, 0.2)
    step_width: Range = 0.3
    platform: Range = 1.0
    border: Range = 0.25
    down: bool = False
    _positive: ClassVar[tuple[str, ...]] = ("step_width",)

    def boxes(self, difficulty: float, rng: np.random.Generator, size: Size = (8.0, 8.0)) -> Floats:
        """Returns a box a step where stairs ascend, and four a step where they descend; see `BoxKind.boxes`."""
        height, width, platform = (self._named(name, difficulty) for name in ("step_height", "step_width", "platform"))
        border = self._inside(difficulty, size, platform)
        steps = int((min(size) / 2.0 - border - platform / 2.0) / width + EPSILON)
        if steps < 1:
            raise ValueError(
                f"Stairs: no step of {width:g} m fits a tile of {size[0]:g} x {size[1]:g} m next to its platform"
            )
        insets = [border + width * step for step in range(steps)]
        if not self.down:
            nested = [_inset(size, inset, height * step) for step, inset in enumerate(insets, 1) if height > 0.0]
            return np.array([_inset(size, 0.0, 0.0), *nested])
        rings = _frame(size, 0.0, border, 0.0)
        for step, (outer, inner) in enumerate(zip(insets, insets[1:]), 1):
            rings += _frame(size, outer, inner, -height * step)
        return np.array([*rings, _inset(size, insets[-1], -height * steps)])


@dataclass(frozen=True)
class Slope(Kind):
    """A pyramid of slopes, up to a platform in the middle, or down to it.

    Parameters
    ----------
    slope : float or (float, float)
        Rise over run.
    platform : float or (float, float)
        Width of the platform.
    border : float or (float, float)
        Width of the flat edge of the tile.
    down : bool
        True for slopes that descend to the platform.
    """

    slope: Range = (0.0, 0.4)
    platform: Range = 1.0
    border: Range = 0.25
    down: bool = False

    def heights(
        self, difficulty: float, rng: np.random.Generator, size: Size = (8.0, 8.0), resolution: float = 0.1
    ) -> Floats:
        """Returns the heights of the pyramid; see `Kind.heights`."""
        slope, platform = self._named("slope", difficulty), self._named("platform", difficulty)
        border = self._inside(difficulty, size, platform)
        run = np.clip(_from_edge(size, resolution) - border, 0.0, min(size) / 2.0 - platform / 2.0 - border)
        return (-slope if self.down else slope) * run


@dataclass(frozen=True)
class Waves(Kind):
    """The sum of a wave along x and one along y, with a crest in the middle.

    Parameters
    ----------
    amplitude : float or (float, float)
        Greatest height, and greatest depth.
    wavelength : float or (float, float)
        Length of a wave.
    border : float or (float, float)
        Width of the flat edge of the tile, inside of which the waves grow over half a metre.
    """

    amplitude: Range = (0.02, 0.2)
    wavelength: Range = 2.0
    border: Range = 0.25
    _positive: ClassVar[tuple[str, ...]] = ("wavelength",)

    def heights(
        self, difficulty: float, rng: np.random.Generator, size: Size = (8.0, 8.0), resolution: float = 0.1
    ) -> Floats:
        """Returns the heights of the waves; see `Kind.heights`."""
        amplitude, wavelength = self._named("amplitude", difficulty), self._named("wavelength", difficulty)
        border = self._inside(difficulty, size, 0.0)
        x, y = (2.0 * np.pi / wavelength * along for along in lattice(size, resolution))
        waves = 0.5 * amplitude * (np.cos(x)[:, np.newaxis] + np.cos(y))
        return np.asarray(waves * np.clip((_from_edge(size, resolution) - border) / _BLEND, 0.0, 1.0))


@dataclass(frozen=True)
class Noise(Kind):
    """Uniformly distributed heights.

    Parameters
    ----------
    amplitude : float or (float, float)
        Greatest height, and greatest depth.
    spacing : float or (float, float)
        Distance between random heights, which are interpolated linearly.
    border : float or (float, float)
        Width of the flat edge of the tile, inside of which the noise grows over half a metre.
    """

    amplitude: Range = (0.01, 0.1)
    spacing: Range = 0.2
    border: Range = 0.25
    _positive: ClassVar[tuple[str, ...]] = ("spacing",)

    def heights(
        self, difficulty: float, rng: np.random.Generator, size: Size = (8.0, 8.0), resolution: float = 0.1
    ) -> Floats:
        """Returns random heights; see `Kind.heights`."""
        amplitude, spacing = self._named("amplitude", difficulty), self._named("spacing", difficulty)
        border = self._inside(difficulty, size, 0.0)
        # Positions of the samples in units of the spacing, of which the last random height lies beyond the last sample.
        along = [(points - points[0]) / spacing for points in lattice(size, resolution)]
        noise = rng.uniform(-amplitude, amplitude, [int(points[-1]) + 2 for points in along])
        for axis, points in enumerate(along):
            below = points.astype(np.int64)
            fraction = np.expand_dims(points - below, 1 - axis)
            noise = (1.0 - fraction) * noise.take(below, axis) + fraction * noise.take(below + 1, axis)
        return np.asarray(noise * np.clip((_from_edge(size, resolution) - border) / _BLEND, 0.0, 1.0))


@dataclass(frozen=True)
class SteppingStones(BoxKind):
    """Stones over holes, in rows that are shifted at random.

    Parameters
    ----------
    stone : float or (float, float)
        Width of a stone.
    gap : float or (float, float)
        Distance between stones.
    unevenness : float or (float, float)
        Greatest height of the stones above the platform, and greatest depth below it.
    depth : float or (float, float)
        Depth of the holes.
    platform : float or (float, float)
        Width of the platform in the middle; stones that it overlaps have its height.
    border : float or (float, float)
        Width of the flat edge of the tile.
    """

    stone: Range = (0.8, 0.3)
    gap: Range = (0.05, 0.3)
    unevenness: Range = (0.0, 0.05)
    depth: Range = 1.0
    platform: Range = 1.0
    border: Range = 0.25
    _positive: ClassVar[tuple[str, ...]] = ("stone", "depth")

    def boxes(self, difficulty: float, rng: np.random.Generator, size: Size = (8.0, 8.0)) -> Floats:
        """Returns a box a stone, and those of the border, the platform and the ground below; see `BoxKind.boxes`."""
        stone, gap, unevenness, depth, platform = (
            self._named(name, difficulty) for name in ("stone", "gap", "unevenness", "depth", "platform")
        )
        border = self._inside(difficulty, size, platform)
        found = [_inset(size, 0.0, -depth), *_frame(size, 0.0, border, 0.0)]
        if platform > 0.0:
            found.append((-platform / 2.0, -platform / 2.0, platform / 2.0, platform / 2.0, 0.0))
        width, length = size[0] / 2.0 - border, size[1] / 2.0 - border
        pitch = stone + gap
        for x in np.arange(rng.uniform(0.0, pitch) - pitch - width, width, pitch).tolist():
            for y in np.arange(rng.uniform(0.0, pitch) - pitch - length, length, pitch).tolist():
                x0, x1 = max(x, -width), min(x + stone, width)
                y0, y1 = max(y, -length), min(y + stone, length)
                top = rng.uniform(-unevenness, unevenness)
                if min(x1 - x0, y1 - y0) < _NARROWEST:
                    continue
                is_at_platform = max(x0, -x1, y0, -y1) < platform / 2.0
                found.append((x0, y0, x1, y1, 0.0 if is_at_platform else max(top, -depth)))
        return np.array(found)


@dataclass(frozen=True)
class Obstacles(BoxKind):
    """Boxes at random positions on a plane.

    Parameters
    ----------
    height : float or (float, float)
        Greatest height; heights are random between half of it and all of it.
    width : float or (float, float)
        Greatest width and length; they are random between half of it and all of it.
    count : float or (float, float)
        Number of boxes, rounded; those on the platform are omitted.
    platform : float or (float, float)
        Width of the free space in the middle.
    border : float or (float, float)
        Width of the flat edge of the tile.
    """

    height: Range = (0.05, 0.25)
    width: Range = 1.0
    count: Range = 30
    platform: Range = 1.0
    border: Range = 0.25
    _positive: ClassVar[tuple[str, ...]] = ("width",)

    def boxes(self, difficulty: float, rng: np.random.Generator, size: Size = (8.0, 8.0)) -> Floats:
        """Returns the boxes and the ground below; see `BoxKind.boxes`."""
        height, width, count, platform = (
            self._named(name, difficulty) for name in ("height", "width", "count", "platform")
        )
        border = self._inside(difficulty, size, max(platform, width))
        half = 0.5 * width * rng.uniform(0.5, 1.0, (round(count), 2))
        room = np.array(size) / 2.0 - border - half
        middle = rng.uniform(-room, room)
        tops = height * rng.uniform(0.5, 1.0, (round(count), 1))
        is_free = (np.abs(middle) - half >= platform / 2.0).any(axis=1)
        found = np.hstack([middle - half, middle + half, tops])[is_free & (height > 0.0)]
        return np.vstack([_inset(size, 0.0, 0.0), found])


def cells(length: float, resolution: float, name: str) -> int:
    """Returns the number of lattice cells along a length, which must be a multiple of the resolution."""
    if not 0.0 < resolution < np.inf:
        raise ValueError(f"the resolution is {resolution!r}, not a length greater than 0")
    if not 0.0 <= length < np.inf:
        raise ValueError(f"{name} is {length!r}, not a length")
    count = round(length / resolution)
    if abs(count * resolution - length) > 1e-6 * resolution:
        raise ValueError(f"{name} is {length:g} m, not a multiple of the resolution of {resolution:g} m")
    return count


def lattice(size: Size, resolution: float) -> tuple[Floats, Floats]:
    """Returns the coordinates of the samples of a tile along x and y."""
    counts = [cells(length, resolution, "the size of a tile") for length in size]
    x, y = (np.linspace(-length / 2.0, length / 2.0, count + 1) for length, count in zip(size, counts))
    return x, y


def _from_edge(size: Size, resolution: float) -> Floats:
    """Returns the distance of each sample from the edge of its tile."""
    x, y = (length / 2.0 - np.abs(along) for length, along in zip(size, lattice(size, resolution)))
    return np.minimum(x[:, np.newaxis], y)


def _inset(size: Size, inset: float, top: float) -> tuple[float, float, float, float, float]:
    """Returns the box whose sides have a distance from the edge of its tile."""
    x, y = size[0] / 2.0 - inset, size[1] / 2.0 - inset
    return (-x, -y, x, y, top)


def _frame(size: Size, outer: float, inner: float, top: float) -> list[tuple[float, float, float, float, float]]:
    """Returns the four boxes between two distances from the edge of a tile."""
    if inner <= outer:
        return []
    x, y, _, _, _ = _inset(size, outer, top)
    left, near, right, far, _ = _inset(size, inner, top)
    return [(x, y, -x, near, top), (x, far, -x, -y, top), (x, near, left, far, top), (right, near, -x, far, top)]
