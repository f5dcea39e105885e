//! The options of a model for the step itself: integrator and feature switches.

/// The integration method of velocity and position.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Integrator {
    /// Semi-implicit Euler, joint damping implicit.
    #[default]
    Euler,
    /// Euler, implicit in the derivatives of damping and actuation with respect to velocity.
    ImplicitFast,
    /// Euler, implicit in the derivatives of all forces except constraint forces with respect to velocity, including
    /// Coriolis forces.
    Implicit,
    /// Fourth-order Runge–Kutta.
    Rk4,
    /// Velocity stepping: constraints are solved in a metric that includes the damping and the stiffness of smooth
    /// forces, and the solution is the step.
    Discrete,
}

/// Feature switches: MuJoCo's disable flags, stated positively and on by default, and those of its enable flags that
/// affect motion or inverse dynamics.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Flags {
    /// All constraints.
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
    /// Several contacts of a pair whose contacts MuJoCo finds by its general algorithm (see
    /// `clench_collide::multiccd_applies`); otherwise only the deepest.
    pub multiccd: bool,
    /// Constraints use the inverse inertia of the present configuration, not an estimate at qpos0. Off by default.
    pub diagexact: bool,
    /// Trees at rest sleep.
    pub sleep: bool,
    /// The input of inverse dynamics is the acceleration by which a step changes the velocity, see
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
