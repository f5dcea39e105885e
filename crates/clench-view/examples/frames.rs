//! Measures the server's cost of a frame: `cargo run --release -p clench-view --example frames [MODEL...]`.
//!
//! Steps each model (by default the humanoid and a heap of a thousand bodies) and makes a frame every eighth step, as
//! `clench view` does sixty times a second. Prints one JSON line per model: bodies, mean contacts, mean bytes of a
//! frame and of its delta to the previous one, and the median times in µs of a frame, a delta, and the eight steps.

use clench::{Model, Sim, load, load_str};
use clench_view::delta::delta;
use clench_view::frame::{FrameExtras, encode};
use serde_json::json;
use std::error::Error;
use std::sync::Arc;
use std::time::Instant;

const FRAMES: usize = 60;
const STEPS: usize = 8;

/// A thousand bodies of four shapes that fall onto each other.
const HEAP: &str = "<mujoco model='a thousand bodies'><option timestep='0.002'/><worldbody><geom type='plane' size='9 9 1'/>
  <replicate count='10' offset='.21 .01 .003'><replicate count='25' offset='.013 .21 .002'>
    <body pos='0 0 .06'><freejoint/><geom size='.05'/></body>
    <body pos='.02 .01 .2' euler='10 20 0'><freejoint/><geom type='box' size='.05 .05 .05'/></body>
    <body pos='0 .02 .35' euler='80 0 0'><freejoint/><geom type='capsule' size='.04 .05'/></body>
    <body pos='.01 0 .5' euler='40 0 0'><freejoint/><geom type='cylinder' size='.05 .05'/></body>
  </replicate></replicate></worldbody></mujoco>";

fn main() -> Result<(), Box<dyn Error>> {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
    let named: Vec<String> = std::env::args().skip(1).collect();
    for path in &named {
        measure(load(path)?)?;
    }
    if named.is_empty() {
        measure(load(format!("{root}/models/humanoid.xml"))?)?;
        measure(load_str(HEAP)?)?;
    }
    Ok(())
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

fn measure(model: Model) -> Result<(), Box<dyn Error>> {
    let mut sim = Sim::<f64>::new(Arc::new(model))?;
    let (mut bytes, mut changed, mut contacts) = (0, 0, 0);
    let (mut steps, mut frames, mut deltas) = (Vec::new(), Vec::new(), Vec::new());
    let mut last = Vec::new();
    for _ in 0..FRAMES {
        let start = Instant::now();
        for _ in 0..STEPS {
            sim.step()?;
        }
        steps.push(1e6 * start.elapsed().as_secs_f64());
        let start = Instant::now();
        let frame = encode(&mut sim, &FrameExtras::default())?;
        frames.push(1e6 * start.elapsed().as_secs_f64());
        let start = Instant::now();
        let delta = delta(&last, &frame);
        deltas.push(1e6 * start.elapsed().as_secs_f64());
        changed += delta.map_or(frame.len(), |delta| delta.len());
        bytes += frame.len();
        last = frame;
        contacts += sim.contacts().len();
    }
    let row = json!({
        "model": sim.model().name,
        "bodies": sim.model().nbody() - 1,
        "contacts": contacts / FRAMES,
        "bytes": bytes / FRAMES,
        "changed_bytes": changed / FRAMES,
        "delta_microseconds": median(deltas),
        "frame_microseconds": median(frames),
        "steps_microseconds": median(steps),
    });
    println!("{row}");
    Ok(())
}
