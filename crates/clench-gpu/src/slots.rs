//! Slots for constraints that are added at run time. A batch has them on request: every environment needs memory for
//! their rows, and kernels that read them.

use crate::batch::{GpuBatch, check_memory, in_memory};
use crate::error::GpuError;
use crate::kernel_options::KernelOptions;
use crate::pipelines::Pipelines;
use crate::plan::Plan;
use crate::precision::GpuReal;

/// The maximum number of slots.
const MAX_SLOTS: usize = 1 << 16;

impl<S: GpuReal> GpuBatch<S> {
    /// Gives every environment the model's slots for constraints that are added at run time, all empty. The fields
    /// `dynamic_kind`, `dynamic_body1`, `dynamic_body2`, `dynamic_anchor1`, `dynamic_anchor2` and `dynamic_quat` of the
    /// state can then be written, and adding or removing a constraint compiles nothing. Repeated calls have no effect.
    ///
    /// # Errors
    /// Returns an error if memory is too small, or if the device refuses a kernel. The batch does not change then.
    pub fn enable_dynamic_constraints(&mut self) -> Result<(), GpuError> {
        let slots = self.model.max_dynamic_constraints;
        if self.has_slots() || slots == 0 {
            return Ok(());
        }
        let device = &*self.device;
        if slots > MAX_SLOTS {
            return Err(GpuError::TooManySlots {
                max: MAX_SLOTS,
                slots,
            });
        }
        let kernels = KernelOptions {
            slots: true,
            ..self.base.kernels
        };
        let available = device.limits.max_compute_workgroup_storage_size as usize;
        let pairs = self.base.candidates.clone();
        let plan = Plan::<S>::new(&self.model, &self.settings, pairs, kernels, available);
        let sizes = plan.sizes();
        check_memory(device, self.count, sizes)?;
        let arrays = in_memory(device, self.count, sizes, || {
            let mut arrays = self.arrays.clone();
            arrays.state = device.array("state", (sizes[0] * self.count) as u64);
            arrays.rows = device.array("rows", (sizes[2] * self.count) as u64);
            arrays.layout = device.constants("layout", &plan.preface.layout.bytes::<S>());
            arrays
        })?;
        let features = (&*self.model, self.settings.flags.sleep);
        let mut pipelines = Pipelines::new::<S>(device, plan.preface, self.count, features)?;
        pipelines.observe_as::<S>(&self.pipelines, device, self.count)?;
        // The slots come last in the state, and its other fields stay where they are.
        let bytes = (size_of::<S>() * self.state.size * self.count) as u64;
        self.submit(|batch, encoder| {
            encoder.copy_buffer_to_buffer(&batch.arrays.state, 0, &arrays.state, 0, bytes);
        })?;
        for old in [&self.arrays.state, &self.arrays.rows, &self.arrays.layout] {
            old.destroy();
        }
        self.bindings = arrays.bind(device);
        self.arrays = arrays;
        self.pipelines = pipelines;
        self.base = plan.base;
        self.capacity = plan.capacity;
        (self.state, self.rows) = (plan.state, plan.rows);
        Ok(())
    }

    /// Returns true if the environments have slots.
    pub(crate) fn has_slots(&self) -> bool {
        self.base.kernels.slots
    }
}
