//! The exit codes of the program.

/// The exit code of bad input: a model, a state or an option that cannot be used.
pub(super) const BAD_INPUT: u8 = 2;

/// Returns true if the reader of the output has closed it, as in `clench …
/// head`; this is not reported.
pub(super) fn is_closed_pipe(error: &anyhow::Error) -> bool {
    error.chain().any(|cause| {
        cause
            .downcast_ref::<std::io::Error>()
            .is_some_and(|e| e.kind() == std::io::ErrorKind::BrokenPipe)
    })
}
