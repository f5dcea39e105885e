//! The metric in which the integrator `discrete` solves for accelerations.
//!
//! A step evaluates smooth forces at its end, to first order in velocities and positions. With B and K the symmetric
//! positive semidefinite parts of −∂τ/∂v and −∂τ/∂q,
//!
//! ```text
//! M̂ a = τ − h K v + Jᵀf        M̂ = M + h B + h² K
//! ```
//!
//! where a is the change of the velocity in the step over h. The terms match MuJoCo 4.0, with which these rules were
//! determined: derivatives of springs and dampers of joints, on the diagonal, isotropic for a ball or free joint; fluid
//! drag; and s JᵀJ of tendons and actuators, s = h b + h² k with b and k the derivatives of their forces by velocity
//! and length. A derivative that would reduce the metric counts as zero.
//!
//! Couplings of dofs of different branches do not fit the pattern of M. The solver receives them as rows of a quadratic
//! cost, ½ s (J a − J a_s)². With ½ (a − a_s)ᵀ(M̂ − Σ s JᵀJ)(a − a_s), it is the cost in the whole metric about the
//! acceleration a_s without constraints.

use crate::dynamics::actuator_derivatives::{length_derivative, velocity_derivative};
use crate::dynamics::derivatives::{add_fluid_derivatives, add_outer};
use crate::dynamics::ellipsoid::FluidForces;
use crate::dynamics::reflected::{dof_damper, tendon_damper};
use crate::dynamics::spring::{
    JointElongation, joint_elongation, joint_spring, tendon_elongation, tendon_spring,
};
use crate::dynamics::tendon;
use crate::dynamics::transmission::moment;
use crate::model::{BiasKind, GainKind, Integrator, Model, Params};
use crate::stages::{Forces, Positions, Velocities};
use crate::state::State;
use clench_math::{Mask, Real, Vec3, kernel};
use clench_solver::{Solver, Tree, TreeFactor, TreeMatrix};

/// The direction in which the forces of a term act.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Along {
    /// The length of a tendon.
    Tendon(usize),
    /// A length of an actuator, one of `Model::nout`.
    Output(usize),
}

impl Along {
    /// Returns the dofs that it depends on, ascending.
    pub fn dofs(self, model: &Model) -> &[u32] {
        match self {
            Along::Tendon(t) => model.tendon_dofs.dofs(t),
            Along::Output(output) => model.actuator_dofs.dofs(output),
        }
    }
}

/// The memory of the metric; empty except for [`Integrator::Discrete`].
#[derive(Clone, Debug)]
pub struct Metric<T: Real> {
    /// M. The problem stores the part of M̂ that fits its pattern.
    pub mass: TreeMatrix<T>,
    /// Its factor.
    pub mass_factor: TreeFactor<T>,
    /// −h K v (nv).
    pub shift: Vec<T>,
    /// The diagonal of M̂ − M (nv).
    pub added: Vec<T>,
    /// M̂ with only the diagonal of tendon and actuator terms, used by MuJoCo's exact inverse inertias and no-slip
    /// sweeps; empty if equal to M̂.
    backbone: TreeMatrix<T>,
    /// Its factor.
    backbone_factor: TreeFactor<T>,
    /// The terms that may couple dofs of different branches.
    pub couplings: Vec<Along>,
    /// s of each coupling.
    pub scales: Vec<T>,
    /// The lanes in which tendon and actuator terms, later also constraints, act on a tree (ntree).
    pub touched: Vec<T::Mask>,
    /// The index of each tendon in `couplings` (ntendon).
    of_tendon: Vec<Option<usize>>,
    /// The index of each actuator length in `couplings` (nout).
    of_output: Vec<Option<usize>>,
    acts: bool,
}

impl<T: Real> Metric<T> {
    /// Allocates memory for the metric of a model.
    #[cold] // Compiled for size.
    #[inline(never)]
    pub fn new(model: &Model) -> Self {
        let acts = model.integrator == Integrator::Discrete;
        let numbers = if acts { model.nv } else { 0 };
        let mut metric = Metric {
            mass: TreeMatrix::default(),
            mass_factor: TreeFactor::default(),
            shift: vec![T::ZERO; numbers],
            added: vec![T::ZERO; numbers],
            backbone: TreeMatrix::default(),
            backbone_factor: TreeFactor::default(),
            couplings: Vec::new(),
            scales: Vec::new(),
            touched: Vec::new(),
            of_tendon: Vec::new(),
            of_output: Vec::new(),
            acts,
        };
        if !acts {
            return metric;
        }
        metric.mass = TreeMatrix::zeros(&model.tree);
        metric.mass_factor = TreeFactor::zeros(&model.tree);
        metric.touched = vec![T::Mask::splat(false); model.ntree()];
        let tendons = (0..model.tendons.len()).map(Along::Tendon);
        let terms = tendons.chain((0..model.nout()).map(Along::Output));
        if terms.clone().any(|along| along.dofs(model).len() > 1) {
            metric.backbone = TreeMatrix::zeros(&model.tree);
            metric.backbone_factor = TreeFactor::zeros(&model.tree);
        }
        let couplings = &mut metric.couplings;
        let mut coupling = |along: Along| {
            let fits = is_chain(&model.tree, along.dofs(model));
            (!fits).then(|| {
                couplings.push(along);
                couplings.len() - 1
            })
        };
        let tendons = (0..model.tendons.len()).map(Along::Tendon);
        metric.of_tendon = tendons.map(&mut coupling).collect();
        let outputs = (0..model.nout()).map(Along::Output);
        metric.of_output = outputs.map(&mut coupling).collect();
        metric.scales = vec![T::ZERO; metric.couplings.len()];
        metric
    }

    /// Returns true if the model steps in this metric.
    pub fn acts(&self) -> bool {
        self.acts
    }

    /// Returns the factor of the backbone, if it differs from that of the problem.
    pub(crate) fn backbone_factor(&self) -> Option<&TreeFactor<T>> {
        (!self.backbone.values.is_empty()).then_some(&self.backbone_factor)
    }

    /// Factors the backbone. Returns false in lanes where it is not positive definite.
    pub(crate) fn factor_backbone(&mut self, tree: &Tree, solver: &Solver<T>) -> T::Mask {
        match self.backbone.values.is_empty() {
            true => T::Mask::splat(true),
            false => solver.factor(&mut self.backbone_factor, tree, &self.backbone),
        }
    }

    /// Returns true if any coupling between branches acts in any lane.
    pub fn is_coupled(&self) -> bool {
        self.scales.iter().any(|scale| !scale.eq(T::ZERO).all())
    }
}

/// Returns the tendons and actuator lengths that may add to the metric.
pub fn terms(model: &Model) -> impl Iterator<Item = Along> + '_ {
    let tendons = (0..model.tendons.len()).filter(|&t| acts_on_tendon(model, t));
    let outputs = (model.actuators.iter())
        .filter(|actuator| {
            let constant = matches!(
                actuator.gain,
                GainKind::Fixed | GainKind::User | GainKind::Pid
            );
            !constant || !matches!(actuator.bias, BiasKind::None | BiasKind::User)
        })
        .flat_map(|actuator| actuator.outputs.clone());
    (tendons.map(Along::Tendon)).chain(outputs.map(Along::Output))
}

/// Returns true if tendon `t` has a spring or a damper.
fn acts_on_tendon(model: &Model, t: usize) -> bool {
    let p = &model.params;
    let any = |linear: f64, higher: [f64; 2]| linear != 0.0 || higher != [0.0; 2];
    let springs = model.flags.spring && any(p.tendon_stiffness[t], p.tendon_stiffnesspoly[t]);
    let dampers = model.flags.damper
        && (any(p.tendon_damping[t], p.tendon_dampingpoly[t])
            || !model.tendons[t].reflecting.is_empty());
    springs || dampers
}

/// Returns the terms that may couple dofs of different branches.
pub fn couplings(model: &Model) -> impl Iterator<Item = Along> + '_ {
    terms(model).filter(|along| !is_chain(&model.tree, along.dofs(model)))
}

/// Returns true if each of these ascending dofs is above the next.
fn is_chain(tree: &Tree, dofs: &[u32]) -> bool {
    let above = |pair: &[u32]| tree.row(pair[1] as usize).contains(&pair[0]);
    dofs.windows(2).all(above)
}

/// Calls `visit` with each dof that a term acts on and J along it.
#[inline(always)]
pub(crate) fn each_arm<T: Real>(
    model: &Model,
    pos: &Positions<T>,
    along: Along,
    mut visit: impl FnMut(usize, T),
) {
    match along {
        Along::Tendon(t) => tendon::gradient(model, pos, t).for_each(|(dof, arm)| visit(dof, arm)),
        Along::Output(output) => moment(model, pos, output).for_each(|(dof, arm)| visit(dof, arm)),
    }
}

/// Replaces M in `mass` with the part of M̂ that fits its pattern; `metric` stores the remainder.
#[kernel]
pub(crate) fn add_metric<T: Real>(
    model: &Model,
    params: &Params<T>,
    state: &State<T>,
    (pos, vel, force): (&Positions<T>, &Velocities<T>, &Forces<T>),
    metric: &mut Metric<T>,
    mass: &mut TreeMatrix<T>,
) {
    mass.values.copy_from_slice(&metric.mass.values);
    metric.shift.fill(T::ZERO);
    metric.scales.fill(T::ZERO);
    metric.touched.fill(T::Mask::splat(false));
    let h = params.timestep;
    if model.flags.spring {
        for j in 0..model.joints.len() {
            add_joint_spring(model, params, state, j, metric, mass);
        }
    }
    if model.flags.damper {
        for (i, &v) in state.qvel.iter().enumerate() {
            let slope = dof_damper(model, params, i).damping_slope(v);
            *diagonal(&model.tree, mass, i) += h * slope.max(T::ZERO);
        }
    }
    add_fluid_derivatives(model, params, (pos, vel), FluidForces::Drag, -h, mass);
    let backbone = metric.backbone.values.iter_mut();
    backbone
        .zip(&mass.values)
        .for_each(|(to, &from)| *to = from);
    for (i, added) in metric.added.iter_mut().enumerate() {
        *added = T::ZERO;
        *added -= *diagonal(&model.tree, &mut metric.mass, i);
    }
    for t in 0..model.tendons.len() {
        let derivatives = tendon_derivatives(model, params, state, (pos, vel), t);
        let term = Term::new(h, derivatives, vel.ten_velocity[t]);
        let coupling = metric.of_tendon[t];
        term.add(model, pos, Along::Tendon(t), coupling, metric, mass);
    }
    if model.flags.actuation {
        for (u, actuator) in model.actuators.iter().enumerate() {
            let stages = (pos, vel, force);
            let derivatives = [
                -length_derivative(model, params, state, stages, u),
                -velocity_derivative(model, params, state, stages, u),
            ];
            for output in actuator.outputs.clone() {
                let term = Term::new(h, derivatives, vel.actuator_velocity[output]);
                let coupling = metric.of_output[output];
                term.add(model, pos, Along::Output(output), coupling, metric, mass);
            }
        }
    }
    for (i, added) in metric.added.iter_mut().enumerate() {
        *added += *diagonal(&model.tree, mass, i);
    }
}

#[inline(always)]
fn diagonal<'a, T: Real>(tree: &Tree, matrix: &'a mut TreeMatrix<T>, dof: usize) -> &'a mut T {
    &mut matrix.values[tree.row_start(dof + 1) - 1]
}

/// Adds the spring of joint `j`.
#[inline(always)]
fn add_joint_spring<T: Real>(
    model: &Model,
    params: &Params<T>,
    state: &State<T>,
    j: usize,
    metric: &mut Metric<T>,
    mass: &mut TreeMatrix<T>,
) {
    let Some(elongation) = joint_elongation(model, params, state, j) else {
        return;
    };
    let (spring, h, first) = (
        joint_spring(params, j),
        params.timestep,
        model.joints[j].dof,
    );
    let mut add = |x: T, dofs: std::ops::Range<usize>| {
        let slope = h * spring.stiffness_slope(x).max(T::ZERO);
        for i in dofs {
            metric.shift[i] -= slope * state.qvel[i];
            *diagonal(&model.tree, mass, i) += h * slope;
        }
    };
    let length = |x: Vec3<T>| x.norm();
    match elongation {
        JointElongation::Scalar(x) => add(x, first..first + 1),
        JointElongation::Rotation(rotation) => add(length(rotation), first..first + 3),
        JointElongation::Pose(shift, rotation) => {
            add(length(shift), first..first + 3);
            add(length(rotation), first + 3..first + 6);
        }
    }
}

/// Returns −∂force/∂length and −∂force/∂velocity of tendon `t`. A spring has none within its dead band.
#[inline(always)]
fn tendon_derivatives<T: Real>(
    model: &Model,
    params: &Params<T>,
    state: &State<T>,
    (pos, vel): (&Positions<T>, &Velocities<T>),
    t: usize,
) -> [T; 2] {
    let mut derivatives = [T::ZERO; 2];
    let spring = tendon_spring(params, t);
    if model.flags.spring && !spring.is_zero() {
        let elongation = tendon_elongation(model, params, &state.plastic, t, pos.ten_length[t]);
        let slack = elongation.eq(T::ZERO);
        derivatives[0] = T::select(slack, T::ZERO, spring.stiffness_slope(elongation));
    }
    if model.flags.damper {
        let damper = tendon_damper(model, params, t);
        derivatives[1] = damper.damping_slope(vel.ten_velocity[t]);
    }
    derivatives
}

/// A term s JᵀJ of the metric, and its share `shift` Jᵀ of −h K v.
struct Term<T> {
    scale: T,
    shift: T,
}

impl<T: Real> Term<T> {
    /// Creates a term from the negated derivatives of the force, at the velocity `rate`.
    #[inline(always)]
    fn new(h: T, [length, velocity]: [T; 2], rate: T) -> Self {
        let stiffness = h * length.max(T::ZERO);
        Term {
            scale: h * stiffness + h * velocity.max(T::ZERO),
            shift: -stiffness * rate,
        }
    }

    /// Adds the term to the matrix, or to the couplings at index `coupling`.
    #[kernel]
    fn add(
        &self,
        model: &Model,
        pos: &Positions<T>,
        along: Along,
        coupling: Option<usize>,
        metric: &mut Metric<T>,
        mass: &mut TreeMatrix<T>,
    ) {
        if self.scale.eq(T::ZERO).all() {
            return;
        }
        let Metric {
            shift,
            added,
            scales,
            touched,
            backbone,
            ..
        } = metric;
        let acts = self.scale.gt(T::ZERO);
        for &dof in along.dofs(model) {
            touched[model.tree.tree_of(dof as usize)] |= acts;
        }
        each_arm(
            model,
            pos,
            along,
            #[inline(always)]
            |dof, arm| shift[dof] += self.shift * arm,
        );
        if !backbone.values.is_empty() {
            each_arm(
                model,
                pos,
                along,
                #[inline(always)]
                |dof, arm| *diagonal(&model.tree, backbone, dof) += self.scale * arm * arm,
            );
        }
        match (coupling, along) {
            (Some(coupling), _) => {
                scales[coupling] = self.scale;
                each_arm(
                    model,
                    pos,
                    along,
                    #[inline(always)]
                    |dof, arm| added[dof] += self.scale * arm * arm,
                );
            }
            (None, Along::Tendon(t)) => {
                add_outer(model, tendon::gradient(model, pos, t), self.scale, mass);
            }
            (None, Along::Output(output)) => {
                add_outer(model, moment(model, pos, output), self.scale, mass);
            }
        }
    }
}
