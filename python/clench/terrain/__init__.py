"""Terrain for locomotion: stairs, slopes, waves, stepping stones, noise and obstacles, in a grid of rising difficulty.

::

    import clench
    from clench import terrain

    kinds = [terrain.Stairs(), terrain.Stairs(down=True), terrain.Slope(), terrain.Noise(amplitude=(0.01, 0.1))]
    ground = terrain.grid(kinds, rows=10, size=(8, 8), seed=0)
    spec = clench.ModelSpec.from_file("robot.xml")
    ground.add_to(spec, friction=[0.8, 0.005, 0.0001])
    batch = clench.Batch(spec.build(), 4096)
    batch.qpos[:, :3] += ground.origins[row, column]    # (4096, 3), with an index of each environment

Rows have rising difficulty, from 0 to 1, and columns are kinds. The grid is one height field, or with ``boxes=True``
boxes, of the world: a model with a terrain has the bodies and joints that it has without. A number of a kind is
constant, or a pair ``(easiest, hardest)``, between which the difficulty interpolates. Lengths are metres.

Subclass `Kind` and write ``heights`` for a kind of your own.
"""

from clench.terrain.grid import Terrain, grid
from clench.terrain.kinds import BoxKind, Flat, Kind, Noise, Obstacles, Slope, Stairs, SteppingStones, Waves

__all__ = [
    "BoxKind",
    "Flat",
    "Kind",
    "Noise",
    "Obstacles",
    "Slope",
    "Stairs",
    "SteppingStones",
    "Terrain",
    "Waves",
    "grid",
]
