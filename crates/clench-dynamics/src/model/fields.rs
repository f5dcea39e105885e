//! The fields of [`Params`] by name: the rules of their numbers, and the fields that follow from them.

use super::rule::Rule;
use super::{Coupled, Model, ParamField, Params};
use crate::error::{SimError, check_length};
use clench_collide::{Shape, ShapeKind};
use clench_math::{Real, Scalar};
use std::sync::Arc;

/// The minimum length of axes and quaternions.
const MIN_LENGTH: f64 = 1e-7;

impl ParamField {
    /// Returns the field with a name.
    ///
    /// # Errors
    /// Returns an error if no field has the name.
    pub fn find(name: &str) -> Result<Self, SimError> {
        let all = ParamField::ALL.iter();
        let found = all.clone().find(|field| field.name() == name);
        found
            .copied()
            .ok_or_else(|| SimError::unknown("parameter", name, all.map(|field| field.name())))
    }

    /// Returns its shape in a model, such as (nbody, 3) for `body_inertia`; empty for a single number.
    pub fn shape(self, model: &Model) -> Vec<usize> {
        model.params.shape(self)
    }

    /// Returns the field with a name, for setting it.
    ///
    /// # Errors
    /// Returns an error if no field has the name, or if the field follows from another.
    pub fn settable(name: &str) -> Result<Self, SimError> {
        let found = ParamField::find(name)?;
        let field = found.name();
        match found.rule() {
            Rule::Follows(other) => Err(SimError::Follows { field, other }),
            Rule::Finite
            | Rule::Positive
            | Rule::NotNegative
            | Rule::AsModel
            | Rule::IfModel
            | Rule::Range
            | Rule::Quaternion
            | Rule::Axis => Ok(found),
        }
    }

    /// Returns true if its elements are geoms.
    pub fn is_of_geoms(self) -> bool {
        self.name().starts_with("geom_")
    }

    /// Returns the number of numbers per element, at least one. A single vector, such as gravity, is an element.
    pub fn element_width(self, model: &Model) -> usize {
        let numbers: usize = self.shape(model).iter().skip(1).product();
        numbers.max(model.params.flat(self).element_width())
    }

    /// Returns the fields that follow from this one in a model, and change with it.
    pub fn followers(self, model: &Model) -> &'static [ParamField] {
        let at_sites = || model.equalities.iter().any(|e| e.sites.is_some());
        match self {
            ParamField::body_mass => &[ParamField::body_subtreemass],
            ParamField::geom_size => &[ParamField::geom_rbound],
            ParamField::site_pos if at_sites() => &[ParamField::eq_anchor1, ParamField::eq_anchor2],
            ParamField::site_quat if at_sites() => &[ParamField::eq_quat1, ParamField::eq_quat2],
            _ => &[],
        }
    }

    /// Returns the number of numbers of each direction, if this field holds directions, which are normalized.
    pub fn direction_size(self) -> Option<usize> {
        match self.rule() {
            Rule::Quaternion => Some(4),
            Rule::Axis => Some(3),
            Rule::Range
            | Rule::Finite
            | Rule::Positive
            | Rule::NotNegative
            | Rule::AsModel
            | Rule::IfModel
            | Rule::Follows(_) => None,
        }
    }

    /// Checks the numbers of this field for one environment, and normalizes quaternions and axes.
    ///
    /// # Errors
    /// Returns an error if the length is wrong, or for the first invalid number.
    pub fn check_row<S: Scalar>(self, model: &Model, row: &mut [S]) -> Result<(), SimError> {
        let field = self.name();
        let rule = self.rule();
        let of_model = model.params.read_lane(self, 0);
        check_length(field, row.len(), of_model.len())?;
        for (index, (&value, &of_model)) in row.iter().zip(&of_model).enumerate() {
            if let Some(range) = rule.refuses(value, of_model) {
                let value = value.to_f64();
                return Err(SimError::Parameter {
                    field,
                    index,
                    value,
                    range,
                });
            }
        }
        if self == ParamField::geom_size {
            require_own_sizes(model, field, row)?;
        }
        if rule == Rule::Range {
            return require_rising(field, row);
        }
        let Some(size) = self.direction_size() else {
            return Ok(());
        };
        (row.chunks_exact_mut(size).enumerate())
            .try_for_each(|(i, direction)| normalize(field, size * i, direction))
    }
}

/// Returns true if a shape's size is that of its asset, which is the same in every environment.
fn has_own_size(kind: ShapeKind) -> bool {
    matches!(kind, ShapeKind::Mesh | ShapeKind::HeightField)
}

fn require_own_sizes<S: Scalar>(
    model: &Model,
    field: &'static str,
    row: &[S],
) -> Result<(), SimError> {
    for (g, geom) in model.geoms.iter().enumerate() {
        let own = model.params.geom_size[g].to_array().map(S::new);
        let size = &row[3 * g..][..3];
        if has_own_size(geom.kind) && size != own {
            let axis = (0..3).find(|&i| size[i] != own[i]).unwrap_or(0);
            return Err(SimError::Parameter {
                field,
                index: 3 * g + axis,
                value: size[axis].to_f64(),
                range: "the size of its mesh or height field",
            });
        }
    }
    Ok(())
}

fn require_rising<S: Scalar>(field: &'static str, row: &[S]) -> Result<(), SimError> {
    let falls = |pair: &[S]| pair[0] > pair[1];
    match row.chunks_exact(2).position(falls) {
        None => Ok(()),
        Some(i) => Err(SimError::Parameter {
            field,
            index: 2 * i + 1,
            value: row[2 * i + 1].to_f64(),
            range: "at least the preceding number",
        }),
    }
}

fn normalize<S: Scalar>(
    field: &'static str,
    index: usize,
    direction: &mut [S],
) -> Result<(), SimError> {
    let squared = (direction.iter()).fold(S::ZERO, |sum, &x| sum + x * x);
    let norm = Real::sqrt(squared);
    if !(norm > S::new(MIN_LENGTH) && norm.is_finite()) {
        return Err(SimError::Parameter {
            field,
            index,
            value: direction[0].to_f64(),
            range: "part of a direction whose length is finite and not too small",
        });
    }
    // A unit direction stays as it is, so that numbers that were read and are set again do not change.
    if (squared - S::ONE).abs() > S::new(8.0) * S::EPSILON {
        direction.iter_mut().for_each(|x| *x /= norm);
    }
    Ok(())
}

/// Returns the equalities between sites: their indices, sites and what they couple.
fn between_sites(model: &Model) -> impl Iterator<Item = (usize, [usize; 2], Coupled)> {
    let equalities = model.equalities.iter().enumerate();
    equalities.filter_map(|(i, e)| Some((i, e.sites?, e.target.coupled())))
}

impl<T: Real> Params<T> {
    /// Computes the fields that follow directly from another: the masses of subtrees from those of bodies, the bounding
    /// radii of geoms from their sizes, the frames of equalities between sites from those of the sites. The inverse
    /// inertias `*_invweight0`, which scale constraints, do not change.
    pub fn derive(&mut self, model: &Model, field: ParamField) {
        match field {
            ParamField::body_mass => {
                self.body_subtreemass.clone_from(&self.body_mass);
                for b in (1..model.nbody()).rev() {
                    let mass = self.body_subtreemass[b];
                    self.body_subtreemass[model.bodies[b].parent] += mass;
                }
            }
            ParamField::geom_size => {
                for (g, (geom, &size)) in model.geoms.iter().zip(&self.geom_size).enumerate() {
                    if geom.kind == ShapeKind::Plane || has_own_size(geom.kind) {
                        continue;
                    }
                    let radius = &mut self.geom_rbound[g];
                    let exists = radius.ge(T::ZERO);
                    let derived = Shape::new(geom.kind, size).bounding_radius();
                    *radius = T::select(exists, derived, *radius);
                }
            }
            ParamField::site_pos => {
                for (i, [site1, site2], _) in between_sites(model) {
                    self.eq_anchor1[i] = self.site_pos[site1];
                    self.eq_anchor2[i] = self.site_pos[site2];
                }
            }
            ParamField::site_quat => {
                for (i, [site1, site2], coupled) in between_sites(model) {
                    if let Coupled::Frames(_) = coupled {
                        self.eq_quat1[i] = self.site_quat[site1];
                        self.eq_quat2[i] = self.site_quat[site2];
                    }
                }
            }
            _ => {}
        }
    }
}

impl Model {
    /// Updates the structure of a model whose environments get parameters of their own. Structure lets a step skip
    /// terms that are zero in the model: dry friction of a dof or tendon, inertia and damping that an actuator
    /// reflects, the offset of an inertial frame, [trivial poses](super::SameFrames). If a number in `row` is not zero,
    /// the step must no longer skip it. The model is copied at most once, and only if something changes.
    pub fn clear_structural_guarantees<S: Scalar>(
        model: &mut Arc<Model>,
        field: ParamField,
        row: &[S],
    ) {
        Model::restrict_same_frames(model, field, row);
        let nonzero = |numbers: &[S]| numbers.iter().any(|&x| x != S::ZERO);
        let bodies = || model.bodies.iter().enumerate();
        let shift_inertia: fn(&mut Model, usize) =
            |model, b| model.bodies[b].simple_inertia = false;
        let (change, changes): (fn(&mut Model, usize), Vec<usize>) = match field {
            ParamField::dof_frictionloss => (
                |model, i| model.dofs[i].frictionloss = true,
                (model.dofs.iter().enumerate())
                    .filter(|&(i, dof)| !dof.frictionloss && nonzero(&row[i..=i]))
                    .map(|(i, _)| i)
                    .collect(),
            ),
            ParamField::tendon_frictionloss => (
                |model, t| model.tendons[t].frictionloss = true,
                (model.tendons.iter().enumerate())
                    .filter(|&(i, tendon)| !tendon.frictionloss && nonzero(&row[i..=i]))
                    .map(|(i, _)| i)
                    .collect(),
            ),
            ParamField::actuator_damping
            | ParamField::actuator_dampingpoly
            | ParamField::actuator_armature => {
                let width = row.len() / model.actuators.len().max(1);
                let changes = (0..model.actuators.len())
                    .filter(|&u| !model.reflects(u) && nonzero(&row[width * u..][..width]));
                (Model::let_reflect, changes.collect())
            }
            ParamField::body_ipos => (
                shift_inertia,
                bodies()
                    .filter(|&(b, body)| body.simple_inertia && nonzero(&row[3 * b..][..3]))
                    .map(|(b, _)| b)
                    .collect(),
            ),
            ParamField::body_iquat => (
                shift_inertia,
                bodies()
                    .filter(|&(b, body)| body.simple_inertia && nonzero(&row[4 * b + 1..][..3]))
                    .map(|(b, _)| b)
                    .collect(),
            ),
            // No shortcut of the step depends on the other fields.
            _ => return,
        };
        for i in changes {
            change(Arc::make_mut(model), i);
        }
    }
}
