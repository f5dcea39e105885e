//! The structure that models of one layout have in common.

use clench_dynamics::model::Model;

/// The first field in which two elements differ, and their names.
type Difference<'a> = Option<(&'static str, [&'a str; 2])>;

/// Returns the name of the first field in which two elements differ.
macro_rules! first_difference {
    ($a:ident, $b:ident: $($field:ident)*) => {
        None$(.or_else(|| ($a.$field != $b.$field).then_some(stringify!($field))))*
    };
}

/// Compares the given fields of the elements of a list.
macro_rules! compare {
    ($a:ident, $b:ident, $kind:literal in $list:ident: $($field:ident)*) => {
        compare($kind, [$a.$list.len(), $b.$list.len()], &|i| {
            let (a, b) = (&$a.$list[i], &$b.$list[i]);
            let field = first_difference!(a, b: $($field)*)?;
            Some((field, [&a.name[..], &b.name]))
        })
    };
}

/// Compares two lists of elements of a kind, of some lengths. Returns a description of the first difference.
fn compare<'a>(
    kind: &str,
    [a, b]: [usize; 2],
    difference: &dyn Fn(usize) -> Difference<'a>,
) -> Result<(), String> {
    for i in 0..a.min(b) {
        if let Some((field, names)) = difference(i) {
            let [a, b] = names.map(|name| match name {
                "" => format!("{kind} {i}"),
                name => format!("{kind} {i}, \"{name}\""),
            });
            let field = field.replace('_', " ");
            return Err(match a == b {
                true => format!("the {field} of {a}"),
                false => format!("the {field} of {a} in one and {b} in the other"),
            });
        }
    }
    match a == b {
        true => Ok(()),
        false => Err(format!("{a} and {b} of kind {kind}")),
    }
}

/// Checks that a model has the structure of a layout. Both name the geoms of the layout.
///
/// # Errors
/// Returns a description of the first element that differs.
pub(super) fn require_same(a: &Model, b: &Model) -> Result<(), String> {
    compare!(a, b, "joint" in joints: name kind body qpos dof plastic limited actfrclimited actgravcomp)?;
    compare!(a, b, "body" in bodies: parent weld joints dofs sites cameras mocap fluid_ellipsoids)?;
    require_same_drag(a, b)?;
    compare!(a, b, "site" in sites: body kind mesh)?;
    compare!(a, b, "camera" in cameras: body mode orthographic resolution intrinsic)?;
    compare("tree", [a.trees.len(), b.trees.len()], &|i| {
        let (a, b) = (&a.trees[i], &b.trees[i]);
        let field = first_difference!(a, b: bodies qpos dofs mocap sleep)?;
        Some((field, ["", ""]))
    })?;
    compare!(a, b, "tendon" in tendons: path coefs plastic limited actfrclimited)?;
    compare!(a, b, "actuator" in actuators: name transmission dynamics acts outputs gain bias states controls inputs
        ctrllimited history forcelimited actlimited actearly disabled)?;
    compare!(a, b, "sensor" in sensors: name kind target data cutoff numbers history phase)?;
    compare!(a, b, "equality" in equalities: target sites pose_at_qpos0 active0)?;
    compare!(a, b, "pair" in pairs: geoms condim)?;
    let whole = first_difference!(a, b: integrator flags options override_contacts max_dynamic_constraints
        max_stick_pairs nq nv na nplastic nhistory nmocap tree tendon_ties excludes);
    match whole {
        Some(field) => Err(format!("their {}", field.replace('_', " "))),
        None => Ok(()),
    }
}

/// Compares the numbers that determine the derivative of a medium's drag.
fn require_same_drag(a: &Model, b: &Model) -> Result<(), String> {
    let drags = |model: &Model| model.params.density != 0.0 || model.params.viscosity != 0.0;
    match drags(a) || drags(b) {
        true => compare!(a, b, "body" in bodies: diagonal_inertia),
        false => Ok(()),
    }
}

/// Clears the shortcuts of a layout that a model of the same structure does not allow.
pub(super) fn generalize(layout: &mut Model, model: &Model) {
    for (all, one) in layout.bodies.iter_mut().zip(&model.bodies) {
        all.simple_inertia &= one.simple_inertia;
        all.diagonal_inertia &= one.diagonal_inertia;
        all.never_simple |= one.never_simple;
    }
    for (all, one) in layout.dofs.iter_mut().zip(&model.dofs) {
        all.frictionloss |= one.frictionloss;
    }
    for (all, one) in layout.tendons.iter_mut().zip(&model.tendons) {
        all.frictionloss |= one.frictionloss;
        unite(&mut all.reflecting, &one.reflecting);
    }
    for (all, one) in layout.joints.iter_mut().zip(&model.joints) {
        unite(&mut all.reflecting, &one.reflecting);
    }
    for (all, one) in [
        (&mut layout.same_frames.bodies, &model.same_frames.bodies),
        (&mut layout.same_frames.joints, &model.same_frames.joints),
        (&mut layout.same_frames.sites, &model.same_frames.sites),
    ] {
        all.iter_mut().zip(one).for_each(|(all, &one)| *all &= one);
    }
    let (budget, other) = (&mut layout.budget, &model.budget);
    budget.contacts = budget.contacts.max(other.contacts);
    budget.matrix = budget.matrix.max(other.matrix);
}

/// Adds indices to an ascending list.
fn unite(all: &mut Vec<usize>, other: &[usize]) {
    all.extend_from_slice(other);
    all.sort_unstable();
    all.dedup();
}
