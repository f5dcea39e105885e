"""A batch whose environments are spread over the machines of a Ray cluster, which must be installed (``pip install 'clench[ray]'``).

::

    import clench
    import clench.ray

    model = clench.ModelSpec.from_file("robot.xml").build()
    with clench.ray.Batch(model, 100_000, workers=8, threads=16) as batch:
        batch.ctrl[:] = 0.1
        batch.step(10)
        print(batch.qpos.mean(axis=0))

`Batch` here has the face of `clench.Batch`: an environment moves as there, to the bit, on however many machines. A worker that
dies is replaced: the new one begins with the last snapshot of the lost one and does again what came after it, so that the run ends
with the same bits as without the death.

What stands here: the driver's side (`batch.py`, with what is asked in `asked.py` and what is tied at run time in `tied.py`; one
worker as the driver sees it in `worker.py`), what a worker runs (`shard.py`), arrays that are kept here and there (`mirror.py`), and
answers that travel (`answers.py`). No physics, and nothing that imports ``ray`` before it is used.
"""

from clench.ray.answers import IkResult, RayHits
from clench.ray.batch import Batch

__all__ = ["Batch", "IkResult", "RayHits"]
