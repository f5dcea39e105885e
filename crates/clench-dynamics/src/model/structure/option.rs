//! What a model says of the step itself: integrator and feature switches.

/// How velocity and position advance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Integrator {
    /// Semi-implicit Euler, joint damping implicit.
    #[default]
    Euler,
    /// Euler, implicit in the derivatives of damping and actuation with respect to velocity.
    ImplicitFast,
    /// Euler, implicit in the derivatives of all forces but constraints' with respect to velocity, Coriolis forces included.
    Implicit,
    /// Fourth-order Runge–Kutta.
    Rk4,
    /// Velocity stepping: constraints are solved for in a metric that has the damping and the stiffness of smooth forces, and what is
    /// found is the step.
    Discrete,
}

/// Feature switches: MuJoCo's disable flags, said positively and on by default, and of its enable flags those that act on motion
/// or on inverse dynamics.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Flags {
    /// Any constraint at all.
    pub constraint: bool,
    /// Equality constraints.
    pub equality: bool,
    /// Dry friction.
    pub frictionloss: bool,
    /// Joint and tendon limits.
    pub limit: bool,
    /// Contacts.
    pub contact: bool,
    /// Springs.
    pub spring: bool,
    /// Dampers.
    pub damper: bool,
    /// Gravity.
    pub gravity: bool,
    /// Clamping of controls to their range.
    pub clampctrl: bool,
    /// Warm start of the solver.
    pub warmstart: bool,
    /// No contacts between a body and its parent.
    pub filterparent: bool,
    /// Actuation.
    pub actuation: bool,
    /// `solref` time constants at least twice the time step.
    pub refsafe: bool,
    /// Islands.
    pub island: bool,
    /// Euler integrates joint damping implicitly.
    pub eulerdamp: bool,
    /// Sensors.
    pub sensor: bool,
    /// Several contacts of a pair whose contacts MuJoCo finds by its general algorithm (see `clench_collide::multiccd_matters`);
    /// without it the deepest alone.
    pub multiccd: bool,
    /// Constraints see the inverse inertia of the present configuration, not an estimate of that at qpos0. Off by default.
    pub diagexact: bool,
    /// Trees that rest sleep.
    pub sleep: bool,
    /// Inverse dynamics are given the acceleration by which a step changes the velocity, see
    /// [`Acceleration`](crate::inverse::Acceleration). Off by default.
    pub invdiscrete: bool,
}

impl Default for Flags {
    fn default() -> Self {
        Flags {
            constraint: true,
            equality: true,
            frictionloss: true,
            limit: true,
            contact: true,
            spring: true,
            damper: true,
            gravity: true,
            clampctrl: true,
            warmstart: true,
            filterparent: true,
            actuation: true,
            refsafe: true,
            island: true,
            eulerdamp: true,
            sensor: true,
            multiccd: true,
            diagexact: false,
            sleep: false,
            invdiscrete: false,
        }
    }
}
