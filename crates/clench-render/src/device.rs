//! The GPU that draws.

use std::sync::OnceLock;
use wgpu::{
    Adapter, Backends, Device, DeviceDescriptor, Instance, InstanceDescriptor, Limits,
    PowerPreference, Queue, RequestAdapterOptions,
};

/// An error of drawing.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// There is no device; includes a remedy.
    #[error(
        "there is no device to render on: neither a GPU with Vulkan, Metal or Direct3D 12, nor Mesa's software device; on Debian \
         and Ubuntu install the package mesa-vulkan-drivers ({0})"
    )]
    NoDevice(String),
    /// The device failed.
    #[error("the rendering device {0} failed: {1}")]
    Failed(String, String),
    /// The size of the image is out of range.
    #[error("an image of {0} x {1} pixels cannot be rendered: each side must have 1 to {2} pixels")]
    Size(u32, u32, u32),
    /// The camera does not exist in the model.
    #[error("there is no camera {0}, only {1}")]
    NoCamera(usize, usize),
    /// The state cannot be evaluated.
    #[error(transparent)]
    Sim(#[from] clench::SimError),
}

/// The reason why there is no device, after a search without success: a process searches once.
static MISSING: OnceLock<String> = OnceLock::new();

/// Returns the name of the device that draws; `None` if there is none.
pub fn device_name() -> Option<String> {
    adapter().map(|adapter| adapter.get_info().name).ok()
}

/// Finds the fastest GPU, or else a software device.
fn adapter() -> Result<Adapter, RenderError> {
    if let Some(why) = MISSING.get() {
        return Err(RenderError::NoDevice(why.clone()));
    }
    let instance = Instance::new(InstanceDescriptor {
        backends: Backends::PRIMARY,
        ..InstanceDescriptor::new_without_display_handle()
    });
    let adapter = pollster::block_on(instance.request_adapter(&RequestAdapterOptions {
        power_preference: PowerPreference::HighPerformance,
        ..RequestAdapterOptions::default()
    }));
    adapter.map_err(|error| {
        let why = MISSING.get_or_init(|| error.to_string());
        RenderError::NoDevice(why.clone())
    })
}

/// A device with its queue, and its name for messages.
pub(crate) struct Gpu {
    pub device: Device,
    pub queue: Queue,
    pub name: String,
}

impl Gpu {
    /// Opens the device that draws.
    ///
    /// # Errors
    /// Returns an error if there is none, or it does not start.
    pub(crate) fn open() -> Result<Self, RenderError> {
        let adapter = adapter()?;
        let name = adapter.get_info().name;
        let opened = pollster::block_on(adapter.request_device(&DeviceDescriptor {
            label: Some("clench"),
            required_limits: Limits {
                max_buffer_size: adapter.limits().max_buffer_size,
                ..Limits::default().using_resolution(adapter.limits())
            },
            ..DeviceDescriptor::default()
        }));
        let (device, queue) =
            opened.map_err(|error| RenderError::Failed(name.clone(), error.to_string()))?;
        Ok(Gpu {
            device,
            queue,
            name,
        })
    }
}
