//! Batches of environments of one model on a graphics device.

use crate::base::Base;
use crate::check::{Simulation, check};
use crate::clock::Clock;
use crate::device::{Device, DeviceInfo};
use crate::error::GpuError;
use crate::fields::Fields;
use crate::kernel_options::{KernelOptions, contacts_at_start};
use crate::pipelines::{Arrays, Pipeline, Pipelines};
use crate::plan::Plan;
use crate::precision::GpuReal;
use crate::solver_memory::check_dofs;
use crate::tables::{Capacity, ENVS, MEASURES, has_sensor_history};
use clench_rigid::contact::candidates;
use clench_rigid::model::Model;
use clench_rigid::options::RigidOptions;
use clench_rigid::settings::StepSettings;
use std::fmt;
use std::sync::Arc;
use zerocopy::IntoBytes;

/// The number of steps per submission: enough to keep the device busy, few enough not to trigger a watchdog.
const STEPS_AT_A_TIME: usize = 16;

/// Options of a batch on a graphics device.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GpuOptions {
    /// Options that override those of the model. `max_contacts` is the size of the contact pool of an environment; by
    /// default, the maximum that its pairs can have, limited to 48 to 128 (fewer for more degrees of freedom), or to
    /// twice the contacts of the initial state or a keyframe if that is more.
    pub options: RigidOptions,
    /// A part of the name of the device to use; by default the first of [`devices`](crate::devices).
    pub device: Option<String>,
    /// Use kernels that serve any model instead of specialized ones. They are slower, but are compiled only once for
    /// many kinds of models.
    pub general_kernels: bool,
}

/// A batch of environments of one model on a graphics device, in single precision or, if the device supports it,
/// double.
///
/// Results depend only on the state of an environment, and are bitwise reproducible on the same device and driver. An
/// environment that fails keeps its last valid state and reports the reason in [`statuses`](Self::statuses), without
/// affecting others.
pub struct GpuBatch<S = f32> {
    pub(crate) device: Arc<Device>,
    pub(crate) arrays: Arrays,
    pub(crate) state: Fields,
    pub(crate) work: Fields,
    pub(crate) rows: Fields,
    pub(crate) reports: Fields,
    pub(crate) count: usize,
    pub(crate) bindings: wgpu::BindGroup,
    /// Per-environment parameters, indexed by parameter, then environment; empty while all have the model's.
    pub(crate) own: Vec<S>,
    pub(crate) base: Base<S>,
    pub(crate) pipelines: Pipelines,
    pub(crate) capacity: Capacity,
    pub(crate) settings: StepSettings,
    pub(crate) model: Arc<Model>,
    /// The last submitted steps, which may still be running.
    pending: Option<wgpu::SubmissionIndex>,
}

impl<S> fmt::Debug for GpuBatch<S> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.debug_struct("GpuBatch")
            .field("model", &self.model.name)
            .field("count", &self.count)
            .field("device", &self.device.info.name)
            .finish_non_exhaustive()
    }
}

/// Frees the memory immediately, because the device outlives the batch.
impl<S> Drop for GpuBatch<S> {
    fn drop(&mut self) {
        for buffer in self.arrays.all() {
            buffer.destroy();
        }
        self.device.tidy();
    }
}

impl<S: GpuReal> GpuBatch<S> {
    /// Creates `count` environments in the model's initial state.
    ///
    /// # Errors
    /// Returns an error if there is no device, the model is unsupported, an option is out of range, or memory is too
    /// small.
    pub fn new(model: Arc<Model>, count: usize, options: GpuOptions) -> Result<Self, GpuError> {
        let settings = StepSettings::supported::<S>(&model, options.options)?;
        let model = settings.adapt(model);
        let collide = settings.flags.constraint && settings.flags.contact;
        let pairs = if collide {
            candidates(&model)
        } else {
            Vec::new()
        };
        check(&Simulation {
            model: &model,
            settings: &settings,
            candidates: &pairs,
        })?;
        check_dofs(model.nv, settings.solver.constraint_solver)?;
        let device = Device::open(options.device.as_deref(), S::FEATURES)?;
        let sleeps = settings.flags.sleep;
        let kernels = KernelOptions {
            general: options.general_kernels,
            slots: false,
            contacts: contacts_at_start(&model, options.options)?,
        };
        let available = device.limits.max_compute_workgroup_storage_size as usize;
        let plan = Plan::<S>::new(&model, &settings, pairs, kernels, available);
        check_memory(&device, count, plan.sizes())?;
        let arrays = allocate::<S>(&device, &plan, count)?;
        let queue = &device.queue;
        queue.write_buffer(&arrays.words, 0, plan.tables.words.as_bytes());
        queue.write_buffer(&arrays.words, 4 * ENVS as u64, [count as u32].as_bytes());
        queue.write_buffer(&arrays.numbers, 0, plan.tables.numbers_in::<S>().as_bytes());
        let pipelines = Pipelines::new::<S>(&device, plan.preface, count, (&model, sleeps))?;
        let mut batch = GpuBatch {
            bindings: arrays.bind(&device),
            own: Vec::new(),
            base: plan.base,
            device,
            arrays,
            state: plan.state,
            work: plan.work,
            rows: plan.rows,
            reports: plan.reports,
            count,
            pipelines,
            capacity: plan.capacity,
            settings,
            model,
            pending: None,
        };
        if has_sensor_history(&batch.model) {
            batch.observe(true)?;
        }
        batch.reset()?;
        Ok(batch)
    }

    /// Advances all running environments by the given number of time steps. Faults of single environments are reported
    /// in [`statuses`](Self::statuses). Returns while the device still computes the last steps; reads and
    /// [`finish`](Self::finish) wait for them. With the option `autoreset`, steps that fail are repeated from the
    /// initial state, see [`resets`](Self::resets), and the call waits for the device.
    ///
    /// # Errors
    /// Returns an error if the device was lost, perhaps in the steps of the previous call.
    pub fn step(&mut self, steps: usize) -> Result<(), GpuError> {
        if !self.settings.autoreset {
            return self.dispatch(steps);
        }
        let before = self.resets()?;
        self.dispatch(steps)?;
        self.catch_up(&before).map(drop)
    }

    /// Submits steps of all running environments.
    ///
    /// # Errors
    /// Returns an error if the device was lost, perhaps in the steps of the previous call.
    pub(crate) fn dispatch(&mut self, steps: usize) -> Result<(), GpuError> {
        let mut remaining = steps;
        while remaining > 0 {
            let now = remaining.min(STEPS_AT_A_TIME);
            let commands =
                self.commands(|batch, encoder| (0..now).for_each(|_| batch.encode_step(encoder)));
            let submission = self.device.queue.submit([commands]);
            if let Some(before) = self.pending.replace(submission) {
                self.device.wait(before)?;
            }
            remaining -= now;
        }
        Ok(())
    }

    /// Waits until the device has completed all steps.
    ///
    /// # Errors
    /// Returns an error if the device was lost.
    pub fn finish(&mut self) -> Result<(), GpuError> {
        self.pending
            .take()
            .map_or(Ok(()), |last| self.device.wait(last))
    }

    /// Computes everything that depends on the states, without changing these.
    ///
    /// # Errors
    /// Returns an error if the device was lost.
    pub fn forward(&mut self) -> Result<(), GpuError> {
        self.submit(|batch, encoder| {
            batch.clear_failures(encoder);
            batch.encode(encoder, None, batch.pipelines.forward_and_observed());
        })
    }

    /// Runs [`forward`](Self::forward) and records failures in `failure`.
    ///
    /// # Errors
    /// Returns an error if the device was lost.
    pub(crate) fn forward_and_check(&mut self) -> Result<(), GpuError> {
        self.submit(|batch, encoder| {
            batch.clear_failures(encoder);
            let forward = batch.pipelines.forward_and_observed();
            batch.encode(
                encoder,
                None,
                forward.chain([&batch.pipelines.check_forward]),
            );
        })
    }

    /// Advances all running environments by one time step. Returns the time of each kernel by the device's clock, s, in
    /// order.
    ///
    /// # Errors
    /// Returns an error if the device has no such clock or was lost.
    pub fn time_stages(&mut self) -> Result<Vec<(&'static str, f64)>, GpuError> {
        let kernels = Vec::from_iter(self.pipelines.step().cloned());
        let clock = Clock::new(&self.device, kernels.len())?;
        self.submit(|batch, encoder| {
            batch.clear_failures(encoder);
            for (k, kernel) in kernels.iter().enumerate() {
                batch.encode(encoder, clock.timestamp_writes(k), [kernel].into_iter());
            }
            clock.write(encoder);
        })?;
        let times = clock.read(&self.device)?;
        let names = kernels.iter().map(|kernel| kernel.name);
        Ok(names.zip(times).collect())
    }

    /// Resets all environments to the model's initial state; all run.
    ///
    /// # Errors
    /// Returns an error if the device was lost.
    pub fn reset(&mut self) -> Result<(), GpuError> {
        let all: Vec<usize> = (0..self.count).collect();
        self.reset_envs(&all)
    }

    /// Resets the given environments to the model's initial state; they run.
    ///
    /// # Errors
    /// Returns an error if an environment does not exist or the device was lost.
    pub fn reset_envs(&mut self, envs: &[usize]) -> Result<(), GpuError> {
        let mut restarts = vec![0u32; self.count];
        for &env in envs {
            self.check_env(env)?;
            restarts[env] = 1;
        }
        self.write_report("restart", &restarts);
        self.submit(|batch, encoder| {
            batch.encode(encoder, None, [&batch.pipelines.restart].into_iter())
        })
    }

    pub(crate) fn submit(
        &self,
        encode: impl FnOnce(&Self, &mut wgpu::CommandEncoder),
    ) -> Result<(), GpuError> {
        let commands = self.commands(encode);
        self.device.submit(commands)
    }

    fn commands(
        &self,
        encode: impl FnOnce(&Self, &mut wgpu::CommandEncoder),
    ) -> wgpu::CommandBuffer {
        let device = &self.device.device;
        let mut encoder = device.create_command_encoder(&Default::default());
        encode(self, &mut encoder);
        encoder.finish()
    }

    /// Encodes a compute pass of kernels, optionally timed.
    pub(crate) fn encode<'a>(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        timestamp_writes: Option<wgpu::ComputePassTimestampWrites>,
        kernels: impl Iterator<Item = &'a Pipeline>,
    ) {
        if self.count == 0 {
            return;
        }
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: None,
            timestamp_writes,
        });
        pass.set_bind_group(0, &self.bindings, &[]);
        kernels.for_each(|kernel| kernel.dispatch(&mut pass));
    }

    fn encode_step(&self, encoder: &mut wgpu::CommandEncoder) {
        self.clear_failures(encoder);
        self.encode(encoder, None, self.pipelines.step());
    }

    /// Enables sensors in every subsequent step and forward pass: `sensordata` can be read, with the values from the
    /// start of the last step.
    ///
    /// # Errors
    /// Returns an error if the device or its driver refuses a kernel.
    pub fn measure(&mut self) -> Result<(), GpuError> {
        self.observe(true)
    }

    /// Enables accelerations of bodies and forces between them in every subsequent step, and optionally sensors.
    ///
    /// # Errors
    /// Returns an error if the device refuses a kernel.
    pub(crate) fn observe(&mut self, sensors: bool) -> Result<(), GpuError> {
        self.end_rest();
        if sensors {
            let offset = 4 * MEASURES as u64;
            (self.device.queue).write_buffer(&self.arrays.words, offset, [1u32].as_bytes());
            self.enable_cameras()?;
        }
        self.pipelines
            .observe::<S>(&self.device, self.count, sensors)
    }

    /// Enables camera poses in every subsequent step.
    ///
    /// # Errors
    /// Returns an error if the device refuses the kernel.
    pub(crate) fn enable_cameras(&mut self) -> Result<(), GpuError> {
        if self.model.cameras.is_empty() {
            return Ok(());
        }
        self.end_rest();
        self.pipelines
            .compile_cameras::<S>(&self.device, self.count)
    }

    pub(crate) fn check_env(&self, env: usize) -> Result<(), GpuError> {
        let count = self.count;
        if env < count {
            return Ok(());
        }
        Err(GpuError::NoSuchEnvironment { env, count })
    }

    /// Returns the number of environments.
    pub fn count(&self) -> usize {
        self.count
    }
    /// Returns the model.
    pub fn model(&self) -> &Arc<Model> {
        &self.model
    }
    /// Returns all options, resolved.
    pub fn settings(&self) -> &StepSettings {
        &self.settings
    }
    /// Returns the device.
    pub fn device(&self) -> &DeviceInfo {
        &self.device.info
    }
    /// Returns the bytes of an environment on the device.
    pub fn bytes_per_env(&self) -> usize {
        let numbers = [&self.state, &self.work, &self.rows].map(|fields| fields.size);
        size_of::<S>() * numbers.iter().sum::<usize>() + 4 * self.reports.size
    }
}

/// Allocates the arrays of a plan for `count` environments.
fn allocate<S: GpuReal>(device: &Device, plan: &Plan<S>, count: usize) -> Result<Arrays, GpuError> {
    let sizes = plan.sizes();
    in_memory(device, count, sizes, || {
        let array = |label, k: usize| device.array(label, (sizes[k] * count) as u64);
        let tables = &plan.tables;
        let numbers = device.array("numbers", (size_of::<S>() * tables.numbers.len()) as u64);
        Arrays {
            words: device.array("words", 4 * tables.words.len() as u64),
            parameters: numbers.clone(),
            numbers,
            state: array("state", 0),
            work: array("work", 1),
            rows: array("rows", 2),
            reports: array("reports", 3),
            layout: device.constants("layout", &plan.preface.layout.bytes::<S>()),
        }
    })
}

/// Returns what `allocate` makes, unless the device runs out of memory for `count` environments of the given bytes.
///
/// # Errors
/// Returns an error if it does.
pub(crate) fn in_memory<R>(
    device: &Device,
    count: usize,
    sizes: [usize; 4],
    allocate: impl FnOnce() -> R,
) -> Result<R, GpuError> {
    let scope = (device.device).push_error_scope(wgpu::ErrorFilter::OutOfMemory);
    let allocated = allocate();
    if pollster::block_on(scope.pop()).is_none() {
        return Ok(allocated);
    }
    Err(GpuError::OutOfMemory {
        device: device.info.name.clone(),
        count,
        bytes: sizes.iter().sum::<usize>() as u64,
        max: None,
    })
}

/// Checks that the largest array of `count` environments of the given bytes each fits a buffer and can be indexed.
pub(crate) fn check_memory(
    device: &Device,
    count: usize,
    sizes: [usize; 4],
) -> Result<(), GpuError> {
    let largest = sizes.into_iter().max().unwrap_or(0).max(4) as u64;
    let bytes = device.max_buffer().min(4 * u64::from(u32::MAX));
    let max = bytes / largest;
    if count as u64 <= max {
        return Ok(());
    }
    Err(GpuError::OutOfMemory {
        device: device.info.name.clone(),
        count,
        bytes: sizes.iter().sum::<usize>() as u64,
        max: usize::try_from(max).ok(),
    })
}
