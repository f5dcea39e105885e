//! Kinematic trees: their sleep policies, the speed scale of their dofs, and their initial sleep.

use super::check::describe;
use super::element::Element;
use super::model_builder::ModelBuilder;
use super::{BodySpec, BuildError};
use clench_dynamics::contact::check_supported;
use clench_dynamics::context::StepContext;
use clench_dynamics::model::{KinematicTree, Model, SleepPolicy, Transmission};
use clench_dynamics::options::RigidOptions;
use clench_dynamics::settings::StepSettings;
use clench_dynamics::sleep::{AWAKE, READY};
use clench_dynamics::state::State;
use clench_dynamics::workspace::Workspace;
use clench_dynamics::{pipeline, sleep};

/// Finds the trees, and resolves which may sleep.
///
/// # Errors
/// Returns an error for a policy of a body that is not the root of a tree, or a policy that permits sleep of a tree
/// that a tendon couples to another.
pub(super) fn add_trees(
    builder: &ModelBuilder,
    order: &[usize],
    model: &mut Model,
) -> Result<(), BuildError> {
    find_trees(model);
    for (b, &old) in order.iter().enumerate() {
        let spec = &builder.bodies[old];
        if spec.sleep == SleepPolicy::Auto {
            continue;
        }
        let Some(tree) = tree_of_root(model, b) else {
            return Err(not_a_root(spec));
        };
        model.trees[tree].sleep = spec.sleep;
    }
    let mut driven = Vec::new();
    for actuator in &model.actuators {
        // Only the first of two sites counts, as in MuJoCo.
        let body = match actuator.transmission {
            Transmission::Joint(j) | Transmission::JointInParent(j) | Transmission::Rotation(j) => {
                model.joints[j].body
            }
            Transmission::Site(site)
            | Transmission::SiteInFrame([site, _])
            | Transmission::RotationInFrame([site, _])
            | Transmission::SliderCrank([site, _]) => model.sites[site].body,
            Transmission::Body(body) => body,
            Transmission::Tendon(tendon) => {
                driven.extend(model.trees_of(model.tendon_dofs.dofs(tendon)));
                continue;
            }
        };
        driven.extend(model.tree_of_body(body));
    }
    for tree in driven {
        prevent_sleep(&mut model.trees[tree]);
    }
    for (t, spec) in builder.tendons.iter().enumerate() {
        let trees = model.trees_of(model.tendon_dofs.dofs(t));
        model
            .tendon_ties
            .push(<[usize; 2]>::try_from(&trees[..]).ok());
        let p = &model.params;
        let linear = [p.tendon_stiffness[t], p.tendon_damping[t]];
        let others = p.tendon_stiffnesspoly[t]
            .into_iter()
            .chain(p.tendon_dampingpoly[t]);
        let pulls = linear.into_iter().chain(others).any(|number| number != 0.0);
        if trees.len() < 2 || (trees.len() == 2 && !pulls) {
            continue;
        }
        for tree in trees {
            if let SleepPolicy::Allowed | SleepPolicy::Init = model.trees[tree].sleep {
                return Err(
                    spec.error("acts on several trees and would not wake one of them that sleeps")
                );
            }
            prevent_sleep(&mut model.trees[tree]);
        }
    }
    for tree in &mut model.trees {
        if tree.sleep == SleepPolicy::Auto {
            tree.sleep = SleepPolicy::Allowed;
        }
    }
    Ok(())
}

/// Sets the policy of a tree that can move undetected to `Never`, unless the model specifies one.
fn prevent_sleep(tree: &mut KinematicTree) {
    if tree.sleep == SleepPolicy::Auto {
        tree.sleep = SleepPolicy::Never;
    }
}

fn find_trees(model: &mut Model) {
    model.trees = Vec::with_capacity(model.tree.ntree());
    for (b, body) in model.bodies.iter().enumerate() {
        let Some(tree) = model.tree_of_body(b) else {
            continue;
        };
        if tree == model.trees.len() {
            model.trees.push(KinematicTree {
                bodies: b..b,
                qpos: model.joints[body.joints.start].qpos..0,
                dofs: body.dofs.start..0,
                mocap: model.bodies[body.root].mocap,
                sleep: SleepPolicy::Auto,
            });
        }
        let last = model.joints[..body.joints.end].last();
        let tree = &mut model.trees[tree];
        tree.bodies.end = b + 1;
        if let Some(joint) = last {
            tree.qpos.end = joint.qpos + joint.kind.nq();
            tree.dofs.end = joint.dof + joint.kind.nv();
        }
    }
}

/// Returns the tree of which a body is the root.
fn tree_of_root(model: &Model, body: usize) -> Option<usize> {
    let tree = model.tree_of_body(body)?;
    (model.trees[tree].bodies.start == body).then_some(tree)
}

fn not_a_root(spec: &BodySpec) -> BuildError {
    spec.error("has a sleep policy, but is not the moving root of a tree")
}

/// Deactivates the trees that begin asleep. Islands sleep as a whole: if one tree of an island begins awake, all do,
/// and a note reports it.
///
/// # Errors
/// Returns an error if options are out of range.
pub(super) fn begin_asleep(model: &mut Model) -> Result<(), BuildError> {
    if !model.flags.sleep {
        return Ok(());
    }
    model.tree_asleep0 = vec![AWAKE; model.ntree()];
    let begins_asleep = |tree: &KinematicTree| tree.sleep == SleepPolicy::Init;
    if !model.trees.iter().any(begins_asleep) {
        return Ok(());
    }
    let settings = StepSettings::new::<f64>(model, RigidOptions::new())
        .map_err(|wrong| BuildError::new("model", wrong.to_string()))?;
    if settings.flags.constraint && settings.flags.contact && check_supported(model).is_err() {
        // It cannot be simulated.
        return Ok(());
    }
    let (mut state, mut ws) = (State::new(model), Workspace::new(model));
    let context = StepContext::without_sensors(model, &model.params, &settings);
    pipeline::forward(context, &state, &mut ws);
    for (tree, counter) in model.trees.iter().zip(&mut state.tree_asleep) {
        *counter = if begins_asleep(tree) { READY } else { AWAKE };
    }
    ws.sleep.begin(model, &state);
    sleep::fall_asleep(context, &mut state, &mut ws);
    for (t, tree) in model.trees.iter().enumerate() {
        let counter = ws.sleep.counters()[t];
        let restless = begins_asleep(tree) && counter < 0.0;
        model.tree_asleep0[t] = if restless { AWAKE } else { counter };
        if restless {
            let root = tree.bodies.start;
            let name = describe(&model.bodies[root].name, root);
            let why = "a tree that it touches or is coupled to starts awake";
            model.notes.push(format!("{name} starts awake: {why}"));
        }
    }
    Ok(())
}
