//! Building a model from its description.

use super::model_builder::ModelBuilder;
use super::placed::Assets;
use super::resolve::AllNames;
use super::{
    BuildError, DEFAULT_DYNAMIC_CONSTRAINTS, actuators, bodies, budget, cameras, check, contacts,
    derived, equalities, fuse, keyframes, length_range, lights, sensors, sleep, tendons,
    user_numbers,
};
use clench_dynamics::constants::pose;
use clench_dynamics::model::{Model, Params, RowPattern, SameFrames, Visuals};
use clench_math::Vec3;
use clench_solver::Tree;
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

impl ModelBuilder {
    /// Checks the description and builds the model, by the rules of MuJoCo's compiler: bodies are numbered depth first,
    /// meshes are centred about their centres of mass, masses come from geoms if they are not given, ranges become
    /// limits, and the inverse inertias that scale constraints are computed in the initial configuration.
    ///
    /// # Errors
    /// Returns the first error found: names that are already used or unknown, numbers that are not finite, impossible
    /// sizes, masses and inertias, misplaced joints, ranges that are not ascending, vectors of the wrong length. The
    /// error names the element and, if it came from a file, its source location.
    pub fn build(&self) -> Result<Model, BuildError> {
        if self.bodies.is_empty() {
            return Err(BuildError::new(
                "model",
                "has no body; the first is the world",
            ));
        }
        check::check(self)?;
        let assets = Assets::new(self)?;
        if !self.compiler.fusestatic {
            return self.assemble(assets);
        }
        AllNames::new(self, &bodies::depth_first(&self.bodies)?)?;
        let fused = ModelBuilder {
            bodies: fuse::fuse(self, &assets)?,
            ..self.clone()
        };
        fused.assemble(assets)
    }

    /// Builds the model of a checked description.
    fn assemble(&self, assets: Assets) -> Result<Model, BuildError> {
        let order = bodies::depth_first(&self.bodies)?;
        let names = AllNames::new(self, &order)?;
        let mut model = self.empty_model();
        let palette = Arc::clone(&assets.palette);
        model.visuals = palette.visuals();

        bodies::add_all(self, &order, &assets, &mut model)?;
        model.same_frames = SameFrames::of(&model.params);
        assets.move_into(self, &mut model)?;
        derived::require_inertia(&model, &order)?;
        derived::masses(self, &mut model);
        budget::matrices(self, &model)?;
        model.tree = Arc::new(tree(&model)?);
        contacts::add_all(self, &names, &mut model)?;
        tendons::add_all(self, &names, &palette, &mut model)?;
        actuators::add_all(self, &names, &mut model)?;
        cameras::aim_all(self, &order, &names, &mut model)?;
        lights::aim_all(self, &order, &names, &mut model)?;
        sensors::add_all(self, &names, &mut model)?;
        user_numbers::pad(self, &mut model)?;
        sleep::add_trees(self, &order, &mut model)?;

        let pose0 = pose(&model, &model.params, &model.params.qpos0);
        let rest = |model: &Model| pose(model, &model.params, &model.params.qpos_spring);
        tendons::spring_lengths(self, rest, &mut model);
        lights::set_initial_poses(&pose0, &mut model);
        equalities::add_all(self, &names, &pose0, &mut model)?;
        budget::equalities(self, &model)?;
        let joints = order.iter().flat_map(|&b| &self.bodies[b].joints);
        let springdampers: Vec<_> = joints.map(|j| j.springdamper).collect();
        derived::derive(self, &order, &springdampers, pose0, &mut model)?;
        length_range::find_all(self, &mut model)?;
        budget::keyframes(self, &model)?;
        keyframes::add_all(self, &mut model)?;
        sleep::begin_asleep(&mut model)?;
        Ok(model)
    }

    /// Creates a model without any element.
    fn empty_model(&self) -> Model {
        let physics = &self.physics;
        let contacts = physics.contact_override.unwrap_or_default();
        Model {
            name: self.name.clone(),
            bodies: Vec::new(),
            joints: Vec::new(),
            dofs: Vec::new(),
            geoms: Vec::new(),
            sites: Vec::new(),
            cameras: Vec::new(),
            tendons: Vec::new(),
            tendon_dofs: RowPattern::default(),
            actuators: Vec::new(),
            actuator_dofs: RowPattern::default(),
            sensors: Vec::new(),
            equalities: Vec::new(),
            max_dynamic_constraints: DEFAULT_DYNAMIC_CONSTRAINTS,
            max_stick_pairs: None,
            pairs: Vec::new(),
            excludes: HashSet::new(),
            exclude_names: HashMap::new(),
            keyframes: Vec::new(),
            meshes: Vec::new(),
            height_fields: Vec::new(),
            geom_assets: Vec::new(),
            nq: 0,
            nv: 0,
            na: 0,
            nplastic: 0,
            nhistory: 0,
            nmocap: 0,
            tree: Arc::default(),
            trees: Vec::new(),
            tendon_ties: Vec::new(),
            tree_asleep0: Vec::new(),
            integrator: physics.integrator,
            flags: physics.flags,
            override_contacts: physics.contact_override.is_some(),
            options: self.options,
            budget: self.budget,
            params: Params {
                timestep: physics.timestep,
                gravity: Vec3::from_array(physics.gravity),
                wind: Vec3::from_array(physics.wind),
                magnetic: Vec3::from_array(physics.magnetic),
                density: physics.density,
                viscosity: physics.viscosity,
                sleep_tolerance: physics.sleep_tolerance,
                override_margin: contacts.margin,
                override_solref: contacts.solref,
                override_solimp: contacts.solimp,
                override_friction: contacts.friction,
                ..Params::default()
            },
            same_frames: SameFrames::default(),
            notes: self.notes.clone(),
            omitted: self.omitted.clone(),
            custom: self.custom.clone(),
            visuals: Visuals::default(),
        }
    }
}

fn tree(model: &Model) -> Result<Tree, BuildError> {
    let parents: Vec<_> = model.dofs.iter().map(|dof| dof.parent).collect();
    Tree::new(&parents).map_err(|e| BuildError::new("model", e.to_string()))
}
