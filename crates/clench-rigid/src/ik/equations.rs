//! The linear equations of an iteration: (A + μ I) δ = g, with A = Σ JᵀW²J and g = Σ JᵀW²e over the tasks.

use super::{Ik, IkTarget, IkTask};
use clench_dynamics::dynamics::frames::Frames;
use clench_dynamics::dynamics::integrate::differentiate_positions;
use clench_dynamics::dynamics::jacobian::{point_jacobian, subtree_jacobian};
use clench_dynamics::model::Model;
use clench_math::{Quat, Real, Vec3, kernel};

/// A, g, errors and cost at the present positions. `n` is the number of dofs that are solved for.
#[derive(Clone, Debug, Default)]
pub(super) struct Equations<T> {
    /// Lower triangle of A, row by row (n (n + 1) / 2).
    pub matrix: Vec<T>,
    /// g (n).
    pub right: Vec<T>,
    /// Squared norm of each task's unweighted error.
    pub errors: Vec<T>,
    /// ½ Σ |W e|².
    pub cost: T,
}

/// Scratch memory of `Equations::build` (6 × nv, nv).
#[derive(Clone, Debug)]
pub(super) struct Scratch<T> {
    jacobian: Vec<T>,
    velocity: Vec<T>,
}

impl<T: Real> Scratch<T> {
    pub(super) fn new(model: &Model) -> Self {
        Scratch {
            jacobian: vec![T::ZERO; 6 * model.nv],
            velocity: vec![T::ZERO; model.nv],
        }
    }
}

/// Returns the start of row `i` of a lower triangle.
#[inline(always)]
pub(super) fn row_start(i: usize) -> usize {
    i * (i + 1) / 2
}

impl<T: Real> Equations<T> {
    pub(super) fn new(ik: &Ik) -> Self {
        let n = ik.dofs.len();
        Equations {
            matrix: vec![T::ZERO; row_start(n)],
            right: vec![T::ZERO; n],
            errors: vec![T::ZERO; ik.tasks.len()],
            cost: T::ZERO,
        }
    }

    /// Builds the equations at the present poses.
    #[kernel]
    pub fn build(
        &mut self,
        frames: Frames<'_, T>,
        qpos: &[T],
        (ik, mut goals): (&Ik, &[T]),
        scratch: &mut Scratch<T>,
    ) {
        self.matrix.fill(T::ZERO);
        self.right.fill(T::ZERO);
        self.cost = T::ZERO;
        for (k, task) in ik.tasks.iter().enumerate() {
            let (goal, rest) = goals.split_at(task.target.goal_len(frames.model));
            goals = rest;
            self.errors[k] = match task.target {
                IkTarget::Posture => {
                    self.add_posture(frames.model, ik, task, (qpos, goal), scratch)
                }
                IkTarget::Position(_) | IkTarget::Orientation(_) | IkTarget::CentreOfMass(_) => {
                    self.add_vector(frames, ik, task, goal, scratch)
                }
            };
        }
    }

    /// Adds a task with three error components and returns its squared error.
    #[inline(always)]
    fn add_vector(
        &mut self,
        frames: Frames<'_, T>,
        ik: &Ik,
        task: &IkTask,
        goal: &[T],
        scratch: &mut Scratch<T>,
    ) -> T {
        let Frames { model, params, pos } = frames;
        let jacobian = &mut scratch.jacobian;
        let (error, rows) = match task.target {
            IkTarget::Orientation(object) => {
                point_jacobian(model, pos, &frames.point(object), jacobian);
                let goal = Quat::from_slice(goal).normalize();
                let error = goal * frames.orientation(object).conjugate();
                (error.to_rotation_vector(), &jacobian[3 * model.nv..])
            }
            IkTarget::Position(object) => {
                point_jacobian(model, pos, &frames.point(object), jacobian);
                (
                    Vec3::from_slice(goal) - frames.position(object),
                    &jacobian[..],
                )
            }
            IkTarget::CentreOfMass(body) => {
                subtree_jacobian(model, params, pos, body, &mut jacobian[..3 * model.nv]);
                (
                    Vec3::from_slice(goal) - pos.subtree_com[body],
                    &jacobian[..],
                )
            }
            IkTarget::Posture => return T::ZERO,
        };
        let mut squared = Vec3::ZERO;
        for c in 0..3 {
            let weight = task.weights[c.min(task.weights.len() - 1)];
            squared[c] = T::new(weight * weight);
        }
        self.cost += T::new(0.5) * error.scale_by(squared).dot(error);
        let column = |i: usize| {
            let dof = ik.dofs[i] as usize;
            Vec3::new(rows[dof], rows[model.nv + dof], rows[2 * model.nv + dof])
        };
        for i in 0..ik.dofs.len() {
            let weighted = column(i).scale_by(squared);
            self.right[i] += weighted.dot(error);
            for (j, entry) in self.matrix[row_start(i)..row_start(i + 1)]
                .iter_mut()
                .enumerate()
            {
                *entry += weighted.dot(column(j));
            }
        }
        counted(error, squared)
    }

    #[inline(always)]
    fn add_posture(
        &mut self,
        model: &Model,
        ik: &Ik,
        task: &IkTask,
        (qpos, goal): (&[T], &[T]),
        scratch: &mut Scratch<T>,
    ) -> T {
        let error = &mut scratch.velocity;
        differentiate_positions(model, qpos, goal, T::ONE, error);
        for (i, &dof) in ik.dofs.iter().enumerate() {
            let weight = task.weights[dof as usize];
            let squared = T::new(weight * weight);
            self.matrix[row_start(i) + i] += squared;
            self.right[i] += squared * error[dof as usize];
        }
        let mut sum = T::ZERO;
        for (&error, &weight) in error.iter().zip(&task.weights) {
            if weight > 0.0 {
                self.cost += T::new(0.5 * weight * weight) * error * error;
                sum += error * error;
            }
        }
        sum
    }

    /// Solves (A + μ I) δ = g for the dofs that are not held; δ of a held dof is zero. `factor` is scratch memory for
    /// the Cholesky factor. Returns false in lanes where the matrix is not positive definite.
    #[kernel]
    pub fn solve(
        &self,
        damping: T,
        at_limit: &[T::Mask],
        factor: &mut [T],
        step: &mut [T],
    ) -> T::Mask {
        use clench_math::Mask;
        let mut positive = T::Mask::splat(true);
        factor.copy_from_slice(&self.matrix);
        for i in 0..step.len() {
            let start = row_start(i);
            for j in 0..i {
                let omitted = at_limit[i] | at_limit[j];
                factor[start + j] = T::select(omitted, T::ZERO, factor[start + j]);
            }
            let diagonal = factor[start + i] + damping;
            factor[start + i] = T::select(at_limit[i], T::ONE, diagonal);
            step[i] = T::select(at_limit[i], T::ZERO, self.right[i]);
        }
        for i in 0..step.len() {
            let (above, own) = factor.split_at_mut(row_start(i));
            for j in 0..=i {
                let mut sum = own[j];
                let row = match j == i {
                    true => &own[..j],
                    false => &above[row_start(j)..row_start(j) + j],
                };
                for (&a, &b) in row.iter().zip(&own[..j]) {
                    sum -= a * b;
                }
                if j < i {
                    own[j] = sum / above[row_start(j) + j];
                    continue;
                }
                let pivot = sum.gt(T::ZERO);
                positive &= pivot;
                own[i] = T::select(pivot, sum, T::ONE).sqrt();
            }
        }
        solve_factored(factor, step);
        positive
    }

    /// Copies the values of `other` in the lanes of `mask`.
    #[kernel]
    pub fn blend(&mut self, mask: T::Mask, other: &Self) {
        let pairs = [
            (&mut self.matrix, &other.matrix),
            (&mut self.right, &other.right),
            (&mut self.errors, &other.errors),
        ];
        for (own, other) in pairs {
            for (own, &other) in own.iter_mut().zip(other) {
                *own = T::select(mask, other, *own);
            }
        }
        self.cost = T::select(mask, other.cost, self.cost);
    }
}

/// Returns the squared error over positive weights.
#[inline(always)]
fn counted<T: Real>(error: Vec3<T>, weights: Vec3<T>) -> T {
    let mut sum = T::ZERO;
    for c in 0..3 {
        let counts = weights[c].gt(T::ZERO);
        sum += T::select(counts, error[c] * error[c], T::ZERO);
    }
    sum
}

/// Replaces b by the solution of L Lᵀ x = b.
#[inline(always)]
fn solve_factored<T: Real>(factor: &[T], x: &mut [T]) {
    for i in 0..x.len() {
        let row = &factor[row_start(i)..row_start(i + 1)];
        let mut sum = x[i];
        for (&l, &x) in row[..i].iter().zip(&*x) {
            sum -= l * x;
        }
        x[i] = sum / row[i];
    }
    for i in (0..x.len()).rev() {
        let row = &factor[row_start(i)..row_start(i + 1)];
        x[i] /= row[i];
        let own = x[i];
        for (x, &l) in x.iter_mut().zip(&row[..i]) {
            *x -= l * own;
        }
    }
}
