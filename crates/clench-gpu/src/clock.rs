//! Timing of kernels by the device's clock.

use crate::device::Device;
use crate::error::GpuError;
use zerocopy::FromBytes;

/// The bytes of a timestamp.
const TIME: u64 = 8;

/// Timestamps before and after each of a number of compute passes.
pub(crate) struct Clock {
    times: wgpu::QuerySet,
    /// The buffer of the timestamps.
    seen: wgpu::Buffer,
    passes: usize,
}

impl Clock {
    /// Creates a clock for `passes` passes.
    ///
    /// # Errors
    /// Returns an error if the device has no clock.
    pub(crate) fn new(device: &Device, passes: usize) -> Result<Self, GpuError> {
        let features = device.device.features();
        if !features.contains(wgpu::Features::TIMESTAMP_QUERY) {
            return Err(GpuError::Unusable {
                device: device.info.name.clone(),
                reason: "it has no timestamps to measure kernels".to_owned(),
            });
        }
        let descriptor = wgpu::QuerySetDescriptor {
            label: Some("times"),
            ty: wgpu::QueryType::Timestamp,
            count: 2 * passes as u32,
        };
        Ok(Clock {
            times: device.device.create_query_set(&descriptor),
            seen: device.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("times"),
                size: 2 * TIME * passes as u64,
                usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            }),
            passes,
        })
    }

    /// Returns the timestamp writes of the k-th timed pass.
    pub(crate) fn timestamp_writes(
        &self,
        k: usize,
    ) -> Option<wgpu::ComputePassTimestampWrites<'_>> {
        Some(wgpu::ComputePassTimestampWrites {
            query_set: &self.times,
            beginning_of_pass_write_index: Some(2 * k as u32),
            end_of_pass_write_index: Some(2 * k as u32 + 1),
        })
    }

    /// Writes the timestamps to the buffer, after the last pass.
    pub(crate) fn write(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.resolve_query_set(&self.times, 0..2 * self.passes as u32, &self.seen, 0);
    }

    /// Returns the duration of each pass, s.
    ///
    /// # Errors
    /// Returns an error if the device was lost.
    pub(crate) fn read(&self, device: &Device) -> Result<Vec<f64>, GpuError> {
        let bytes = device.download(&self.seen, 0, 2 * TIME * self.passes as u64)?;
        let period = f64::from(device.queue.get_timestamp_period()) * 1e-9;
        let ticks = bytes.chunks_exact(TIME as usize);
        let ticks = Vec::from_iter(ticks.map(|ticks| u64::read_from_bytes(ticks).unwrap_or(0)));
        let passes = ticks.chunks_exact(2);
        Ok(passes
            .map(|pass| pass[1].saturating_sub(pass[0]) as f64 * period)
            .collect())
    }
}
