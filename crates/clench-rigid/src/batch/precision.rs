//! The number types of batches.

use super::job::Stepper;
use super::shared::Shared;
use super::stepper::MakeStepper;
use crate::ik::{Ik, Search};
use crate::output::{Output, Source};
use crate::readout::{self, Push, TendonLine};
use crate::sensor;
use crate::sensor::bodies::update as update_body_forces;
use clench_dynamics::Step;
use clench_dynamics::check;
use clench_dynamics::dynamics::energy::Energy;
use clench_dynamics::inverse::Acceleration;
use clench_dynamics::model::{Model, Params};
use clench_dynamics::settings::StepSettings;
use clench_dynamics::state::State;
use clench_dynamics::workspace::{EnergyScratch, Workspace};
use clench_math::{Instructions, Mask, Scalar};

/// A number type of simulations and batches: `f64` or `f32`.
///
/// From the same state, a step in `f32` leads to accelerations within 1e-3 of the largest of them (or of 1, if all are smaller)
/// and to positions within 1e-6 (m, rad) of those in `f64`; what rests moves by less than 1e-6 m in a thousand steps. The
/// tests hold steps of a humanoid and of loose parts, and a stack at rest, to these bounds.
pub trait Precision: Lanewise {}
impl Precision for f64 {}
impl Precision for f32 {}

/// The number type that one environment is computed in.
type Alone<S> = <S as Scalar>::Alone;

/// Declares the functions of [`Lanewise`], each with its body, and compiles them for both precisions.
macro_rules! compile {
    ($($(#[$doc:meta])* fn $name:ident($($argument:ident: $type:ty),* $(,)?) $(-> $result:ty)? $body:block)*) => {
        /// What simulations and batches need of a number type; outside this crate only its name is known. None of it is generic, so that
        /// all kernels are compiled with this crate, and not with each of its users.
        pub trait Lanewise: Scalar + Shared {
            $($(#[$doc])* fn $name($($argument: $type),*) $(-> $result)?;)*
        }
        impl Lanewise for f64 {
            $(fn $name($($argument: $type),*) $(-> $result)? $body)*
        }
        impl Lanewise for f32 {
            $(fn $name($($argument: $type),*) $(-> $result)? $body)*
        }
    };
}

compile! {
    /// A thread's scratch in lanes of these instructions; `None` if they are not available.
    fn stepper(instructions: Instructions, model: &Model) -> Option<Box<dyn Stepper<Self>>> {
        Self::in_lanes(instructions, MakeStepper { model })
    }

    /// The parameters of a model, for one environment.
    fn params(model: &Model) -> Params<Alone<Self>> {
        model.params.broadcast()
    }

    /// Room for what one environment computes.
    fn workspace(model: &Model) -> Workspace<Alone<Self>> {
        (Step::compiled().workspace)(model)
    }

    /// Whether a step can start from the state of one environment.
    fn good_inputs(state: &State<Self>) -> bool {
        check::good_inputs(state, check::has_occasional(state))
    }

    /// Whether a step or forward pass of one environment went well.
    fn good_results(state: &State<Self>, ws: &Workspace<Alone<Self>>) -> bool {
        check::well_computed(ws).lane(0) && check::well_moved(state)
    }

    /// [`pipeline::step`](clench_dynamics::pipeline::step) of one environment.
    fn step(
        model: &Model,
        params: &Params<Alone<Self>>,
        settings: &StepSettings,
        state: &mut State<Alone<Self>>,
        ws: &mut Workspace<Alone<Self>>,
    ) {
        (Step::compiled().step)(model, params, settings, state, ws, sensor::evaluate);
    }

    /// [`pipeline::forward`](clench_dynamics::pipeline::forward) of one environment.
    fn forward(
        model: &Model,
        params: &Params<Alone<Self>>,
        settings: &StepSettings,
        state: &State<Alone<Self>>,
        ws: &mut Workspace<Alone<Self>>,
    ) {
        (Step::compiled().forward)(model, params, settings, state, ws, sensor::evaluate);
    }

    /// [`pipeline::rest`](clench_dynamics::pipeline::rest) of one environment.
    fn rest(
        model: &Model,
        params: &Params<Alone<Self>>,
        settings: &StepSettings,
        state: &mut State<Alone<Self>>,
        ws: &mut Workspace<Alone<Self>>,
    ) -> bool {
        (Step::compiled().rest)(model, params, settings, state, ws, sensor::evaluate)
    }

    /// [`pipeline::before_forces`](clench_dynamics::pipeline::before_forces) of one environment.
    fn before_forces(
        model: &Model,
        params: &Params<Alone<Self>>,
        settings: &StepSettings,
        state: &State<Alone<Self>>,
        ws: &mut Workspace<Alone<Self>>,
    ) {
        (Step::compiled().before_forces)(model, params, settings, state, ws);
    }

    /// [`pipeline::step_from_forces`](clench_dynamics::pipeline::step_from_forces) of one environment.
    fn step_from_forces(
        model: &Model,
        params: &Params<Alone<Self>>,
        settings: &StepSettings,
        state: &mut State<Alone<Self>>,
        ws: &mut Workspace<Alone<Self>>,
    ) {
        (Step::compiled().step_from_forces)(model, params, settings, state, ws, sensor::evaluate);
    }

    /// [`pipeline::position_stage`](clench_dynamics::pipeline::position_stage) of one environment.
    fn position_stage(
        model: &Model,
        params: &Params<Alone<Self>>,
        state: &State<Alone<Self>>,
        ws: &mut Workspace<Alone<Self>>,
    ) {
        (Step::compiled().position_stage)(model, params, state, ws);
    }

    /// [`pipeline::state_energy`](clench_dynamics::pipeline::state_energy) of one environment.
    fn state_energy(
        model: &Model,
        params: &Params<Alone<Self>>,
        state: &State<Alone<Self>>,
        scratch: &mut EnergyScratch<Alone<Self>>,
    ) -> Energy<Alone<Self>> {
        (Step::compiled().state_energy)(model, params, state, scratch)
    }

    /// An output of one environment, appended to `out`.
    fn read(output: Output, source: &mut Source<Alone<Self>>, out: &mut Vec<Alone<Self>>) {
        output.read(source, out);
    }

    /// What the joints of bodies of one environment carry.
    fn body_forces(source: &mut Source<Alone<Self>>) {
        update_body_forces(source.model, source.params, source.state, source.ws);
    }

    /// What the constraints of one environment push on.
    fn pushes(source: &Source<Alone<Self>>) -> Vec<Push> {
        readout::pushes(source, 0)
    }

    /// Where the tendons of one environment run.
    fn tendon_lines(
        model: &Model,
        params: &Params<Alone<Self>>,
        ws: &Workspace<Alone<Self>>,
    ) -> Vec<TendonLine> {
        readout::tendon_lines(model, params, &ws.position)
    }

    /// A search for positions of one environment.
    fn ik(model: &Model, params: &Params<Alone<Self>>, ik: &Ik, search: &mut Search<Alone<Self>>) {
        search.run(model, params, ik);
    }

    /// [`inverse`](clench_dynamics::inverse::inverse) of one environment.
    fn inverse(
        model: &Model,
        params: &Params<Alone<Self>>,
        settings: &StepSettings,
        state: &State<Alone<Self>>,
        given: (&[Alone<Self>], Acceleration),
        ws: &mut Workspace<Alone<Self>>,
        qfrc_inverse: &mut [Alone<Self>],
    ) {
        (Step::compiled().inverse)(model, params, settings, state, given, ws, qfrc_inverse);
    }
}
