//! Parameters and options of a simulation, changed while it runs.

use super::Sim;
use crate::Precision;
use clench_dynamics::constants::{CONSTANTS, constants};
use clench_dynamics::error::SimError;
use clench_dynamics::model::{Model, ParamField, Params};
use clench_dynamics::options::RigidOptions;
use clench_dynamics::settings::StepSettings;

impl<T: Precision> Sim<T> {
    /// Replaces the values of a field of [`params`](Self::params), element by element, and updates dependent fields:
    /// `body_subtreemass` from `body_mass`, `geom_rbound` from `geom_size`, the frames of equalities between sites from
    /// `site_pos` and `site_quat`. Quaternions and axes are normalized. All other derived values stay the same until
    /// [`set_constants`](Self::set_constants).
    ///
    /// # Errors
    /// Returns an error if the name is unknown, if the field is derived from another, if the number of values is wrong,
    /// or if a value is invalid. The parameters are then unchanged.
    pub fn set_param(&mut self, field: &str, values: &[T]) -> Result<(), SimError> {
        let field = ParamField::settable(field)?;
        let mut row = values.to_vec();
        field.check_row(&self.model, &mut row)?;
        self.assign_param(field, &row);
        Ok(())
    }

    /// Assigns a field as [`set_param`](Self::set_param) does, for a copy of a simulation: also a field that follows
    /// from another, after that one. Every bit is retained, also of directions.
    ///
    /// # Errors
    /// Returns an error as [`set_param`](Self::set_param) does.
    pub fn restore_param(&mut self, field: &str, values: &[T]) -> Result<(), SimError> {
        let field = ParamField::find(field)?;
        field.check_row(&self.model, &mut values.to_vec())?;
        self.assign_param(field, values);
        Ok(())
    }

    fn assign_param(&mut self, field: ParamField, row: &[T]) {
        Model::clear_structural_guarantees(&mut self.model, field, row);
        self.params.write_lanes(field, row);
        self.params.derive(&self.model, field);
        self.invalidate();
    }

    /// Computes the derived parameters in the initial configuration, as MuJoCo's `mj_setConst` does: subtree masses,
    /// the inverse inertias `*_invweight0` by which constraints are scaled, `dof_length`, `tendon_length0`,
    /// `actuator_acc0`, added masses of ellipsoids in a medium, frames of cameras (`cam_*0`), second anchors of
    /// connects, poses of welds to which the model gives none, anchors at sites. Call it after masses, inertias,
    /// positions or armatures have changed, unless constraints should keep the softness of the original model. Such
    /// anchors and poses are replaced even if [`weld_here`](Self::weld_here) wrote them.
    ///
    /// # Errors
    /// Returns an error if the mass matrix is not positive definite. The parameters are then unchanged.
    pub fn set_constants(&mut self) -> Result<(), SimError> {
        let mut params = self.model.params.clone();
        for &field in ParamField::ALL {
            let row = self.params.read_lane(field, 0);
            params.write_of_simulation(field, &row, &self.model.params);
        }
        let rows = constants(&self.model, &mut params);
        let rows = rows.map_err(|singular| singular.error(&self.model, None))?;
        for (field, row) in CONSTANTS.into_iter().zip(rows) {
            self.params.write_lanes(field, &row);
        }
        self.invalidate();
        Ok(())
    }

    /// Returns a field of [`params`](Self::params), by name, element by element.
    ///
    /// # Errors
    /// Returns an error if the name is unknown.
    pub fn param(&self, field: &str) -> Result<Vec<T>, SimError> {
        let field = ParamField::find(field)?;
        Ok(self.params.read_lane(field, 0))
    }

    /// Sets the time step, s.
    ///
    /// # Errors
    /// Returns an error if the time step is not positive and finite.
    pub fn set_timestep(&mut self, timestep: f64) -> Result<(), SimError> {
        self.set_param("timestep", &[T::new(timestep)])
    }

    /// Creates a simulation in double precision with the same model, options, parameters and state.
    ///
    /// # Errors
    /// See [`with_options`](Sim::with_options).
    pub fn in_double_precision(&self) -> Result<Sim<f64>, SimError> {
        let mut sim = Sim::with_options(self.model.clone(), self.options)?;
        sim.state.set_values(&self.state);
        let params = sim.params_mut();
        for &field in ParamField::ALL {
            let row = self.params.read_lane(field, 0);
            params.write_lane(field, 0, &Vec::from_iter(row.iter().map(|x| x.to_f64())));
        }
        Ok(sim)
    }

    /// Returns the parameters of this simulation.
    pub fn params(&self) -> &Params<T::SingleEnv> {
        &self.params
    }
    /// Returns a number that changes with the parameters. No other parameters have it, in any simulation.
    pub fn params_version(&self) -> u64 {
        self.params_version
    }
    /// Returns the parameters for modification in this simulation. Arrays keep their lengths. Unlike
    /// [`set_param`](Self::set_param), it checks and updates nothing.
    pub fn params_mut(&mut self) -> &mut Params<T::SingleEnv> {
        self.invalidate();
        Model::invalidate_same_frames(&mut self.model);
        &mut self.params
    }

    /// Replaces the options that the user set, for subsequent steps.
    ///
    /// # Errors
    /// Returns an error if an option is out of range or belongs to the creation of the simulation, or if a possible
    /// collision is not supported. The options are then unchanged.
    pub fn set_options(&mut self, options: RigidOptions) -> Result<(), SimError> {
        let settings = StepSettings::supported::<T>(&self.model, options)?;
        settings.check_stick_references(&self.model)?;
        self.settings = settings;
        self.options = options;
        self.invalidate();
        Ok(())
    }
}
