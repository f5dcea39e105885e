// Buffers of past controls: an owner's number, the times of samples, oldest first, relative to the present, and their
// values. CPU counterpart: `history.rs` of clench-dynamics. A buffer is a row of words at `h`.

fn sample_time(h: u32, k: u32) -> f32 {
    return fetch_state(HISTORY + words[h + HISTORY_START] + 1u + k);
}

fn sample_value(h: u32, k: u32, part: u32) -> f32 {
    return fetch_state(HISTORY + words[h + HISTORY_START] + 1u + words[h + HISTORY_SAMPLES] + k * words[h + HISTORY_WIDTH] + part);
}

// Returns the slope between two samples; one second replaces a zero time difference.
fn sample_slope(h: u32, before: u32, after: u32, part: u32) -> f32 {
    let time = sample_time(h, after) - sample_time(h, before);
    return (sample_value(h, after, part) - sample_value(h, before, part)) / select(1.0, time, time > 0.0);
}

// Interpolates between samples `k` − 1 and `k`.
fn between_samples(h: u32, k: u32, at: f32, part: u32) -> f32 {
    let before = sample_value(h, k - 1u, part);
    let after = sample_value(h, k, part);
    let difference = sample_time(h, k) - sample_time(h, k - 1u);
    let span = select(1.0, difference, difference > 0.0);
    let x = (at - sample_time(h, k - 1u)) / span;
    switch words[h + HISTORY_INTERPOLATION] {
        case HOLD: {
            return before;
        }
        case LINEAR: {
            return before + x * (after - before);
        }
        case CUBIC, default: {
            var left: f32 = 0.0;
            if (k > 1u) {
                left = sample_slope(h, k - 2u, k, part);
            }
            var right: f32 = 0.0;
            if (k + 1u < words[h + HISTORY_SAMPLES]) {
                right = sample_slope(h, k - 1u, k + 1u, part);
            }
            let squared = x * x;
            let cubed = x * x * x;
            let rise = 3.0 * squared - 2.0 * cubed;
            let bend = span * (left * (cubed - 2.0 * squared + x) + right * (cubed - squared));
            return before * (1.0 - rise) + after * rise + bend;
        }
    }
}

// Returns a part of the buffer's value at a time relative to the present. It is constant before the oldest and after
// the newest sample.
fn read_history(h: u32, at: f32, part: u32) -> f32 {
    let same = max(8.0 * EPSILON * abs(at), TINY);
    var newest = 0u;
    for (var k = 1u; k < words[h + HISTORY_SAMPLES]; k++) {
        if (sample_time(h, k) <= at + same) {
            newest = k;
        }
    }
    if (newest + 1u < words[h + HISTORY_SAMPLES] && sample_time(h, newest) + same < at) {
        return between_samples(h, newest + 1u, at, part);
    }
    return sample_value(h, newest, part);
}
