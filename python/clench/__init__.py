"""MuJoCo's constraint model, fast: one robot or thousands at once.

Load a model; simulate one environment with `Sim` or many with `Batch`:

>>> import clench
>>> model = clench.Model.from_xml('''
... <mujoco>
...   <worldbody>
...     <geom name="floor" type="plane" size="1 1 1"/>
...     <body name="ball" pos="0 0 0.2"><freejoint/><geom size="0.1" mass="2"/></body>
...   </worldbody>
... </mujoco>''')
>>> sim = clench.Sim(model)
>>> sim.step(2000)
>>> print(sim.qpos[2].round(2), sim.contacts.force[0, 0].round(2))
0.1 19.62

>>> batch = clench.Batch(model, 1000, precision="32")
>>> batch.qvel[:, 0] = range(1000)
>>> batch.step(10)
0

Names, units, layouts and defaults are MuJoCo's. `clench.gymnasium` has vector environments, `clench.ray` batches on a cluster.
"""

from clench import _pickle as _pickle
from clench._core import (
    OUTPUTS,
    PARAMETERS,
    Batch,
    Block,
    ComTarget,
    Constraints,
    Contact,
    Contacts,
    Element,
    FrameTarget,
    FreeCamera,
    IkResult,
    Linearization,
    Model,
    PostureTarget,
    RayHit,
    RayHits,
    Recording,
    RigidOptions,
    Separation,
    Sim,
    Solution,
    SolverStats,
    StateViews,
    Viewer,
    __version__,
    devices,
    render_device,
    solve,
)
from clench._descriptions import load_description
from clench._identify import Identification, identify
from clench._named import (
    ActuatorView,
    BodyView,
    CameraView,
    ElementView,
    EqualityView,
    GeomView,
    JointView,
    Parameters,
    SiteView,
    TendonView,
)
from clench._spec import ModelSpec, SpecElement
from clench._state import State
from clench._status import EnvStatus, IkStatus
from clench._view import view
from clench.errors import BusyError, ClenchError, LoadError, SimulationError

# The classes that users need first lead the reference.
__all__ = [
    "Model",
    "Sim",
    "Batch",
    "RigidOptions",
    "ModelSpec",
    "State",
    "OUTPUTS",
    "PARAMETERS",
    "ActuatorView",
    "Block",
    "BodyView",
    "BusyError",
    "CameraView",
    "ClenchError",
    "ComTarget",
    "Constraints",
    "Contact",
    "Contacts",
    "Element",
    "ElementView",
    "EnvStatus",
    "EqualityView",
    "FrameTarget",
    "FreeCamera",
    "GeomView",
    "Identification",
    "IkResult",
    "IkStatus",
    "JointView",
    "Linearization",
    "LoadError",
    "Parameters",
    "PostureTarget",
    "RayHit",
    "RayHits",
    "Recording",
    "Separation",
    "SimulationError",
    "SiteView",
    "Solution",
    "SolverStats",
    "SpecElement",
    "StateViews",
    "TendonView",
    "Viewer",
    "__version__",
    "devices",
    "identify",
    "load_description",
    "render_device",
    "solve",
    "view",
]
