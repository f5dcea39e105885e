//! A backend of `clench-rigid`'s batch that steps on a graphics device.

use crate::batch::{GpuBatch, GpuOptions};
use crate::codes::Code;
use crate::error::{GpuError, GpuFault};
use crate::kernels::DivergedField;
use crate::precision::GpuReal;
use clench_math::Motion;
use clench_rigid::batch::{Backend, Outcome, StepFailure};
use clench_rigid::contact::Excess;
use clench_rigid::model::Model;
use clench_rigid::{Batch, BatchOptions, Output, SimError};
use std::sync::Arc;

/// Creates a batch of `count` environments in the model's initial state, stepped by a graphics device. Each call
/// uploads the rows that users wrote and downloads the states once, however many steps it makes.
///
/// The device computes the outputs; those that are recorded are downloaded. Outputs that it does not compute are
/// refused. Queries (Jacobians, rays, inverse kinematics, ...) run on the processor, from the rows. `device` is a part
/// of the name of the device to use; the default is the first of [`devices`](crate::devices).
///
/// # Errors
/// Same as [`GpuBatch::new`].
///
/// ```no_run
/// use clench_rigid::BatchOptions;
/// # fn model() -> std::sync::Arc<clench_rigid::Model> { unimplemented!() }
/// let mut batch = clench_gpu::batch::<f32>(model(), 4096, BatchOptions::default(), None)?;
/// batch.record(&["xpos"])?;
/// batch.state.ctrl.row_mut(7).fill(0.1);
/// batch.step_n(10)?;
/// println!("{:?} {:?}", batch.state.qpos.row(7), batch.output("xpos"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn batch<S: GpuReal>(
    model: Arc<Model>,
    count: usize,
    options: BatchOptions,
    device: Option<&str>,
) -> Result<Batch<S>, GpuError> {
    let on_device = GpuOptions {
        options: options.options,
        device: device.map(str::to_owned),
        general_kernels: false,
    };
    let on_device = GpuBatch::<S>::new(Arc::clone(&model), count, on_device)?;
    Ok(Batch::with_backend(
        model,
        count,
        options,
        Box::new(on_device),
    )?)
}

/// Returns the report field that holds an output, if one does.
fn report_field(output: Output) -> Option<&'static str> {
    match output {
        Output::contact_count => Some("ncon"),
        Output::solver_iterations => Some("niter"),
        // The others are fields of their own name, or computed by the host.
        _ => None,
    }
}

impl<S: GpuReal> GpuBatch<S> {
    /// Collects the outcome of each running environment from the field `report` of the reports, and its resets.
    fn outcomes(
        &self,
        report: &str,
        resets: &[u32],
        running: &[bool],
        outcomes: &mut [Outcome],
    ) -> Result<(), GpuError> {
        let (steps, faults) = (self.report("steps")?, self.faults(report)?);
        let none = faults.iter().all(Option::is_none);
        let details = if none {
            None
        } else {
            Some([
                self.report("fault_field")?,
                self.report("fault_index")?,
                self.report("fault_value")?,
                self.report("repeats")?,
            ])
        };
        for env in (0..self.count).filter(|&env| running[env]) {
            let detail = |k: usize| details.as_ref().map_or(0, |all| all[k][env]);
            let failure = faults[env].map(|fault| match fault {
                GpuFault::Singular => StepFailure::Singular,
                GpuFault::Unfinished => StepFailure::Unfinished,
                GpuFault::ContactOverflow { limit } => StepFailure::ContactOverflow { limit },
                GpuFault::StickOverflow { .. } => StepFailure::OverBudget(Excess::StickPairs),
                GpuFault::Diverged => {
                    let field = DivergedField::of(detail(0));
                    StepFailure::Diverged {
                        field: field.unwrap_or(DivergedField::Qacc).name(),
                        index: detail(1) as usize,
                        value: f64::from(f32::from_bits(detail(2))),
                    }
                }
            });
            outcomes[env] = Outcome {
                steps: steps[env] as usize,
                resets: resets[env] as usize,
                restarted: resets[env] > 0 || detail(3) > 0,
                failure,
            };
        }
        Ok(())
    }
}

impl<S: GpuReal> Backend<S> for GpuBatch<S> {
    fn name(&self) -> String {
        self.device.info.name.clone()
    }

    fn bytes_per_env(&self) -> usize {
        GpuBatch::bytes_per_env(self)
    }

    fn holds(&self, field: &str) -> bool {
        self.state.find(field).is_some()
    }

    fn computes(&self, output: Output) -> bool {
        match output {
            Output::ten_J | Output::actuator_moment | Output::actuator_power => true,
            Output::site_jacp | Output::site_jacr => true,
            output => report_field(output).is_some() || self.work.find(output.name()).is_some(),
        }
    }

    fn request(&mut self, outputs: &[Output]) -> Result<(), SimError> {
        let of_bodies = |output: &Output| {
            use Output::{cacc, cfrc_ext, cfrc_int, contact_force};
            matches!(output, cacc | cfrc_int | cfrc_ext | contact_force)
        };
        let of_cameras = |output: &Output| matches!(output, Output::cam_xpos | Output::cam_xmat);
        if outputs.iter().any(of_cameras) {
            self.enable_cameras()?;
        }
        if outputs.iter().any(of_bodies) {
            self.observe(false)?;
        }
        if outputs.contains(&Output::sensordata) {
            self.measure()?;
        }
        Ok(())
    }

    fn parameters_of(&self, model: &Model) -> Result<Vec<S>, SimError> {
        Ok(GpuBatch::parameters_of(self, model)?)
    }

    fn set_parameters(&mut self, envs: &[usize], rows: &[Vec<S>]) -> Result<(), SimError> {
        Ok(self.write_parameters(envs, rows)?)
    }

    fn write(&mut self, field: &'static str, rows: &[S]) -> Result<(), SimError> {
        // Slots are reserved when the first constraint is added. Until then all are empty.
        if field.starts_with("dynamic_") && !self.has_slots() {
            if rows.iter().all(|x| x.eq(&S::ZERO)) {
                return Ok(());
            }
            self.enable_dynamic_constraints()?;
        }
        Ok(self.write_unchecked(field, rows)?)
    }

    fn read(&mut self, field: &'static str, rows: &mut [S]) -> Result<(), SimError> {
        rows.copy_from_slice(&GpuBatch::read(self, field)?);
        Ok(())
    }

    fn read_output(&mut self, output: Output, rows: &mut [S]) -> Result<(), SimError> {
        if let Some(field) = report_field(output) {
            let words = self.report(field)?;
            let counts = rows.iter_mut().zip(words);
            counts.for_each(|(row, count)| *row = S::new(f64::from(count)));
            return Ok(());
        }
        match output {
            Output::ten_J => self.tendon_jacobians(rows)?,
            Output::actuator_moment => self.moment_arms(rows)?,
            Output::actuator_power => self.driving_powers(rows)?,
            Output::site_jacp => self.site_jacobians(Motion::velocity_at, rows)?,
            Output::site_jacr => self.site_jacobians(|axis, _| axis.angular, rows)?,
            output => rows.copy_from_slice(&GpuBatch::read(self, output.name())?),
        }
        Ok(())
    }

    fn step(
        &mut self,
        steps: usize,
        keeps_controls: bool,
        running: &[bool],
        outcomes: &mut [Outcome],
    ) -> Result<(), SimError> {
        self.choose(running);
        self.keep_controls(keeps_controls);
        self.dispatch(steps)?;
        let none = vec![0; self.count];
        let resets = self.catch_up(&none)?;
        Ok(self.outcomes("status", &resets, running, outcomes)?)
    }

    fn forward(&mut self, running: &[bool], outcomes: &mut [Outcome]) -> Result<(), SimError> {
        self.choose(running);
        self.forward_and_check()?;
        Ok(self.outcomes("failure", &vec![0; self.count], running, outcomes)?)
    }
}
