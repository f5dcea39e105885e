// The sample times of buffers. CPU counterpart: `history.rs` of clench-dynamics.

// Returns true if a sample is due now; always if the period is zero.
fn is_due(h: u32, period: f32) -> bool {
    return period <= 0.0 || fetch_state(HISTORY + words[h + HISTORY_START]) + period <= clock();
}
