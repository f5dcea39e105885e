//! The trivial fixed poses of a model, which kinematics need not compose (MuJoCo's `sameframe`).
//!
//! Most joints are anchored at the origin of their body, and most bodies, geoms and sites are aligned with their parent
//! or body. Skipping a trivial pose gives the composed one to the bit, except for the sign of zeros.

use super::{Model, ParamField, Params};
use clench_math::{Quat, Scalar, Vec3};
use std::sync::Arc;

/// The fixed poses that are trivial.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SameFrames {
    /// Bodies aligned with their parent before their joints act (nbody).
    pub bodies: Vec<bool>,
    /// Joints anchored at the origin of their body (njnt).
    pub joints: Vec<bool>,
    /// Geoms aligned with their body (ngeom).
    pub geoms: Vec<bool>,
    /// Sites aligned with their body (nsite).
    pub sites: Vec<bool>,
}

impl SameFrames {
    /// Finds the trivial poses of a model's parameters.
    pub fn of(params: &Params<f64>) -> Self {
        let along = |quats: &[Quat<f64>]| quats.iter().map(|&q| q == Quat::IDENTITY).collect();
        let centred = |anchor: &Vec3<f64>| anchor.to_array() == [0.0; 3];
        SameFrames {
            bodies: along(&params.body_quat),
            joints: params.jnt_pos.iter().map(centred).collect(),
            geoms: along(&params.geom_quat),
            sites: along(&params.site_quat),
        }
    }

    /// Returns the flags that a field determines, and the trivial numbers of an element.
    fn decided_by(&mut self, field: ParamField) -> Option<(&mut Vec<bool>, &'static [f64])> {
        const ORIGIN: &[f64] = &[0.0; 3];
        const ALONG: &[f64] = &[1.0, 0.0, 0.0, 0.0];
        match field {
            ParamField::body_quat => Some((&mut self.bodies, ALONG)),
            ParamField::jnt_pos => Some((&mut self.joints, ORIGIN)),
            ParamField::geom_quat => Some((&mut self.geoms, ALONG)),
            ParamField::site_quat => Some((&mut self.sites, ALONG)),
            _ => None,
        }
    }

    /// Clears the flags that no longer hold if an environment has the numbers `row` in a field.
    fn restrict<S: Scalar>(&mut self, field: ParamField, row: &[S]) {
        if let Some((same, trivial)) = self.decided_by(field) {
            for (same, numbers) in same.iter_mut().zip(row.chunks_exact(trivial.len())) {
                *same &= numbers
                    .iter()
                    .map(|x| x.to_f64())
                    .eq(trivial.iter().copied());
            }
        }
    }
}

impl Model {
    /// Clears the flags that no longer hold with an environment's numbers of a field. The model is copied only if
    /// something changes.
    pub fn restrict_same_frames<S: Scalar>(model: &mut Arc<Model>, field: ParamField, row: &[S]) {
        let mut same = model.same_frames.clone();
        same.restrict(field, row);
        Model::set_same_frames(model, same);
    }

    /// Clears all flags, for arbitrary numbers.
    pub fn invalidate_same_frames(model: &mut Arc<Model>) {
        let mut same = model.same_frames.clone();
        for all in [
            &mut same.bodies,
            &mut same.joints,
            &mut same.geoms,
            &mut same.sites,
        ] {
            all.fill(false);
        }
        Model::set_same_frames(model, same);
    }

    fn set_same_frames(model: &mut Arc<Model>, same: SameFrames) {
        if model.same_frames != same {
            Arc::make_mut(model).same_frames = same;
        }
    }
}
