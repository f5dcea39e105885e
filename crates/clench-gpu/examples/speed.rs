//! Steps a second by number of environments, on the device and in the processor's lanes (single precision, all threads) in the
//! same run, and the time of each stage in µs an environment, as lines of JSON: `speed MODEL [MOST ENVIRONMENTS] [DEVICE]`.

use clench_gpu::{GpuBatch, GpuError, GpuOptions};
use clench_rigid::Batch;
use std::error::Error;
use std::sync::Arc;
use std::time::Instant;

/// Steps before the clock starts: what is compiled, loaded and settled by then is not counted.
const WARM_UP: usize = 20;
/// How long a measurement lasts at least, s.
const LEAST: f64 = 1.0;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments
        .next()
        .ok_or("speed MODEL [MOST ENVIRONMENTS] [DEVICE]")?;
    let most = arguments.next().map_or(Ok(65_536), |n| n.parse())?;
    let device = arguments.next();
    let model = Arc::new(clench_formats::load(&path)?);
    let counts = (0..9).map(|k| 1usize << (2 * k));
    for count in counts.take_while(|&count| count <= most) {
        let options = GpuOptions {
            device: device.clone(),
            ..GpuOptions::default()
        };
        let mut gpu = match GpuBatch::<f32>::new(model.clone(), count, options) {
            Ok(gpu) => gpu,
            // More than the device holds.
            Err(e @ GpuError::OutOfMemory { .. }) => {
                eprintln!("{e}");
                break;
            }
            Err(e) => return Err(e.into()),
        };
        let mut cpu = Batch::<f32>::new(model.clone(), count)?;
        let gpu_speed = speed(count, |steps| Ok(gpu.step(steps)?))?;
        let cpu_speed = speed(count, |steps| Ok(cpu.step_n(steps).map(drop)?))?;
        let stages = gpu.time_stages()?.into_iter();
        let stages = stages
            .map(|(stage, seconds)| format!("\"{stage}\": {:.4}", 1e6 * seconds / count as f64));
        println!(
            "{{\"envs\": {count}, \"device\": {gpu_speed:.0}, \"processor\": {cpu_speed:.0}, \"bytes_per_env\": {}, \
             \"name\": {:?}, \"stages\": {{{}}}}}",
            gpu.bytes_per_env(),
            gpu.device().name,
            Vec::from_iter(stages).join(", ")
        );
    }
    Ok(())
}

/// Steps of environments in a second.
fn speed(
    count: usize,
    mut step: impl FnMut(usize) -> Result<(), Box<dyn Error>>,
) -> Result<f64, Box<dyn Error>> {
    step(WARM_UP)?;
    let (start, mut steps) = (Instant::now(), 0);
    while start.elapsed().as_secs_f64() < LEAST {
        step(8)?;
        steps += 8;
    }
    Ok((steps * count) as f64 / start.elapsed().as_secs_f64())
}
