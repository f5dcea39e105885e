//! Transmissions to sites: a wrench in a site's frame, the pose of a site in the frame of another, slider-cranks.
//!
//! Each length changes with the motions of one or two bodies; its moment arm along a dof is the power of a force and a
//! couple on each body at unit velocity of that dof. Dofs that move both bodies have none, as in MuJoCo.

use crate::dynamics::chains::{Chains, Side};
use crate::dynamics::project::force_at;
use crate::model::{Model, Params};
use crate::stages::Positions;
use clench_math::{Force, Quat, Real, Vec3};

/// A force and a couple, in world axes, at a site.
struct Pull<T> {
    site: usize,
    force: Vec3<T>,
    couple: Vec3<T>,
}

impl<T: Real> Pull<T> {
    #[inline(always)]
    fn body(&self, model: &Model) -> usize {
        model.sites[self.site].body
    }

    /// Returns the spatial force about the reference point of the body's tree.
    #[inline(always)]
    fn spatial(&self, model: &Model, pos: &Positions<T>) -> Force<T> {
        let at = pos.site_xpos[self.site];
        force_at(model, pos, self.body(model), at, self.force, self.couple)
    }
}

/// Computes the moment arms of a wrench along the axes of a site. Such an actuator has no length.
#[inline(always)]
pub(crate) fn wrench_arms<T: Real>(
    model: &Model,
    pos: &Positions<T>,
    site: usize,
    gear: &[T; 6],
    row: &mut [T],
) {
    let axes = &pos.site_xmat[site];
    let pull = Pull {
        site,
        force: *axes * Vec3::from_slice(gear),
        couple: *axes * Vec3::from_slice(&gear[3..]),
    };
    let force = pull.spatial(model, pos);
    let chain = Chains::new(model, [pull.body(model), 0]);
    for ((dof, _), arm) in chain.iter().zip(row) {
        *arm = pos.cdof[dof].dot(force);
    }
}

/// Computes the moment arms, over the dofs that move two bodies relative to each other, of a pull on each.
#[inline(always)]
fn relative_arms<T: Real>(model: &Model, pos: &Positions<T>, pulls: [Pull<T>; 2], row: &mut [T]) {
    let forces = [0, 1].map(|i| pulls[i].spatial(model, pos));
    let bodies = [0, 1].map(|i| pulls[i].body(model));
    let chains = Chains::new(model, bodies).without_common();
    for ((dof, side), arm) in chains.iter().zip(row) {
        *arm = pos.cdof[dof].dot(forces[usize::from(side == Side::Second)]);
    }
}

/// Computes the length and moment arms of the pose of a site in the frame of another: its position along the first
/// three gears, and its rotation vector along the others.
#[inline(always)]
pub(crate) fn relative_pose<T: Real>(
    model: &Model,
    params: &Params<T>,
    pos: &Positions<T>,
    [site, reference]: [usize; 2],
    gear: &[T; 6],
    row: &mut [T],
) -> T {
    let (along, about) = (Vec3::from_slice(gear), Vec3::from_slice(&gear[3..]));
    let axes = &pos.site_xmat[reference];
    let shift = axes.transpose_mul(pos.site_xpos[site] - pos.site_xpos[reference]);
    let rotation = relative_rotation(model, params, pos, [site, reference]);
    let (force, couple) = (*axes * along, *axes * about);
    let pulls = [
        Pull {
            site,
            force,
            couple,
        },
        Pull {
            site: reference,
            force: -force,
            couple: -couple,
        },
    ];
    relative_arms(model, pos, pulls, row);
    shift.dot(along) + rotation.dot(about)
}

/// Returns the rotation vector of a site in the frame of another.
#[inline(always)]
pub(crate) fn relative_rotation<T: Real>(
    model: &Model,
    params: &Params<T>,
    pos: &Positions<T>,
    sites: [usize; 2],
) -> Vec3<T> {
    let [own, other] = [sites[0], sites[1]];
    let own: Quat<T> = pos.xquat[model.sites[own].body] * params.site_quat[own];
    let other: Quat<T> = pos.xquat[model.sites[other].body] * params.site_quat[other];
    own.difference(other)
}

/// Computes the moment arms of a couple about an axis of a site, against another site.
#[inline(always)]
pub(crate) fn turning_arms<T: Real>(
    model: &Model,
    pos: &Positions<T>,
    [site, reference]: [usize; 2],
    axis: usize,
    row: &mut [T],
) {
    let couple = pos.site_xmat[site].column(axis);
    let pull = |site: usize, couple: Vec3<T>| Pull {
        site,
        force: Vec3::ZERO,
        couple,
    };
    relative_arms(
        model,
        pos,
        [pull(site, couple), pull(reference, -couple)],
        row,
    );
}

/// Computes the length and moment arms of a slider-crank: a rod of length r joins the crank's pin, at v from the
/// slider's site, to a slider on the axis z of that site, at
///
/// ```text
/// s = a − √w,   a = v · z,   w = a² + r² − v²        ∂s/∂v = (1 − a/√w) z + v/√w        ∂s/∂z = (1 − a/√w) v
/// ```
///
/// If the rod is too short to reach the axis, the slider is at a, next to the pin.
#[inline(always)]
pub(crate) fn slider_crank<T: Real>(
    model: &Model,
    params: &Params<T>,
    pos: &Positions<T>,
    actuator: usize,
    [crank, slider]: [usize; 2],
    row: &mut [T],
) -> T {
    let (rod, gear) = (
        params.actuator_cranklength[actuator],
        params.actuator_gear[actuator][0],
    );
    let axis = pos.site_xmat[slider].column(2);
    let offset = pos.site_xpos[crank] - pos.site_xpos[slider];
    let along = offset.dot(axis);
    let squared = along * along + rod * rod - offset.norm_squared();
    let reaches = squared.gt(T::ZERO);
    let root = T::select(reaches, squared, T::ONE).sqrt();
    let inverse = T::select(reaches, T::ONE / root, T::ZERO);
    let lean = T::ONE - along * inverse;
    let by_offset = (axis * lean + offset * inverse) * gear;
    let by_axis = offset * (lean * gear);
    let pulls = [
        Pull {
            site: crank,
            force: by_offset,
            couple: Vec3::ZERO,
        },
        Pull {
            site: slider,
            force: -by_offset,
            couple: axis.cross(by_axis),
        },
    ];
    relative_arms(model, pos, pulls, row);
    (along - T::select(reaches, root, T::ZERO)) * gear
}
