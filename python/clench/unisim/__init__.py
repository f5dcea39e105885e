"""A backend for UniSim, the layer between UniLab's tasks and physics engines. UniSim and PyTorch must be installed
(``pip install 'clench[unisim]'``).

::

    import torch
    from clench.unisim import create_backend
    from unisim.scene import SceneCfg

    backend = create_backend(SceneCfg(model_file="robot.xml"), num_envs=1024, sim_dt=0.005)
    backend.materialize()
    backend.step_tensor(torch.zeros(1024, backend.num_actuators), nsteps=4)
    backend.get_state_views(("qpos", "qvel"))["qpos"]   # (1024, nq)

`ClenchBackend` implements ``unisim.SimBackend`` over one `clench.Batch`. UniSim's own ``create_backend`` knows only its
built-in engines, so tasks must be given this one. Meanings follow UniSim's adapter for MuJoCo: generalized coordinates,
controls, sensors and reset terms have the same layouts and the same times.

The modules are the model of a scene (`scene.py`), queries of it (`model_queries.py`), randomization and external
forces (`randomization.py`), the boundary to Torch (`tensors.py`), snapshots and pictures (`playback.py`), and their
union (`backend.py`).
"""

try:
    import unisim as _unisim  # noqa: F401  It is imported for its error only.
except ImportError as error:
    raise ImportError("clench.unisim needs UniSim: pip install 'clench[unisim]'", name=error.name) from error

from clench.unisim.backend import ClenchBackend, create_backend

__all__ = ["ClenchBackend", "create_backend"]
