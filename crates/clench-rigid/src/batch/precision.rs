//! The number types of batches.

use super::job::Stepper;
use super::shared::Shared;
use super::stepper::MakeStepper;
use crate::check;
use crate::dynamics::energy::Energy;
use crate::ik::{Ik, Search};
use crate::inverse::{self, Acceleration};
use crate::model::{Model, Params};
use crate::pipeline;
use crate::settings::StepSettings;
use crate::state::State;
use crate::workspace::{EnergyScratch, Workspace};
use clench_math::{Instructions, Scalar};

/// A number type of simulations and batches: `f64` or `f32`.
///
/// From the same state, a step in `f32` leads to accelerations within 1e-3 of the largest of them (or of 1, if all are smaller)
/// and to positions within 1e-6 (m, rad) of those in `f64`; what rests moves by less than 1e-6 m in a thousand steps. The
/// tests hold steps of a humanoid and of loose parts, and a stack at rest, to these bounds.
pub trait Precision: Lanewise {}
impl Precision for f64 {}
impl Precision for f32 {}

/// What a batch needs of a number type; outside this crate only its name is known.
pub trait Lanewise: Scalar + Shared {
    /// A thread's scratch in lanes of these instructions; `None` if the processor lacks them. Not generic, so that stepping in
    /// lanes is compiled with this crate and not with each of its users.
    fn stepper(instructions: Instructions, model: &Model) -> Option<Box<dyn Stepper<Self>>>;
    /// [`pipeline::step`] of one environment, likewise compiled once.
    fn step(
        model: &Model,
        params: &Params<Self>,
        settings: &StepSettings,
        state: &mut State<Self>,
        ws: &mut Workspace<Self>,
    );
    /// Returns whether a step can start from the state of one environment.
    fn good_inputs(state: &State<Self>) -> bool;
    /// Returns whether a step or forward pass of one environment went well.
    fn good_results(state: &State<Self>, ws: &Workspace<Self>) -> bool;
    /// [`pipeline::forward`] of one environment.
    fn forward(
        model: &Model,
        params: &Params<Self>,
        settings: &StepSettings,
        state: &State<Self>,
        ws: &mut Workspace<Self>,
    );
    /// A search for positions in one environment.
    fn ik(model: &Model, params: &Params<Self>, ik: &Ik, search: &mut Search<Self>);
    /// [`inverse::inverse`] of one environment.
    fn inverse(
        model: &Model,
        params: &Params<Self>,
        settings: &StepSettings,
        state: &State<Self>,
        given: (&[Self], Acceleration),
        ws: &mut Workspace<Self>,
        qfrc_inverse: &mut [Self],
    );
    /// [`pipeline::rest`] of one environment.
    fn rest(
        model: &Model,
        params: &Params<Self>,
        settings: &StepSettings,
        state: &mut State<Self>,
        ws: &mut Workspace<Self>,
    ) -> bool;
    /// [`pipeline::before_forces`] of one environment.
    fn before_forces(
        model: &Model,
        params: &Params<Self>,
        settings: &StepSettings,
        state: &State<Self>,
        ws: &mut Workspace<Self>,
    );
    /// [`pipeline::step_from_forces`] of one environment.
    fn step_from_forces(
        model: &Model,
        params: &Params<Self>,
        settings: &StepSettings,
        state: &mut State<Self>,
        ws: &mut Workspace<Self>,
    );
    /// [`pipeline::state_energy`] of one environment.
    fn state_energy(
        model: &Model,
        params: &Params<Self>,
        state: &State<Self>,
        scratch: &mut EnergyScratch<Self>,
    ) -> Energy<Self>;
    /// [`pipeline::position_stage`] of one environment.
    fn position_stage(
        model: &Model,
        params: &Params<Self>,
        state: &State<Self>,
        ws: &mut Workspace<Self>,
    );
}

macro_rules! lanewise {
    ($scalar:ident) => {
        impl Lanewise for $scalar {
            fn stepper(
                instructions: Instructions,
                model: &Model,
            ) -> Option<Box<dyn Stepper<$scalar>>> {
                $scalar::in_lanes(instructions, MakeStepper { model })
            }
            fn step(
                model: &Model,
                params: &Params<$scalar>,
                settings: &StepSettings,
                state: &mut State<$scalar>,
                ws: &mut Workspace<$scalar>,
            ) {
                pipeline::step(model, params, settings, state, ws);
            }
            fn good_inputs(state: &State<$scalar>) -> bool {
                check::good_inputs(state, check::has_occasional(state))
            }
            fn good_results(state: &State<$scalar>, ws: &Workspace<$scalar>) -> bool {
                check::good_results(state, ws)
            }
            fn forward(
                model: &Model,
                params: &Params<$scalar>,
                settings: &StepSettings,
                state: &State<$scalar>,
                ws: &mut Workspace<$scalar>,
            ) {
                pipeline::forward(model, params, settings, state, ws);
            }
            fn ik(model: &Model, params: &Params<$scalar>, ik: &Ik, search: &mut Search<$scalar>) {
                search.run(model, params, ik);
            }
            fn inverse(
                model: &Model,
                params: &Params<$scalar>,
                settings: &StepSettings,
                state: &State<$scalar>,
                given: (&[$scalar], Acceleration),
                ws: &mut Workspace<$scalar>,
                qfrc_inverse: &mut [$scalar],
            ) {
                inverse::inverse(model, params, settings, state, given, ws, qfrc_inverse);
            }
            fn rest(
                model: &Model,
                params: &Params<$scalar>,
                settings: &StepSettings,
                state: &mut State<$scalar>,
                ws: &mut Workspace<$scalar>,
            ) -> bool {
                pipeline::rest(model, params, settings, state, ws)
            }
            fn before_forces(
                model: &Model,
                params: &Params<$scalar>,
                settings: &StepSettings,
                state: &State<$scalar>,
                ws: &mut Workspace<$scalar>,
            ) {
                pipeline::before_forces(model, params, settings, state, ws);
            }
            fn step_from_forces(
                model: &Model,
                params: &Params<$scalar>,
                settings: &StepSettings,
                state: &mut State<$scalar>,
                ws: &mut Workspace<$scalar>,
            ) {
                pipeline::step_from_forces(model, params, settings, state, ws);
            }
            fn state_energy(
                model: &Model,
                params: &Params<$scalar>,
                state: &State<$scalar>,
                scratch: &mut EnergyScratch<$scalar>,
            ) -> Energy<$scalar> {
                pipeline::state_energy(model, params, state, scratch)
            }
            fn position_stage(
                model: &Model,
                params: &Params<$scalar>,
                state: &State<$scalar>,
                ws: &mut Workspace<$scalar>,
            ) {
                pipeline::position_stage(model, params, state, ws);
            }
        }
    };
}
lanewise!(f64);
lanewise!(f32);
