"""Types of the compiled part of :mod:`clench`."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from typing import Any, Final, Literal, Protocol, SupportsFloat, SupportsIndex, TypeAlias, final, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray
from typing_extensions import Self, disjoint_base

from clench._named import (
    ActuatorView,
    BodyView,
    CameraView,
    EqualityView,
    GeomView,
    JointView,
    Parameters,
    SiteView,
    TendonView,
)
from clench._state import State

__all__ = [
    "OUTPUTS",
    "PARAMETERS",
    "Batch",
    "Block",
    "ComTarget",
    "Constraints",
    "Contact",
    "Contacts",
    "Element",
    "FrameTarget",
    "FreeCamera",
    "IkResult",
    "Linearization",
    "Model",
    "PostureTarget",
    "RayHit",
    "RayHits",
    "Recording",
    "RigidOptions",
    "Separation",
    "Sim",
    "Solution",
    "SolverStats",
    "StateViews",
    "Viewer",
    "__version__",
    "devices",
    "render_device",
    "solve",
]

_Precision: TypeAlias = Literal["64", "32"]
_Camera: TypeAlias = str | SupportsIndex | FreeCamera | None
_Cameras: TypeAlias = _Camera | Sequence[_Camera]
_Kind: TypeAlias = Literal[
    "body",
    "joint",
    "geom",
    "site",
    "camera",
    "tendon",
    "actuator",
    "sensor",
    "equality",
    "keyframe",
    "pair",
    "mesh",
    "hfield",
]
_Cost: TypeAlias = Literal["quadratic", "one_sided", "huber", "pyramid", "elliptic"]
_Status: TypeAlias = Literal["unconstrained", "proven", "converged", "no_progress", "iteration_limit", "non_finite", "too_large"]
_Source: TypeAlias = Literal[
    "equality", "dynamic", "friction_dof", "friction_tendon", "limit_joint", "limit_tendon", "contact"
]
_Floats: TypeAlias = NDArray[np.float64]
_Codes: TypeAlias = NDArray[np.int32]
_Flags: TypeAlias = NDArray[np.bool_]

class _Memory(Protocol):  # of an array, or of a tensor
    def __dlpack__(self, *args: Any, **kwargs: Any) -> Any: ...

__version__: str
OUTPUTS: tuple[str, ...]
PARAMETERS: tuple[str, ...]
_STATE_FIELDS: tuple[tuple[str, str, str, str], ...]  # Name, type, shape and description; all except the time.

@final
class Model:
    @staticmethod
    def from_file(
        path: str | PathLike[str],
        *,
        budget: float = 1.0,
        package_path: Sequence[str | PathLike[str]] = (),
        floating: bool = False,
        ignore_unsupported: bool = False,
        max_dynamic_constraints: SupportsIndex = 8,
    ) -> Model: ...
    @staticmethod
    def from_xml(
        text: str,
        *,
        budget: float = 1.0,
        floating: bool = False,
        ignore_unsupported: bool = False,
        assets: Mapping[str, bytes] = {},
        max_dynamic_constraints: SupportsIndex = 8,
    ) -> Model: ...
    @staticmethod
    def _check(text: str, assets: Mapping[str, bytes]) -> None: ...
    @staticmethod
    def _strict_xml(text: str) -> str: ...
    def to_xml(self) -> str: ...
    def integrate_pos(
        self,
        qpos: ArrayLike,  # (nq,) or (k, nq)
        qvel: ArrayLike,  # (nv,) or (k, nv)
        time: float = 1.0,
    ) -> _Floats: ...  # in the shape of qpos
    def differentiate_pos(
        self,
        qpos1: ArrayLike,  # (nq,) or (k, nq)
        qpos2: ArrayLike,  # in the same shape
        time: float = 1.0,
    ) -> _Floats: ...  # (nv,) or (k, nv)
    def __reduce__(self) -> tuple[Any, ...]: ...
    def __copy__(self) -> Model: ...
    def __deepcopy__(self, _memo: Any, /) -> Model: ...
    @property
    def name(self) -> str: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def omitted(self) -> list[str]: ...
    def numeric(self, name: str) -> _Floats: ...
    def text(self, name: str) -> str: ...
    def custom_tuple(self, name: str) -> list[tuple[str, str, float]]: ...
    @property
    def options(self) -> RigidOptions: ...
    @property
    def integrator(self) -> Literal["Euler", "implicitfast", "implicit", "discrete", "RK4"]: ...
    @property
    def nq(self) -> int: ...
    @property
    def nv(self) -> int: ...
    @property
    def nu(self) -> int: ...
    @property
    def nactuator(self) -> int: ...
    @property
    def nout(self) -> int: ...
    @property
    def na(self) -> int: ...
    @property
    def nhistory(self) -> int: ...
    @property
    def nplastic(self) -> int: ...
    @property
    def nbody(self) -> int: ...
    @property
    def njnt(self) -> int: ...
    @property
    def ngeom(self) -> int: ...
    @property
    def nsite(self) -> int: ...
    @property
    def ncam(self) -> int: ...
    @property
    def ntendon(self) -> int: ...
    @property
    def neq(self) -> int: ...
    @property
    def max_dynamic_constraints(self) -> int: ...
    @property
    def nsensor(self) -> int: ...
    @property
    def nsensordata(self) -> int: ...
    @property
    def nkey(self) -> int: ...
    @property
    def nmocap(self) -> int: ...
    @property
    def npair(self) -> int: ...
    @property
    def nmesh(self) -> int: ...
    @property
    def nhfield(self) -> int: ...
    def appearance(self) -> dict[str, NDArray[np.float64]]: ...
    def names(self, kind: _Kind) -> list[str]: ...
    def body(self, which: str | SupportsIndex) -> Element: ...
    def joint(self, which: str | SupportsIndex) -> Element: ...
    def geom(self, which: str | SupportsIndex) -> Element: ...
    def site(self, which: str | SupportsIndex) -> Element: ...
    def camera(self, which: str | SupportsIndex) -> Element: ...
    def tendon(self, which: str | SupportsIndex) -> Element: ...
    def actuator(self, which: str | SupportsIndex) -> Element: ...
    def sensor(self, which: str | SupportsIndex) -> Element: ...
    def equality(self, which: str | SupportsIndex) -> Element: ...
    def keyframe(self, which: str | SupportsIndex) -> Element: ...
    def pair(self, which: str | SupportsIndex) -> Element: ...
    def mesh(self, which: str | SupportsIndex) -> Element: ...
    def hfield(self, which: str | SupportsIndex) -> Element: ...

    # Fields. Arrays cannot be written to; lengths and times are in SI units; quaternions are w, x, y, z.
    timestep: Final[float]  # Seconds a step.
    gravity: Final[_Floats]  # (3,) Acceleration of gravity.
    wind: Final[_Floats]  # (3,) Velocity of the medium.
    magnetic: Final[_Floats]  # (3,) Magnetic field for magnetometers.
    density: Final[float]  # Density of the medium.
    viscosity: Final[float]  # Viscosity of the medium.
    sleep_tolerance: Final[float]  # Speed below which trees fall asleep, m/s.
    override_margin: Final[float]  # Margin of every contact, with the flag override.
    override_solref: Final[_Floats]  # (2,) Reference dynamics of every contact, likewise.
    override_solimp: Final[_Floats]  # (5,) Impedance of every contact, likewise.
    override_friction: Final[_Floats]  # (5,) Friction of every contact, likewise.
    qpos0: Final[_Floats]  # (nq,) Initial position coordinates.
    qpos_spring: Final[_Floats]  # (nq,) Rest positions of springs.

    body_pos: Final[_Floats]  # (nbody, 3) Position in the parent's frame.
    body_quat: Final[_Floats]  # (nbody, 4) Orientation in the parent's frame.
    body_ipos: Final[_Floats]  # (nbody, 3) Centre of mass in the body frame.
    body_iquat: Final[_Floats]  # (nbody, 4) Orientation of the inertial frame in the body frame.
    body_mass: Final[_Floats]  # (nbody,) Mass.
    body_subtreemass: Final[_Floats]  # (nbody,) Mass of the body and all below it.
    body_inertia: Final[_Floats]  # (nbody, 3) Principal moments.
    body_gravcomp: Final[_Floats]  # (nbody,) Share of the weight that is lifted; if none is positive, none counts.
    body_invweight0: Final[_Floats]  # (nbody, 2) Mean inverse inertia at qpos0: of translation, of rotation.
    body_parentid: Final[_Codes]  # (nbody,) The parent; the world is its own.
    body_rootid: Final[_Codes]  # (nbody,) The ancestor below the world.
    body_weldid: Final[_Codes]  # (nbody,) The ancestor that it cannot move against.
    body_mocapid: Final[_Codes]  # (nbody,) Index among mocap bodies, or -1.
    body_jntnum: Final[_Codes]  # (nbody,) Number of joints.
    body_jntadr: Final[_Codes]  # (nbody,) The first of them, or -1.
    body_dofnum: Final[_Codes]  # (nbody,) Number of degrees of freedom.
    body_dofadr: Final[_Codes]  # (nbody,) The first of them, or -1.
    body_geomnum: Final[_Codes]  # (nbody,) Number of geoms.
    body_geomadr: Final[_Codes]  # (nbody,) The first of them, or -1.
    body_user: Final[_Floats]  # (nbody, k) User data.

    jnt_pos: Final[_Floats]  # (njnt, 3) Anchor in the body frame.
    jnt_axis: Final[_Floats]  # (njnt, 3) Unit axis in the body frame.
    jnt_stiffness: Final[_Floats]  # (njnt,) Spring stiffness.
    jnt_stiffnesspoly: Final[_Floats]  # (njnt, 2) Coefficients of the spring's quadratic and cubic force.
    jnt_springyield: Final[_Floats]  # (njnt,) Elongation at which the spring yields.
    jnt_range: Final[_Floats]  # (njnt, 2) Allowed positions.
    jnt_margin: Final[_Floats]  # (njnt,) Distance at which the limit becomes active.
    jnt_actfrcrange: Final[_Floats]  # (njnt, 2) Limits of the total actuator force.
    jnt_solref: Final[_Floats]  # (njnt, 2) Limit reference dynamics.
    jnt_solimp: Final[_Floats]  # (njnt, 5) Limit impedance.
    jnt_type: Final[_Codes]  # (njnt,) 0 free, 1 ball, 2 slide, 3 hinge.
    jnt_bodyid: Final[_Codes]  # (njnt,) The body that it moves.
    jnt_qposadr: Final[_Codes]  # (njnt,) The first of its position coordinates.
    jnt_dofadr: Final[_Codes]  # (njnt,) The first of its degrees of freedom.
    jnt_plasticadr: Final[_Codes]  # (njnt,) Index of the rest position of its plastic spring in the state, or -1.
    jnt_group: Final[_Codes]  # (njnt,) Group.
    jnt_limited: Final[_Flags]  # (njnt,) True if its range is a limit.
    jnt_actfrclimited: Final[_Flags]  # (njnt,) True if the force of its actuators is limited.
    jnt_actgravcomp: Final[_Flags]  # (njnt,) True if gravity compensation counts as actuation.
    jnt_user: Final[_Floats]  # (njnt, k) User data.

    dof_armature: Final[_Floats]  # (nv,) Added inertia.
    dof_length: Final[_Floats]  # (nv,) Length that converts angular to linear velocity for `sleep_tolerance`, m.
    dof_damping: Final[_Floats]  # (nv,) Damping.
    dof_dampingpoly: Final[_Floats]  # (nv, 2) Coefficients of quadratic and cubic damping.
    dof_frictionloss: Final[_Floats]  # (nv,) Dry friction.
    dof_solref: Final[_Floats]  # (nv, 2) Dry-friction reference dynamics.
    dof_solimp: Final[_Floats]  # (nv, 5) Dry-friction impedance.
    dof_invweight0: Final[_Floats]  # (nv,) Mean inverse inertia at qpos0.
    dof_bodyid: Final[_Codes]  # (nv,) The body that it moves.
    dof_jntid: Final[_Codes]  # (nv,) The joint that it belongs to.
    dof_parentid: Final[_Codes]  # (nv,) The one before it on the way to the root, or -1.

    geom_pos: Final[_Floats]  # (ngeom, 3) Position in the body frame.
    geom_quat: Final[_Floats]  # (ngeom, 4) Orientation in the body frame.
    geom_size: Final[_Floats]  # (ngeom, 3) Sizes.
    geom_rbound: Final[_Floats]  # (ngeom,) Radius of the bounding sphere; 0 for planes.
    geom_friction: Final[_Floats]  # (ngeom, 3) Slide, spin and roll friction.
    geom_margin: Final[_Floats]  # (ngeom,) Margin.
    geom_gap: Final[_Floats]  # (ngeom,) Gap.
    geom_surfacevel: Final[_Floats]  # (ngeom, 6) Velocity of the surface in the geom's frame: linear, angular.
    geom_adhesion: Final[_Floats]  # (ngeom,) Adhesive force of contacts.
    geom_fluidcoef: Final[_Floats]  # (ngeom, 5) Coefficients of blunt, slender and angular drag, Kutta and Magnus lift.
    geom_virtualmass: Final[_Floats]  # (ngeom, 3) Volume of the medium that moves with the geom along each axis.
    geom_virtualinertia: Final[_Floats]  # (ngeom, 3) Inertia of the medium that turns with the geom, at unit density.
    geom_solmix: Final[_Floats]  # (ngeom,) Weight in mixing.
    geom_solref: Final[_Floats]  # (ngeom, 2) Reference dynamics.
    geom_solimp: Final[_Floats]  # (ngeom, 5) Impedance.
    geom_type: Final[_Codes]  # (ngeom,) 0 plane, 1 hfield, 2 sphere, 3 capsule, 4 ellipsoid, 5 cylinder, 6 box, 7 mesh.
    geom_dataid: Final[_Codes]  # (ngeom,) Its mesh or height field, or -1.
    geom_bodyid: Final[_Codes]  # (ngeom,) The body that carries it.
    geom_contype: Final[_Codes]  # (ngeom,) Bits of its contact type.
    geom_conaffinity: Final[_Codes]  # (ngeom,) Bits of the types that it collides with.
    geom_condim: Final[_Codes]  # (ngeom,) Dimensions of its contacts.
    geom_priority: Final[_Codes]  # (ngeom,) Whose parameters win.
    geom_group: Final[_Codes]  # (ngeom,) Group.
    geom_user: Final[_Floats]  # (ngeom, k) User data.

    site_size: Final[_Floats]  # (nsite, 3) Size of the site's volume, as a geom's.
    site_pos: Final[_Floats]  # (nsite, 3) Position in the body frame.
    site_quat: Final[_Floats]  # (nsite, 4) Orientation in the body frame.
    site_bodyid: Final[_Codes]  # (nsite,) The body that carries it.
    site_user: Final[_Floats]  # (nsite, k) User data.
    cam_pos: Final[_Floats]  # (ncam, 3) Position in the body frame.
    cam_quat: Final[_Floats]  # (ncam, 4) Orientation in the body frame.
    cam_pos0: Final[_Floats]  # (ncam, 3) From the body to the camera in the initial configuration, world axes.
    cam_poscom0: Final[_Floats]  # (ncam, 3) From the centre of mass of the body and all below it to the camera, likewise.
    cam_mat0: Final[_Floats]  # (ncam, 9) Orientation in the initial configuration, row by row.
    cam_fovy: Final[_Floats]  # (ncam,) Vertical field of view, degrees; for orthographic cameras, the picture's height.
    cam_sensorsize: Final[_Floats]  # (ncam, 2) Size of the sensor, width and height; both zero: cam_fovy counts.
    cam_intrinsic: Final[_Floats]  # (ncam, 4) Focal length and principal point, two numbers each.
    cam_bodyid: Final[_Codes]  # (ncam,) The body that carries it.
    cam_resolution: Final[_Codes]  # (ncam, 2) Pixels: width, height.
    cam_user: Final[_Floats]  # (ncam, k) User data.

    wrap_coef: Final[_Floats]  # (nwrap,) Parameters of tendon paths: coefficients of joints, divisors of pulleys, else 0.
    wrap_type: Final[_Codes]  # (nwrap,) 1 joint, 2 pulley, 3 site, 4 sphere, 5 cylinder.
    wrap_objid: Final[_Codes]  # (nwrap,) The joint, site or geom; -1 for pulleys.
    wrap_sideid: Final[_Codes]  # (nwrap,) The side site of a geom, or -1.

    tendon_stiffness: Final[_Floats]  # (ntendon,) Spring stiffness.
    tendon_stiffnesspoly: Final[_Floats]  # (ntendon, 2) Coefficients of the spring's quadratic and cubic force.
    tendon_damping: Final[_Floats]  # (ntendon,) Damping.
    tendon_dampingpoly: Final[_Floats]  # (ntendon, 2) Coefficients of quadratic and cubic damping.
    tendon_armature: Final[_Floats]  # (ntendon,) Inertia of changes of the length.
    tendon_lengthspring: Final[_Floats]  # (ntendon, 2) Dead band of the spring.
    tendon_springyield: Final[_Floats]  # (ntendon,) Elongation at which the spring yields.
    tendon_length0: Final[_Floats]  # (ntendon,) Length at qpos0.
    tendon_invweight0: Final[_Floats]  # (ntendon,) Inverse inertia at qpos0.
    tendon_range: Final[_Floats]  # (ntendon, 2) Allowed lengths.
    tendon_margin: Final[_Floats]  # (ntendon,) Distance at which the limit becomes active.
    tendon_actfrcrange: Final[_Floats]  # (ntendon, 2) Limits of the total actuator force.
    tendon_frictionloss: Final[_Floats]  # (ntendon,) Dry friction.
    tendon_solref_lim: Final[_Floats]  # (ntendon, 2) Limit reference dynamics.
    tendon_solimp_lim: Final[_Floats]  # (ntendon, 5) Limit impedance.
    tendon_solref_fri: Final[_Floats]  # (ntendon, 2) Dry-friction reference dynamics.
    tendon_solimp_fri: Final[_Floats]  # (ntendon, 5) Dry-friction impedance.
    tendon_type: Final[_Codes]  # (ntendon,) 0 fixed, 1 spatial.
    tendon_user: Final[_Floats]  # (ntendon, k) User data.
    tendon_num: Final[_Codes]  # (ntendon,) Number of elements of its path.
    tendon_adr: Final[_Codes]  # (ntendon,) The first element of its path, or -1.
    tendon_plasticadr: Final[_Codes]  # (ntendon,) Index of the rest length of its plastic spring in the state, or -1.
    tendon_limited: Final[_Flags]  # (ntendon,) True if its range is a limit.
    tendon_actfrclimited: Final[_Flags]  # (ntendon,) True if the force of its actuators is limited.

    actuator_gear: Final[_Floats]  # (nactuator, 6) Scaling of the force onto the transmission's axes.
    actuator_cranklength: Final[_Floats]  # (nactuator,) Length of the rod of a slider-crank, or 0.
    actuator_dynprm: Final[_Floats]  # (nactuator, 10) Parameters of the dynamics.
    actuator_gainprm: Final[_Floats]  # (nactuator, 10) Parameters of the gain.
    actuator_biasprm: Final[_Floats]  # (nactuator, 10) Parameters of the bias.
    actuator_ctrlrange: Final[_Floats]  # (nu, 2) Allowed controls.
    actuator_forcerange: Final[_Floats]  # (nactuator, 2) Allowed forces.
    actuator_actrange: Final[_Floats]  # (nactuator, 2) Allowed activations.
    actuator_delay: Final[_Floats]  # (nactuator,) Delay of controls, s; only for actuators that store past ones.
    actuator_damping: Final[_Floats]  # (nactuator,) Damping that the target gets, times the square of the gear.
    actuator_dampingpoly: Final[_Floats]  # (nactuator, 2) Coefficients of its quadratic and cubic damping, likewise.
    actuator_armature: Final[_Floats]  # (nactuator,) Inertia that the target gets, likewise.
    actuator_acc0: Final[_Floats]  # (nactuator,) Norm of the acceleration that a unit force causes at qpos0.
    actuator_lengthrange: Final[_Floats]  # (nactuator, 2) Range of transmission lengths, for muscles.
    actuator_trntype: Final[_Codes]  # (nactuator,) 0 joint, 1 in the parent's frame, 2 slider-crank, 3 tendon, 4 site, 5 body.
    actuator_trnid: Final[_Codes]  # (nactuator, 2) Target of the transmission; the slider or reference site, or -1.
    actuator_dyntype: Final[_Codes]  # (nactuator,) 0 none, 1 integrator, 2 filter, 3 filterexact, 4 muscle, 5 dcmotor, 6 pid, 7 user.
    actuator_gaintype: Final[_Codes]  # (nactuator,) 0 fixed, 1 affine, 2 muscle, 3 dcmotor, 4 so3, 5 pid, 6 user.
    actuator_biastype: Final[_Codes]  # (nactuator,) 0 none, 1 affine, 2 muscle, 3 dcmotor, 4 so3, 5 user.
    actuator_actadr: Final[_Codes]  # (nactuator,) The first of its activations, or -1.
    actuator_actnum: Final[_Codes]  # (nactuator,) Number of activations; the last one has the effect.
    actuator_ctrladr: Final[_Codes]  # (nactuator,) The first of its controls, or -1.
    actuator_ctrlnum: Final[_Codes]  # (nactuator,) Number of controls: one, except for controllers and motors.
    actuator_outadr: Final[_Codes]  # (nactuator,) The first of its lengths, velocities and forces.
    actuator_outnum: Final[_Codes]  # (nactuator,) Number of forces: one, but three for an orientation servo.
    actuator_group: Final[_Codes]  # (nactuator,) Group.
    actuator_ctrllimited: Final[_Flags]  # (nu,) True if its control is clamped.
    actuator_forcelimited: Final[_Flags]  # (nactuator,) True if its force is clamped.
    actuator_actlimited: Final[_Flags]  # (nactuator,) True if its activation is clamped.
    actuator_actearly: Final[_Flags]  # (nactuator,) True if the activation at the end of the step is used.
    actuator_user: Final[_Floats]  # (nactuator, k) User data.

    sensor_adr: Final[_Codes]  # (nsensor,) The first of its numbers in sensordata.
    sensor_dim: Final[_Codes]  # (nsensor,) Number of values.
    sensor_cutoff: Final[_Floats]  # (nsensor,) Limit of its values, if positive.
    sensor_delay: Final[_Floats]  # (nsensor,) Delay of its values, s; only if it stores past values.
    sensor_interval: Final[_Floats]  # (nsensor,) Sampling interval, s; zero: every step. (MuJoCo stores the phase with it.)
    sensor_noise: Final[_Floats]  # (nsensor,) Standard deviation of the noise that is expected; none is added.
    sensor_phase: Final[_Floats]  # (nsensor,) Time of the last sample before time zero, s; zero: one period before.
    sensor_user: Final[_Floats]  # (nsensor, k) User data.

    eq_anchor1: Final[_Floats]  # (neq, 3) Anchor or weld point in the first body's frame.
    eq_anchor2: Final[_Floats]  # (neq, 3) Anchor or weld point in the second body's frame.
    eq_quat1: Final[_Floats]  # (neq, 4) Weld frame in the first body.
    eq_quat2: Final[_Floats]  # (neq, 4) Weld frame in the second body.
    eq_torquescale: Final[_Floats]  # (neq,) Weld: length that scales rotations.
    eq_polycoef: Final[_Floats]  # (neq, 5) Coefficients, constant first.
    eq_solref: Final[_Floats]  # (neq, 2) Reference dynamics.
    eq_solimp: Final[_Floats]  # (neq, 5) Impedance.
    eq_type: Final[_Codes]  # (neq,) 0 connect, 1 weld, 2 joint, 3 tendon.
    eq_obj1id: Final[_Codes]  # (neq,) The first body, joint or tendon; of a site, its body.
    eq_obj2id: Final[_Codes]  # (neq,) The second, or -1.
    eq_active0: Final[_Flags]  # (neq,) True if it is initially active.

    pair_friction: Final[_Floats]  # (npair, 5) Friction of a pair: two slides, spin, two rolls.
    pair_solref: Final[_Floats]  # (npair, 2) Reference dynamics.
    pair_solreffriction: Final[_Floats]  # (npair, 2) Likewise of friction; zeros: as pair_solref.
    pair_solimp: Final[_Floats]  # (npair, 5) Impedance.
    pair_margin: Final[_Floats]  # (npair,) Margin.
    pair_gap: Final[_Floats]  # (npair,) Gap.
    pair_adhesion: Final[_Floats]  # (npair,) Adhesive force of contacts.
    pair_dim: Final[_Codes]  # (npair,) Dimensions of the contact.
    pair_geom1: Final[_Codes]  # (npair,) The geom whose type has the smaller code.
    pair_geom2: Final[_Codes]  # (npair,) The other.

    mesh_pos: Final[_Floats]  # (nmesh, 3) Its centre of mass in the coordinates of its file.
    mesh_quat: Final[_Floats]  # (nmesh, 4) Its principal axes there.
    mesh_vertadr: Final[_Codes]  # (nmesh,) The first of its vertices.
    mesh_vertnum: Final[_Codes]  # (nmesh,) Number of vertices.
    mesh_faceadr: Final[_Codes]  # (nmesh,) The first of its triangles.
    mesh_facenum: Final[_Codes]  # (nmesh,) Number of triangles.
    mesh_vert: Final[_Floats]  # (nmeshvert, 3) Vertices of all meshes, about the centres of mass, along the principal axes.
    mesh_face: Final[_Codes]  # (nmeshface, 3) Corners of all triangles, counted from the first vertex of each mesh.

    hfield_size: Final[_Floats]  # (nhfield, 4) Half lengths along x and y, elevation, depth of the base.
    hfield_nrow: Final[_Codes]  # (nhfield,) Number of rows, along y.
    hfield_ncol: Final[_Codes]  # (nhfield,) Number of columns, along x.
    hfield_adr: Final[_Codes]  # (nhfield,) The first of its heights.
    hfield_data: Final[_Floats]  # (nhfielddata,) Heights of all, as parts of the elevation.

    key_time: Final[_Floats]  # (nkey,) Time, s.
    key_qpos: Final[_Floats]  # (nkey, nq) Position coordinates.
    key_qvel: Final[_Floats]  # (nkey, nv) Velocities.
    key_act: Final[_Floats]  # (nkey, na) Activations.
    key_plastic: Final[_Floats]  # (nkey, nplastic) Rest positions of plastic springs.
    key_ctrl: Final[_Floats]  # (nkey, nu) Controls.
    key_mpos: Final[_Floats]  # (nkey, nmocap, 3) Positions of mocap bodies.
    key_mquat: Final[_Floats]  # (nkey, nmocap, 4) Orientations of mocap bodies.

@final
class Element:
    @property
    def kind(self) -> _Kind: ...
    @property
    def id(self) -> int: ...
    @property
    def name(self) -> str: ...

    # Fields of the model, less the kind, in this element's row: its shape, and the kinds that have it.
    acc0: Final[float]  # actuator
    act: Final[_Floats]  # (na,) keyframe
    actadr: Final[int]  # actuator
    actearly: Final[bool]  # actuator
    actfrclimited: Final[bool]  # joint, tendon
    actfrcrange: Final[_Floats]  # (2,) joint, tendon
    actgravcomp: Final[bool]  # joint
    active0: Final[bool]  # equality
    actlimited: Final[bool]  # actuator
    actnum: Final[int]  # actuator
    actrange: Final[_Floats]  # (2,) actuator
    adhesion: Final[float]  # geom, pair
    adr: Final[int]  # tendon, sensor, hfield
    anchor1: Final[_Floats]  # (3,) equality
    anchor2: Final[_Floats]  # (3,) equality
    armature: Final[float]  # tendon, actuator
    axis: Final[_Floats]  # (3,) joint
    biasprm: Final[_Floats]  # (10,) actuator
    biastype: Final[int]  # actuator
    bodyid: Final[int]  # joint, geom, site, camera
    conaffinity: Final[int]  # geom
    condim: Final[int]  # geom
    contype: Final[int]  # geom
    cranklength: Final[float]  # actuator
    ctrl: Final[_Floats]  # (nu,) keyframe
    ctrladr: Final[int]  # actuator
    ctrllimited: Final[bool]  # actuator
    ctrlnum: Final[int]  # actuator
    outadr: Final[int]  # actuator
    outnum: Final[int]  # actuator
    plastic: Final[_Floats]  # (nplastic,) keyframe
    plasticadr: Final[int]  # joint, tendon
    springyield: Final[float]  # joint, tendon
    ctrlrange: Final[_Floats]  # (2,) actuator
    cutoff: Final[float]  # sensor
    damping: Final[float]  # tendon
    dampingpoly: Final[_Floats]  # (2,) tendon, actuator
    data: Final[_Floats]  # (nrow, ncol) hfield
    dataid: Final[int]  # geom
    delay: Final[float]  # actuator, sensor
    dim: Final[int]  # sensor, pair
    dofadr: Final[int]  # body, joint
    dofnum: Final[int]  # body
    dynprm: Final[_Floats]  # (10,) actuator
    dyntype: Final[int]  # actuator
    face: Final[_Codes]  # (facenum, 3) mesh
    faceadr: Final[int]  # mesh
    facenum: Final[int]  # mesh
    fluidcoef: Final[_Floats]  # (5,) geom
    forcelimited: Final[bool]  # actuator
    forcerange: Final[_Floats]  # (2,) actuator
    fovy: Final[float]  # camera
    friction: Final[_Floats]  # geom, pair
    frictionloss: Final[float]  # tendon
    gainprm: Final[_Floats]  # (10,) actuator
    gaintype: Final[int]  # actuator
    gap: Final[float]  # geom, pair
    gear: Final[_Floats]  # (6,) actuator
    geom1: Final[int]  # pair
    geom2: Final[int]  # pair
    geomadr: Final[int]  # body
    geomnum: Final[int]  # body
    gravcomp: Final[float]  # body
    group: Final[int]  # joint, geom, actuator
    inertia: Final[_Floats]  # (3,) body
    interval: Final[float]  # sensor
    intrinsic: Final[_Floats]  # (4,) camera
    invweight0: Final[Any]  # body, tendon
    ipos: Final[_Floats]  # (3,) body
    iquat: Final[_Floats]  # (4,) body
    jntadr: Final[int]  # body
    jntnum: Final[int]  # body
    length0: Final[float]  # tendon
    lengthrange: Final[_Floats]  # (2,) actuator
    lengthspring: Final[_Floats]  # (2,) tendon
    limited: Final[bool]  # joint, tendon
    margin: Final[float]  # joint, geom, tendon, pair
    mass: Final[float]  # body
    mat0: Final[_Floats]  # (9,) camera
    mocapid: Final[int]  # body
    mpos: Final[_Floats]  # (nmocap, 3) keyframe
    mquat: Final[_Floats]  # (nmocap, 4) keyframe
    ncol: Final[int]  # hfield
    noise: Final[float]  # sensor
    nrow: Final[int]  # hfield
    num: Final[int]  # tendon
    obj1id: Final[int]  # equality
    obj2id: Final[int]  # equality
    parentid: Final[int]  # body
    phase: Final[float]  # sensor
    polycoef: Final[_Floats]  # (5,) equality
    pos: Final[_Floats]  # (3,) body, joint, geom, site, camera, mesh
    pos0: Final[_Floats]  # (3,) camera
    poscom0: Final[_Floats]  # (3,) camera
    priority: Final[int]  # geom
    qpos: Final[_Floats]  # (nq,) keyframe
    qposadr: Final[int]  # joint
    quat: Final[_Floats]  # (4,) body, geom, site, camera, mesh
    quat1: Final[_Floats]  # (4,) equality
    quat2: Final[_Floats]  # (4,) equality
    qvel: Final[_Floats]  # (nv,) keyframe
    range: Final[_Floats]  # (2,) joint, tendon
    rbound: Final[float]  # geom
    resolution: Final[_Codes]  # (2,) camera
    rootid: Final[int]  # body
    sensorsize: Final[_Floats]  # (2,) camera
    size: Final[_Floats]  # (3,) geom, site, (4,) hfield
    solimp: Final[_Floats]  # (5,) joint, geom, equality, pair
    solimp_fri: Final[_Floats]  # (5,) tendon
    solimp_lim: Final[_Floats]  # (5,) tendon
    solmix: Final[float]  # geom
    solref: Final[_Floats]  # (2,) joint, geom, equality, pair
    solref_fri: Final[_Floats]  # (2,) tendon
    solref_lim: Final[_Floats]  # (2,) tendon
    solreffriction: Final[_Floats]  # (2,) pair
    stiffness: Final[float]  # joint, tendon
    stiffnesspoly: Final[_Floats]  # (2,) joint
    subtreemass: Final[float]  # body
    surfacevel: Final[_Floats]  # (6,) geom
    time: Final[float]  # keyframe
    torquescale: Final[float]  # equality
    trnid: Final[_Codes]  # (2,) actuator
    trntype: Final[int]  # actuator
    type: Final[int]  # joint, geom, equality
    user: Final[_Floats]  # (k,) body, joint, geom, site, camera, tendon, actuator, sensor
    vert: Final[_Floats]  # (vertnum, 3) mesh
    vertadr: Final[int]  # mesh
    vertnum: Final[int]  # mesh
    virtualinertia: Final[_Floats]  # (3,) geom
    virtualmass: Final[_Floats]  # (3,) geom
    weldid: Final[int]  # body
    # Of a joint: rows of its degrees of freedom, and its position coordinates.
    dof_armature: Final[_Floats]  # (nv,)
    dof_damping: Final[_Floats]  # (nv,)
    dof_dampingpoly: Final[_Floats]  # (nv, 2)
    dof_frictionloss: Final[_Floats]  # (nv,)
    dof_length: Final[_Floats]  # (nv,)
    dof_solref: Final[_Floats]  # (nv, 2)
    dof_solimp: Final[_Floats]  # (nv, 5)
    dof_invweight0: Final[_Floats]  # (nv,)
    dof_bodyid: Final[_Codes]  # (nv,)
    dof_jntid: Final[_Codes]  # (nv,)
    dof_parentid: Final[_Codes]  # (nv,)
    qpos0: Final[_Floats]  # (nq,)
    qpos_spring: Final[_Floats]  # (nq,)

@final
class RigidOptions:
    def __new__(
        cls,
        *,
        # <arguments of options> Written by `cargo xtask stubs`.
        constraint_solver: Literal["Newton", "CG"] | None = None,
        iterations: SupportsIndex | None = None,
        tolerance: SupportsFloat | None = None,
        ls_iterations: SupportsIndex | None = None,
        ls_tolerance: SupportsFloat | None = None,
        sparse_solve: bool | np.bool_ | Literal["auto"] | None = None,
        noslip_iterations: SupportsIndex | None = None,
        noslip_tolerance: SupportsFloat | None = None,
        islands: bool | np.bool_ | Literal["auto"] | None = None,
        warmstart: bool | np.bool_ | None = None,
        constraint_timeconst: SupportsFloat | None = None,
        enable_joint_limit: bool | np.bool_ | None = None,
        disable_constraint: bool | np.bool_ | None = None,
        max_contacts: SupportsIndex | Literal["auto"] | None = None,
        friction_cone: Literal["pyramidal", "elliptic"] | None = None,
        contact_model: Literal["convex", "coulomb"] | None = None,
        stiction: bool | np.bool_ | None = None,
        max_stick_pairs: SupportsIndex | None = None,
        impratio: SupportsFloat | None = None,
        ccd_iterations: SupportsIndex | None = None,
        ccd_tolerance: SupportsFloat | None = None,
        autoreset: bool | np.bool_ | None = None,
        # </arguments of options>
    ) -> Self: ...
    # <attributes of options> Written by `cargo xtask stubs`.
    @property
    def constraint_solver(self) -> Literal["Newton", "CG"] | None: ...
    @property
    def iterations(self) -> int | None: ...
    @property
    def tolerance(self) -> float | None: ...
    @property
    def ls_iterations(self) -> int | None: ...
    @property
    def ls_tolerance(self) -> float | None: ...
    @property
    def sparse_solve(self) -> bool | Literal["auto"] | None: ...
    @property
    def noslip_iterations(self) -> int | None: ...
    @property
    def noslip_tolerance(self) -> float | None: ...
    @property
    def islands(self) -> bool | Literal["auto"] | None: ...
    @property
    def warmstart(self) -> bool | None: ...
    @property
    def constraint_timeconst(self) -> float | None: ...
    @property
    def enable_joint_limit(self) -> bool | None: ...
    @property
    def disable_constraint(self) -> bool | None: ...
    @property
    def max_contacts(self) -> int | Literal["auto"] | None: ...
    @property
    def friction_cone(self) -> Literal["pyramidal", "elliptic"] | None: ...
    @property
    def contact_model(self) -> Literal["convex", "coulomb"] | None: ...
    @property
    def stiction(self) -> bool | None: ...
    @property
    def max_stick_pairs(self) -> int | None: ...
    @property
    def impratio(self) -> float | None: ...
    @property
    def ccd_iterations(self) -> int | None: ...
    @property
    def ccd_tolerance(self) -> float | None: ...
    @property
    def autoreset(self) -> bool | None: ...
    # </attributes of options>
    def __getnewargs_ex__(self) -> tuple[tuple[()], dict[str, Any]]: ...

@disjoint_base
class StateViews:
    # Numbers are float64, or float32 in a simulation of precision "32" (but for times). In a batch environments are the first axis.
    @property
    def time(self) -> float | _Floats: ...
    @time.setter
    def time(self, values: ArrayLike) -> None: ...
    # <views of the state> Written by `cargo xtask stubs`.
    @property
    def qpos(self) -> NDArray[Any]: ...  # (nq,)
    @qpos.setter
    def qpos(self, values: ArrayLike) -> None: ...
    @property
    def qvel(self) -> NDArray[Any]: ...  # (nv,)
    @qvel.setter
    def qvel(self, values: ArrayLike) -> None: ...
    @property
    def act(self) -> NDArray[Any]: ...  # (na,)
    @act.setter
    def act(self, values: ArrayLike) -> None: ...
    @property
    def plastic(self) -> NDArray[Any]: ...  # (nplastic,)
    @plastic.setter
    def plastic(self, values: ArrayLike) -> None: ...
    @property
    def history(self) -> NDArray[Any]: ...  # (nhistory,)
    @history.setter
    def history(self, values: ArrayLike) -> None: ...
    @property
    def qacc_warmstart(self) -> NDArray[Any]: ...  # (nv,)
    @qacc_warmstart.setter
    def qacc_warmstart(self, values: ArrayLike) -> None: ...
    @property
    def tree_asleep(self) -> NDArray[np.int32]: ...  # (ntree where trees may sleep, else 0,)
    @tree_asleep.setter
    def tree_asleep(self, values: ArrayLike) -> None: ...
    @property
    def pose_asleep(self) -> NDArray[Any]: ...  # (nq + 7 nmocap where trees may sleep, else 0,)
    @pose_asleep.setter
    def pose_asleep(self, values: ArrayLike) -> None: ...
    @property
    def stick_references(self) -> NDArray[Any]: ...  # (max_stick_pairs with the option stiction, else 0, 9)
    @stick_references.setter
    def stick_references(self, values: ArrayLike) -> None: ...
    @property
    def stick_friction(self) -> NDArray[Any]: ...  # (nv + ntendon with the option stiction, else 0,)
    @stick_friction.setter
    def stick_friction(self, values: ArrayLike) -> None: ...
    @property
    def ctrl(self) -> NDArray[Any]: ...  # (nu,)
    @ctrl.setter
    def ctrl(self, values: ArrayLike) -> None: ...
    @property
    def qfrc_applied(self) -> NDArray[Any]: ...  # (nv,)
    @qfrc_applied.setter
    def qfrc_applied(self, values: ArrayLike) -> None: ...
    @property
    def mocap_pos(self) -> NDArray[Any]: ...  # (nmocap, 3)
    @mocap_pos.setter
    def mocap_pos(self, values: ArrayLike) -> None: ...
    @property
    def mocap_quat(self) -> NDArray[Any]: ...  # (nmocap, 4)
    @mocap_quat.setter
    def mocap_quat(self, values: ArrayLike) -> None: ...
    @property
    def eq_active(self) -> _Flags: ...  # (neq,)
    @eq_active.setter
    def eq_active(self, values: ArrayLike) -> None: ...
    @property
    def xfrc_applied(self) -> NDArray[Any]: ...  # (nbody, 6)
    @xfrc_applied.setter
    def xfrc_applied(self, values: ArrayLike) -> None: ...
    @property
    def dynamic_kind(self) -> NDArray[np.int32]: ...  # (max_dynamic_constraints,)
    @dynamic_kind.setter
    def dynamic_kind(self, values: ArrayLike) -> None: ...
    @property
    def dynamic_serial(self) -> NDArray[np.int32]: ...  # (max_dynamic_constraints,)
    @dynamic_serial.setter
    def dynamic_serial(self, values: ArrayLike) -> None: ...
    @property
    def dynamic_body1(self) -> NDArray[np.int32]: ...  # (max_dynamic_constraints,)
    @dynamic_body1.setter
    def dynamic_body1(self, values: ArrayLike) -> None: ...
    @property
    def dynamic_body2(self) -> NDArray[np.int32]: ...  # (max_dynamic_constraints,)
    @dynamic_body2.setter
    def dynamic_body2(self, values: ArrayLike) -> None: ...
    @property
    def dynamic_anchor1(self) -> NDArray[Any]: ...  # (max_dynamic_constraints, 3)
    @dynamic_anchor1.setter
    def dynamic_anchor1(self, values: ArrayLike) -> None: ...
    @property
    def dynamic_anchor2(self) -> NDArray[Any]: ...  # (max_dynamic_constraints, 3)
    @dynamic_anchor2.setter
    def dynamic_anchor2(self, values: ArrayLike) -> None: ...
    @property
    def dynamic_quat(self) -> NDArray[Any]: ...  # (max_dynamic_constraints, 4)
    @dynamic_quat.setter
    def dynamic_quat(self, values: ArrayLike) -> None: ...
    # </views of the state>

@dataclass(kw_only=True, eq=False, repr=False)
class _StateArrays:
    time: NDArray[Any]
    # <arrays of a state> Written by `cargo xtask stubs`.
    qpos: NDArray[Any]
    qvel: NDArray[Any]
    act: NDArray[Any]
    plastic: NDArray[Any]
    history: NDArray[Any]
    qacc_warmstart: NDArray[Any]
    tree_asleep: NDArray[np.int32]
    pose_asleep: NDArray[Any]
    stick_references: NDArray[Any]
    stick_friction: NDArray[Any]
    ctrl: NDArray[Any]
    qfrc_applied: NDArray[Any]
    mocap_pos: NDArray[Any]
    mocap_quat: NDArray[Any]
    eq_active: _Flags
    xfrc_applied: NDArray[Any]
    dynamic_kind: NDArray[np.int32]
    dynamic_serial: NDArray[np.int32]
    dynamic_body1: NDArray[np.int32]
    dynamic_body2: NDArray[np.int32]
    dynamic_anchor1: NDArray[Any]
    dynamic_anchor2: NDArray[Any]
    dynamic_quat: NDArray[Any]
    # </arrays of a state>

class _Outputs(StateViews):
    # Outputs of the last step or forward: copies for a simulation; for a batch, views of the recorded ones, with the
    # environments as first axis. All are read-only.
    qacc: Final[NDArray[Any]]  # (nv,) Accelerations.
    xpos: Final[NDArray[Any]]  # (nbody, 3) Positions of bodies.
    xquat: Final[NDArray[Any]]  # (nbody, 4) Orientations of bodies.
    xmat: Final[NDArray[Any]]  # (nbody, 9) The same as matrices, row by row.
    xipos: Final[NDArray[Any]]  # (nbody, 3) Centres of mass of bodies.
    ximat: Final[NDArray[Any]]  # (nbody, 9) Orientations of inertial frames.
    xanchor: Final[NDArray[Any]]  # (njnt, 3) Joint anchors.
    xaxis: Final[NDArray[Any]]  # (njnt, 3) Joint axes.
    geom_xpos: Final[NDArray[Any]]  # (ngeom, 3) Positions of geoms.
    geom_xmat: Final[NDArray[Any]]  # (ngeom, 9) Orientations of geoms.
    site_xpos: Final[NDArray[Any]]  # (nsite, 3) Positions of sites.
    site_xmat: Final[NDArray[Any]]  # (nsite, 9) Orientations of sites.
    site_jacp: Final[NDArray[Any]]  # (nsite, 3, nv) Jacobians of the positions of sites.
    site_jacr: Final[NDArray[Any]]  # (nsite, 3, nv) Jacobians of their orientations.
    cam_xpos: Final[NDArray[Any]]  # (ncam, 3) Positions of cameras.
    cam_xmat: Final[NDArray[Any]]  # (ncam, 9) Orientations of cameras, x to the right, y up, z backwards.
    subtree_com: Final[NDArray[Any]]  # (nbody, 3) Centre of mass of each body and all below it.
    cinert: Final[NDArray[Any]]  # (nbody, 10) Inertias about the centre of mass of the tree.
    cvel: Final[NDArray[Any]]  # (nbody, 6) Velocities there, angular first.
    cdof: Final[NDArray[Any]]  # (nv, 6) Motion of each dof at unit velocity, likewise.
    ten_J: Final[NDArray[Any]]  # (ntendon, nv) Moment arms of tendons.
    ten_length: Final[NDArray[Any]]  # (ntendon,) Lengths of tendons.
    ten_velocity: Final[NDArray[Any]]  # (ntendon,) Velocities of tendons.
    actuator_length: Final[NDArray[Any]]  # (nout,) Lengths of actuators: one, but three of an orientation servo.
    actuator_moment: Final[NDArray[Any]]  # (nout, nv) Moment arms of actuators.
    actuator_velocity: Final[NDArray[Any]]  # (nout,) Velocities of actuators.
    actuator_force: Final[NDArray[Any]]  # (nout,) Forces of actuators.
    qfrc_actuator: Final[NDArray[Any]]  # (nv,) The same along dofs.
    qfrc_passive: Final[NDArray[Any]]  # (nv,) Springs, dampers, gravity compensation, fluid.
    qfrc_bias: Final[NDArray[Any]]  # (nv,) Coriolis, centrifugal and gravitational forces.
    qfrc_smooth: Final[NDArray[Any]]  # (nv,) All forces but those of constraints.
    qfrc_constraint: Final[NDArray[Any]]  # (nv,) Constraint forces.
    cfrc_ext: Final[NDArray[Any]]  # (nbody, 6) External force about the centre of mass of the tree, torque first.
    cfrc_int: Final[NDArray[Any]]  # (nbody, 6) Force of each body's joints about the centre of mass of the tree, torque first.
    cacc: Final[NDArray[Any]]  # (nbody, 6) Accelerations there with gravity's upward reaction, angular first.
    contact_force: Final[NDArray[Any]]  # (nbody, 6) Contacts, at the body's centre of mass, force first.
    sensordata: Final[NDArray[Any]]  # (nsensordata,) Sensor values.
    energy: Final[NDArray[Any]]  # (2,) Potential and kinetic energy of the state.

    # Views of elements.
    def body(self, which: str | SupportsIndex) -> BodyView: ...
    def joint(self, which: str | SupportsIndex) -> JointView: ...
    def geom(self, which: str | SupportsIndex) -> GeomView: ...
    def site(self, which: str | SupportsIndex) -> SiteView: ...
    def camera(self, which: str | SupportsIndex) -> CameraView: ...
    def tendon(self, which: str | SupportsIndex) -> TendonView: ...
    def actuator(self, which: str | SupportsIndex) -> ActuatorView: ...
    def equality(self, which: str | SupportsIndex) -> EqualityView: ...
    @property
    def params(self) -> Parameters: ...

class _Shared(_Outputs):
    # The calls of both `Sim` and `Batch`. Shapes are those of a simulation; in a batch the environments are the first
    # axis of results. Arguments are the same for all of its environments, or have that axis too; those of `jvp`, `vjp`
    # and `rollout_vjp` always have it (the second axis of one with T rows).
    @property
    def model(self) -> Model: ...
    @property
    def options(self) -> RigidOptions: ...
    @options.setter
    def options(self, options: RigidOptions) -> None: ...
    @property
    def precision(self) -> _Precision: ...
    @property
    def state(self) -> State: ...
    @state.setter
    def state(self, state: State) -> None: ...
    def param(self, field: str) -> NDArray[Any]: ...  # as in the model
    def _restore_param(self, field: str, values: NDArray[Any]) -> None: ...
    def sensor(self, which: str | SupportsIndex) -> NDArray[Any]: ...  # (sensor_dim,)
    def linearize(
        self,
        outputs: Sequence[str] = (),
        parameters: Sequence[str] | Mapping[str, Sequence[int]] | None = None,
        *,
        memory: bool | np.bool_ = False,
        sensors: bool | np.bool_ = True,
        errors: bool | np.bool_ = False,
    ) -> Linearization: ...
    def jvp(
        self,
        x: ArrayLike | None = None,  # (2 nv + na,) or (2 nv + na, k)
        u: ArrayLike | None = None,  # (nu,) or (nu, k)
        parameters: Mapping[str, ArrayLike] | None = None,  # (numbers,) or (numbers, k)
        outputs: Sequence[str] = (),
    ) -> tuple[_Floats, _Floats]: ...  # (2 nv + na,) and (nsensordata + outputs,), or with k columns
    def vjp(
        self,
        x: ArrayLike | None = None,  # (2 nv + na,)
        y: ArrayLike | None = None,  # (nsensordata + outputs,)
        parameters: Sequence[str] | Mapping[str, Sequence[int]] | None = None,
        outputs: Sequence[str] = (),
        *,
        memory: bool | np.bool_ = False,
    ) -> tuple[_Floats, _Floats, dict[str, _Floats]]: ...  # (2 nv + na,), (nu,) and (numbers,)
    def rollout_vjp(
        self,
        ctrl: ArrayLike,  # (T, nu)
        x: ArrayLike,  # (T, 2 nv + na)
        *,
        memory: bool | np.bool_ = False,
    ) -> tuple[_Floats, _Floats]: ...  # (2 nv + na,) and (T, nu)
    def mass_matrix(self) -> _Floats: ...  # (nv, nv)
    def velocity(
        self,
        *,
        body: str | SupportsIndex | None = None,
        body_com: str | SupportsIndex | None = None,
        geom: str | SupportsIndex | None = None,
        site: str | SupportsIndex | None = None,
        camera: str | SupportsIndex | None = None,
        local: bool = False,
    ) -> NDArray[Any]: ...  # (2, 3): linear, angular
    def acceleration(
        self,
        *,
        body: str | SupportsIndex | None = None,
        body_com: str | SupportsIndex | None = None,
        geom: str | SupportsIndex | None = None,
        site: str | SupportsIndex | None = None,
        camera: str | SupportsIndex | None = None,
        local: bool = False,
    ) -> NDArray[Any]: ...  # (2, 3): linear, angular
    def mul_mass(self, x: ArrayLike) -> NDArray[Any]: ...  # (nv,); in a simulation also (k, nv)
    def solve_mass(self, x: ArrayLike) -> NDArray[Any]: ...  # likewise
    def inverse(self, qacc: ArrayLike, *, discrete: bool | None = None) -> NDArray[Any]: ...  # likewise
    def rays(
        self,
        origins: ArrayLike,  # (k, 3) or (1, 3)
        directions: ArrayLike,  # (k, 3) or (1, 3)
        *,
        body: str | SupportsIndex | None = None,
        body_com: str | SupportsIndex | None = None,
        geom: str | SupportsIndex | None = None,
        site: str | SupportsIndex | None = None,
        camera: str | SupportsIndex | None = None,
        groups: ArrayLike | None = None,
        fixed: bool | np.bool_ = True,
        exclude_body: str | SupportsIndex | None = None,
    ) -> RayHits: ...
    def heights(
        self,
        hfield: str | SupportsIndex,
        places: ArrayLike,  # (k, 2)
        *,
        body: str | SupportsIndex | None = None,
        body_com: str | SupportsIndex | None = None,
        geom: str | SupportsIndex | None = None,
        site: str | SupportsIndex | None = None,
        camera: str | SupportsIndex | None = None,
    ) -> NDArray[Any]: ...  # (k,)
    def ik(
        self,
        targets: Iterable[FrameTarget | ComTarget | PostureTarget],
        *,
        start: ArrayLike | None = None,  # (nq,)
        iterations: SupportsIndex = 100,
        tolerance: float = 1e-6,
        damping: float = 1e-3,
        max_step: float | None = None,
        limits: bool = True,
        dofs: ArrayLike | None = None,  # (nv,)
        restarts: SupportsIndex = 0,
    ) -> IkResult: ...

@final
class Sim(_Shared):
    def __new__(
        cls, model: Model, options: RigidOptions | None = None, *, precision: _Precision = "64", threads: SupportsIndex = 1
    ) -> Self: ...
    @property
    def threads(self) -> int: ...
    @threads.setter
    def threads(self, threads: SupportsIndex) -> None: ...
    @property
    def time(self) -> float: ...
    @time.setter
    def time(self, values: ArrayLike) -> None: ...
    def step(self, n: SupportsIndex = 1, control: Callable[[Sim], object] | None = None) -> None: ...
    def step1(self) -> None: ...
    def step2(self) -> None: ...
    def forward(self) -> None: ...
    def reset(self, keyframe: str | SupportsIndex | None = None) -> None: ...
    @property
    def _last_serial(self) -> int: ...
    @_last_serial.setter
    def _last_serial(self, serial: int) -> None: ...
    def add_weld(self, body1: str | SupportsIndex, body2: str | SupportsIndex) -> int: ...
    def add_connect(self, body1: str | SupportsIndex, body2: str | SupportsIndex, anchor: ArrayLike) -> int: ...
    def remove(self, constraint: SupportsIndex) -> None: ...
    @property
    def dynamic_constraints(self) -> list[int]: ...
    def weld_here(self, which: str | SupportsIndex) -> None: ...
    def set_equality(self, which: str | SupportsIndex, active: bool | np.bool_) -> None: ...
    def set_param(self, field: str, values: ArrayLike) -> None: ...
    def set_constants(self) -> None: ...
    def output(self, name: str) -> Any: ...  # an array, or a float if the output is a single number
    @property
    def contacts(self) -> Contacts: ...
    @property
    def constraints(self) -> Constraints: ...
    @property
    def solver_stats(self) -> SolverStats: ...
    @property
    def resets(self) -> int: ...
    @property
    def contact_overflow(self) -> bool: ...
    def render(
        self,
        width: SupportsIndex = 640,
        height: SupportsIndex = 480,
        *,
        camera: _Cameras = None,
        kind: Literal["rgb", "depth", "geom"] = "rgb",
        groups: Sequence[int] | None = None,
        out: _Memory | None = None,
        device: Literal["gpu", "cpu"] | None = None,
        appearance: dict[str, Any] | None = None,
    ) -> NDArray[Any]: ...  # (height, width) or (height, width, 3); (cameras, ...) for a sequence of cameras
    def ray(
        self,
        origin: ArrayLike,  # (3,)
        direction: ArrayLike,  # (3,)
        *,
        groups: ArrayLike | None = None,
        fixed: bool | np.bool_ = True,
        exclude_body: str | SupportsIndex | None = None,
    ) -> RayHit | None: ...
    def distance(
        self,
        geom1: str | SupportsIndex,
        geom2: str | SupportsIndex,
        limit: float | None = None,
    ) -> Separation | None: ...
    def jacobian(
        self,
        *,
        body: str | SupportsIndex | None = None,
        body_com: str | SupportsIndex | None = None,
        geom: str | SupportsIndex | None = None,
        site: str | SupportsIndex | None = None,
        camera: str | SupportsIndex | None = None,
        point: ArrayLike | None = None,  # (3,)
        out: _Memory | None = None,  # (2, 3, nv)
    ) -> NDArray[Any]: ...  # (2, 3, nv): translation, rotation
    def jacobian_rate(
        self,
        *,
        body: str | SupportsIndex | None = None,
        body_com: str | SupportsIndex | None = None,
        geom: str | SupportsIndex | None = None,
        site: str | SupportsIndex | None = None,
        camera: str | SupportsIndex | None = None,
        point: ArrayLike | None = None,  # (3,)
        out: _Memory | None = None,  # (2, 3, nv)
    ) -> NDArray[Any]: ...  # (2, 3, nv): translation, rotation
    def subtree_jacobian(
        self,
        body: str | SupportsIndex,
        *,
        out: _Memory | None = None,  # (3, nv)
    ) -> NDArray[Any]: ...  # (3, nv)
    def joint_forces(
        self,
        body: str | SupportsIndex,
        force: ArrayLike | None = None,  # (3,)
        torque: ArrayLike | None = None,  # (3,)
        point: ArrayLike | None = None,  # (3,)
    ) -> NDArray[Any]: ...  # (nv,)

    actuator_power: Final[float]  # Power input of actuators, W; without those that brake.
    contact_count: Final[float]
    solver_iterations: Final[float]

@final
class Batch(_Shared):
    def __new__(
        cls,
        model: Model | Sequence[Model],
        n_envs: SupportsIndex,
        precision: _Precision | None = None,
        threads: SupportsIndex | None = None,
        *,
        options: RigidOptions | None = None,
        record: Sequence[str] = (),
        device: str = "cpu",  # or "gpu", "gpu:NAME"
        env_model: ArrayLike | None = None,  # (n,)
    ) -> Self: ...
    @property
    def models(self) -> tuple[Model, ...]: ...
    @property
    def env_model(self) -> NDArray[np.int64]: ...  # (n,)
    def geoms_of(self, model: SupportsIndex) -> NDArray[np.int64]: ...  # (ngeom of that model,)
    @property
    def n_envs(self) -> int: ...
    @property
    def device(self) -> str: ...
    @property
    def threads(self) -> int: ...
    @property
    def lanes(self) -> int: ...
    @property
    def bytes_per_env(self) -> int: ...
    @property
    def time(self) -> _Floats: ...  # (n,)
    @time.setter
    def time(self, values: ArrayLike) -> None: ...
    def set_state(self, state: State, envs: ArrayLike | None = None) -> None: ...
    def step(self, n: SupportsIndex = 1) -> int: ...
    def forward(self, mask: ArrayLike | None = None) -> int: ...
    def reset(
        self,
        mask: ArrayLike | None = None,
        keyframe: str | SupportsIndex | None = None,
        *,
        env_model: ArrayLike | None = None,  # one for each environment of the mask
    ) -> None: ...
    def revive(self, mask: ArrayLike | None = None) -> None: ...
    @property
    def status(self) -> NDArray[np.int8]: ...  # (n,), codes of clench.EnvStatus
    @property
    def running(self) -> _Flags: ...  # (n,)
    @property
    def resets(self) -> NDArray[np.int64]: ...  # (n,)
    def fault(self, env: SupportsIndex) -> str | None: ...
    def randomize(
        self, field: str, values: ArrayLike, envs: ArrayLike | None = None, *, consistent: bool | np.bool_ = False
    ) -> None: ...
    def set_constants(self, mask: ArrayLike | None = None) -> None: ...
    def record(self, *names: str) -> None: ...
    @property
    def outputs(self) -> tuple[str, ...]: ...
    def output(self, name: str) -> NDArray[Any]: ...  # (n, ...)
    def rollout(
        self,
        initial: State | ArrayLike | None = None,  # or (n, 1 + nq + nv + na), or one for all: time, qpos, qvel, act
        ctrl: ArrayLike | Callable[[int], ArrayLike | None] | None = None,  # (steps, nu) or (n, steps, nu)
        record: Sequence[str] = ("qpos", "qvel"),
        steps: SupportsIndex | None = None,
        *,
        progress: bool | np.bool_ | Callable[[int, int], object] | None = None,
    ) -> dict[str, NDArray[Any]]: ...  # (n, steps, ...) each
    def contacts(self, env: SupportsIndex) -> Contacts: ...
    def constraints(self, env: SupportsIndex) -> Constraints: ...
    def render(
        self,
        env: ArrayLike | None = None,  # an index, several, or None for all
        width: SupportsIndex = 640,
        height: SupportsIndex = 480,
        *,
        camera: _Cameras = None,
        kind: Literal["rgb", "depth", "geom"] = "rgb",
        groups: Sequence[int] | None = None,
        out: _Memory | None = None,
        device: Literal["gpu", "cpu"] | None = None,
        appearance: dict[str, Any] | None = None,
    ) -> NDArray[Any]: ...  # as for Sim.render; (n, ...) unless env is an index
    def ray(
        self,
        origin: ArrayLike,
        direction: ArrayLike,
        *,
        groups: ArrayLike | None = None,
        fixed: bool | np.bool_ = True,
        exclude_body: str | SupportsIndex | None = None,
    ) -> tuple[_Floats, NDArray[np.int64]]: ...  # (n,) each: distance, geom
    def distance(
        self, geom1: str | SupportsIndex, geom2: str | SupportsIndex, limit: SupportsFloat | None = None
    ) -> _Floats: ...  # (n,)
    @property
    def _last_serials(self) -> list[int]: ...
    @_last_serials.setter
    def _last_serials(self, serials: list[int]) -> None: ...
    def _restore_outputs(self, outputs: Mapping[str, NDArray[Any]]) -> None: ...
    def add_weld(
        self, body1: str | SupportsIndex, body2: str | SupportsIndex, envs: ArrayLike | None = None
    ) -> NDArray[np.int64]: ...  # (len(envs),)
    def add_connect(
        self, body1: str | SupportsIndex, body2: str | SupportsIndex, anchor: ArrayLike, envs: ArrayLike | None = None
    ) -> NDArray[np.int64]: ...  # (len(envs),)
    def remove(self, constraints: ArrayLike, envs: ArrayLike | None = None) -> None: ...
    def weld_here(self, which: str | SupportsIndex, envs: ArrayLike | None = None) -> None: ...
    def set_equality(self, which: str | SupportsIndex, active: bool | np.bool_ | ArrayLike) -> None: ...
    def sim(self, env: SupportsIndex) -> Sim: ...
    def jacobian(
        self,
        *,
        body: str | SupportsIndex | None = None,
        body_com: str | SupportsIndex | None = None,
        geom: str | SupportsIndex | None = None,
        site: str | SupportsIndex | None = None,
        camera: str | SupportsIndex | None = None,
        point: ArrayLike | None = None,  # (3,) or (n, 3)
    ) -> NDArray[Any]: ...  # (n, 2, 3, nv): translation, rotation
    def jacobian_rate(
        self,
        *,
        body: str | SupportsIndex | None = None,
        body_com: str | SupportsIndex | None = None,
        geom: str | SupportsIndex | None = None,
        site: str | SupportsIndex | None = None,
        camera: str | SupportsIndex | None = None,
        point: ArrayLike | None = None,  # (3,) or (n, 3)
    ) -> NDArray[Any]: ...  # (n, 2, 3, nv): translation, rotation
    def subtree_jacobian(self, body: str | SupportsIndex) -> NDArray[Any]: ...  # (n, 3, nv)
    def __len__(self) -> int: ...

    actuator_power: Final[NDArray[Any]]  # (n,)
    contact_count: Final[NDArray[Any]]  # (n,)
    solver_iterations: Final[NDArray[Any]]  # (n,)

@final
class Contacts:
    @property
    def geom_names(self) -> list[tuple[str, str]]: ...
    @property
    def geom(self) -> NDArray[np.int64]: ...  # (ncon, 2)
    @property
    def dim(self) -> NDArray[np.int64]: ...  # (ncon,)
    @property
    def dist(self) -> _Floats: ...  # (ncon,)
    @property
    def pos(self) -> _Floats: ...  # (ncon, 3)
    @property
    def frame(self) -> _Floats: ...  # (ncon, 3, 3)
    @property
    def includemargin(self) -> _Floats: ...  # (ncon,)
    @property
    def friction(self) -> _Floats: ...  # (ncon, 5)
    @property
    def adhesion(self) -> _Floats: ...  # (ncon,)
    @property
    def surfacevel(self) -> _Floats: ...  # (ncon, 3) along both tangents and about the normal
    @property
    def force(self) -> _Floats: ...  # (ncon, 6) in the contact frame
    @property
    def wrench(self) -> _Floats: ...  # (ncon, 6) in world axes, on the second geom
    def of_geom(self, which: str | SupportsIndex) -> Contacts: ...
    def of_body(self, which: str | SupportsIndex) -> Contacts: ...
    def between(self, geom1: str | SupportsIndex, geom2: str | SupportsIndex) -> Contacts: ...
    @overload
    def __getitem__(self, which: int | np.integer[Any], /) -> Contact: ...
    @overload
    def __getitem__(self, which: slice | Sequence[int] | NDArray[Any], /) -> Contacts: ...
    def __iter__(self) -> Iterator[Contact]: ...
    def __len__(self) -> int: ...

@final
class Contact:
    @property
    def geom(self) -> tuple[int, int]: ...
    @property
    def geom_names(self) -> tuple[str, str]: ...
    @property
    def body(self) -> tuple[int, int]: ...
    @property
    def dim(self) -> int: ...
    @property
    def dist(self) -> float: ...
    @property
    def pos(self) -> _Floats: ...  # (3,)
    @property
    def frame(self) -> _Floats: ...  # (3, 3)
    @property
    def includemargin(self) -> float: ...
    @property
    def friction(self) -> _Floats: ...  # (5,)
    @property
    def adhesion(self) -> float: ...
    @property
    def surfacevel(self) -> _Floats: ...  # (3,)
    @property
    def force(self) -> _Floats: ...  # (6,) in the contact frame
    @property
    def wrench(self) -> _Floats: ...  # (6,) in world axes, on the second geom

@final
class RayHit:
    @property
    def geom(self) -> int: ...
    @property
    def geom_name(self) -> str: ...
    @property
    def distance(self) -> float: ...
    @property
    def position(self) -> _Floats: ...  # (3,)
    @property
    def normal(self) -> _Floats: ...  # (3,)

@final
class RayHits:
    # In a batch the environments are the first axis.
    @property
    def geom(self) -> NDArray[np.int64]: ...  # (k,)
    @property
    def distance(self) -> NDArray[Any]: ...  # (k,)
    @property
    def normal(self) -> NDArray[Any]: ...  # (k, 3)

@final
class FrameTarget:
    def __new__(
        cls,
        *,
        body: str | SupportsIndex | None = None,
        body_com: str | SupportsIndex | None = None,
        geom: str | SupportsIndex | None = None,
        site: str | SupportsIndex | None = None,
        camera: str | SupportsIndex | None = None,
        position: ArrayLike | None = None,  # (3,), in a batch also (n, 3)
        quat: ArrayLike | None = None,  # (4,), in a batch also (n, 4)
        position_cost: ArrayLike = 1.0,  # a number or (3,)
        orientation_cost: float = 1.0,
    ) -> Self: ...
    @property
    def body(self) -> str | SupportsIndex | None: ...
    @property
    def body_com(self) -> str | SupportsIndex | None: ...
    @property
    def geom(self) -> str | SupportsIndex | None: ...
    @property
    def site(self) -> str | SupportsIndex | None: ...
    @property
    def camera(self) -> str | SupportsIndex | None: ...
    @property
    def position(self) -> Any: ...
    @property
    def quat(self) -> Any: ...
    @property
    def position_cost(self) -> Any: ...
    @property
    def orientation_cost(self) -> float: ...

@final
class ComTarget:
    def __new__(
        cls,
        position: ArrayLike,  # (3,), in a batch also (n, 3)
        body: str | SupportsIndex = 0,
        *,
        cost: ArrayLike = 1.0,  # a number or (3,)
    ) -> Self: ...
    @property
    def position(self) -> Any: ...
    @property
    def body(self) -> str | SupportsIndex: ...
    @property
    def cost(self) -> Any: ...

@final
class PostureTarget:
    def __new__(
        cls,
        qpos: ArrayLike,  # (nq,), in a batch also (n, nq)
        *,
        cost: ArrayLike = 1.0,  # a number or (nv,)
    ) -> Self: ...
    @property
    def qpos(self) -> Any: ...
    @property
    def cost(self) -> Any: ...

@final
class IkResult:
    # In a batch the environments are the first axis; single numbers become arrays.
    @property
    def qpos(self) -> NDArray[Any]: ...  # (nq,)
    @property
    def errors(self) -> NDArray[Any]: ...  # (goals,)
    @property
    def iterations(self) -> Any: ...  # int
    @property
    def status(self) -> Any: ...  # int, a code of clench.IkStatus
    @property
    def reached(self) -> Any: ...  # bool

@final
class Linearization:
    @property
    def A(self) -> _Floats: ...  # (2 nv + na, 2 nv + na)
    @property
    def B(self) -> _Floats: ...  # (2 nv + na, nu)
    @property
    def C(self) -> _Floats: ...  # (nsensordata + outputs, 2 nv + na)
    @property
    def D(self) -> _Floats: ...  # (nsensordata + outputs, nu)
    @property
    def parameters(self) -> dict[str, _Floats]: ...  # (2 nv + na, numbers) each
    @property
    def output_parameters(self) -> dict[str, _Floats]: ...  # (nsensordata + outputs, numbers) each
    @property
    def switching(self) -> Any: ...  # an array, or a list of arrays of a batch
    @property
    def qacc_error(self) -> _Floats | None: ...  # (nv,)
    @property
    def error(self) -> _Floats | None: ...  # (nv, 2 nv + na + nu + numbers of parameters)
    @property
    def reach(self) -> Any: ...  # as switching, or None

@final
class Separation:
    @property
    def distance(self) -> float: ...
    @property
    def normal(self) -> _Floats: ...  # (3,)
    @property
    def points(self) -> _Floats: ...  # (2, 3)

@final
class Constraints:
    @property
    def kind(self) -> list[_Source]: ...
    @property
    def id(self) -> NDArray[np.int64]: ...  # (nefc,)
    @property
    def name(self) -> list[str]: ...
    @property
    def pos(self) -> _Floats: ...  # (nefc,)
    @property
    def margin(self) -> _Floats: ...  # (nefc,)
    @property
    def vel(self) -> _Floats: ...  # (nefc,)
    @property
    def aref(self) -> _Floats: ...  # (nefc,)
    @property
    def D(self) -> _Floats: ...  # (nefc,)
    @property
    def impedance(self) -> _Floats: ...  # (nefc,)
    @property
    def frictionloss(self) -> _Floats: ...  # (nefc,)
    @property
    def force(self) -> _Floats: ...  # (nefc,)
    @property
    def J(self) -> _Floats: ...  # (nefc, nv)
    def __len__(self) -> int: ...

@final
class SolverStats:
    @property
    def status(self) -> _Status: ...
    @property
    def iterations(self) -> int: ...
    @property
    def gradient(self) -> float: ...
    @property
    def improvement(self) -> float: ...
    @property
    def gap(self) -> float: ...
    @property
    def normal_residual(self) -> float: ...
    @property
    def active_set_changes(self) -> int: ...
    @property
    def ls_evaluations(self) -> int: ...
    @property
    def factorizations(self) -> int: ...
    @property
    def updates(self) -> int: ...
    @property
    def noslip_iterations(self) -> int: ...
    @property
    def islands(self) -> int: ...

@final
class Block:
    def __new__(
        cls,
        cost: _Cost,
        jacobian: ArrayLike,
        aref: ArrayLike,
        R: ArrayLike,
        shape: ArrayLike | None = None,
    ) -> Self: ...
    @property
    def cost(self) -> _Cost: ...
    @property
    def dim(self) -> int: ...
    @property
    def jacobian(self) -> _Floats: ...  # (dim, nv)
    @property
    def aref(self) -> _Floats: ...  # (dim,)
    @property
    def R(self) -> _Floats: ...  # (dim,)
    @property
    def shape(self) -> _Floats | None: ...  # (dim,)

@final
class Solution:
    @property
    def qacc(self) -> _Floats: ...  # (nv,)
    @property
    def forces(self) -> list[_Floats]: ...  # (dim,) each
    @property
    def qfrc_constraint(self) -> _Floats: ...  # (nv,)
    @property
    def status(self) -> _Status: ...
    @property
    def certificate(self) -> float: ...
    @property
    def stats(self) -> SolverStats: ...

def devices() -> list[str]: ...
def render_device() -> str | None: ...
def solve(
    M: ArrayLike, a_unc: ArrayLike, blocks: Iterable[Block], options: RigidOptions | None = None
) -> Solution: ...

@final
class FreeCamera:
    def __new__(
        cls,
        lookat: ArrayLike,  # (3,)
        distance: float,
        azimuth: float = 90.0,
        elevation: float = -45.0,
        *,
        fovy: float = 45.0,
    ) -> Self: ...
    @property
    def lookat(self) -> list[float]: ...
    @property
    def distance(self) -> float: ...
    @property
    def azimuth(self) -> float: ...
    @property
    def elevation(self) -> float: ...
    @property
    def fovy(self) -> float: ...

@final
class Recording:
    def __new__(cls, *, limit: SupportsIndex = 1_000_000_000) -> Self: ...
    @property
    def times(self) -> _Floats: ...  # (n,)
    def append(self, target: Sim | Batch, env: SupportsIndex = 0) -> None: ...
    def save(self, path: str | PathLike[str]) -> None: ...
    @staticmethod
    def load(path: str | PathLike[str], *, limit: SupportsIndex = 1_000_000_000) -> Recording: ...
    def show(self) -> None: ...
    def _repr_html_(self) -> str | None: ...
    def __len__(self) -> int: ...

@final
class Viewer:
    def __new__(
        cls,
        target: Sim | Batch,
        *,
        env: SupportsIndex = 0,
        host: str = "127.0.0.1",
        port: SupportsIndex = 0,
        paused: bool = False,
        speed: float = 1.0,
    ) -> Self: ...
    @property
    def url(self) -> str: ...
    @property
    def closed(self) -> bool: ...
    @property
    def clients(self) -> int: ...
    @property
    def paused(self) -> bool: ...
    @paused.setter
    def paused(self, paused: bool) -> None: ...
    @property
    def speed(self) -> float: ...
    @speed.setter
    def speed(self, speed: float) -> None: ...
    @property
    def env(self) -> int: ...
    @env.setter
    def env(self, env: SupportsIndex) -> None: ...
    def sync(self, *, block: bool = True) -> None: ...
    def show_grid(self, count: SupportsIndex, first: SupportsIndex = 0) -> None: ...
    def draw_sphere(
        self,
        center: ArrayLike,  # (3,)
        radius: float = 0.02,
        *,
        rgba: ArrayLike | None = None,  # (4,)
        lifetime: float = 0.0,
    ) -> None: ...
    def draw_line(
        self,
        start: ArrayLike,  # (3,)
        end: ArrayLike,  # (3,)
        radius: float = 0.004,
        *,
        rgba: ArrayLike | None = None,  # (4,)
        lifetime: float = 0.0,
    ) -> None: ...
    def draw_arrow(
        self,
        start: ArrayLike,  # (3,)
        end: ArrayLike,  # (3,)
        radius: float = 0.008,
        *,
        rgba: ArrayLike | None = None,  # (4,)
        lifetime: float = 0.0,
    ) -> None: ...
    def draw_text(
        self,
        at: ArrayLike,  # (3,)
        text: str,
        *,
        rgba: ArrayLike | None = None,  # (4,)
        lifetime: float = 0.0,
    ) -> None: ...
    def clear_draws(self) -> None: ...
    def close(self) -> None: ...
    def _repr_html_(self) -> str: ...
    def __enter__(self) -> Self: ...
    def __exit__(self, *_raised: object) -> None: ...
