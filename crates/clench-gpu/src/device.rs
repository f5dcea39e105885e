//! Graphics devices: which there are, and one taken up for computing.

use crate::error::GpuError;
use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

/// A graphics device of this machine.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DeviceInfo {
    /// Its name, as the driver tells it.
    pub name: String,
    /// What it is: a card, part of the processor, or software.
    pub kind: String,
    /// By what it is reached, such as Vulkan, and its driver.
    pub driver: String,
    /// The largest buffer, bytes: bounds how many environments fit.
    pub max_buffer: u64,
    /// Whether it is software that runs on the processor.
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
        wgpu::DeviceType::DiscreteGpu => "card",
        wgpu::DeviceType::IntegratedGpu => "part of the processor",
        wgpu::DeviceType::VirtualGpu => "virtual card",
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

/// The largest array that a kernel can see.
fn max_buffer(limits: &wgpu::Limits) -> u64 {
    limits
        .max_buffer_size
        .min(limits.max_storage_buffer_binding_size)
}

/// All that can compute, cards before software.
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

/// The devices of this machine that can compute, in the order in which they are chosen: cards first, software last.
pub fn devices() -> Vec<DeviceInfo> {
    adapters().iter().map(describe).collect()
}

/// A device that was taken up.
pub(crate) struct Device {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    pub info: DeviceInfo,
    pub limits: wgpu::Limits,
    /// What went wrong with it, since it was last looked at.
    failure: Arc<Mutex<Option<String>>>,
}

impl Device {
    /// Takes up the first device whose name contains `name`, whatever the case of its letters; the first of all without one.
    ///
    /// # Errors
    /// No such device, one without `features` (of which only double precision is asked for), or one that cannot be had.
    pub(crate) fn open(name: Option<&str>, features: wgpu::Features) -> Result<Self, GpuError> {
        let found = adapters();
        if found.is_empty() {
            return Err(GpuError::NoDevice);
        }
        let wanted = name.unwrap_or_default().to_lowercase();
        let fits = |a: &&wgpu::Adapter| a.get_info().name.to_lowercase().contains(&wanted);
        let adapter = found.iter().find(fits).ok_or_else(|| {
            let names: Vec<_> = found.iter().map(|a| a.get_info().name).collect();
            GpuError::NoSuchDevice {
                asked: name.unwrap_or_default().to_owned(),
                known: names.join(", "),
            }
        })?;
        if !adapter.features().contains(features) {
            return Err(GpuError::NoDoublePrecision {
                device: adapter.get_info().name,
            });
        }
        Self::take_up(adapter, features)
    }

    fn take_up(adapter: &wgpu::Adapter, features: wgpu::Features) -> Result<Self, GpuError> {
        let info = describe(adapter);
        let limits = adapter.limits();
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("clench"),
            required_limits: limits.clone(),
            required_features: features,
            ..wgpu::DeviceDescriptor::default()
        };
        let unusable = |e: wgpu::RequestDeviceError| GpuError::Unusable {
            device: info.name.clone(),
            reason: e.to_string(),
        };
        let (device, queue) =
            pollster::block_on(adapter.request_device(&descriptor)).map_err(unusable)?;
        let failure = Arc::new(Mutex::new(None));
        let note = |failure: &Arc<Mutex<Option<String>>>| {
            let failure = failure.clone();
            move |reason: String| {
                let mut slot = failure.lock().unwrap_or_else(PoisonError::into_inner);
                slot.get_or_insert(reason);
            }
        };
        let (lost, wrong) = (note(&failure), note(&failure));
        device.set_device_lost_callback(move |_, reason| lost(reason));
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| wrong(error.to_string())));
        Ok(Device {
            device,
            queue,
            info,
            limits,
            failure,
        })
    }

    /// The largest array that a kernel can see, bytes.
    pub(crate) fn max_buffer(&self) -> u64 {
        max_buffer(&self.limits)
    }

    /// Waits until all that was submitted is done.
    ///
    /// # Errors
    /// That the device was lost, or refused something, since the last call.
    pub(crate) fn wait(&self) -> Result<(), GpuError> {
        let waited = self.device.poll(wgpu::PollType::wait_indefinitely());
        let mut failure = self.failure.lock().unwrap_or_else(PoisonError::into_inner);
        match (failure.take(), waited) {
            (Some(reason), _) => Err(self.lost(reason)),
            (None, Err(e)) => Err(self.lost(e.to_string())),
            (None, Ok(_)) => Ok(()),
        }
    }

    pub(crate) fn lost(&self, reason: String) -> GpuError {
        let device = self.info.name.clone();
        GpuError::Lost { device, reason }
    }

    /// An array of so many bytes, all zero, that kernels read and write.
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

    /// A small array that kernels only read, with what is in it.
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

    /// The bytes of a part of an array, on this side of the bus.
    ///
    /// # Errors
    /// That the device was lost.
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
        self.queue.submit([encoder.finish()]);
        copy.map_async(wgpu::MapMode::Read, .., |_| ());
        self.wait()?;
        let view = copy.get_mapped_range(..);
        let view = view.map_err(|e| self.lost(e.to_string()))?;
        Ok(view.to_vec())
    }
}
