//! Scalar functions of positions along which forces act: the lengths of tendons and actuators, and the positions of
//! constraint rows.
//!
//! A force f(x, ẋ) along a coordinate x with the gradient J acts on the dofs as Jᵀf. If J is not constant, its rates
//! C = ∂J/∂q add Cᵀf, and J (∂f/∂ẋ) C v by the change of ẋ = J v.

use super::step::Step;
use clench_dynamics::dynamics::force_derivatives::ForceDerivatives;

/// A coordinate at the positions of a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Coordinate<'a> {
    /// The dofs that change it.
    pub dofs: &'a [u32],
    /// J: the arm of its force along each dof.
    pub arms: &'a [f64],
    /// The derivative of the coordinate by the position of each dof: J, but for some actuators.
    pub by_position: &'a [f64],
    /// The derivative of each arm by the position of each dof, row after row; empty if all are zero.
    pub rates: &'a [f64],
}

/// A force along a coordinate, with its derivatives.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct AlongForce {
    pub value: f64,
    pub by_length: f64,
    pub by_velocity: f64,
}

impl<'a> Coordinate<'a> {
    /// Returns the length of a tendon.
    pub(super) fn of_tendon(step: &Step<'a>, tendon: usize) -> Self {
        let pattern = &step.model.tendon_dofs;
        let arms = &step.plain.position.ten_jacobian[pattern.range(tendon)];
        Coordinate {
            dofs: pattern.dofs(tendon),
            arms,
            by_position: arms,
            rates: step.curves.of_tendon(tendon),
        }
    }

    /// Returns the length of an actuator.
    pub(super) fn of_actuator(step: &Step<'a>, actuator: usize) -> Self {
        let output = step.model.actuators[actuator].outputs.start;
        let pattern = &step.model.actuator_dofs;
        let arms = &step.plain.position.actuator_moment[pattern.range(output)];
        let rates = step.curves.of_actuator(actuator);
        Coordinate {
            dofs: pattern.dofs(output),
            arms,
            by_position: match rates.is_empty() {
                true => arms,
                false => &step.curves.lengths[pattern.range(output)],
            },
            rates,
        }
    }

    /// Returns each dof with its arm.
    pub(super) fn iter(self) -> impl Iterator<Item = (usize, f64)> + Clone + 'a {
        let dofs = self.dofs.iter().map(|&dof| dof as usize);
        dofs.zip(self.arms.iter().copied())
    }

    /// Returns the change of the coordinate with the position of each dof.
    pub(super) fn lengths(self) -> impl Iterator<Item = (usize, f64)> + Clone + 'a {
        let dofs = self.dofs.iter().map(|&dof| dof as usize);
        dofs.zip(self.by_position.iter().copied())
    }

    /// Returns the change of the velocity J v with the position of each dof, at constant v.
    pub(super) fn velocity_changes(self, qvel: &[f64]) -> impl Iterator<Item = (usize, f64)> {
        let dofs = self.dofs.iter().enumerate();
        dofs.map(move |(k, &dof)| (dof as usize, self.change(k, |i| qvel[i])))
    }

    /// Returns the rates of the arm of the k-th dof by the position of each.
    pub(super) fn rates_of(self, k: usize) -> Option<&'a [f64]> {
        self.rates.chunks_exact(self.dofs.len()).nth(k)
    }

    /// Returns Cᵀx: the change of J x with the position of the k-th dof.
    pub(super) fn change(self, k: usize, x: impl Fn(usize) -> f64) -> f64 {
        let rows = self.rates.chunks_exact(self.dofs.len());
        let dofs = self.dofs.iter().map(|&dof| x(dof as usize));
        rows.zip(dofs).map(|(row, x)| row[k] * x).sum()
    }

    /// Subtracts the derivatives of a force from the gradient. `moving` returns the factor of the change of each arm in
    /// the force besides that of its length, `passed` the share of the force that acts along each dof.
    pub(super) fn subtract(
        self,
        (nv, gradient): (usize, &mut ForceDerivatives<'_, f64>),
        force: AlongForce,
        moving: impl Fn(usize) -> f64,
        passed: impl Fn(usize) -> f64,
    ) {
        let lengths = self.iter().zip(self.lengths()).enumerate();
        for (column, ((other, velocity), (_, length))) in lengths {
            let change = force.by_length * length + self.change(column, &moving);
            for (row, (dof, arm)) in self.iter().enumerate() {
                let turned = self.rates_of(row).map_or(0.0, |rates| rates[column]);
                let by_position = arm * change + force.value * turned;
                gradient.add(dof, other, -passed(dof) * by_position);
                let by_velocity = arm * force.by_velocity * velocity;
                gradient.add(dof, nv + other, -passed(dof) * by_velocity);
            }
        }
    }
}
