//! The number types of simulations and batches, for which this crate compiles what they call.

use crate::batch::job::Stepper;
use crate::batch::shared::Shared;
use crate::batch::stepper::MakeStepper;
use crate::ik::{Ik, Search};
use crate::output::{Output, Source};
use crate::query::Query;
use crate::readout::{self, Push, TendonLine};
use crate::sensor;
use crate::sensor::bodies::update as update_body_forces;
use clench_dynamics::check;
use clench_dynamics::context::StepContext;
use clench_dynamics::model::{Model, Params};
use clench_dynamics::settings::StepSettings;
use clench_dynamics::state::State;
use clench_dynamics::workspace::Workspace;
use clench_math::{Instructions, Mask, Scalar};

/// A number type of simulations and batches: `f64` or `f32`.
///
/// From the same state, a step in `f32` yields accelerations within 1e-3 of the largest of them (or of 1, if all are
/// smaller) and positions within 1e-6 (m, rad) of those in `f64`; bodies at rest move by less than 1e-6 m in a thousand
/// steps. The tests check these bounds for a humanoid, for loose parts, and for a stack at rest.
pub trait Precision: Lanewise {}
impl Precision for f64 {}
impl Precision for f32 {}

/// The number type that one environment is computed in.
type SingleEnv<S> = <S as Scalar>::SingleEnv;

/// Declares the functions of [`Lanewise`] with their bodies, and compiles them for both precisions.
macro_rules! compile {
    ($($(#[$doc:meta])* fn $name:ident$(<$life:lifetime>)?($($argument:ident: $type:ty),* $(,)?) $(-> $result:ty)? $body:block)*) => {
        /// The operations of simulations and batches for a number type that [`Step`](clench_dynamics::Step) does not
        /// have; only the name of this trait is public. They are not generic, so that all kernels are compiled with
        /// this crate, and not with its users.
        pub trait Lanewise: Scalar + Shared {
            $($(#[$doc])* fn $name$(<$life>)?($($argument: $type),*) $(-> $result)?;)*
        }
        impl Lanewise for f64 {
            $(fn $name$(<$life>)?($($argument: $type),*) $(-> $result)? $body)*
        }
        impl Lanewise for f32 {
            $(fn $name$(<$life>)?($($argument: $type),*) $(-> $result)? $body)*
        }
    };
}

compile! {
    /// Creates a thread's scratch memory in lanes of these instructions; `None` if they are not available.
    fn stepper(instructions: Instructions, model: &Model) -> Option<Box<dyn Stepper<Self>>> {
        Self::in_lanes(instructions, MakeStepper { model })
    }

    /// Returns the parameters of a model, for one environment.
    fn params(model: &Model) -> Params<SingleEnv<Self>> {
        model.params.broadcast()
    }

    /// Returns true if a step can start from the state of one environment.
    fn good_inputs(state: &State<Self>) -> bool {
        check::good_inputs(state, check::has_occasional(state))
    }

    /// Returns true if a step or forward pass of one environment succeeded.
    fn good_results(state: &State<Self>, ws: &Workspace<SingleEnv<Self>>) -> bool {
        check::well_computed(ws).lane(0) && check::well_moved(state)
    }

    /// Returns the context of a step of one environment.
    fn context<'a>(
        model: &'a Model,
        params: &'a Params<SingleEnv<Self>>,
        settings: &'a StepSettings,
    ) -> StepContext<'a, SingleEnv<Self>> {
        StepContext { model, params, settings, sensors: sensor::evaluate }
    }

    /// Appends an output of one environment to `out`.
    fn read(output: Output, source: &mut Source<SingleEnv<Self>>, out: &mut Vec<SingleEnv<Self>>) {
        output.read(source, out);
    }

    /// Computes the joint reactions on bodies of one environment.
    fn body_forces(source: &mut Source<SingleEnv<Self>>) {
        update_body_forces(source.model, source.params, source.state, source.ws);
    }

    /// Appends the answer to a query about one environment.
    fn answer(
        query: Query<'_>,
        computed: (&Model, &Params<SingleEnv<Self>>, &Workspace<SingleEnv<Self>>),
        input: &[SingleEnv<Self>],
        out: &mut Vec<SingleEnv<Self>>,
    ) {
        query.write(computed, input, out);
    }

    /// Returns the forces of the constraints of one environment.
    fn pushes(source: &Source<SingleEnv<Self>>) -> Vec<Push> {
        readout::pushes(source, 0)
    }

    /// Returns the tendon paths of one environment.
    fn tendon_lines(
        model: &Model,
        params: &Params<SingleEnv<Self>>,
        ws: &Workspace<SingleEnv<Self>>,
    ) -> Vec<TendonLine> {
        readout::tendon_lines(model, params, &ws.position)
    }

    /// Runs inverse kinematics for one environment.
    fn ik(model: &Model, params: &Params<SingleEnv<Self>>, ik: &Ik, search: &mut Search<SingleEnv<Self>>) {
        search.run(model, params, ik);
    }
}
