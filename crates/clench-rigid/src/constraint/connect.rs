//! Connect: two points, one on each body, coincide.
//!
//! ```text
//! r = p₁ − p₂        J = ∂p₁/∂q − ∂p₂/∂q        r̈ = J a + J̇ v   ⇒   aref = −b J v − k d r − J̇ v
//! ```
//!
//! J̇ v is what the points accelerate by while no dof does: the spatial bias acceleration of each body, taken to the
//! point, plus ω × ṗ. The impedance is that of the violation's length; A₀ the sum of the bodies' translational inverse
//! weights.

use super::assembly::{Assembly, BlockRecord, ConstraintSource, Row};
use super::chains::{BodyPoint, Chains, Side};
use super::{Scene, Softness};
use clench_math::{Real, Vec3};
use clench_solver::Cost;

pub(super) fn push<T: Real>(
    scene: &Scene<T>,
    out: &mut Assembly<T>,
    equality: usize,
    bodies: [usize; 2],
) {
    let chains = Chains::new(scene, bodies);
    chains.collect(out.dofs());
    if out.dofs().is_empty() {
        return;
    }
    let points = anchors(scene, equality, bodies);
    let (violation, offsets, bias) = separation(scene, bodies, points);
    let params = scene.params;
    let soft = Softness::new(
        params.eq_solref[equality],
        params.eq_solimp[equality],
        violation.norm(),
        scene.least_timeconst,
    );
    let a0 = bodies.map(|b| params.body_invweight0[b][0]);
    let rows: [Row<T>; 3] = std::array::from_fn(|i| {
        let row = Row::new(&soft, violation[i], T::ZERO, a0[0] + a0[1]);
        Row {
            aref: row.aref - bias[i],
            ..row
        }
    });
    let block = BlockRecord {
        source: ConstraintSource::Equality(equality),
        active: scene.state.eq_active[equality],
        margin: T::ZERO,
        impedance: soft.impedance,
    };
    out.push(Cost::Quadratic, block, &rows, |_, jacobian| {
        fill_translation(scene, &chains, offsets, jacobian);
    });
}

/// The anchors of a connect or weld in the world.
pub(super) fn anchors<T: Real>(
    scene: &Scene<T>,
    equality: usize,
    [body1, body2]: [usize; 2],
) -> [Vec3<T>; 2] {
    let (pos, params) = (scene.position, scene.params);
    [
        pos.xpos[body1] + pos.xmat[body1] * params.eq_anchor1[equality],
        pos.xpos[body2] + pos.xmat[body2] * params.eq_anchor2[equality],
    ]
}

/// The separation of two points of two bodies, their offsets from the reference points of their trees, and the
/// acceleration of the separation while no dof accelerates.
pub(super) fn separation<T: Real>(
    scene: &Scene<T>,
    bodies: [usize; 2],
    points: [Vec3<T>; 2],
) -> (Vec3<T>, [Vec3<T>; 2], Vec3<T>) {
    let moving = [0, 1].map(|i| BodyPoint::new(scene, bodies[i], points[i]));
    let bias = moving.map(|point| point.bias_acceleration(scene).linear);
    (
        points[0] - points[1],
        moving.map(|point| point.offset),
        bias[0] - bias[1],
    )
}

/// Rows 0 to 2 of a Jacobian: velocity of the first point less that of the second.
pub(super) fn fill_translation<T: Real>(
    scene: &Scene<T>,
    chains: &Chains,
    offsets: [Vec3<T>; 2],
    jacobian: &mut [T],
) {
    let ndof = chains.iter().count();
    for (column, (dof, side)) in chains.iter().enumerate() {
        let axis = scene.position.cdof[dof];
        let velocity = match side {
            Side::Both => axis.velocity_at(offsets[0]) - axis.velocity_at(offsets[1]),
            Side::First => axis.velocity_at(offsets[0]),
            Side::Second => -axis.velocity_at(offsets[1]),
        };
        for i in 0..3 {
            jacobian[i * ndof + column] = velocity[i];
        }
    }
}
