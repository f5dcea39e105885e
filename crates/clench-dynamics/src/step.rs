//! The step, compiled in this crate for each number type. Dependent crates call it without compiling it again.

use crate::context::StepContext;
use crate::dynamics::energy::{Energy, energy};
use crate::dynamics::integrate::integrate_positions;
use crate::dynamics::kinematics::Computed;
use crate::dynamics::velocity::velocities;
use crate::inverse::{Acceleration, inverse};
use crate::model::{Model, Params};
use crate::part::Part;
use crate::pipeline;
use crate::stages::{Positions, Velocities};
use crate::state::State;
use crate::workspace::{EnergyScratch, Workspace};
use clench_math::{CompiledKernels, KernelTable, Real};
use clench_solver::{Tree, TreeFactor, TreeMatrix};
use std::sync::LazyLock;

/// Pointers to the functions of a step, for one number type.
#[derive(Clone, Copy, Debug)]
#[expect(clippy::type_complexity, reason = "the signatures of the functions")]
pub struct Step<T: Real> {
    /// [`Workspace::new`].
    pub workspace: fn(&Model) -> Workspace<T>,
    /// [`State::splat_from`].
    pub splat_state: fn(&mut State<T>, &State<T::Scalar>),
    /// [`pipeline::step`].
    pub step: fn(StepContext<T>, &mut State<T>, &mut Workspace<T>),
    /// [`pipeline::forward`].
    pub forward: fn(StepContext<T>, &State<T>, &mut Workspace<T>),
    /// [`pipeline::step_asleep`].
    pub step_asleep: fn(StepContext<T>, &mut State<T>, &mut Workspace<T>) -> bool,
    /// [`pipeline::before_forces`].
    pub before_forces: fn(StepContext<T>, &State<T>, &mut Workspace<T>),
    /// [`pipeline::step_from_forces`].
    pub step_from_forces: fn(StepContext<T>, &mut State<T>, &mut Workspace<T>),
    /// [`pipeline::position_stage`].
    pub position_stage: fn(&Model, &Params<T>, &State<T>, &mut Workspace<T>),
    /// [`pipeline::poses`].
    pub poses: fn(&Model, &Params<T>, &State<T>, Computed, &mut Positions<T>),
    /// [`pipeline::body_poses`].
    pub body_poses: fn(&Model, &Params<T>, &State<T>, Computed, &mut Positions<T>),
    /// [`velocities`].
    pub velocities: fn(&Model, &[Part], &Positions<T>, &[T], &mut Velocities<T>),
    /// [`energy`].
    pub energy: fn(&Model, &Params<T>, &Positions<T>, &TreeMatrix<T>, &State<T>) -> Energy<T>,
    /// [`pipeline::state_energy`].
    pub state_energy: fn(&Model, &Params<T>, &State<T>, &mut EnergyScratch<T>) -> Energy<T>,
    /// [`integrate_positions`].
    pub integrate_positions: fn(&Model, &mut [T], &[T], T),
    /// [`TreeMatrix::mul`].
    pub mul: fn(&TreeMatrix<T>, &Tree, &[T], &mut [T]),
    /// [`TreeFactor::solve`].
    pub solve: fn(&TreeFactor<T>, &Tree, &mut [T]),
    /// [`inverse`].
    pub inverse: fn(StepContext<T>, &State<T>, (&[T], Acceleration), &mut Workspace<T>, &mut [T]),
}

impl<T: Real> Step<T> {
    /// Returns the step of a number type that [`Scalar::in_lanes`](clench_math::Scalar::in_lanes) passes to tasks.
    ///
    /// # Panics
    /// Panics if `T` is another type.
    pub fn compiled() -> Self {
        compiled().table::<StepTable, T>()
    }
}

// Not generic, so that everything is compiled here.
#[inline(never)]
fn compiled() -> &'static CompiledKernels {
    static COMPILED: LazyLock<CompiledKernels> = LazyLock::new(CompiledKernels::new::<StepTable>);
    &COMPILED
}

struct StepTable;

impl KernelTable for StepTable {
    type Of<T: Real> = Step<T>;
    fn of<T: Real>() -> Step<T> {
        Step {
            workspace: Workspace::new,
            splat_state: State::splat_from,
            step: pipeline::step,
            forward: pipeline::forward,
            step_asleep: pipeline::step_asleep,
            before_forces: pipeline::before_forces,
            step_from_forces: pipeline::step_from_forces,
            position_stage: pipeline::position_stage,
            poses: pipeline::poses,
            body_poses: pipeline::body_poses,
            velocities,
            energy,
            state_energy: pipeline::state_energy,
            integrate_positions,
            mul: TreeMatrix::mul,
            solve: TreeFactor::solve,
            inverse,
        }
    }
}
