//! Per-environment parameters: the numbers of a model that differs from the batch's only in its parameters.

use crate::batch::GpuBatch;
use crate::error::GpuError;
use crate::precision::GpuReal;
use crate::tables::{OWN_PARAMETERS, Tables};
use clench_collide::ShapeKind;
use clench_rigid::model::Model;
use std::iter::repeat_n;
use zerocopy::IntoBytes;

impl<S: GpuReal> GpuBatch<S> {
    /// Returns the parameters of a model that differs from the batch's only in these.
    ///
    /// # Errors
    /// Returns an error if they need different kernels: a new spring, or a value that is compiled into them.
    pub(crate) fn parameters_of(&self, model: &Model) -> Result<Vec<S>, GpuError> {
        let (tables, _) = Tables::new::<S>(
            model,
            &self.settings,
            &self.base.candidates,
            self.base.kernels,
        );
        let base = &self.base;
        // Environments share meshes and height fields.
        let resized = model.geoms.iter().enumerate().any(|(g, geom)| {
            let is_shared = matches!(geom.kind, ShapeKind::Mesh | ShapeKind::HeightField);
            is_shared && model.params.geom_size[g] != self.model().params.geom_size[g]
        });
        let same_structure = tables.constants == base.constants && tables.layout == base.layout;
        if resized || !same_structure || tables.words != base.words {
            return Err(GpuError::Structure);
        }
        Ok(tables.numbers_in())
    }

    /// Sets the parameters of environments.
    ///
    /// # Errors
    /// Returns an error if the device has too little memory.
    pub(crate) fn write_parameters(
        &mut self,
        envs: &[usize],
        rows: &[Vec<S>],
    ) -> Result<(), GpuError> {
        self.end_rest();
        let count = self.count;
        let each = (size_of::<S>() * self.base.parameters.len()) as u64;
        let bytes = each * count as u64;
        if bytes > self.device.max_buffer() {
            return Err(GpuError::OutOfMemory {
                device: self.device.info.name.clone(),
                count,
                bytes: each,
                max: usize::try_from(self.device.max_buffer() / each.max(1)).ok(),
            });
        }
        if self.own.is_empty() {
            let each = self.base.parameters.iter();
            self.own = each.flat_map(|&x| repeat_n(x, count)).collect();
            self.arrays.parameters = self.device.array("parameters", bytes);
            self.bindings = self.arrays.bind(&self.device);
            let offset = 4 * OWN_PARAMETERS as u64;
            (self.device.queue).write_buffer(&self.arrays.words, offset, [1u32].as_bytes());
        }
        for (&env, row) in envs.iter().zip(rows) {
            for (k, &x) in row.iter().enumerate() {
                self.own[k * count + env] = x;
            }
        }
        (self.device.queue).write_buffer(&self.arrays.parameters, 0, self.own.as_bytes());
        Ok(())
    }
}
