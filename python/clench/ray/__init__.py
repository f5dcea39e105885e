"""A batch whose environments are distributed over the machines of a Ray cluster. Ray must be installed (``pip install
'clench[ray]'``).

::

    import clench
    import clench.ray

    model = clench.ModelSpec.from_file("robot.xml").build()
    with clench.ray.Batch(model, 100_000, workers=8, threads=16) as batch:
        batch.ctrl[:] = 0.1
        batch.step(10)
        print(batch.qpos.mean(axis=0))

`Batch` has the API of `clench.Batch`, except `ray`, derivatives, GPUs and several models. An environment moves
identically, to the bit, on any number of machines. A worker that dies is replaced: the new one starts from the last
snapshot of the lost one and repeats the later calls, so that the run ends with the same bits as without the failure.

The modules are the driver's side (`batch.py`, with queries in `queries.py` and dynamic constraints in `dynamic_constraints.py`;
`worker.py` represents one worker), the code that a worker runs (`shard.py`), arrays that driver and workers share
(`mirror.py`), and results that are sent between machines (`results.py`). There is no physics, and ``ray`` is imported
only on use.
"""

from clench.ray.results import IkResult, RayHits
from clench.ray.batch import Batch

__all__ = ["Batch", "IkResult", "RayHits"]
