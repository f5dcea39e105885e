//! The geoms of several models in one layout.
//!
//! A geom of the layout stands for at most one geom of each model, of the same class: the part of a geom's structure
//! that a step reads. The geoms of a body keep their order in every model, so that the contacts of an environment have
//! the same order as in its own model. The geoms of each body are therefore a common supersequence of those of all
//! models: model by model, the longest common subsequence with the layout so far is shared, where geoms of equal names
//! count more and the rest is inserted.

use super::difference::differ;
use clench_collide::ShapeKind;
use clench_dynamics::error::SimError;
use clench_dynamics::model::{
    Appearance, ContactSide, FrameObject, Geom, Model, SensorTarget, Wrap,
};
use std::sync::Arc;

/// The value of two geoms of one class that share a slot.
const MATCH: u32 = 2;
/// The additional value if they have the same name, or none.
const SAME_NAME: u32 = 3;
/// The maximum size of the table of values of a body's geoms; longer lists share the first slots.
const MAX_TABLE: usize = 1 << 20;

/// The structure of a geom that lanes must have in common.
#[derive(Clone, Copy, PartialEq)]
struct Class {
    kind: ShapeKind,
    bits: [u32; 2],
    condim: u32,
    priority: i32,
    group: i32,
    visible: bool,
    fluid_ellipsoid: bool,
}

impl Class {
    fn of(geom: &Geom) -> Self {
        Class {
            kind: geom.kind,
            bits: [geom.contype, geom.conaffinity],
            condim: geom.condim,
            priority: geom.priority,
            group: geom.group,
            visible: geom.visible,
            fluid_ellipsoid: geom.fluid_ellipsoid,
        }
    }
}

/// A geom of the layout: the first geom that it stands for, and the order of its creation.
#[derive(Clone)]
struct Slot {
    geom: Geom,
    appearance: Appearance,
    owner: (usize, usize),
    number: usize,
}

/// The geoms of the layout by body, and those that stand for the geoms of each model.
pub(super) struct Alignment {
    bodies: Vec<Vec<Slot>>,
    owners: Vec<(usize, usize)>,
    /// For each model, the number of the slot of each geom.
    slots: Vec<Vec<usize>>,
}

impl Alignment {
    /// Aligns the geoms of models.
    ///
    /// # Errors
    /// Returns an error if the models differ in their number of bodies.
    pub(super) fn new(models: &[Arc<Model>]) -> Result<Self, SimError> {
        let mut bodies = vec![Vec::new(); models[0].nbody()];
        let (mut count, mut slots) = (0, Vec::new());
        for (m, model) in models.iter().enumerate() {
            if model.nbody() != bodies.len() {
                let [first, other] = [&models[0], model].map(|model| model.nbody());
                return Err(differ(models, m, format!("{first} and {other} bodies")));
            }
            let mut own = Vec::new();
            for (body, merged) in model.bodies.iter().zip(&mut bodies) {
                let geoms = body.geoms.clone().map(|g| Slot {
                    geom: model.geoms[g].clone(),
                    appearance: model.visuals.geoms.get(g).copied().unwrap_or_default(),
                    owner: (m, g),
                    number: usize::MAX,
                });
                own.extend(merge(merged, geoms.collect(), &mut count));
            }
            slots.push(own);
        }
        let mut alignment = Alignment {
            bodies,
            owners: Vec::new(),
            slots,
        };
        let mut index_in_layout = vec![0; count];
        for (index, slot) in alignment.bodies.iter().flatten().enumerate() {
            index_in_layout[slot.number] = index;
            alignment.owners.push(slot.owner);
        }
        let all = alignment.slots.iter_mut().flatten();
        all.for_each(|slot| *slot = index_in_layout[*slot]);
        Ok(alignment)
    }

    /// Returns, for each model, the slot in the layout of each geom.
    pub(super) fn geoms(&self) -> Vec<Vec<usize>> {
        self.slots.clone()
    }

    /// Returns the model and the geom whose numbers each geom of the layout has in the models without it.
    pub(super) fn owners(&self) -> &[(usize, usize)] {
        &self.owners
    }

    /// Replaces the geoms of a model by those of the layout.
    pub(super) fn lay_out(&self, model: &mut Model) {
        model.geoms.clear();
        model.visuals.geoms.clear();
        for (body, slots) in model.bodies.iter_mut().zip(&self.bodies) {
            let start = model.geoms.len();
            model
                .geoms
                .extend(slots.iter().map(|slot| slot.geom.clone()));
            (model.visuals.geoms).extend(slots.iter().map(|slot| slot.appearance));
            body.geoms = start..model.geoms.len();
        }
        model.same_frames.geoms = vec![true; model.geoms.len()];
    }
}

/// Merges the geoms of a body of a further model into those of the layout. Returns the number of the slot of each.
fn merge(merged: &mut Vec<Slot>, own: Vec<Slot>, count: &mut usize) -> Vec<usize> {
    let (mut all, mut numbers) = (Vec::new(), Vec::new());
    let mut next = 0;
    for (slot, shared) in own.iter().zip(shared_slots(merged, &own)) {
        let end = shared.unwrap_or(next);
        all.extend_from_slice(&merged[next..end]);
        next = end;
        match shared {
            Some(shared) => {
                all.push(merged[shared].clone());
                next += 1;
            }
            None => {
                all.push(Slot {
                    number: *count,
                    ..slot.clone()
                });
                *count += 1;
            }
        }
        numbers.extend(all.last().map(|slot| slot.number));
    }
    all.extend_from_slice(&merged[next..]);
    *merged = all;
    numbers
}

/// Returns the slot in `merged` that each geom of a further model shares, in ascending order; `None` for a new geom.
fn shared_slots(merged: &[Slot], own: &[Slot]) -> Vec<Option<usize>> {
    // Most models agree in most geoms.
    let is_same = |(a, b): &(&Slot, &Slot)| value(a, b) == Some(MATCH + SAME_NAME);
    let start = merged.iter().zip(own).take_while(is_same).count();
    let (merged_rest, own_rest) = (&merged[start..], &own[start..]);
    let rest = match merged_rest.len().saturating_mul(own_rest.len()) {
        0..=MAX_TABLE => best_slots(merged_rest, own_rest),
        _ => first_slots(merged_rest, own_rest),
    };
    let rest = rest.into_iter().map(|slot| slot.map(|slot| start + slot));
    (0..start).map(Some).chain(rest).collect()
}

/// Returns the value of two geoms that share a slot, if they can.
fn value(a: &Slot, b: &Slot) -> Option<u32> {
    let matches = Class::of(&a.geom) == Class::of(&b.geom);
    let named = a.geom.name == b.geom.name;
    matches.then_some(MATCH + if named { SAME_NAME } else { 0 })
}

/// Returns the slots of greatest total value, by dynamic programming.
fn best_slots(merged: &[Slot], own: &[Slot]) -> Vec<Option<usize>> {
    // The greatest value of the geoms from i and j on.
    let mut best = vec![vec![0; own.len() + 1]; merged.len() + 1];
    for i in (0..merged.len()).rev() {
        for j in (0..own.len()).rev() {
            let shared = value(&merged[i], &own[j]).map_or(0, |value| value + best[i + 1][j + 1]);
            best[i][j] = shared.max(best[i + 1][j]).max(best[i][j + 1]);
        }
    }
    let mut i = 0;
    let find_slot = |j: usize| {
        while i < merged.len() && best[i][j] > best[i][j + 1] {
            i += 1;
            let shared = value(&merged[i - 1], &own[j]).map(|value| value + best[i][j + 1]);
            if shared == Some(best[i - 1][j]) {
                return Some(i - 1);
            }
        }
        None
    };
    (0..own.len()).map(find_slot).collect()
}

/// Returns for each geom the first slot of its class after the slot of the geom before it.
fn first_slots(merged: &[Slot], own: &[Slot]) -> Vec<Option<usize>> {
    let mut next = 0;
    let find_slot = |slot: &Slot| {
        let mut rest = merged[next..].iter();
        let found = rest.position(|other| value(other, slot).is_some())?;
        next += found + 1;
        Some(next - 1)
    };
    own.iter().map(find_slot).collect()
}

/// Replaces the indices of geoms in a model's references by those in the layout.
pub(super) fn rename_geoms(model: &mut Model, geoms: &[usize]) {
    let wraps = model.tendons.iter_mut().flat_map(|tendon| &mut tendon.path);
    for wrap in wraps {
        if let Wrap::Geom { geom, .. } = wrap {
            *geom = geoms[*geom];
        }
    }
    let pairs = model.pairs.iter_mut().flat_map(|pair| &mut pair.geoms);
    pairs.for_each(|geom| *geom = geoms[*geom]);
    let frame = |object: &mut FrameObject| {
        if let FrameObject::Geom(geom) = object {
            *geom = geoms[*geom];
        }
    };
    for sensor in &mut model.sensors {
        match &mut sensor.target {
            SensorTarget::Frame { object, reference } => {
                frame(object);
                reference.as_mut().map(frame);
            }
            SensorTarget::Inside { object, .. } => frame(object),
            SensorTarget::Taxels { geom, .. } => *geom = geoms[*geom],
            SensorTarget::Geoms(sets) => {
                for set in sets.iter_mut().filter(|set| set.start < set.end) {
                    *set = geoms[set.start]..geoms[set.end - 1] + 1;
                }
            }
            SensorTarget::Contacts(query) => {
                for side in &mut query.sides {
                    if let ContactSide::Geom(geom) = side {
                        *geom = geoms[*geom];
                    }
                }
            }
            SensorTarget::Nothing
            | SensorTarget::Element(_)
            | SensorTarget::Projection { .. }
            | SensorTarget::Rays { .. } => {}
        }
    }
}

/// Checks that all models have the same geoms and assets where a sensor measures distances or volumes.
///
/// # Errors
/// Returns an error that names a sensor and two models.
pub(super) fn check_measured(
    models: &[Arc<Model>],
    geoms: &[Vec<usize>],
    layout: &Model,
) -> Result<(), SimError> {
    for sensor in &layout.sensors {
        let measured: Vec<usize> = match &sensor.target {
            SensorTarget::Geoms(sets) => sets.iter().cloned().flatten().collect(),
            SensorTarget::Inside {
                object,
                enclosed: true,
                ..
            } => object.enclosed_geoms(layout).collect(),
            SensorTarget::Taxels { geom, .. } => vec![*geom],
            SensorTarget::Inside { .. }
            | SensorTarget::Nothing
            | SensorTarget::Element(_)
            | SensorTarget::Frame { .. }
            | SensorTarget::Projection { .. }
            | SensorTarget::Rays { .. }
            | SensorTarget::Contacts(_) => continue,
        };
        let assets = &layout.geom_assets;
        let differs = |&m: &usize| {
            let differs = |&g: &usize| !geoms[m].contains(&g) || assets[m][g] != assets[0][g];
            measured.iter().any(differs)
        };
        if let Some(other) = (0..models.len()).find(differs) {
            let name = &sensor.name;
            let difference = format!("the geoms that sensor \"{name}\" measures");
            return Err(differ(models, other, difference));
        }
    }
    Ok(())
}
