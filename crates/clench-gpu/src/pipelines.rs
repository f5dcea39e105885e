//! The compiled kernels of a batch, and the arrays that they share.

use crate::device::Device;
use crate::error::GpuError;
use crate::kernels::{self, Kernel, Preface};
use crate::precision::Texts;
use clench_rigid::dynamics::gyroscopic::is_free_tree;
use clench_rigid::model::{Integrator, Model};

/// A compiled kernel.
#[derive(Clone)]
pub(crate) struct Pipeline {
    /// The entry point.
    pub name: &'static str,
    pipeline: wgpu::ComputePipeline,
    workgroups: [u32; 3],
}

/// The kernels of a step.
pub(crate) struct Pipelines {
    /// The text that precedes all kernels.
    preface: Preface,
    /// Camera poses, once requested.
    cameras: Option<Pipeline>,
    /// Accelerations of bodies and forces between them, once requested.
    body_forces: Option<Pipeline>,
    /// Rays and skins of sensors, if any, and sensors, once requested.
    pub sensors: Vec<Pipeline>,
    pub restart: Pipeline,
    /// The forward pass.
    pub forward: Vec<Pipeline>,
    /// Drags the stick references along after the first forward pass of a step, with the option `stiction`.
    pub drag: Option<Pipeline>,
    /// The duality gap of the last solve.
    pub gap: Pipeline,
    /// Checks the results of a forward pass outside a step.
    pub check_forward: Pipeline,
    /// Lets trees fall asleep, if they may.
    fall_asleep: Option<Pipeline>,
    /// The integrator: one for each forward pass of a step.
    advance: Vec<Pipeline>,
}

/// The arrays, in the order of the kernels' bindings.
#[derive(Clone)]
pub(crate) struct Arrays {
    pub words: wgpu::Buffer,
    pub numbers: wgpu::Buffer,
    pub state: wgpu::Buffer,
    pub work: wgpu::Buffer,
    pub rows: wgpu::Buffer,
    pub reports: wgpu::Buffer,
    /// The same buffer as `numbers` while no environment has parameters of its own.
    pub parameters: wgpu::Buffer,
    /// The [`Layout`](crate::layout::Layout) of the arrays.
    pub layout: wgpu::Buffer,
}

impl Arrays {
    pub(crate) fn all(&self) -> [&wgpu::Buffer; 8] {
        let Arrays {
            words,
            numbers,
            state,
            work,
            rows,
            reports,
            parameters,
            layout,
        } = self;
        [
            words, numbers, state, work, rows, reports, parameters, layout,
        ]
    }

    /// Creates the bindings of the kernels.
    pub(crate) fn bind(&self, device: &Device) -> wgpu::BindGroup {
        let entries: Vec<_> = (0..)
            .zip(self.all())
            .map(|(binding, buffer)| wgpu::BindGroupEntry {
                binding,
                resource: buffer.as_entire_binding(),
            })
            .collect();
        device.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("arrays"),
            layout: &device.arrays,
            entries: &entries,
        })
    }
}

impl Pipelines {
    /// Compiles the kernels for `count` environments, with the given preface.
    ///
    /// # Errors
    /// Returns an error if the device refuses a kernel.
    pub(crate) fn new<S: Texts>(
        device: &Device,
        preface: Preface,
        count: usize,
        (model, sleeps): (&Model, bool),
    ) -> Result<Self, GpuError> {
        let compile = |kernel: &Kernel| compile::<S>(device, &preface, count, kernel);
        let in_metric = model.integrator == Integrator::Discrete;
        let spins = in_metric && (0..model.joints.len()).any(|j| is_free_tree(model, j));
        let forward = [
            (kernels::WAKE, sleeps),
            (kernels::POSITIONS, true),
            (kernels::BROAD_PHASE, true),
            (kernels::NARROW_PHASE, true),
            (kernels::CONTACTS, true),
            (kernels::FORCES, true),
            (kernels::METRIC, in_metric),
            (kernels::CONSTRAINTS, true),
            (kernels::ASSEMBLE, true),
            (kernels::SOLVE, true),
            (kernels::SPIN, spins),
        ];
        let advance = match model.integrator {
            Integrator::Rk4 => vec![compile(&kernels::RUNGE_KUTTA)?; 4],
            Integrator::ImplicitFast => vec![compile(&kernels::IMPLICIT_FAST)?],
            Integrator::Implicit => vec![compile(&kernels::IMPLICIT)?],
            Integrator::Euler | Integrator::Discrete => vec![compile(&kernels::EULER)?],
        };
        let drag = model.max_stick_pairs.map(|_| compile(&kernels::DRAG));
        let forward = forward.iter().filter(|(_, runs)| *runs);
        let forward = forward.map(|(kernel, _)| compile(kernel));
        let forward = forward.collect::<Result<_, _>>()?;
        Ok(Pipelines {
            cameras: None,
            body_forces: None,
            sensors: Vec::new(),
            restart: compile(&kernels::RESTART)?,
            gap: compile(&kernels::GAP)?,
            check_forward: compile(&kernels::CHECK_FORWARD)?,
            drag: drag.transpose()?,
            fall_asleep: (sleeps.then_some(&kernels::FALL_ASLEEP))
                .map(compile)
                .transpose()?,
            forward,
            advance,
            preface,
        })
    }

    /// Returns the kernels of requested outputs, except sensors.
    pub(crate) fn observed(&self) -> impl Iterator<Item = &Pipeline> {
        self.cameras.iter().chain(&self.body_forces)
    }

    /// Returns the kernels of a step in order.
    pub(crate) fn step(&self) -> impl Iterator<Item = &Pipeline> {
        let last = self.advance.len() - 1;
        let stages = self.advance.iter().enumerate();
        stages.flat_map(move |(stage, advance)| {
            // Sensors measure at the start of a step; everything else is from the last forward pass.
            let measured = self.sensors.iter().filter(move |_| stage == 0);
            let shown = stage == last || measured.clone().count() > 0;
            let observed = self.observed().filter(move |_| shown).chain(measured);
            let dragged = self.drag.iter().filter(move |_| stage == 0);
            let forward = self.forward.iter().chain(observed).chain(dragged);
            forward.chain(&self.fall_asleep).chain([advance])
        })
    }

    /// Returns the kernels of a forward pass and of all requested outputs.
    pub(crate) fn forward_and_observed(&self) -> impl Iterator<Item = &Pipeline> {
        let observed = self.observed().chain(&self.sensors);
        self.forward.iter().chain(observed)
    }

    /// Compiles the kernels of outputs, unless they are compiled.
    ///
    /// # Errors
    /// Returns an error if the device refuses a kernel.
    pub(crate) fn observe<S: Texts>(
        &mut self,
        device: &Device,
        count: usize,
        sensors: bool,
    ) -> Result<(), GpuError> {
        let compile = |kernel| compile::<S>(device, &self.preface, count, kernel);
        if self.body_forces.is_none() {
            self.body_forces = Some(compile(&kernels::BODY_FORCES)?);
        }
        if sensors && self.sensors.is_empty() {
            if self.preface.rays > 0 {
                self.sensors.push(compile(&kernels::RAYS)?);
            }
            if self.preface.taxels > 0 {
                self.sensors.push(compile(&kernels::SKINS)?);
            }
            self.sensors.push(compile(&kernels::SENSORS)?);
        }
        Ok(())
    }

    /// Compiles the kernels of outputs that another batch of kernels has.
    ///
    /// # Errors
    /// Returns an error if the device refuses a kernel.
    pub(crate) fn observe_as<S: Texts>(
        &mut self,
        other: &Pipelines,
        device: &Device,
        count: usize,
    ) -> Result<(), GpuError> {
        if other.cameras.is_some() {
            self.compile_cameras::<S>(device, count)?;
        }
        if other.body_forces.is_some() {
            self.observe::<S>(device, count, !other.sensors.is_empty())?;
        }
        Ok(())
    }

    /// Compiles the camera kernel, unless it is compiled.
    ///
    /// # Errors
    /// Returns an error if the device refuses the kernel.
    pub(crate) fn compile_cameras<S: Texts>(
        &mut self,
        device: &Device,
        count: usize,
    ) -> Result<(), GpuError> {
        if self.cameras.is_none() {
            let cameras = compile::<S>(device, &self.preface, count, &kernels::CAMERAS)?;
            self.cameras = Some(cameras);
        }
        Ok(())
    }
}

/// Returns a kernel, compiling it unless it is cached.
fn compile<S: Texts>(
    device: &Device,
    preface: &Preface,
    count: usize,
    kernel: &Kernel,
) -> Result<Pipeline, GpuError> {
    let text = kernel.source::<S>(preface);
    let pipeline = device.kernel(text, |text| create(device, kernel, text))?;
    Ok(Pipeline {
        name: kernel.entry,
        pipeline,
        workgroups: kernel.workgroups(count, preface),
    })
}

fn create(device: &Device, kernel: &Kernel, text: &str) -> Result<wgpu::ComputePipeline, GpuError> {
    let scope = device
        .device
        .push_error_scope(wgpu::ErrorFilter::Validation);
    let descriptor = wgpu::ShaderModuleDescriptor {
        label: Some(kernel.entry),
        source: wgpu::ShaderSource::Wgsl(text.into()),
    };
    // Counting the iterations of every loop costs a GPU a fifth of a step.
    let mut checks = wgpu::ShaderRuntimeChecks::checked();
    checks.force_loop_bounding = false;
    // SAFETY: every loop of our kernels terminates for any numbers: it has a limit, or a count that only grows or only
    // shrinks. All other checks stay.
    let module = unsafe { (device.device).create_shader_module_trusted(descriptor, checks) };
    let pipeline = device
        .device
        .create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(kernel.entry),
            layout: Some(&device.pipeline_layout),
            module: &module,
            entry_point: Some(kernel.entry),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        });
    if let Some(error) = pollster::block_on(scope.pop()) {
        return Err(GpuError::Unusable {
            device: device.info.name.clone(),
            reason: format!("it rejects the kernel `{}`: {error}", kernel.entry),
        });
    }
    if let Some(loss) = device.loss() {
        return Err(GpuError::Unusable {
            device: device.info.name.clone(),
            reason: format!("its driver fails on the kernel `{}`: {loss}", kernel.entry),
        });
    }
    Ok(pipeline)
}

impl Pipeline {
    /// Appends the kernel to a pass.
    pub(crate) fn dispatch(&self, pass: &mut wgpu::ComputePass) {
        let [x, y, z] = self.workgroups;
        pass.set_pipeline(&self.pipeline);
        pass.dispatch_workgroups(x, y, z);
    }
}
