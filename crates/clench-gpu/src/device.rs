//! Graphics devices: those available, and those that this process has opened.
//!
//! Batches on one device share it and its compiled kernels: a second batch of the same or a similar model needs no
//! compilation.

use crate::error::GpuError;
use std::collections::HashMap;
use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, mpsc};

/// A graphics device of this machine.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DeviceInfo {
    /// The name that the driver reports.
    pub name: String,
    /// The kind: GPU, integrated GPU, virtual GPU, or software.
    pub kind: String,
    /// The API, such as Vulkan, and the driver.
    pub driver: String,
    /// The largest buffer, bytes; it limits the number of environments.
    pub max_buffer: u64,
    /// True if it is software that runs on the processor.
    pub software: bool,
}

impl fmt::Display for DeviceInfo {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let gib = self.max_buffer as f64 / f64::from(1 << 30);
        write!(
            f,
            "{} ({}, {}, buffers up to {gib:.2} GiB)",
            self.name, self.kind, self.driver
        )
    }
}

fn describe(adapter: &wgpu::Adapter) -> DeviceInfo {
    let info = adapter.get_info();
    let software = info.device_type == wgpu::DeviceType::Cpu;
    let kind = match info.device_type {
        wgpu::DeviceType::DiscreteGpu => "GPU",
        wgpu::DeviceType::IntegratedGpu => "integrated GPU",
        wgpu::DeviceType::VirtualGpu => "virtual GPU",
        wgpu::DeviceType::Cpu => "software",
        wgpu::DeviceType::Other => "of unknown kind",
    };
    DeviceInfo {
        name: info.name,
        kind: kind.to_owned(),
        driver: format!("{:?} {}", info.backend, info.driver)
            .trim_end()
            .to_owned(),
        max_buffer: max_buffer(&adapter.limits()),
        software,
    }
}

/// Returns the largest array that a kernel can access.
fn max_buffer(limits: &wgpu::Limits) -> u64 {
    limits
        .max_buffer_size
        .min(limits.max_storage_buffer_binding_size)
}

/// Returns all adapters that can compute, GPUs before software.
fn adapters() -> Vec<wgpu::Adapter> {
    let instance =
        wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
    let backends = wgpu::Backends::VULKAN | wgpu::Backends::METAL | wgpu::Backends::DX12;
    let mut found = pollster::block_on(instance.enumerate_adapters(backends));
    found.retain(|adapter| {
        let flags = adapter.get_downlevel_capabilities().flags;
        flags.contains(wgpu::DownlevelFlags::COMPUTE_SHADERS)
    });
    found.sort_by_key(|adapter| match adapter.get_info().device_type {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    });
    found
}

/// Returns the devices of this machine that can compute, in order of preference: GPUs first, software last.
pub fn devices() -> Vec<DeviceInfo> {
    adapters().iter().map(describe).collect()
}

/// Creates the bindings of all kernels: the model and the parameters are read-only, the other arrays writable.
fn layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    let entry = |binding| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer {
            ty: match binding {
                7 => wgpu::BufferBindingType::Uniform,
                _ => wgpu::BufferBindingType::Storage {
                    read_only: binding < 2 || binding == 6,
                },
            },
            has_dynamic_offset: false,
            min_binding_size: None,
        },
        count: None,
    };
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("arrays"),
        entries: &[0, 1, 2, 3, 4, 5, 6, 7].map(entry),
    })
}

/// The maximum number of cached kernels of a device. Beyond it the cache is cleared; batches retain their kernels.
const MAX_KERNELS: usize = 128;

/// The open devices of this process, with the requested names and features.
struct OpenDevices {
    /// The owner; a forked process cannot use its parent's devices.
    process: u32,
    devices: Vec<(Option<String>, wgpu::Features, Arc<Device>)>,
}

static OPEN_DEVICES: Mutex<Option<OpenDevices>> = Mutex::new(None);

/// Locks a mutex, ignoring poisoning.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Calls a function with the open devices of this process.
fn with_open_devices<T>(use_it: impl FnOnce(&mut OpenDevices) -> T) -> T {
    let mut open = lock(&OPEN_DEVICES);
    let process = std::process::id();
    if open.as_ref().is_none_or(|open| open.process != process) {
        // Dropping a parent's devices would wait for threads that exist only in the parent.
        std::mem::forget(open.take());
    }
    use_it(open.get_or_insert_with(|| OpenDevices {
        process,
        devices: Vec::new(),
    }))
}

/// An open device.
pub(crate) struct Device {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    pub info: DeviceInfo,
    pub limits: wgpu::Limits,
    /// The first failure since the last check.
    failure: Arc<Mutex<Option<String>>>,
    /// The reason for its loss, if it is lost.
    lost: Arc<Mutex<Option<String>>>,
    /// The bindings of its kernels.
    pub arrays: wgpu::BindGroupLayout,
    pub pipeline_layout: wgpu::PipelineLayout,
    /// The kernels by source text; `None` while one is compiled.
    kernels: Mutex<HashMap<String, Arc<Mutex<Option<wgpu::ComputePipeline>>>>>,
}

impl Device {
    /// Opens the first device whose name contains `name` (case-insensitive), or the first of all if `None`. An open
    /// device that is not lost is shared.
    ///
    /// # Errors
    /// Returns an error if there is no such device, it lacks `features` (only double precision is requested), or it
    /// cannot be opened.
    pub(crate) fn open(
        name: Option<&str>,
        features: wgpu::Features,
    ) -> Result<Arc<Self>, GpuError> {
        let open_device = with_open_devices(|open| {
            open.devices
                .retain(|(_, _, device)| lock(&device.lost).is_none());
            let fits = |(key, able, _): &&(Option<String>, wgpu::Features, _)| {
                key.as_deref() == name && *able == features
            };
            open.devices.iter().find(fits).map(|found| found.2.clone())
        });
        if let Some(device) = open_device {
            return Ok(device);
        }
        let device = Arc::new(Self::find(name, features)?);
        let name = name.map(str::to_owned);
        with_open_devices(|open| open.devices.push((name, features, device.clone())));
        Ok(device)
    }

    fn find(name: Option<&str>, features: wgpu::Features) -> Result<Self, GpuError> {
        let found = adapters();
        if found.is_empty() {
            return Err(GpuError::NoDevice);
        }
        let wanted = name.unwrap_or_default().to_lowercase();
        let fits = |a: &&wgpu::Adapter| a.get_info().name.to_lowercase().contains(&wanted);
        let adapter = found.iter().find(fits).ok_or_else(|| {
            let names: Vec<_> = found.iter().map(|a| a.get_info().name).collect();
            GpuError::NoSuchDevice {
                requested: name.unwrap_or_default().to_owned(),
                available: names.join(", "),
            }
        })?;
        if !adapter.features().contains(features) {
            return Err(GpuError::NoDoublePrecision {
                device: adapter.get_info().name,
            });
        }
        Self::open_adapter(adapter, features)
    }

    fn open_adapter(adapter: &wgpu::Adapter, features: wgpu::Features) -> Result<Self, GpuError> {
        let info = describe(adapter);
        let limits = adapter.limits();
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("clench"),
            required_limits: limits.clone(),
            required_features: features | (adapter.features() & wgpu::Features::TIMESTAMP_QUERY),
            ..wgpu::DeviceDescriptor::default()
        };
        let unusable = |e: wgpu::RequestDeviceError| GpuError::Unusable {
            device: info.name.clone(),
            reason: e.to_string(),
        };
        let (device, queue) =
            pollster::block_on(adapter.request_device(&descriptor)).map_err(unusable)?;
        let (failure, lost) = (Arc::default(), Arc::default());
        let recorder = |slot: &Arc<Mutex<Option<String>>>| {
            let slot = slot.clone();
            move |reason: String| {
                lock(&slot).get_or_insert(reason);
            }
        };
        let (record_loss, record_failure) = (recorder(&lost), recorder(&failure));
        device.set_device_lost_callback(move |_, reason| record_loss(reason));
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            record_failure(error.to_string())
        }));
        let arrays = layout(&device);
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("arrays"),
            bind_group_layouts: &[Some(&arrays)],
            immediate_size: 0,
        });
        Ok(Device {
            arrays,
            pipeline_layout,
            kernels: Mutex::default(),
            device,
            queue,
            info,
            limits,
            failure,
            lost,
        })
    }

    /// Returns the largest array that a kernel can access, bytes.
    pub(crate) fn max_buffer(&self) -> u64 {
        max_buffer(&self.limits)
    }

    /// Submits commands and waits for them.
    ///
    /// # Errors
    /// Returns an error if the device is lost or has reported an error since the last call.
    pub(crate) fn submit(&self, commands: wgpu::CommandBuffer) -> Result<(), GpuError> {
        let submission = self.queue.submit([commands]);
        self.wait(submission)
    }

    /// Waits for a submission and all before it.
    ///
    /// # Errors
    /// Returns an error if the device is lost or has reported an error since the last call.
    pub(crate) fn wait(&self, submission: wgpu::SubmissionIndex) -> Result<(), GpuError> {
        let waited = self.device.poll(wgpu::PollType::Wait {
            submission_index: Some(submission),
            timeout: None,
        });
        let failure = lock(&self.lost)
            .clone()
            .or_else(|| lock(&self.failure).take());
        match (failure, waited) {
            (Some(reason), _) => Err(self.lost(reason)),
            (None, Err(e)) => Err(self.lost(e.to_string())),
            (None, Ok(_)) => Ok(()),
        }
    }

    /// Returns the reason if the device is lost.
    pub(crate) fn loss(&self) -> Option<String> {
        lock(&self.lost).clone()
    }

    /// Frees unused resources.
    pub(crate) fn tidy(&self) {
        let _ = self.device.poll(wgpu::PollType::Poll);
    }

    /// Returns the kernel of a text from the cache, or compiles it with `compile`.
    ///
    /// # Errors
    /// Returns the errors of `compile`.
    pub(crate) fn kernel(
        &self,
        text: String,
        compile: impl FnOnce(&str) -> Result<wgpu::ComputePipeline, GpuError>,
    ) -> Result<wgpu::ComputePipeline, GpuError> {
        let slot = {
            let mut kernels = lock(&self.kernels);
            if kernels.len() >= MAX_KERNELS && !kernels.contains_key(&text) {
                kernels.clear();
            }
            Arc::clone(kernels.entry(text.clone()).or_default())
        };
        // Other kernels can be compiled meanwhile; requests for this one wait.
        let mut slot = lock(&slot);
        if let Some(known) = &*slot {
            return Ok(known.clone());
        }
        Ok(slot.insert(compile(&text)?).clone())
    }

    fn lost(&self, reason: String) -> GpuError {
        let device = self.info.name.clone();
        GpuError::Lost { device, reason }
    }

    /// Creates a zeroed array of the given bytes that kernels read and write.
    pub(crate) fn array(&self, label: &str, bytes: u64) -> wgpu::Buffer {
        self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: bytes.max(4),
            usage: wgpu::BufferUsages::STORAGE
                | wgpu::BufferUsages::COPY_DST
                | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        })
    }

    /// Creates a small read-only array with the given contents.
    pub(crate) fn constants(&self, label: &str, bytes: &[u8]) -> wgpu::Buffer {
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: bytes.len() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        self.queue.write_buffer(&buffer, 0, bytes);
        buffer
    }

    /// Downloads a part of an array to the host.
    ///
    /// # Errors
    /// Returns an error if the device was lost.
    pub(crate) fn download(
        &self,
        from: &wgpu::Buffer,
        start: u64,
        bytes: u64,
    ) -> Result<Vec<u8>, GpuError> {
        if bytes == 0 {
            return Ok(Vec::new());
        }
        let copy = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("download"),
            size: bytes,
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let mut encoder = self.device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(from, start, &copy, 0, bytes);
        let (sender, receiver) = mpsc::channel();
        encoder.map_buffer_on_submit(&copy, wgpu::MapMode::Read, .., move |mapped| {
            let _ = sender.send(mapped);
        });
        self.submit(encoder.finish())?;
        // Another thread that polls the device may receive the callback.
        let mapped = receiver.recv().map_err(|e| self.lost(e.to_string()))?;
        mapped.map_err(|e| self.lost(e.to_string()))?;
        let view = copy.get_mapped_range(..);
        let view = view.map_err(|e| self.lost(e.to_string()))?;
        Ok(view.to_vec())
    }
}
