//! Options with which the kernels of a batch are compiled.

/// Options of the kernels, besides the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct KernelOptions {
    /// True if they serve any model: they read the layout for its features.
    pub general: bool,
    /// True if the state has slots for constraints that are added at run time.
    pub slots: bool,
}
