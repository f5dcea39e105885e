//! The rates of the coordinates whose arms change: spatial tendons, and actuators of sites, of ball and free joints and
//! of spatial tendons.
//!
//! Kinematics in dual numbers along each dof give them, without any other part of a step.

use crate::tangent;
use clench_dynamics::State;
use clench_dynamics::dynamics::kinematics::Computed;
use clench_dynamics::model::{Actuator, JointKind, Model, Params, RowPattern, Transmission};
use clench_dynamics::part::Part;
use clench_dynamics::pipeline::poses;
use clench_dynamics::stages::Positions;
use clench_math::{Dual, Real};

/// The rates of all coordinates of a model. They are empty for coordinates whose arms are constant.
#[derive(Clone, Debug)]
pub(crate) struct Curves {
    tendons: Rates,
    actuators: Rates,
    /// The derivatives of the lengths of curved actuators by the position of each dof, in the pattern of their arms.
    pub(super) lengths: Vec<f64>,
    /// The dofs that change any of these coordinates.
    dofs: Vec<u32>,
}

/// The rates of coordinates of some kind: for each, the derivative of each arm by the position of each dof.
#[derive(Clone, Debug, Default)]
struct Rates {
    /// The end of each coordinate's rates.
    ends: Vec<usize>,
    values: Vec<f64>,
}

impl Curves {
    /// Allocates memory for a model.
    pub(super) fn new(model: &Model) -> Self {
        let (mut tendons, mut actuators) = (Rates::default(), Rates::default());
        let mut dofs = Vec::new();
        for (t, tendon) in model.tendons.iter().enumerate() {
            let of = model.tendon_dofs.dofs(t);
            tendons.push(of, tendon.is_spatial(), &mut dofs);
        }
        for actuator in &model.actuators {
            let of = model.actuator_dofs.dofs(actuator.outputs.start);
            actuators.push(of, is_curved(model, actuator), &mut dofs);
        }
        dofs.sort_unstable();
        dofs.dedup();
        Curves {
            tendons,
            actuators,
            lengths: vec![0.0; model.actuator_dofs.len()],
            dofs,
        }
    }

    /// Returns the rates of a tendon.
    pub(super) fn of_tendon(&self, tendon: usize) -> &[f64] {
        self.tendons.of(tendon)
    }

    /// Returns the rates of an actuator.
    pub(super) fn of_actuator(&self, actuator: usize) -> &[f64] {
        self.actuators.of(actuator)
    }

    /// Computes all rates at a state. `before` and `pos` are memory.
    pub(crate) fn find<L: Real<Scalar = f64>, const K: usize>(
        &mut self,
        (model, params): (&Model, &Params<Dual<L, K>>),
        state: &State<f64>,
        (before, pos): (&mut State<Dual<L, K>>, &mut Positions<Dual<L, K>>),
    ) {
        let dofs = std::mem::take(&mut self.dofs);
        for part in dofs.chunks(Dual::<L, K>::DIRECTIONS) {
            before.set_values(state);
            for (slot, &dof) in part.iter().enumerate() {
                tangent::move_along(model, dof as usize, (slot, 1.0), &mut before.qpos);
            }
            let whole = [Part::whole(model)];
            poses(model, params, before, Computed::all(&whole), pos);
            for (slot, &dof) in part.iter().enumerate() {
                let by = |number: &Dual<L, K>| number.derivative(slot);
                let jacobian = |i: usize| by(&pos.ten_jacobian[i]);
                let pattern = &model.tendon_dofs;
                (self.tendons).set_column((pattern, &|t| t), dof, jacobian);
                let moment = |i: usize| by(&pos.actuator_moment[i]);
                let output = |u: usize| model.actuators[u].outputs.start;
                let pattern = &model.actuator_dofs;
                (self.actuators).set_column((pattern, &output), dof, moment);
                for u in 0..model.actuators.len() {
                    if let Ok(column) = pattern.dofs(output(u)).binary_search(&dof) {
                        let length = &pos.actuator_length[output(u)];
                        self.lengths[pattern.range(output(u)).start + column] = by(length);
                    }
                }
            }
        }
        self.dofs = dofs;
    }
}

impl Rates {
    /// Appends a coordinate, and its dofs to `all` if it is curved.
    fn push(&mut self, dofs: &[u32], curved: bool, all: &mut Vec<u32>) {
        if curved {
            let end = self.values.len() + dofs.len() * dofs.len();
            self.values.resize(end, 0.0);
            all.extend_from_slice(dofs);
        }
        self.ends.push(self.values.len());
    }

    fn of(&self, index: usize) -> &[f64] {
        let start = index.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.values[start..self.ends[index]]
    }

    /// Sets the rates by the position of a dof, from those of the arms in a pattern.
    fn set_column(
        &mut self,
        (pattern, row): (&RowPattern, &dyn Fn(usize) -> usize),
        dof: u32,
        rate: impl Fn(usize) -> f64,
    ) {
        let mut start = 0;
        for (index, &end) in self.ends.iter().enumerate() {
            let (dofs, arms) = (pattern.dofs(row(index)), pattern.range(row(index)));
            if let (true, Ok(column)) = (end > start, dofs.binary_search(&dof)) {
                let rates = self.values[start..end].chunks_exact_mut(dofs.len());
                for (rates, arm) in rates.zip(arms) {
                    rates[column] = rate(arm);
                }
            }
            start = end;
        }
    }
}

/// Returns true if the arms of an actuator change, or are not those of its length.
pub(super) fn is_curved(model: &Model, actuator: &Actuator) -> bool {
    match actuator.transmission {
        Transmission::Joint(j) | Transmission::JointInParent(j) => match model.joints[j].kind {
            JointKind::Hinge | JointKind::Slide => false,
            JointKind::Ball | JointKind::Free => true,
        },
        Transmission::Tendon(t) => model.tendons[t].is_spatial(),
        Transmission::Site(_)
        | Transmission::SiteInFrame(_)
        | Transmission::SliderCrank(_)
        | Transmission::Body(_)
        | Transmission::Rotation(_)
        | Transmission::RotationInFrame(_) => true,
    }
}
