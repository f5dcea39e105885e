//! The kernels of a batch as the device runs them, and the arrays they share.

use crate::device::Device;
use crate::error::GpuError;
use crate::kernels::{self, Kernel, Preface};
use crate::precision::Texts;
use clench_rigid::model::Integrator;

/// A kernel, compiled.
#[derive(Clone)]
pub(crate) struct Pipeline {
    /// Its entry point.
    pub name: &'static str,
    pipeline: wgpu::ComputePipeline,
    workgroups: [u32; 3],
}

/// All that a step runs.
pub(crate) struct Pipelines {
    /// What stands before the texts.
    preface: Preface,
    /// Where cameras are, once somebody asked.
    cameras: Option<Pipeline>,
    /// Accelerations of bodies and forces between them, once somebody asked.
    body_forces: Option<Pipeline>,
    /// What rays of sensors meet, if there are any, and what sensors measure, once somebody asked.
    pub sensors: Vec<Pipeline>,
    pub restart: Pipeline,
    /// Everything that follows from the state.
    pub forward: Vec<Pipeline>,
    /// How far the last solve may be from the minimum.
    pub gap: Pipeline,
    /// Looks at what a forward pass that is no step left.
    pub verdict: Pipeline,
    /// The integrator: one for each forward pass of a step.
    pub advance: Vec<Pipeline>,
}

/// The arrays, in the order of the kernels' bindings.
pub(crate) struct Arrays {
    pub words: wgpu::Buffer,
    pub numbers: wgpu::Buffer,
    pub state: wgpu::Buffer,
    pub work: wgpu::Buffer,
    pub rows: wgpu::Buffer,
    pub reports: wgpu::Buffer,
    /// The numbers themselves while no environment has parameters of its own.
    pub parameters: wgpu::Buffer,
    /// Where all that lies: [`Layout`](crate::layout::Layout).
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

    /// What the kernels are given.
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
    /// Compiles the kernels for `count` environments, behind what belongs before them.
    ///
    /// # Errors
    /// That the device or its driver refuses a kernel.
    pub(crate) fn new<S: Texts>(
        device: &Device,
        preface: Preface,
        count: usize,
        integrator: Integrator,
    ) -> Result<Self, GpuError> {
        let compile = |kernel: &Kernel| compile::<S>(device, &preface, count, kernel);
        let forward = [
            kernels::POSITIONS,
            kernels::BROAD_PHASE,
            kernels::NARROW_PHASE,
            kernels::CONTACTS,
            kernels::FORCES,
            kernels::CONSTRAINTS,
            kernels::ASSEMBLE,
            kernels::SOLVE,
        ];
        let advance = match integrator {
            Integrator::Rk4 => vec![compile(&kernels::RUNGE_KUTTA)?; 4],
            Integrator::ImplicitFast => vec![compile(&kernels::IMPLICIT_FAST)?],
            Integrator::Implicit => vec![compile(&kernels::IMPLICIT)?],
            _ => vec![compile(&kernels::EULER)?],
        };
        let forward = forward.iter().map(compile);
        let forward = forward.collect::<Result<_, _>>()?;
        Ok(Pipelines {
            cameras: None,
            body_forces: None,
            sensors: Vec::new(),
            restart: compile(&kernels::RESTART)?,
            gap: compile(&kernels::GAP)?,
            verdict: compile(&kernels::VERDICT)?,
            forward,
            advance,
            preface,
        })
    }

    /// What outputs need besides, but for those of sensors.
    pub(crate) fn observed(&self) -> impl Iterator<Item = &Pipeline> {
        self.cameras.iter().chain(&self.body_forces)
    }

    /// A forward pass, and all that somebody asked for.
    pub(crate) fn forward_and_observed(&self) -> impl Iterator<Item = &Pipeline> {
        let observed = self.observed().chain(&self.sensors);
        self.forward.iter().chain(observed)
    }

    /// Compiles what outputs need, if that has not been done.
    ///
    /// # Errors
    /// That the device or its driver refuses a kernel.
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
            self.sensors.push(compile(&kernels::SENSORS)?);
        }
        Ok(())
    }

    /// Compiles what places cameras, if that has not been done.
    ///
    /// # Errors
    /// That the device or its driver refuses the kernel.
    pub(crate) fn place_cameras<S: Texts>(
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

/// A kernel, which the device compiles if it does not have it.
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
    // To count the turns of every loop takes a card a fifth of a step.
    let mut checks = wgpu::ShaderRuntimeChecks::checked();
    checks.force_loop_bounding = false;
    // SAFETY: every loop of our kernels ends, whatever the numbers: it has a bound, or a count that only grows or only shrinks. All other
    // checks stay.
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
            reason: format!("it refuses the kernel `{}`: {error}", kernel.entry),
        });
    }
    if let Some(loss) = device.loss() {
        return Err(GpuError::Unusable {
            device: device.info.name.clone(),
            reason: format!("its driver fails at the kernel `{}`: {loss}", kernel.entry),
        });
    }
    Ok(pipeline)
}

impl Pipeline {
    /// Appends it to a pass.
    pub(crate) fn dispatch(&self, pass: &mut wgpu::ComputePass) {
        let [x, y, z] = self.workgroups;
        pass.set_pipeline(&self.pipeline);
        pass.dispatch_workgroups(x, y, z);
    }
}
