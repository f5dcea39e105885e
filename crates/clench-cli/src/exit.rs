//! How the program ends.

/// Exit code of bad input: a model, a state or an option that cannot be used.
pub(super) const BAD_INPUT: u8 = 2;

/// The reader of our output has gone, as in `clench … | head`: nothing to complain about.
pub(super) fn is_closed_pipe(error: &anyhow::Error) -> bool {
    error.chain().any(|cause| {
        cause
            .downcast_ref::<std::io::Error>()
            .is_some_and(|e| e.kind() == std::io::ErrorKind::BrokenPipe)
    })
}
