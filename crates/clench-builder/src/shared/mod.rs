//! Models with the same joints, actuators and sensors in one layout, so that environments of all share lanes.
//!
//! A step branches by structure, which lanes have in common, and computes with parameters, of which each lane has its
//! own. A shared layout has the structure of all models: each body carries as many geoms of each class as the model
//! with the most of them ([`geoms`]). A model without one of these geoms gives it an infinitely negative bounding
//! radius, so that nothing finds it near. The mesh or height field of a geom may differ between models: see
//! [`Model::geom_assets`].

mod assets;
mod compare;
mod difference;
mod geoms;

use assets::Assets;
use clench_dynamics::error::SimError;
use clench_dynamics::model::{Model, ParamField, Params};
use clench_math::Scalar;
use difference::differ;
use geoms::{Alignment, check_measured, rename_geoms};
use std::ops::Range;
use std::sync::Arc;

/// Models that share lanes.
#[derive(Clone, Debug)]
pub struct SharedLayout {
    layout: Arc<Model>,
    models: Vec<Arc<Model>>,
    /// For each model, the index in the layout of each of its geoms.
    geoms: Vec<Vec<usize>>,
}

/// Environments of one model are grouped if more geoms of the world than this differ: a step in lanes of other models
/// recomputes the bounds of the world.
const MANY_STATICS: usize = 32;

/// Consecutive numbers of a parameter field.
#[derive(Clone, Debug, PartialEq)]
pub struct ParamRange {
    /// The field.
    pub field: ParamField,
    /// The numbers, whole elements.
    pub numbers: Range<usize>,
}

impl SharedLayout {
    /// Finds a layout for models.
    ///
    /// # Errors
    /// Returns an error that names two models and the element in which they differ, if they do not have the same
    /// bodies, joints, sites, cameras, tendons, actuators, sensors and constraints, except for their numbers.
    pub fn new(models: &[Arc<Model>]) -> Result<Self, SimError> {
        if models.is_empty() {
            return Err(SimError::NoModel);
        }
        let (mut models, mut assets) = (models.to_vec(), Assets::default());
        let all = models.iter_mut();
        all.for_each(|model| assets.share_meshes(model));
        let alignment = Alignment::new(&models)?;
        let geoms = alignment.geoms();
        let mut layout = Model::clone(&models[0]);
        alignment.lay_out(&mut layout);
        rename_geoms(&mut layout, &geoms[0]);
        assets.rename_meshes(&mut layout);
        for (m, (model, geoms)) in models.iter().zip(&geoms).enumerate().skip(1) {
            let mut renamed = Model::clone(model);
            rename_geoms(&mut renamed, geoms);
            assets.rename_meshes(&mut renamed);
            let same = compare::require_same(&layout, &renamed);
            same.map_err(|difference| differ(&models, m, difference))?;
            compare::generalize(&mut layout, &renamed);
        }
        let slots = layout.geoms.len();
        let own = models.iter().zip(&geoms);
        let lists = own.map(|(model, geoms)| assets.of_geoms(model, geoms, slots));
        layout.geom_assets = lists.collect();
        assets.give_to(&mut layout, alignment.owners());
        check_measured(&models, &geoms, &layout)?;
        let mut shared = SharedLayout {
            layout: Arc::new(layout),
            models,
            geoms,
        };
        shared.general_numbers(alignment.owners());
        Ok(shared)
    }

    /// Returns the shared structure, with the parameters of the first model.
    pub fn layout(&self) -> &Arc<Model> {
        &self.layout
    }

    /// Returns the models.
    pub fn models(&self) -> &[Arc<Model>] {
        &self.models
    }

    /// Returns the index in the layout of each geom of a model.
    pub fn geoms(&self, model: usize) -> &[usize] {
        &self.geoms[model]
    }

    /// Returns true if environments of one model are faster together: a geom has different meshes or height fields in
    /// two models, or many geoms of the world differ in some of the numbers of [`differences`](Self::differences).
    pub fn prefers_groups(&self, differences: &[ParamRange]) -> bool {
        let mut moved = vec![false; self.layout.geoms.len()];
        for ParamRange { field, numbers } in differences {
            let width = match field {
                ParamField::geom_pos => 3,
                ParamField::geom_rbound => 1,
                _ => continue,
            };
            moved[numbers.start / width..numbers.end / width].fill(true);
        }
        let of_world = |body: usize| self.layout.bodies[body].weld == 0;
        let statics = self.layout.geoms.iter().map(|geom| of_world(geom.body));
        let differ = statics
            .zip(moved)
            .filter(|&(is_static, moved)| is_static && moved);
        differ.count() > MANY_STATICS || self.differ_in_assets()
    }

    /// Returns true if a geom has different meshes or height fields in two models.
    fn differ_in_assets(&self) -> bool {
        let models = &self.layout.geom_assets;
        (0..self.layout.geoms.len()).any(|geom| {
            let mut own = models.iter().filter_map(|assets| assets[geom]);
            let first = own.next();
            own.any(|other| Some(other) != first)
        })
    }

    /// Gives the layout numbers for all its geoms, and clears the guarantees that the numbers of some model break.
    fn general_numbers(&mut self, owners: &[(usize, usize)]) {
        let layout = Arc::make_mut(&mut self.layout);
        for &field in ParamField::ALL.iter().filter(|field| field.is_of_geoms()) {
            layout.params.resize(field, layout.geoms.len());
            let rows = self.models.iter();
            let rows = Vec::from_iter(rows.map(|model| model.params.read_lane(field, 0)));
            for (slot, &(model, geom)) in owners.iter().enumerate() {
                let width = rows[model].len() / self.models[model].geoms.len();
                let row = &rows[model][width * geom..][..width];
                layout.params.write_part(field, 0, width * slot, row);
            }
        }
        let params = self.params(0);
        Arc::make_mut(&mut self.layout).params = params;
        for model in 0..self.models.len() {
            let params = self.params(model);
            for &field in ParamField::ALL {
                let row = params.read_lane(field, 0);
                Model::clear_structural_guarantees(&mut self.layout, field, &row);
            }
        }
    }

    /// Returns the parameters of a model in the layout.
    pub fn params(&self, model: usize) -> Params<f64> {
        let (own, geoms) = (&self.models[model], &self.geoms[model]);
        let mut params = self.layout.params.clone();
        let mut present = vec![false; self.layout.geoms.len()];
        geoms.iter().for_each(|&slot| present[slot] = true);
        for absent in (0..present.len()).filter(|&slot| !present[slot]) {
            params.geom_rbound[absent] = f64::NEG_INFINITY;
        }
        for &field in ParamField::ALL {
            let row = own.params.read_lane(field, 0);
            if !field.is_of_geoms() {
                params.write_lane(field, 0, &row);
                continue;
            }
            let width = row.len() / own.geoms.len().max(1);
            for (row, slot) in row.chunks(width.max(1)).zip(geoms) {
                params.write_part(field, 0, width * slot, row);
            }
        }
        params.lane_models = vec![model as u32];
        params
    }

    /// Returns a row of a field in the layout as a row of a model.
    pub fn own_row<S: Scalar>(&self, model: usize, field: ParamField, row: &[S]) -> Vec<S> {
        if !field.is_of_geoms() {
            return row.to_vec();
        }
        let width = row.len() / self.layout.geoms.len().max(1);
        let slots = self.geoms[model].iter();
        slots
            .flat_map(|slot| row[width * slot..][..width].iter().copied())
            .collect()
    }

    /// Writes a row of a field of a model into one of the layout.
    pub fn write_own_row<S: Scalar>(
        &self,
        model: usize,
        field: ParamField,
        own: &[S],
        row: &mut [S],
    ) {
        if !field.is_of_geoms() {
            return row.copy_from_slice(own);
        }
        let width = row.len() / self.layout.geoms.len().max(1);
        for (own, slot) in own.chunks(width.max(1)).zip(&self.geoms[model]) {
            row[width * slot..][..width].copy_from_slice(own);
        }
    }

    /// Returns the numbers in which some models differ, and these numbers of each model.
    pub fn differences(&self) -> (Vec<ParamRange>, Vec<Vec<f64>>) {
        let first = self.params(0);
        let first = Vec::from_iter(
            ParamField::ALL
                .iter()
                .map(|&field| first.read_lane(field, 0)),
        );
        let mut differ = Vec::from_iter(first.iter().map(|row| vec![false; row.len()]));
        for model in 1..self.models.len() {
            let params = self.params(model);
            for ((&field, first), differ) in ParamField::ALL.iter().zip(&first).zip(&mut differ) {
                let row = params.read_lane(field, 0);
                for ((differ, a), b) in differ.iter_mut().zip(first).zip(&row) {
                    *differ |= a.to_bits() != b.to_bits();
                }
            }
        }
        let mut ranges: Vec<ParamRange> = Vec::new();
        for (&field, differ) in ParamField::ALL.iter().zip(&differ) {
            let width = field.element_width(&self.layout);
            let elements = differ.chunks(width).enumerate();
            for (element, _) in elements.filter(|(_, differ)| differ.contains(&true)) {
                let (start, end) = (width * element, width * (element + 1));
                match ranges.last_mut() {
                    Some(last) if last.field == field && last.numbers.end == start => {
                        last.numbers.end = end;
                    }
                    _ => ranges.push(ParamRange {
                        field,
                        numbers: start..end,
                    }),
                }
            }
        }
        let row = |model: usize| {
            let params = self.params(model);
            let part = |range: &ParamRange| {
                params.read_lane(range.field, 0)[range.numbers.clone()].to_vec()
            };
            ranges.iter().flat_map(part).collect()
        };
        let rows = (0..self.models.len()).map(row).collect();
        (ranges, rows)
    }
}
