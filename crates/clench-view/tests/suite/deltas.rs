//! A frame and its delta make the next frame, over any interval, and static data is not sent again.

use clench::{Sim, load_str};
use clench_view::delta::{DELTA, delta};
use clench_view::frame::{FrameExtras, SECTIONS, encode};
use std::sync::Arc;

/// A falling ball, a ball at rest, and fifty that are part of the world.
const SCENE: &str = "<mujoco><worldbody><geom type='plane' size='1 1 1'/>
    <body pos='0 0 .3'><freejoint/><geom size='.1'/></body>
    <body pos='1 0 .1'><freejoint/><geom size='.1'/></body>
    <replicate count='50' offset='0 .3 0'><body pos='3 0 1'><geom size='.1'/></body></replicate>
  </worldbody></mujoco>";

fn number(bytes: &[u8], at: usize) -> usize {
    u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize
}

/// Applies a delta as a browser does.
fn patched(before: &[u8], changed: &[u8]) -> Vec<u8> {
    assert!(changed.starts_with(&DELTA));
    let head = 20 + 4 * SECTIONS.len();
    let mut made = [b"CLNF", &changed[4..head]].concat();
    let (mut at, mut old) = (head, head);
    let mut take = |bytes: usize| {
        at += bytes;
        &changed[at - bytes..at]
    };
    for (index, section) in SECTIONS.iter().enumerate() {
        let row = 4 * section.width;
        let [rows, count] = [before, changed].map(|frame| number(frame, 20 + 4 * index));
        let kept = &before[old..old + row * rows];
        old += kept.len();
        match number(take(4), 0) {
            0 => made.extend(kept),
            1 => {
                let bits = take(4 * count.div_ceil(32)).to_vec();
                for (k, kept) in kept.chunks_exact(row).enumerate() {
                    let changed = bits[k / 8] >> (k % 8) & 1 == 1;
                    made.extend(if changed { take(row) } else { kept });
                }
            }
            _ => made.extend(take(row * count)),
        }
    }
    made
}

#[test]
fn a_client_that_missed_frames_still_has_the_right_ones() {
    let mut sim = Sim::<f64>::new(Arc::new(load_str(SCENE).unwrap())).unwrap();
    let mut frames = Vec::new();
    for _ in 0..40 {
        (0..10).for_each(|_| sim.step().unwrap());
        frames.push(encode(&mut sim, &FrameExtras::default()).unwrap());
    }
    for missed in [1, 3, 17] {
        let mut seen = frames[0].clone();
        for frame in frames.iter().step_by(missed).skip(1) {
            seen = match delta(&seen, frame) {
                Some(changed) => patched(&seen, &changed),
                None => frame.clone(),
            };
            assert!(seen == *frame);
        }
    }
}

#[test]
fn unchanged_values_are_not_sent_again() {
    let mut sim = Sim::<f64>::new(Arc::new(load_str(SCENE).unwrap())).unwrap();
    let mut frame = || {
        sim.step().unwrap();
        encode(&mut sim, &FrameExtras::default()).unwrap()
    };
    let (first, second) = (frame(), frame());
    let changed = delta(&first, &second).unwrap();
    // At most two of fifty-three bodies have moved.
    assert!(
        4 * changed.len() < second.len(),
        "{} of {}",
        changed.len(),
        second.len()
    );
    let same = delta(&second, &second).unwrap();
    assert_eq!(same.len(), 20 + 8 * SECTIONS.len());
    for broken in [&second[..30], &second[..second.len() - 4], b"CLNF", b""] {
        assert!(delta(broken, &second).is_none() && delta(&second, broken).is_none());
    }
}
