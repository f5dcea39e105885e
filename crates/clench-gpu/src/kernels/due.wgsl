// When a buffer takes a sample. Sister of `history.rs` of clench-rigid.

// Where a sample is due now; always where the period is zero.
fn is_due(h: u32, period: f32) -> bool {
    return period <= 0.0 || given(HISTORY + words[h]) + period <= clock();
}
