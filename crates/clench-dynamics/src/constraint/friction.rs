//! Dry friction of dofs and tendons: a force of at most η against the motion.
//!
//! ```text
//! r = 0        J = ∂q_i/∂q  or  ∂length/∂q        aref = −b v        cost: Huber of loss η
//! ```
//!
//! The slope R applies at small accelerations, so sticking friction creeps. With the option `stiction`, r is the
//! displacement since it stuck, and aref = −b v − k d r: see the module `stiction`. The impedance is that at zero
//! violation; A₀ is the inverse weight of the dof or tendon.

use super::Softness;
use super::assembly::Assembly;
use super::context::ConstraintContext;
use super::coordinate::Coordinate;
use super::row::Row;
use crate::record::{BlockRecord, ConstraintSource};
use clench_math::{Mask, Real, kernel};
use clench_solver::Cost;

/// Appends the friction of all dofs, then of all tendons.
#[kernel]
pub(super) fn push_all<T: Real>(context: &ConstraintContext<T>, out: &mut Assembly<T>) {
    let (model, params) = (context.model, context.params);
    for (i, dof) in model.dofs.iter().enumerate() {
        if !dof.frictionloss {
            continue;
        }
        let dofs = out.dofs();
        dofs.clear();
        dofs.push(i as u32);
        let friction = Friction {
            source: ConstraintSource::DofFriction(i),
            index: i,
            awake: context.sleep.is_awake(model.tree.tree_of(i)),
            loss: params.dof_frictionloss[i],
            solref: params.dof_solref[i],
            solimp: params.dof_solimp[i],
            a0: params.dof_invweight0[i],
        };
        friction.push(context, out, |_, jacobian| jacobian[0] = T::ONE);
    }
    for (i, tendon) in model.tendons.iter().enumerate() {
        if !tendon.frictionloss {
            continue;
        }
        let coordinate = Coordinate::Tendon(i);
        let dofs = out.dofs();
        dofs.clear();
        coordinate.insert_dofs(context, dofs);
        let friction = Friction {
            source: ConstraintSource::TendonFriction(i),
            index: model.nv + i,
            awake: context.awake([coordinate]),
            loss: params.tendon_frictionloss[i],
            solref: params.tendon_solref_fri[i],
            solimp: params.tendon_solimp_fri[i],
            a0: params.tendon_invweight0[i],
        };
        friction.push(context, out, |dofs, jacobian| {
            coordinate.add_gradient(context, dofs, T::ONE, jacobian);
        });
    }
}

/// Computes the softness and the row of a friction, without displacement, from its solref, solimp and inverse weight.
#[inline(always)]
pub(super) fn soft_row<T: Real>(
    min_timeconst: T,
    (solref, solimp, a0): ([T; 2], [T; 5], T),
    loss: T,
) -> (Softness<T>, Row<T>) {
    let soft = Softness::new(solref, solimp, T::ZERO, min_timeconst);
    let row = Row {
        shape: loss,
        stiffness: T::ZERO,
        ..Row::new(&soft, T::ZERO, T::ZERO, a0)
    };
    (soft, row)
}

struct Friction<T: Real> {
    source: ConstraintSource,
    /// The index in `State::stick_friction`.
    index: usize,
    /// The lanes in which any object that it brakes is awake.
    awake: T::Mask,
    loss: T,
    solref: [T; 2],
    solimp: [T; 5],
    a0: T,
}

impl<T: Real> Friction<T> {
    #[inline(always)]
    fn push(
        self,
        context: &ConstraintContext<T>,
        out: &mut Assembly<T>,
        fill: impl FnOnce(&[u32], &mut [T]),
    ) {
        let active = self.awake & self.loss.gt(T::ZERO);
        if !active.any() {
            return;
        }
        let numbers = (self.solref, self.solimp, self.a0);
        let (soft, mut row) = soft_row(context.min_timeconst, numbers, self.loss);
        if context.stiction.is_some() {
            let displacement = context.state.stick_friction[self.index];
            row = Row {
                pos: displacement,
                aref: -soft.stiffness * displacement,
                stiffness: soft.stiffness,
                ..row
            };
        }
        let block = BlockRecord {
            source: self.source,
            active,
            margin: T::ZERO,
            impedance: soft.impedance,
        };
        out.push(Cost::Huber, block, &[row], fill);
    }
}
