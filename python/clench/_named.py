"""Elements of a simulation or a batch by name: what belongs to a body, a joint, a geom, ready to be read and set.

Each class is a table with a line for each quantity, which says where it comes from: the state (live), an output (of the last step), a
parameter (of this simulation alone). How the three are read and set stands once, in the classes of the lines.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, SupportsIndex, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from typing_extensions import Self

    from clench._core import Batch, Element, Sim

__all__ = [
    "ActuatorView",
    "BodyView",
    "CameraView",
    "ElementView",
    "EqualityView",
    "GeomView",
    "JointView",
    "Parameters",
    "SiteView",
    "TendonView",
]


class _Line:
    """A quantity of an element: which rows of which array it is."""

    def __init__(self, array: str, doc: str, rows: str = "_row") -> None:
        self._array = array
        self._rows = rows
        self.__doc__ = doc

    def _part(self, view: ElementView, array: NDArray[Any]) -> Any:
        """The rows of this element, after the axis over environments where there is one."""
        rows = getattr(view, self._rows)
        return array[rows] if view._alone else array[:, rows]

    @overload
    def __get__(self, view: None, of: type[Any]) -> Self: ...
    @overload
    def __get__(self, view: ElementView, of: type[Any]) -> Any: ...
    def __get__(self, view: ElementView | None, of: type[Any]) -> Any:
        if view is None:
            return self
        return self._read(view)

    def _read(self, view: ElementView) -> Any:
        raise NotImplementedError

    def __set__(self, view: ElementView, values: ArrayLike) -> None:
        raise AttributeError(f"{self._array} follows from the state and cannot be set")


class _State(_Line):
    """A part of the state: a live view."""

    def _read(self, view: ElementView) -> Any:
        return self._part(view, getattr(view._owner, self._array))

    def __set__(self, view: ElementView, values: ArrayLike) -> None:
        array = getattr(view._owner, self._array)
        rows = getattr(view, self._rows)
        # Also where the part is a single number, which is no view.
        array[rows if view._alone else (slice(None), rows)] = values


class _Output(_Line):
    """What the last step or forward pass computed, or follows from the present state: as `Sim.output` and `Batch.output`."""

    def _read(self, view: ElementView) -> Any:
        return self._part(view, view._owner.output(self._array))


class _Parameter(_Line):
    """A parameter as this simulation uses it: a copy that cannot be written; an assignment is checked as `set_param` does."""

    def _read(self, view: ElementView) -> Any:
        part = self._part(view, view._owner.param(self._array))
        if isinstance(part, np.ndarray):
            part.setflags(write=False)
        return part

    def __set__(self, view: ElementView, values: ArrayLike) -> None:
        array = view._owner.param(self._array)
        rows = getattr(view, self._rows)
        array[rows if view._alone else (slice(None), rows)] = values
        _set_parameter(view._owner, self._array, array)


def _set_parameter(owner: Any, field: str, values: ArrayLike) -> None:
    if _is_alone(owner):
        owner.set_param(field, values)
    else:
        owner.randomize(field, values)


def _is_alone(owner: Any) -> bool:
    """Whether it is a `Sim`, which has no axis over environments."""
    return not hasattr(owner, "n_envs")


class ElementView:
    """An element of a simulation or batch: what belongs to it can be read and set.

    Parts of the state are live views of the same memory; write into them or assign. Outputs are those of the last step, or of the
    present state where it was written since; in a batch they must be recorded. Parameters are of this simulation alone: they are read
    as copies that cannot be written, and an assignment is checked. In a batch all have the environments as their first axis.

    Parameters
    ----------
    owner : Sim or Batch
        What it is an element of.
    which : str or int
        Its name or index.
    """

    __slots__ = ("_alone", "_element", "_owner", "_row")
    _kind = ""

    def __init__(self, owner: Sim | Batch, which: str | SupportsIndex) -> None:
        self._element: Element = getattr(owner.model, self._kind)(which)
        self._owner = owner
        self._row: int = self._element.id
        self._alone = _is_alone(owner)

    @property
    def element(self) -> Element:
        """The element of the model, which knows its structure too."""
        return self._element

    @property
    def id(self) -> int:
        """Index among the elements of its kind."""
        return self._row

    @property
    def name(self) -> str:
        """Its name, possibly empty."""
        return self.element.name

    def __repr__(self) -> str:
        what = f'"{self.name}"' if self.name else "without a name"
        return f"<clench.{type(self).__name__}: {self._kind} {self._row}, {what}>"


class BodyView(ElementView):
    """A body, see `ElementView`."""

    __slots__ = ()
    _kind = "body"

    xpos = _Output("xpos", "Position (3), m.")
    xquat = _Output("xquat", "Orientation (4), a unit quaternion, w first.")
    xmat = _Output("xmat", "The same as a matrix (9), row by row.")
    xipos = _Output("xipos", "Centre of mass (3), m.")
    ximat = _Output("ximat", "Orientation of the inertial frame (9), row by row.")
    subtree_com = _Output("subtree_com", "Centre of mass of the body and all below it (3), m.")
    cinert = _Output("cinert", "Inertia about the centre of mass of the tree (10).")
    cvel = _Output("cvel", "Velocity there (6): angular, rad/s, then linear, m/s.")
    cacc = _Output("cacc", "Acceleration there with gravity's upward reaction (6): angular, then linear.")
    cfrc_int = _Output("cfrc_int", "What its joints carry, about the centre of mass of the tree (6): torque, N m, then force, N.")
    cfrc_ext = _Output("cfrc_ext", "What acts on it from outside, likewise (6).")
    contact_force = _Output("contact_force", "Net force of its contacts, at its centre of mass (6): force, N, then torque, N m, world axes.")
    xfrc_applied = _State("xfrc_applied", "What the user applies at its centre of mass (6): force, N, then torque, N m, world axes.")
    mocap_pos = _State("mocap_pos", "Position of a mocap body (3), m.", "_mocap")
    mocap_quat = _State("mocap_quat", "Orientation of a mocap body (4), w first.", "_mocap")
    pos = _Parameter("body_pos", "Position in the parent's frame (3), m.")
    quat = _Parameter("body_quat", "Orientation in the parent's frame (4), w first.")
    ipos = _Parameter("body_ipos", "Centre of mass in the body frame (3), m.")
    iquat = _Parameter("body_iquat", "Orientation of the inertial frame in the body frame (4), w first.")
    mass = _Parameter("body_mass", "Mass, kg.")
    subtreemass = _Parameter("body_subtreemass", "Mass of the body and all below it, kg; follows from `mass`.")
    inertia = _Parameter("body_inertia", "Principal moments (3), kg m².")
    gravcomp = _Parameter("body_gravcomp", "Share of the weight that is lifted.")
    invweight0 = _Parameter("body_invweight0", "Mean inverse inertia at qpos0 (2): of translation, of rotation.")

    @property
    def _mocap(self) -> int:
        index = int(self.element.mocapid)
        if index < 0:
            raise AttributeError(f'body "{self.name}" is no mocap body')
        return index


class JointView(ElementView):
    """A joint, see `ElementView`. Quantities along its degrees of freedom have as many entries as those."""

    __slots__ = ()
    _kind = "joint"

    qpos = _State("qpos", "Position coordinates: 1 of a hinge or slide, 4 of a ball, 7 of a free joint.", "_coordinates")
    qvel = _State("qvel", "Velocities (ndof), rad/s or m/s.", "_dofs")
    qfrc_applied = _State("qfrc_applied", "Forces that the user applies (ndof), N m or N.", "_dofs")
    qacc_warmstart = _State("qacc_warmstart", "Acceleration of the previous step, where the solver starts (ndof).", "_dofs")
    qacc = _Output("qacc", "Accelerations (ndof), rad/s² or m/s².", "_dofs")
    qfrc_bias = _Output("qfrc_bias", "Coriolis, centrifugal and gravitational forces (ndof).", "_dofs")
    qfrc_passive = _Output("qfrc_passive", "Springs, dampers, gravity compensation, fluid (ndof).", "_dofs")
    qfrc_actuator = _Output("qfrc_actuator", "Forces of actuators (ndof).", "_dofs")
    qfrc_smooth = _Output("qfrc_smooth", "All forces but those of constraints (ndof).", "_dofs")
    qfrc_constraint = _Output("qfrc_constraint", "Constraint forces (ndof).", "_dofs")
    cdof = _Output("cdof", "Motion of each degree of freedom at unit velocity (ndof, 6), angular first.", "_dofs")
    xanchor = _Output("xanchor", "Anchor (3), m, world frame.")
    xaxis = _Output("xaxis", "Axis (3), world frame.")
    pos = _Parameter("jnt_pos", "Anchor in the body frame (3), m.")
    axis = _Parameter("jnt_axis", "Unit axis in the body frame (3).")
    range = _Parameter("jnt_range", "Allowed positions (2), rad or m.")
    margin = _Parameter("jnt_margin", "Distance at which the limit appears.")
    stiffness = _Parameter("jnt_stiffness", "Spring stiffness, N m/rad or N/m.")
    stiffnesspoly = _Parameter("jnt_stiffnesspoly", "Coefficients of the spring's quadratic and cubic force (2).")
    actfrcrange = _Parameter("jnt_actfrcrange", "Limits of the total actuator force (2).")
    solref = _Parameter("jnt_solref", "Reference dynamics of the limit (2).")
    solimp = _Parameter("jnt_solimp", "Impedance of the limit (5).")
    qpos0 = _Parameter("qpos0", "Initial position coordinates.", "_coordinates")
    qpos_spring = _Parameter("qpos_spring", "Position coordinates at which the spring rests.", "_coordinates")
    armature = _Parameter("dof_armature", "Added inertia (ndof), kg m² or kg.", "_dofs")
    damping = _Parameter("dof_damping", "Damping (ndof), N m s/rad or N s/m.", "_dofs")
    dampingpoly = _Parameter("dof_dampingpoly", "Coefficients of quadratic and cubic damping (ndof, 2).", "_dofs")
    frictionloss = _Parameter("dof_frictionloss", "Dry friction (ndof), N m or N.", "_dofs")

    @property
    def _coordinates(self) -> slice:
        first = int(self.element.qposadr)
        return slice(first, first + (7, 4, 1, 1)[int(self.element.type)])

    @property
    def _dofs(self) -> slice:
        first = int(self.element.dofadr)
        return slice(first, first + (6, 3, 1, 1)[int(self.element.type)])


class GeomView(ElementView):
    """A geom, see `ElementView`."""

    __slots__ = ()
    _kind = "geom"

    xpos = _Output("geom_xpos", "Position (3), m.")
    xmat = _Output("geom_xmat", "Orientation (9), row by row.")
    pos = _Parameter("geom_pos", "Position in the body frame (3), m.")
    quat = _Parameter("geom_quat", "Orientation in the body frame (4), w first.")
    size = _Parameter("geom_size", "Sizes (3), m.")
    rbound = _Parameter("geom_rbound", "Radius of the bounding sphere, m; follows from `size`.")
    friction = _Parameter("geom_friction", "Slide, spin and roll friction (3).")
    margin = _Parameter("geom_margin", "Margin, m.")
    gap = _Parameter("geom_gap", "Gap, m.")
    surfacevel = _Parameter("geom_surfacevel", "Velocity of the surface in the geom's frame (6): linear, angular.")
    adhesion = _Parameter("geom_adhesion", "Force with which contacts hold on, N.")
    fluidcoef = _Parameter("geom_fluidcoef", "Coefficients of blunt, slender and angular drag, Kutta and Magnus lift (5).")
    virtualmass = _Parameter("geom_virtualmass", "Volume of the medium that moves with the geom along each axis (3), m³.")
    virtualinertia = _Parameter("geom_virtualinertia", "Inertia of the medium that turns with it, at unit density (3).")
    solmix = _Parameter("geom_solmix", "Weight in mixing.")
    solref = _Parameter("geom_solref", "Reference dynamics (2).")
    solimp = _Parameter("geom_solimp", "Impedance (5).")


class SiteView(ElementView):
    """A site, see `ElementView`."""

    __slots__ = ()
    _kind = "site"

    xpos = _Output("site_xpos", "Position (3), m.")
    xmat = _Output("site_xmat", "Orientation (9), row by row.")
    pos = _Parameter("site_pos", "Position in the body frame (3), m.")
    quat = _Parameter("site_quat", "Orientation in the body frame (4), w first.")
    size = _Parameter("site_size", "Size of its volume, as a geom's (3), m.")


class CameraView(ElementView):
    """A camera, see `ElementView`."""

    __slots__ = ()
    _kind = "camera"

    xpos = _Output("cam_xpos", "Position (3), m.")
    xmat = _Output("cam_xmat", "Orientation (9), row by row: x to the right, y up, z backwards.")
    pos = _Parameter("cam_pos", "Position in the body frame (3), m.")
    quat = _Parameter("cam_quat", "Orientation in the body frame (4), w first.")
    pos0 = _Parameter("cam_pos0", "From the body to the camera in the initial configuration (3), m, world axes.")
    poscom0 = _Parameter("cam_poscom0", "From the centre of mass of the body and all below it, likewise (3), m.")
    mat0 = _Parameter("cam_mat0", "Orientation in the initial configuration (9), row by row.")
    fovy = _Parameter("cam_fovy", "Vertical field of view, degrees; where lines of sight are parallel, the picture's height.")
    sensorsize = _Parameter("cam_sensorsize", "Size of the sensor (2), width and height, m.")
    intrinsic = _Parameter("cam_intrinsic", "Focal length and principal point (4).")


class TendonView(ElementView):
    """A tendon, see `ElementView`."""

    __slots__ = ()
    _kind = "tendon"

    length = _Output("ten_length", "Length, m, or sum of joint positions.")
    velocity = _Output("ten_velocity", "Its rate of change.")
    stiffness = _Parameter("tendon_stiffness", "Spring stiffness, N/m.")
    stiffnesspoly = _Parameter("tendon_stiffnesspoly", "Coefficients of the spring's quadratic and cubic force (2).")
    damping = _Parameter("tendon_damping", "Damping, N s/m.")
    dampingpoly = _Parameter("tendon_dampingpoly", "Coefficients of quadratic and cubic damping (2).")
    armature = _Parameter("tendon_armature", "Inertia of changes of the length, kg.")
    lengthspring = _Parameter("tendon_lengthspring", "Dead band of the spring (2), m.")
    length0 = _Parameter("tendon_length0", "Length at qpos0, m.")
    invweight0 = _Parameter("tendon_invweight0", "Inverse inertia at qpos0.")
    range = _Parameter("tendon_range", "Allowed lengths (2), m.")
    margin = _Parameter("tendon_margin", "Distance at which the limit appears, m.")
    actfrcrange = _Parameter("tendon_actfrcrange", "Limits of the total actuator force (2), N.")
    frictionloss = _Parameter("tendon_frictionloss", "Dry friction, N.")
    solref_lim = _Parameter("tendon_solref_lim", "Reference dynamics of the limit (2).")
    solimp_lim = _Parameter("tendon_solimp_lim", "Impedance of the limit (5).")
    solref_fri = _Parameter("tendon_solref_fri", "Reference dynamics of dry friction (2).")
    solimp_fri = _Parameter("tendon_solimp_fri", "Impedance of dry friction (5).")


class ActuatorView(ElementView):
    """An actuator, see `ElementView`."""

    __slots__ = ()
    _kind = "actuator"

    ctrl = _State("ctrl", "Its controls, mostly one.", "_controls")
    act = _State("act", "Its activations, mostly none or one.", "_activations")
    length = _Output("actuator_length", "Length of its transmission.")
    velocity = _Output("actuator_velocity", "Its rate of change.")
    force = _Output("actuator_force", "Force, N or N m.")
    gear = _Parameter("actuator_gear", "Scaling of the force onto the transmission's axes (6).")
    cranklength = _Parameter("actuator_cranklength", "Length of the rod of a slider-crank, m.")
    dynprm = _Parameter("actuator_dynprm", "Parameters of the dynamics (10).")
    gainprm = _Parameter("actuator_gainprm", "Parameters of the gain (10).")
    biasprm = _Parameter("actuator_biasprm", "Parameters of the bias (10).")
    ctrlrange = _Parameter("actuator_ctrlrange", "Limits of its controls, a row each (2).", "_controls")
    forcerange = _Parameter("actuator_forcerange", "Limits of the force (2).")
    actrange = _Parameter("actuator_actrange", "Limits of the activation (2).")
    delay = _Parameter("actuator_delay", "How late controls arrive, s.")
    damping = _Parameter("actuator_damping", "Damping of the transmission.")
    dampingpoly = _Parameter("actuator_dampingpoly", "Coefficients of quadratic and cubic damping (2).")
    armature = _Parameter("actuator_armature", "Inertia of the transmission.")
    acc0 = _Parameter("actuator_acc0", "Acceleration by unit force at qpos0.")
    lengthrange = _Parameter("actuator_lengthrange", "Lengths that it can reach (2).")

    @property
    def _controls(self) -> slice:
        first = int(self.element.ctrladr)
        return slice(first, first + int(self.element.ctrlnum))

    @property
    def _activations(self) -> slice:
        first = max(int(self.element.actadr), 0)
        return slice(first, first + int(self.element.actnum))


class EqualityView(ElementView):
    """An equality constraint, see `ElementView`."""

    __slots__ = ()
    _kind = "equality"

    active = _State("eq_active", "Whether it acts.")
    anchor1 = _Parameter("eq_anchor1", "Anchor in the frame of the first body (3), m.")
    anchor2 = _Parameter("eq_anchor2", "Anchor in the frame of the second body (3), m.")
    quat1 = _Parameter("eq_quat1", "Orientation of a weld's frame in the first body (4), w first.")
    quat2 = _Parameter("eq_quat2", "Orientation of a weld's frame in the second body (4), w first.")
    torquescale = _Parameter("eq_torquescale", "Length that scales rotations of a weld, m.")
    polycoef = _Parameter("eq_polycoef", "Coefficients of a joint or tendon equality (5), constant first.")
    solref = _Parameter("eq_solref", "Reference dynamics (2).")
    solimp = _Parameter("eq_solimp", "Impedance (5).")


class Parameters:
    """All parameters of a simulation or batch by name, such as ``sim.params.gravity`` or ``batch.params.geom_friction``.

    They are read as copies that cannot be written; an assignment is checked as `Sim.set_param` and `Batch.randomize` do. In a batch
    the environments are the first axis.
    """

    __slots__ = ("_owner",)

    _owner: Sim | Batch

    def __init__(self, owner: Sim | Batch) -> None:
        object.__setattr__(self, "_owner", owner)

    def __getattr__(self, name: str) -> NDArray[Any]:
        try:
            values = self._owner.param(name)
        except ValueError as error:
            raise AttributeError(str(error)) from None
        values.setflags(write=False)
        return values

    def __setattr__(self, name: str, values: ArrayLike) -> None:
        from clench._core import PARAMETERS

        if name not in PARAMETERS:
            raise AttributeError(f'there is no parameter "{name}"')
        if _is_alone(self._owner):
            _set_parameter(self._owner, name, values)
        else:
            full = self._owner.param(name)
            full[...] = values
            _set_parameter(self._owner, name, full)

    def __dir__(self) -> list[str]:
        from clench._core import PARAMETERS

        return list(PARAMETERS)
