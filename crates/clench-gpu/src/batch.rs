//! Many environments of one model on a graphics device.

use crate::base::Base;
use crate::check::{Simulation, check};
use crate::clock::Clock;
use crate::device::{Device, DeviceInfo};
use crate::error::GpuError;
use crate::fields::{self, Fields};
use crate::kernels::{Memory, preface};
use crate::pipelines::{Arrays, Pipeline, Pipelines};
use crate::precision::GpuReal;
use crate::solver_memory::{SolverMemory, check_dofs};
use crate::tables::{Capacity, ENVS, MEASURES, Tables, has_sensor_history, is_read, ray_count};
use clench_rigid::contact::candidates;
use clench_rigid::model::Model;
use clench_rigid::options::RigidOptions;
use clench_rigid::settings::StepSettings;
use std::fmt;
use std::sync::Arc;
use zerocopy::IntoBytes;

/// Steps that are handed to the device at a time: enough that it never waits, few enough that no watchdog thinks it hangs.
const STEPS_AT_A_TIME: usize = 16;

/// How environments are stepped on a device.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GpuOptions {
    /// Options that go before those of the model. `max_contacts` is the size of the contact pool of an environment; by default as
    /// many as its pairs can have, but no more than 48 to 128, the fewer the more degrees of freedom there are.
    pub options: RigidOptions,
    /// A part of the name of the device to use; by default the first of [`devices`](crate::devices).
    pub device: Option<String>,
    /// Kernels that serve any model, rather than ones made for what this one has: slower, but who looks at many kinds of models waits for
    /// their compiler once.
    pub general_kernels: bool,
}

/// Many environments of one model on a graphics device, in single precision or, where the device has it, in double.
///
/// An environment's results depend on its state alone, and repeat to the bit on the same device and driver. One that cannot go on
/// keeps its last good state and says why in [`statuses`](Self::statuses); its neighbours do not notice.
pub struct GpuBatch<S = f32> {
    pub(crate) device: Arc<Device>,
    pub(crate) arrays: Arrays,
    pub(crate) state: Fields,
    pub(crate) work: Fields,
    pub(crate) rows: Fields,
    pub(crate) reports: Fields,
    pub(crate) count: usize,
    pub(crate) bindings: wgpu::BindGroup,
    /// Parameters of environments, parameter by parameter, environment next to environment; none while all have the model's.
    pub(crate) own: Vec<S>,
    pub(crate) base: Base<S>,
    pub(crate) pipelines: Pipelines,
    pub(crate) capacity: Capacity,
    pub(crate) settings: StepSettings,
    model: Arc<Model>,
    /// The last steps that were handed to the device, on which it may still be working.
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

/// Gives its memory back at once: the device outlives it.
impl<S> Drop for GpuBatch<S> {
    fn drop(&mut self) {
        for buffer in self.arrays.all() {
            buffer.destroy();
        }
        self.device.tidy();
    }
}

impl<S: GpuReal> GpuBatch<S> {
    /// `count` environments in the model's initial state.
    ///
    /// # Errors
    /// No device; a model that cannot be stepped on one yet; options out of range; more environments than the device holds.
    pub fn new(model: Arc<Model>, count: usize, options: GpuOptions) -> Result<Self, GpuError> {
        let general_kernels = options.general_kernels;
        let settings = StepSettings::new::<S>(&model, options.options)?;
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
        let method = settings.solver.constraint_solver;
        check_dofs(model.nv, method)?;
        let device = Device::open(options.device.as_deref(), S::FEATURES)?;
        let room = device.limits.max_compute_workgroup_storage_size as usize;
        let solver = SolverMemory::new::<S>(model.nv, method, room, general_kernels);
        let (mut tables, mut capacity) =
            Tables::new::<S>(&model, &settings, &pairs, general_kernels);
        solver.reserve(&mut capacity, model.tree.nnz(), model.nv);
        let base = Base::new(&tables, pairs);
        tables.shapes(&model, &base.candidates);
        tables.ray_shapes(&model);
        let state = fields::state_fields(&model, capacity);
        let work = fields::work_fields(&model, capacity);
        let thread = fields::thread_fields(&model, capacity);
        let rows = fields::row_fields(&model, capacity);
        let reports = fields::report_fields(&model, capacity);
        tables.initial_state(&model, &state);
        let each = size_of::<S>();
        let sizes = [&state, &work, &rows].map(|fields| each * fields.size);
        let sizes = [sizes[0], sizes[1], sizes[2], 4 * reports.size];
        check_room(&device, count, sizes)?;
        let memory = Memory {
            state: &state,
            work: &work,
            thread: &thread,
            threads: capacity.threads,
            rays: ray_count(&model),
            rows: &rows,
            reports: &reports,
            solver,
        };
        let preface = preface(&tables, &memory);

        let scope = device
            .device
            .push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let array = |label, k: usize| device.array(label, (sizes[k] * count) as u64);
        let numbers = device.array("numbers", (each * tables.numbers.len()) as u64);
        let arrays = Arrays {
            words: device.array("words", 4 * tables.words.len() as u64),
            parameters: numbers.clone(),
            numbers,
            state: array("state", 0),
            work: array("work", 1),
            rows: array("rows", 2),
            reports: array("reports", 3),
            layout: device.constants("layout", &preface.layout.bytes::<S>()),
        };
        if pollster::block_on(scope.pop()).is_some() {
            return Err(GpuError::OutOfMemory {
                device: device.info.name.clone(),
                count,
                bytes: sizes.iter().sum::<usize>() as u64,
                most: None,
            });
        }
        let pipelines = Pipelines::new::<S>(&device, preface, count, model.integrator)?;
        let queue = &device.queue;
        queue.write_buffer(&arrays.words, 0, tables.words.as_bytes());
        queue.write_buffer(&arrays.words, 4 * ENVS as u64, [count as u32].as_bytes());
        queue.write_buffer(&arrays.numbers, 0, tables.numbers_in::<S>().as_bytes());
        let mut batch = GpuBatch {
            bindings: arrays.bind(&device),
            own: Vec::new(),
            base,
            device,
            arrays,
            state,
            work,
            rows,
            reports,
            count,
            pipelines,
            capacity,
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

    /// Advances all environments that run by so many time steps. What a fault is of one environment shows in
    /// [`statuses`](Self::statuses). The device is still at the last of them when this returns, so that it need not wait for what comes
    /// next: whatever reads waits, and so does [`finish`](Self::finish).
    ///
    /// # Errors
    /// That the device was lost, perhaps in the steps of the call before.
    pub fn step(&mut self, steps: usize) -> Result<(), GpuError> {
        let mut left = steps;
        while left > 0 {
            let now = left.min(STEPS_AT_A_TIME);
            let commands =
                self.commands(|batch, encoder| (0..now).for_each(|_| batch.encode_step(encoder)));
            let submission = self.device.queue.submit([commands]);
            if let Some(before) = self.pending.replace(submission) {
                self.device.wait(before)?;
            }
            left -= now;
        }
        Ok(())
    }

    /// Waits until the device has made all steps.
    ///
    /// # Errors
    /// That the device was lost.
    pub fn finish(&mut self) -> Result<(), GpuError> {
        self.pending
            .take()
            .map_or(Ok(()), |last| self.device.wait(last))
    }

    /// Computes everything that follows from the states, and leaves these alone.
    ///
    /// # Errors
    /// That the device was lost.
    pub fn forward(&mut self) -> Result<(), GpuError> {
        self.submit(|batch, encoder| {
            batch.clear_trouble(encoder);
            batch.encode(encoder, None, batch.pipelines.forward_and_observed());
        })
    }

    /// As [`forward`](Self::forward), and notes in `trouble` what went wrong.
    ///
    /// # Errors
    /// That the device was lost.
    pub(crate) fn forward_with_verdict(&mut self) -> Result<(), GpuError> {
        self.submit(|batch, encoder| {
            batch.clear_trouble(encoder);
            let forward = batch.pipelines.forward_and_observed();
            batch.encode(encoder, None, forward.chain([&batch.pipelines.verdict]));
        })
    }

    /// Advances all environments that run by a time step, and tells how long each kernel took by the device's own clock, s, in order.
    ///
    /// # Errors
    /// A device without such a clock; that it was lost.
    pub fn time_stages(&mut self) -> Result<Vec<(&'static str, f64)>, GpuError> {
        let kernels = Vec::from_iter(self.step_kernels().cloned());
        let clock = Clock::new(&self.device, kernels.len())?;
        self.submit(|batch, encoder| {
            batch.clear_trouble(encoder);
            for (k, kernel) in kernels.iter().enumerate() {
                batch.encode(encoder, clock.around(k), [kernel].into_iter());
            }
            clock.write(encoder);
        })?;
        let times = clock.read(&self.device)?;
        let names = kernels.iter().map(|kernel| kernel.name);
        Ok(names.zip(times).collect())
    }

    /// All environments back to the model's initial state; all run.
    ///
    /// # Errors
    /// That the device was lost.
    pub fn reset(&mut self) -> Result<(), GpuError> {
        let all: Vec<usize> = (0..self.count).collect();
        self.reset_envs(&all)
    }

    /// Some environments back to the model's initial state; they run.
    ///
    /// # Errors
    /// An environment that is not there; that the device was lost.
    pub fn reset_envs(&mut self, envs: &[usize]) -> Result<(), GpuError> {
        let mut asked = vec![0u32; self.count];
        for &env in envs {
            self.check_env(env)?;
            asked[env] = 1;
        }
        self.write_report("restart", &asked);
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

    /// A compute pass of some kernels, timed or not.
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

    /// The kernels of a step, one after the other.
    fn step_kernels(&self) -> impl Iterator<Item = &Pipeline> {
        let pipelines = &self.pipelines;
        let last = pipelines.advance.len() - 1;
        let stages = pipelines.advance.iter().enumerate();
        stages.flat_map(move |(stage, advance)| {
            // Sensors measure at the start of a step; all else is as the last forward pass leaves it.
            let measured = pipelines.sensors.iter().filter(move |_| stage == 0);
            let shown = stage == last || measured.clone().count() > 0;
            let observed = pipelines.observed().filter(move |_| shown).chain(measured);
            pipelines.forward.iter().chain(observed).chain([advance])
        })
    }

    fn encode_step(&self, encoder: &mut wgpu::CommandEncoder) {
        self.clear_trouble(encoder);
        self.encode(encoder, None, self.step_kernels());
    }

    /// Measures sensors in every step and forward pass from now on: `sensordata` can be read, as those at the start of the last step found it.
    ///
    /// # Errors
    /// A sensor that the device does not read yet; that the device or its driver refuses a kernel.
    pub fn measure(&mut self) -> Result<(), GpuError> {
        let model = &self.model;
        if let Some(sensor) = model.sensors.iter().find(|s| !is_read(model, s)) {
            return Err(GpuError::Unread {
                device: self.device.info.name.clone(),
                kind: sensor.kind.name(),
                name: sensor.name.clone(),
            });
        }
        self.observe(true)
    }

    /// Computes accelerations of bodies and forces between them in every step from now on, and perhaps sensors.
    ///
    /// # Errors
    /// That the device or its driver refuses a kernel.
    pub(crate) fn observe(&mut self, sensors: bool) -> Result<(), GpuError> {
        if sensors {
            let place = 4 * MEASURES as u64;
            (self.device.queue).write_buffer(&self.arrays.words, place, [1u32].as_bytes());
            self.place_cameras()?;
        }
        self.pipelines
            .observe::<S>(&self.device, self.count, sensors)
    }

    /// Places cameras in every step from now on.
    ///
    /// # Errors
    /// That the device or its driver refuses the kernel.
    pub(crate) fn place_cameras(&mut self) -> Result<(), GpuError> {
        if self.model.cameras.is_empty() {
            return Ok(());
        }
        self.pipelines.place_cameras::<S>(&self.device, self.count)
    }

    pub(crate) fn check_env(&self, env: usize) -> Result<(), GpuError> {
        let count = self.count;
        if env < count {
            return Ok(());
        }
        Err(GpuError::NoSuchEnvironment { env, count })
    }

    /// How many environments there are.
    pub fn count(&self) -> usize {
        self.count
    }
    /// The model.
    pub fn model(&self) -> &Arc<Model> {
        &self.model
    }
    /// All options, decided.
    pub fn settings(&self) -> &StepSettings {
        &self.settings
    }
    /// The device that steps.
    pub fn device(&self) -> &DeviceInfo {
        &self.device.info
    }
    /// Bytes that an environment takes on the device.
    pub fn bytes_per_env(&self) -> usize {
        let numbers = [&self.state, &self.work, &self.rows].map(|fields| fields.size);
        size_of::<S>() * numbers.iter().sum::<usize>() + 4 * self.reports.size
    }
}

/// Whether the largest array of `count` environments, of so many bytes each, is one that kernels can see, and number.
fn check_room(device: &Device, count: usize, sizes: [usize; 4]) -> Result<(), GpuError> {
    let largest = sizes.into_iter().max().unwrap_or(0).max(4) as u64;
    let bytes = device.max_buffer().min(4 * u64::from(u32::MAX));
    let most = bytes / largest;
    if count as u64 <= most {
        return Ok(());
    }
    Err(GpuError::OutOfMemory {
        device: device.info.name.clone(),
        count,
        bytes: sizes.iter().sum::<usize>() as u64,
        most: usize::try_from(most).ok(),
    })
}
