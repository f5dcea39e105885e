"""Terrain of tiles: rows of rising difficulty, columns of kinds."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import ArrayLike

from clench._document import Value
from clench._element import SpecElement
from clench._spec import ModelSpec
from clench.terrain.kinds import EPSILON, BoxKind, Floats, Kind, Size, cells

__all__ = ["Terrain", "grid"]

# A robot starts above the highest point that is not farther from the middle of its tile along x and y, in metres.
_START = 0.4
# Attributes of geoms that are those of the terrain.
_OWN = ("type", "size", "pos", "quat", "axisangle", "xyaxes", "zaxis", "euler", "fromto", "hfield", "mesh")


def grid(
    kinds: Sequence[Kind],
    rows: int = 10,
    *,
    size: Size = (8.0, 8.0),
    border: float = 2.0,
    resolution: float = 0.1,
    difficulty: tuple[float, float] = (0.0, 1.0),
    boxes: bool = False,
    seed: int | np.random.Generator = 0,
) -> Terrain:
    """Creates terrain whose rows have rising difficulty, along x, and whose columns are kinds, along y.

    >>> from clench import terrain
    >>> ground = terrain.grid([terrain.Stairs(), terrain.Noise()], rows=3)
    >>> ground.origins.shape
    (3, 2, 3)

    Parameters
    ----------
    kinds : sequence of Kind
        A kind for each column; repeat one for more columns of it.
    rows : int
        Number of rows.
    size : (float, float)
        Lengths of a tile along x and y, in metres.
    border : float
        Width of the flat ground around all tiles, in metres.
    resolution : float
        Distance between samples of the height field, in metres.
    difficulty : (float, float)
        Difficulty of the first and the last row, 0 to 1, with equal steps in between.
    boxes : bool
        True for boxes instead of a height field: sides are vertical, and all kinds must be a `BoxKind`.
    seed : int or numpy.random.Generator
        Seed of all that is random. A tile depends on it, its row and its column.

    Returns
    -------
    Terrain

    Raises
    ------
    ValueError
        If a number is out of range, a kind does not fit a tile or does not consist of boxes, or sizes are no multiples
        of the resolution.
    """
    if isinstance(kinds, Kind) or not kinds or not all(isinstance(kind, Kind) for kind in kinds):
        raise ValueError(f"kinds are {kinds!r}, not a sequence of kinds of terrain")
    if rows < 1:
        raise ValueError(f"rows is {rows}, not a number of at least 1")
    if np.shape(size) != (2,) or not (np.isfinite(size).all() and min(size) > 0.0):
        raise ValueError(f"the size of a tile is {size!r}, not two lengths greater than 0")
    if not 0.0 <= border < np.inf:
        raise ValueError(f"the border is {border!r}, not a length of at least 0")
    if np.shape(difficulty) != (2,) or not all(0.0 <= level <= 1.0 for level in difficulty):
        raise ValueError(f"the difficulty is {difficulty!r}, not two numbers between 0 and 1")
    entropy = seed if not isinstance(seed, np.random.Generator) else int(seed.integers(2**63))
    levels = np.linspace(*difficulty, rows)
    tiles: list[list[Floats]] = []
    for row, level in enumerate(levels.tolist()):
        tiles.append([])
        for column, kind in enumerate(kinds):
            rng = np.random.default_rng((entropy, row, column))
            tiles[-1].append(_boxes(kind, level, rng, size) if boxes else _heights(kind, level, rng, size, resolution))
    return Terrain(tiles, size, border, None if boxes else resolution, levels)


class Terrain:
    """Terrain of tiles, which `grid` creates. Its middle is the origin of its coordinates.

    `origins` (rows, columns, 3) has the middle of each tile, at the height of the highest point within 0.4 m of it
    along x and y: a robot starts there, plus its own height. `heights` (nx, ny) has the samples of a height field, else
    None; x grows with the first index. `boxes` (n, 5) has least x and y, greatest x and y and height of the top of each
    box, else None. `rows`, `columns`, `difficulties` (rows), `size`, `border` and `resolution` are as in the call of
    `grid`. Lengths are in metres, and arrays are read-only.

    Parameters
    ----------
    tiles : sequence of sequences of numpy.ndarray
        The tiles by row and column: heights, or boxes.
    size : (float, float)
        Lengths of a tile along x and y, in metres.
    border : float
        Width of the flat ground around all tiles, in metres.
    resolution : float or None
        Distance between samples of the height field, in metres; None for boxes.
    difficulties : array_like
        Difficulty of each row.
    """

    def __init__(
        self,
        tiles: Sequence[Sequence[Floats]],
        size: Size,
        border: float,
        resolution: float | None,
        difficulties: ArrayLike,
    ) -> None:
        self._tiles = tiles
        self.size = (float(size[0]), float(size[1]))
        self.border = float(border)
        self.resolution = resolution
        self.difficulties: Floats = np.array(difficulties, np.float64)
        self.rows, self.columns = len(tiles), len(tiles[0])
        x, y = (
            length * (np.arange(count) - 0.5 * (count - 1)) for length, count in zip(size, (self.rows, self.columns))
        )
        self._middles = np.stack(np.broadcast_arrays(x[:, np.newaxis], y), axis=2)
        # Half of the lengths along x and y, with the border.
        self._half = 0.5 * np.array([self.rows * size[0], self.columns * size[1]]) + border
        self.heights: Floats | None = None if resolution is None else self._field(resolution)
        self.boxes: Floats | None = self._all_boxes() if resolution is None else None
        starts = [[[_highest(tile, self.size, resolution)] for tile in row] for row in tiles]
        self.origins: Floats = np.concatenate([self._middles, starts], axis=2)
        for array in (self.heights, self.boxes, self.origins, self.difficulties):
            if array is not None:
                array.flags.writeable = False

    def _field(self, resolution: float) -> Floats:
        """Returns the heights of all tiles and of the border. Of the samples of two neighbours the higher one holds."""
        across, along = (cells(length, resolution, "the size of a tile") for length in self.size)
        border = cells(self.border, resolution, "the border")
        heights = np.full((self.rows * across + 1 + 2 * border, self.columns * along + 1 + 2 * border), -np.inf)
        for row, tiles in enumerate(self._tiles):
            for column, tile in enumerate(tiles):
                x, y = border + row * across, border + column * along
                there = heights[x : x + across + 1, y : y + along + 1]
                np.maximum(there, tile, out=there)
        heights[np.isneginf(heights)] = 0.0
        # Micrometres suffice, and keep the text of a model short.
        return np.round(heights, 6) + 0.0

    def _all_boxes(self) -> Floats:
        """Returns the boxes of all tiles, and those of the border."""
        x, y = self._half
        far, left = x - self.border, y - self.border
        border = [
            [-x, -y, x, -left, 0.0],
            [-x, left, x, y, 0.0],
            [-x, -left, -far, left, 0.0],
            [far, -left, x, left, 0.0],
        ]
        found = [np.array(border)] if self.border > 0.0 else []
        for middles, tiles in zip(self._middles, self._tiles):
            found += [tile + [*middle, *middle, 0.0] for middle, tile in zip(middles, tiles)]
        return np.concatenate(found)

    def cell(self, row: int, column: int) -> Terrain:
        """Returns one tile with its border as a terrain of its own, such as for a model that has only this one.

        Parameters
        ----------
        row, column : int
            Indices of the tile.

        Returns
        -------
        Terrain

        Raises
        ------
        IndexError
            If there is no such tile.
        """
        if row >= self.rows or column >= self.columns:
            raise IndexError(f"there is no tile ({row}, {column}): there are {self.rows} rows and {self.columns} columns")
        return Terrain([[self._tiles[row][column]]], self.size, self.border, self.resolution, [self.difficulties[row]])

    def height(self, x: ArrayLike, y: ArrayLike) -> Floats:
        """Returns the height of the surface at points, as a ray from above finds it.

        Parameters
        ----------
        x, y : array_like
            Coordinates in metres; they are broadcast against each other.

        Returns
        -------
        numpy.ndarray
            Heights in metres, with the shape of the coordinates; NaN outside of the terrain.
        """
        points = np.stack(np.broadcast_arrays(np.asarray(x, np.float64), np.asarray(y, np.float64)), axis=-1)
        flat = points.reshape(-1, 2)
        is_inside = (np.abs(flat) <= self._half + EPSILON).all(axis=1)
        found = np.full(len(flat), np.nan)
        found[is_inside] = self._surface(flat[is_inside])
        return found.reshape(points.shape[:-1])

    def _surface(self, points: Floats) -> Floats:
        """Returns the heights at points (n, 2) of the terrain."""
        if self.heights is None or self.resolution is None:
            return self._tops(points)
        cell = np.clip((points + self._half) / self.resolution, 0.0, np.array(self.heights.shape) - 1.0)
        i, j = np.minimum(cell.astype(np.int64), np.array(self.heights.shape) - 2).T
        u, v = cell.T - (i, j)
        low, high = self.heights[i, j], self.heights[i + 1, j + 1]
        # The two triangles of a cell share the diagonal from its least to its greatest corner.
        right, far = self.heights[i + 1, j], self.heights[i, j + 1]
        below, above = low + u * (right - low) + v * (high - right), low + v * (far - low) + u * (high - far)
        return np.asarray(np.where(u > v, below, above))

    def _tops(self, points: Floats) -> Floats:
        """Returns the heights of the highest boxes at points (n, 2) of the terrain."""
        tops = np.zeros(len(points))
        row, column = np.floor((points + self._half - self.border) / self.size).astype(np.int64).T
        is_tile = (row >= 0) & (row < self.rows) & (column >= 0) & (column < self.columns)
        for r, c in np.unique(np.stack([row, column])[:, is_tile], axis=1).T:
            chosen = np.flatnonzero((row == r) & (column == c))
            tile, local = self._tiles[r][c], (points[chosen] - self._middles[r, c])[:, np.newaxis]
            is_above = ((tile[:, :2] - EPSILON <= local) & (local <= tile[:, 2:4] + EPSILON)).all(axis=2)
            tops[chosen] = np.where(is_above, tile[:, 4], -np.inf).max(axis=1)
        return tops

    def add_to(
        self, spec: ModelSpec, name: str = "terrain", *, thickness: float = 1.0, **attributes: Value
    ) -> list[SpecElement]:
        """Adds the terrain to the world of a model: a height field, or boxes. Bodies and joints stay the same.

        A plane of the model, such as a floor, remains: remove it if it is above parts of the terrain.

        Parameters
        ----------
        spec : ModelSpec
            The model.
        name : str
            Name of the height field and its geom. Boxes are numbered: ``"terrain_0"`` and so on.
        thickness : float
            Thickness of the solid below the lowest point, in metres.
        **attributes : str, bool or array_like
            Attributes of the geoms with MJCF's names, such as ``friction``, ``rgba``, ``group`` or ``class_``.

        Returns
        -------
        list of SpecElement
            The geoms.

        Raises
        ------
        ValueError
            If the thickness is not positive, an attribute is one that the terrain defines, or a name is taken.
        LoadError
            If MJCF does not have an attribute, or a value is invalid.
        """
        if not 0.0 < thickness < np.inf:
            raise ValueError(f"the thickness is {thickness!r}, not a length greater than 0")
        if own := [attribute for attribute in attributes if attribute in _OWN]:
            raise ValueError(f"{own[0]} is not an attribute to choose: the terrain defines it")
        added: list[SpecElement] = []
        try:
            for geom in self._geoms(spec, name, thickness, added):
                added.append(spec.world.add_geom(**{**geom, **attributes}))
        except (TypeError, ValueError):
            # The model is as before the call.
            for element in added:
                element.remove()
            raise
        return [element for element in added if element.tag == "geom"]

    def _geoms(
        self, spec: ModelSpec, name: str, thickness: float, added: list[SpecElement]
    ) -> Iterator[dict[str, Value]]:
        """Iterates over the attributes of the geoms. Adds the height field to the model, and to a list."""
        if self.heights is not None:
            least, height = self.heights.min(), np.ptp(self.heights)
            # The height of a plane is not 0, which models do not accept, but it scales heights that are.
            size = [*self._half, height or 1.0, thickness]
            # Rows of a height field begin at the far end of y.
            rows = self.heights.T[::-1] - least
            shape = dict(zip(("nrow", "ncol"), rows.shape))
            added.append(spec.add_asset("hfield", name=name, size=size, elevation=np.round(rows, 6), **shape))
            yield {"name": name, "type": "hfield", "hfield": name, "pos": [0.0, 0.0, least]}
        elif self.boxes is not None:
            bottom = self.boxes[:, 4].min() - thickness
            for index, (x0, y0, x1, y1, top) in enumerate(self.boxes.tolist()):
                pos = [0.5 * (x0 + x1), 0.5 * (y0 + y1), 0.5 * (top + bottom)]
                half = [0.5 * (x1 - x0), 0.5 * (y1 - y0), 0.5 * (top - bottom)]
                yield {"name": f"{name}_{index}", "type": "box", "pos": pos, "size": half}

    def __repr__(self) -> str:
        if self.heights is not None:
            shape = f"a height field of {self.heights.shape[0]} x {self.heights.shape[1]} samples"
        else:
            shape = f"{0 if self.boxes is None else len(self.boxes)} boxes"
        tile = f"{self.size[0]:g} x {self.size[1]:g} m"
        return f"<clench.terrain.Terrain: {self.rows} x {self.columns} tiles of {tile}, {shape}>"


def _heights(kind: Kind, level: float, rng: np.random.Generator, size: Size, resolution: float) -> Floats:
    """Returns the heights of a tile."""
    heights = np.asarray(kind.heights(level, rng, size, resolution), np.float64)
    shape = tuple(cells(length, resolution, "the size of a tile") + 1 for length in size)
    if heights.shape != shape or not np.isfinite(heights).all():
        raise ValueError(f"{type(kind).__name__}: heights of shape {heights.shape} are not {shape} finite numbers")
    return heights


def _boxes(kind: Kind, level: float, rng: np.random.Generator, size: Size) -> Floats:
    """Returns the boxes of a tile."""
    if not isinstance(kind, BoxKind):
        raise ValueError(f"{type(kind).__name__} does not consist of boxes")
    boxes = np.asarray(kind.boxes(level, rng, size), np.float64)
    if boxes.ndim != 2 or boxes.shape[1] != 5 or not np.isfinite(boxes).all():
        raise ValueError(f"{type(kind).__name__}: boxes of shape {boxes.shape} are not (n, 5) finite numbers")
    if not (boxes[:, :2] < boxes[:, 2:4]).all():
        raise ValueError(f"{type(kind).__name__}: a box has a width or length of 0")
    if not ((boxes[:, :2] <= 0.0) & (boxes[:, 2:4] >= 0.0)).all(axis=1).any():
        raise ValueError(f"{type(kind).__name__}: no box is in the middle of the tile")
    return boxes


def _highest(tile: Floats, size: Size, resolution: float | None) -> float:
    """Returns the height of the highest point near the middle of a tile."""
    if resolution is None:
        is_near = ((tile[:, :2] < _START) & (tile[:, 2:4] > -_START)).all(axis=1)
        return float(tile[is_near, 4].max())
    near = []
    for length, count in zip(size, tile.shape):
        # The samples between which the ends of the interval lie are included.
        reach = min(_START, length / 2.0)
        ends = (length / 2.0 + np.array([-reach, reach])) / resolution
        near.append(slice(int(ends[0] + EPSILON), min(int(np.ceil(ends[1] - EPSILON)) + 1, count)))
    return float(tile[tuple(near)].max())
