//! Steps a second by number of environments, on the device and in the processor's lanes (single precision, all threads) in the
//! same run, and the time of each stage: `speed MODEL [MOST ENVIRONMENTS] [DEVICE]`.

use clench_gpu::{GpuBatch, GpuOptions};
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
    println!("{path}, steps a second:");
    println!(
        "{:>8} {:>12} {:>12} {:>8}",
        "envs", "device", "processor", "ratio"
    );
    let counts = (0..17)
        .map(|k| 1usize << k)
        .filter(|n| n % 4 == 0 || *n == 1);
    for count in counts.take_while(|&count| count <= most) {
        let options = GpuOptions {
            device: device.clone(),
            ..GpuOptions::default()
        };
        let mut gpu = match GpuBatch::new(model.clone(), count, options) {
            Ok(gpu) => gpu,
            Err(e) => {
                println!("{count:>8} {e}");
                break;
            }
        };
        let mut cpu = Batch::<f32>::new(model.clone(), count)?;
        let gpu_speed = speed(count, |steps| Ok(gpu.step(steps)?))?;
        let cpu_speed = speed(count, |steps| {
            (0..steps).try_for_each(|_| cpu.step().map(|_| ()))?;
            Ok(())
        })?;
        println!(
            "{count:>8} {gpu_speed:>12.0} {cpu_speed:>12.0} {:>8.3}",
            gpu_speed / cpu_speed
        );
        if count * 4 > most {
            println!(
                "{}, {} bytes an environment",
                gpu.device(),
                gpu.bytes_per_env()
            );
            for (stage, seconds) in gpu.time_stages()? {
                println!(
                    "{stage:>12} {:8.3} µs an environment",
                    1e6 * seconds / count as f64
                );
            }
        }
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
