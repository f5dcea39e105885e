"""Elements of a simulation or a batch by name, with the quantities of a body, a joint, a geom as attributes.

Each class is a table with one line per quantity, which defines its source: the state (live), an output (of the last
step), or a parameter (of this simulation only). `_lines.py` defines how the three are read and set.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from numpy.typing import ArrayLike, NDArray

from clench._lines import OutputLine, ParameterLine, StateLine, set_parameter
from clench._element_view import ElementView, computed_once, is_alone

if TYPE_CHECKING:
    from clench._core import Batch, Sim

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


class BodyView(ElementView):
    """A body; see `ElementView`."""

    __slots__ = ()
    _kind = "body"

    xpos = OutputLine("xpos", "Position (3), m.")
    xquat = OutputLine("xquat", "Orientation (4), a unit quaternion, w first.")
    xmat = OutputLine("xmat", "Orientation as a matrix (9), row by row.")
    xipos = OutputLine("xipos", "Centre of mass (3), m.")
    ximat = OutputLine("ximat", "Orientation of the inertial frame (9), row by row.")
    subtree_com = OutputLine("subtree_com", "Centre of mass of the subtree of the body (3), m.")
    cinert = OutputLine("cinert", "Inertia about the centre of mass of the tree (10).")
    cvel = OutputLine("cvel", "Velocity at the centre of mass of the tree (6): angular, rad/s, then linear, m/s.")
    cacc = OutputLine("cacc", "Acceleration at the centre of mass of the tree, minus gravity (6): angular, then linear.")
    cfrc_int = OutputLine("cfrc_int", "Reaction of its joints, about the centre of mass of the tree (6): torque, N m, then force, N.")
    cfrc_ext = OutputLine("cfrc_ext", "External load, about the centre of mass of the tree (6): torque, N m, then force, N.")
    contact_force = OutputLine("contact_force", "Net force of its contacts, at its centre of mass (6): force, N, then torque, N m, world axes.")
    xfrc_applied = StateLine("xfrc_applied", "Load that the user applies at its centre of mass (6): force, N, then torque, N m, world axes.")
    mocap_pos = StateLine("mocap_pos", "Position of a mocap body (3), m.", "_mocap")
    mocap_quat = StateLine("mocap_quat", "Orientation of a mocap body (4), w first.", "_mocap")
    pos = ParameterLine("body_pos", "Position in the parent's frame (3), m.")
    quat = ParameterLine("body_quat", "Orientation in the parent's frame (4), w first.")
    ipos = ParameterLine("body_ipos", "Centre of mass in the body frame (3), m.")
    iquat = ParameterLine("body_iquat", "Orientation of the inertial frame in the body frame (4), w first.")
    mass = ParameterLine("body_mass", "Mass, kg.")
    subtreemass = ParameterLine("body_subtreemass", "Mass of the subtree of the body, kg; computed from `mass`.")
    inertia = ParameterLine("body_inertia", "Principal moments (3), kg m².")
    gravcomp = ParameterLine("body_gravcomp", "Fraction of the weight that is compensated.")
    invweight0 = ParameterLine("body_invweight0", "Mean inverse inertia at qpos0 (2): of translation, of rotation.")

    @computed_once
    def _mocap(self) -> int:
        index = int(self.element.mocapid)
        if index < 0:
            raise AttributeError(f'body "{self.name}" is not a mocap body')
        return index


class JointView(ElementView):
    """A joint; see `ElementView`. Quantities along its degrees of freedom have one entry for each of them."""

    __slots__ = ()
    _kind = "joint"

    qpos = StateLine("qpos", "Position coordinates: 1 of a hinge or slide, 4 of a ball, 7 of a free joint.", "_coordinates")
    qvel = StateLine("qvel", "Velocities (ndof), rad/s or m/s.", "_dofs")
    qfrc_applied = StateLine("qfrc_applied", "Forces that the user applies (ndof), N m or N.", "_dofs")
    qacc_warmstart = StateLine("qacc_warmstart", "Acceleration of the previous step, where the solver starts (ndof).", "_dofs")
    qacc = OutputLine("qacc", "Accelerations (ndof), rad/s² or m/s².", "_dofs")
    qfrc_bias = OutputLine("qfrc_bias", "Coriolis, centrifugal and gravitational forces (ndof).", "_dofs")
    qfrc_passive = OutputLine("qfrc_passive", "Springs, dampers, gravity compensation, fluid (ndof).", "_dofs")
    qfrc_actuator = OutputLine("qfrc_actuator", "Forces of actuators (ndof).", "_dofs")
    qfrc_smooth = OutputLine("qfrc_smooth", "All forces except those of constraints (ndof).", "_dofs")
    qfrc_constraint = OutputLine("qfrc_constraint", "Constraint forces (ndof).", "_dofs")
    cdof = OutputLine("cdof", "Motion of each degree of freedom at unit velocity (ndof, 6), angular first.", "_dofs")
    xanchor = OutputLine("xanchor", "Anchor (3), m, world frame.")
    xaxis = OutputLine("xaxis", "Axis (3), world frame.")
    pos = ParameterLine("jnt_pos", "Anchor in the body frame (3), m.")
    axis = ParameterLine("jnt_axis", "Unit axis in the body frame (3).")
    range = ParameterLine("jnt_range", "Allowed positions (2), rad or m.")
    margin = ParameterLine("jnt_margin", "Distance at which the limit becomes active.")
    stiffness = ParameterLine("jnt_stiffness", "Spring stiffness, N m/rad or N/m.")
    stiffnesspoly = ParameterLine("jnt_stiffnesspoly", "Coefficients of the spring's quadratic and cubic force (2).")
    springyield = ParameterLine("jnt_springyield", "Elongation at which the spring yields, m or rad; 0 if it never yields.")
    actfrcrange = ParameterLine("jnt_actfrcrange", "Limits of the total actuator force (2).")
    solref = ParameterLine("jnt_solref", "Reference dynamics of the limit (2).")
    solimp = ParameterLine("jnt_solimp", "Impedance of the limit (5).")
    qpos0 = ParameterLine("qpos0", "Initial position coordinates.", "_coordinates")
    qpos_spring = ParameterLine("qpos_spring", "Position coordinates at which the spring is relaxed.", "_coordinates")
    armature = ParameterLine("dof_armature", "Added inertia (ndof), kg m² or kg.", "_dofs")
    damping = ParameterLine("dof_damping", "Damping (ndof), N m s/rad or N s/m.", "_dofs")
    dampingpoly = ParameterLine("dof_dampingpoly", "Coefficients of quadratic and cubic damping (ndof, 2).", "_dofs")
    frictionloss = ParameterLine("dof_frictionloss", "Dry friction (ndof), N m or N.", "_dofs")

    @computed_once
    def _coordinates(self) -> slice:
        first = int(self.element.qposadr)
        return slice(first, first + (7, 4, 1, 1)[int(self.element.type)])

    @computed_once
    def _dofs(self) -> slice:
        first = int(self.element.dofadr)
        return slice(first, first + (6, 3, 1, 1)[int(self.element.type)])


class GeomView(ElementView):
    """A geom; see `ElementView`."""

    __slots__ = ()
    _kind = "geom"

    xpos = OutputLine("geom_xpos", "Position (3), m.")
    xmat = OutputLine("geom_xmat", "Orientation (9), row by row.")
    pos = ParameterLine("geom_pos", "Position in the body frame (3), m.")
    quat = ParameterLine("geom_quat", "Orientation in the body frame (4), w first.")
    size = ParameterLine("geom_size", "Sizes (3), m.")
    rbound = ParameterLine("geom_rbound", "Radius of the bounding sphere, m; computed from `size`.")
    friction = ParameterLine("geom_friction", "Slide, spin and roll friction (3).")
    margin = ParameterLine("geom_margin", "Margin, m.")
    gap = ParameterLine("geom_gap", "Gap, m.")
    surfacevel = ParameterLine("geom_surfacevel", "Velocity of the surface in the geom's frame (6): linear, angular.")
    adhesion = ParameterLine("geom_adhesion", "Adhesive force of contacts, N.")
    fluidcoef = ParameterLine("geom_fluidcoef", "Coefficients of blunt, slender and angular drag, Kutta and Magnus lift (5).")
    virtualmass = ParameterLine("geom_virtualmass", "Volume of the medium that moves with the geom along each axis (3), m³.")
    virtualinertia = ParameterLine("geom_virtualinertia", "Inertia of the medium that rotates with the geom, at unit density (3).")
    solmix = ParameterLine("geom_solmix", "Weight in mixing.")
    solref = ParameterLine("geom_solref", "Reference dynamics (2).")
    solimp = ParameterLine("geom_solimp", "Impedance (5).")


class SiteView(ElementView):
    """A site; see `ElementView`."""

    __slots__ = ()
    _kind = "site"

    xpos = OutputLine("site_xpos", "Position (3), m.")
    xmat = OutputLine("site_xmat", "Orientation (9), row by row.")
    pos = ParameterLine("site_pos", "Position in the body frame (3), m.")
    quat = ParameterLine("site_quat", "Orientation in the body frame (4), w first.")
    size = ParameterLine("site_size", "Size of its volume, as a geom's (3), m.")


class CameraView(ElementView):
    """A camera; see `ElementView`."""

    __slots__ = ()
    _kind = "camera"

    xpos = OutputLine("cam_xpos", "Position (3), m.")
    xmat = OutputLine("cam_xmat", "Orientation (9), row by row: x to the right, y up, z backwards.")
    pos = ParameterLine("cam_pos", "Position in the body frame (3), m.")
    quat = ParameterLine("cam_quat", "Orientation in the body frame (4), w first.")
    pos0 = ParameterLine("cam_pos0", "Position relative to the body in the initial configuration (3), m, world axes.")
    poscom0 = ParameterLine("cam_poscom0", "Position relative to the centre of mass of the subtree in the initial configuration (3), m, world axes.")
    mat0 = ParameterLine("cam_mat0", "Orientation in the initial configuration (9), row by row.")
    fovy = ParameterLine("cam_fovy", "Vertical field of view, degrees; for an orthographic camera, the height of the image, m.")
    sensorsize = ParameterLine("cam_sensorsize", "Size of the sensor (2), width and height, m.")
    intrinsic = ParameterLine("cam_intrinsic", "Focal length and principal point (4).")


class TendonView(ElementView):
    """A tendon; see `ElementView`."""

    __slots__ = ()
    _kind = "tendon"

    length = OutputLine("ten_length", "Length, m, or sum of joint positions.")
    velocity = OutputLine("ten_velocity", "Its rate of change.")
    stiffness = ParameterLine("tendon_stiffness", "Spring stiffness, N/m.")
    stiffnesspoly = ParameterLine("tendon_stiffnesspoly", "Coefficients of the spring's quadratic and cubic force (2).")
    damping = ParameterLine("tendon_damping", "Damping, N s/m.")
    dampingpoly = ParameterLine("tendon_dampingpoly", "Coefficients of quadratic and cubic damping (2).")
    armature = ParameterLine("tendon_armature", "Inertia of length changes, kg.")
    lengthspring = ParameterLine("tendon_lengthspring", "Dead band of the spring (2), m.")
    springyield = ParameterLine("tendon_springyield", "Elongation at which the spring yields, m; 0 if it never yields.")
    length0 = ParameterLine("tendon_length0", "Length at qpos0, m.")
    invweight0 = ParameterLine("tendon_invweight0", "Inverse inertia at qpos0.")
    range = ParameterLine("tendon_range", "Allowed lengths (2), m.")
    margin = ParameterLine("tendon_margin", "Distance at which the limit becomes active, m.")
    actfrcrange = ParameterLine("tendon_actfrcrange", "Limits of the total actuator force (2), N.")
    frictionloss = ParameterLine("tendon_frictionloss", "Dry friction, N.")
    solref_lim = ParameterLine("tendon_solref_lim", "Reference dynamics of the limit (2).")
    solimp_lim = ParameterLine("tendon_solimp_lim", "Impedance of the limit (5).")
    solref_fri = ParameterLine("tendon_solref_fri", "Reference dynamics of dry friction (2).")
    solimp_fri = ParameterLine("tendon_solimp_fri", "Impedance of dry friction (5).")


class ActuatorView(ElementView):
    """An actuator; see `ElementView`."""

    __slots__ = ()
    _kind = "actuator"

    ctrl = StateLine("ctrl", "Controls, usually one.", "_controls")
    act = StateLine("act", "Activations, usually none or one.", "_activations")
    length = OutputLine("actuator_length", "Length of its transmission; three of an orientation servo.", "_outputs")
    velocity = OutputLine("actuator_velocity", "Its rate of change.", "_outputs")
    force = OutputLine("actuator_force", "Force, N or N m; three of an orientation servo.", "_outputs")
    gear = ParameterLine("actuator_gear", "Scaling of the force onto the transmission's axes (6).")
    cranklength = ParameterLine("actuator_cranklength", "Length of the rod of a slider-crank, m.")
    dynprm = ParameterLine("actuator_dynprm", "Parameters of the dynamics (10).")
    gainprm = ParameterLine("actuator_gainprm", "Parameters of the gain (10).")
    biasprm = ParameterLine("actuator_biasprm", "Parameters of the bias (10).")
    ctrlrange = ParameterLine("actuator_ctrlrange", "Limits of the controls, one row per control (2).", "_controls")
    forcerange = ParameterLine("actuator_forcerange", "Limits of the force (2).")
    actrange = ParameterLine("actuator_actrange", "Limits of the activation (2).")
    delay = ParameterLine("actuator_delay", "Delay of the controls, s.")
    damping = ParameterLine("actuator_damping", "Damping of the transmission.")
    dampingpoly = ParameterLine("actuator_dampingpoly", "Coefficients of quadratic and cubic damping (2).")
    armature = ParameterLine("actuator_armature", "Inertia of the transmission.")
    acc0 = ParameterLine("actuator_acc0", "Norm of the acceleration caused by a unit force at qpos0.")
    lengthrange = ParameterLine("actuator_lengthrange", "Minimum and maximum length (2).")

    @computed_once
    def _controls(self) -> slice:
        first = int(self.element.ctrladr)
        return slice(first, first + int(self.element.ctrlnum))

    @computed_once
    def _outputs(self) -> int | slice:
        first, count = int(self.element.outadr), int(self.element.outnum)
        return first if count == 1 else slice(first, first + count)

    @computed_once
    def _activations(self) -> slice:
        first = max(int(self.element.actadr), 0)
        return slice(first, first + int(self.element.actnum))


class EqualityView(ElementView):
    """An equality constraint; see `ElementView`."""

    __slots__ = ()
    _kind = "equality"

    active = StateLine("eq_active", "True if the constraint is active.")
    anchor1 = ParameterLine("eq_anchor1", "Anchor in the frame of the first body (3), m.")
    anchor2 = ParameterLine("eq_anchor2", "Anchor in the frame of the second body (3), m.")
    quat1 = ParameterLine("eq_quat1", "Orientation of a weld's frame in the first body (4), w first.")
    quat2 = ParameterLine("eq_quat2", "Orientation of a weld's frame in the second body (4), w first.")
    torquescale = ParameterLine("eq_torquescale", "Length that scales rotations of a weld, m.")
    polycoef = ParameterLine("eq_polycoef", "Coefficients of a joint or tendon equality (5), constant first.")
    solref = ParameterLine("eq_solref", "Reference dynamics (2).")
    solimp = ParameterLine("eq_solimp", "Impedance (5).")


class Parameters:
    """All parameters of a simulation or batch by name, such as ``sim.params.gravity`` or ``batch.params.geom_friction``.

    They are read as read-only copies. Assignments are validated as in `Sim.set_param` and `Batch.randomize`. In a batch
    the environments are the first axis.
    """

    __slots__ = ("_owner",)

    _owner: Sim | Batch

    def __init__(self, owner: Sim | Batch) -> None:
        object.__setattr__(self, "_owner", owner)

    def __reduce__(self) -> tuple[Any, ...]:
        """Returns what a copy or pickle is made of: the owner, which is copied too."""
        return type(self), (self._owner,)

    def __getattr__(self, name: str) -> NDArray[Any]:
        if name.startswith("_"):
            # This also applies before any attribute is set, as in a copy that is being made.
            raise AttributeError(f'there is no parameter "{name}"')
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
        if is_alone(self._owner):
            set_parameter(self._owner, name, values)
        else:
            full = self._owner.param(name)
            full[...] = values
            set_parameter(self._owner, name, full)

    def __dir__(self) -> list[str]:
        from clench._core import PARAMETERS

        return list(PARAMETERS)
