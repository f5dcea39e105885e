//! Measures steps per second by number of environments, on the device and in the processor's lanes (single precision,
//! all threads) in the same run, and the time of each stage in µs per environment. Prints lines of JSON:
//! `speed MODEL [MOST ENVIRONMENTS] [STEPS] [DEVICE]`.
//!
//! All environments start in the model's first keyframe, if any. Every eight steps each gets its own controls, within a
//! hundredth of their range of those of the keyframe, as from a policy on the host; this is included in the time.

use clench_gpu::{GpuBatch, GpuError, GpuOptions};
use clench_rigid::{Batch, Model};
use std::error::Error;
use std::sync::Arc;
use std::time::Instant;

/// Steps before the clock starts, in which everything is compiled and loaded.
const WARM_UP: usize = 24;
/// The number of steps with the same controls.
const HOLD: usize = 8;
/// The number of steps in which each kernel is timed.
const TIMED: usize = 8;
/// The longest duration of a measurement, s, even if few steps are done.
const LONGEST: f64 = 5.0;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments
        .next()
        .ok_or("speed MODEL [MOST ENVIRONMENTS] [STEPS] [DEVICE]")?;
    let most = arguments.next().map_or(Ok(65_536), |n| n.parse())?;
    let steps = arguments.next().map_or(Ok(1000), |n| n.parse())?;
    let device = arguments.next();
    let model = Arc::new(clench_formats::load(&path)?);
    let counts = (0..17).map(|k| 1usize << k);
    let counts = counts.filter(|&count| count <= most && (count.ilog2() % 2 == 0 || count == 8192));
    for count in counts {
        let mut gpu = match batches(&model, count, device.as_deref()) {
            Ok(gpu) => gpu,
            // More than fits on the device.
            Err(e @ GpuError::OutOfMemory { .. }) => {
                eprintln!("{e}");
                break;
            }
            Err(e) => return Err(e.into()),
        };
        let mut cpu = Batch::<f32>::new(model.clone(), count)?;
        if !model.keyframes.is_empty() {
            (0..count).try_for_each(|env| cpu.reset_to_keyframe(env, 0))?;
            write(&mut gpu, "qpos", cpu.state.qpos.as_slice())?;
            write(&mut gpu, "qvel", cpu.state.qvel.as_slice())?;
        }
        let center = cpu.state.ctrl.as_slice()[..model.nu()].to_vec();
        let mut controls = Controls::new(&model, &center, count);
        let gpu_speed = speed(count, steps, |steps, last| {
            write(&mut gpu, "ctrl", controls.next())?;
            gpu.iter_mut().try_for_each(|batch| batch.step(steps))?;
            if last {
                gpu.iter_mut().try_for_each(GpuBatch::finish)?;
            }
            Ok(())
        })?;
        // Immediately: an idle GPU lowers its clock rate.
        let mut failed = 0;
        let (mut rows, mut iterations) = (0, 0);
        let mut times: Vec<(&str, f64)> = Vec::new();
        for batch in &mut gpu {
            failed += batch.statuses()?.iter().flatten().count();
            for solve in batch.solves()? {
                rows += solve.rows;
                iterations += solve.iterations;
            }
            for _ in 0..TIMED {
                let stages = match batch.time_stages() {
                    Ok(stages) => stages,
                    // The device has no clock.
                    Err(e @ GpuError::Unusable { .. }) => {
                        eprintln!("{e}");
                        break;
                    }
                    Err(e) => return Err(e.into()),
                };
                for (k, (stage, seconds)) in stages.into_iter().enumerate() {
                    match times.get_mut(k) {
                        Some((_, all)) => *all += seconds / TIMED as f64,
                        None => times.push((stage, seconds / TIMED as f64)),
                    }
                }
            }
        }
        let mut controls = Controls::new(&model, &center, count);
        let cpu_speed = speed(count, steps, |steps, _| {
            cpu.state
                .ctrl
                .as_mut_slice()
                .copy_from_slice(controls.next());
            Ok(cpu.step_n(steps).map(drop)?)
        })?;
        let per_env = |sum: usize| sum as f64 / count as f64;
        let stages = times
            .iter()
            .map(|(stage, seconds)| format!("\"{stage}\": {:.4}", 1e6 * seconds / count as f64));
        println!(
            "{{\"envs\": {count}, \"device\": {gpu_speed:.0}, \"processor\": {cpu_speed:.0}, \"bytes_per_env\": {}, \
             \"failed\": {failed}, \"rows\": {:.1}, \"iterations\": {:.2}, \"name\": {:?}, \"stages\": {{{}}}}}",
            gpu[0].bytes_per_env(),
            per_env(rows),
            per_env(iterations),
            gpu[0].device().name,
            Vec::from_iter(stages).join(", ")
        );
    }
    Ok(())
}

/// Creates `count` environments: one batch, or several of the same size if the device's largest buffer is too small.
fn batches(
    model: &Arc<Model>,
    count: usize,
    device: Option<&str>,
) -> Result<Vec<GpuBatch>, GpuError> {
    let make = |count| {
        let options = GpuOptions {
            device: device.map(str::to_owned),
            ..GpuOptions::default()
        };
        GpuBatch::new(model.clone(), count, options)
    };
    match make(count) {
        Err(GpuError::OutOfMemory { max: Some(max), .. }) if max > 0 => {
            let pieces = count.div_ceil(max).next_power_of_two();
            (0..pieces).map(|_| make(count / pieces)).collect()
        }
        made => Ok(vec![made?]),
    }
}

/// Writes a field of the environments of all batches.
fn write(batches: &mut [GpuBatch], name: &str, values: &[f32]) -> Result<(), GpuError> {
    let each = values.len() / batches.len();
    let mut rest = values;
    batches.iter_mut().try_for_each(|batch| {
        let (own, others) = rest.split_at(each);
        rest = others;
        batch.write(name, own)
    })
}

/// Reproducible controls of all environments: a few sets are created beforehand and used in turn.
struct Controls {
    made: Vec<Vec<f32>>,
    turn: usize,
}

impl Controls {
    /// The number of sets.
    const COUNT: usize = 8;

    fn new(model: &Model, center: &[f32], count: usize) -> Self {
        let limited = (model.actuators.iter()).flat_map(|actuator| actuator.ctrllimited.iter());
        let ranges = limited.zip(&model.params.actuator_ctrlrange).zip(center);
        let ranges = Vec::from_iter(ranges.map(|((&limited, range), &center)| {
            let half = if limited {
                0.5 * (range[1] - range[0])
            } else {
                1.0
            };
            (center, 0.01 * half as f32)
        }));
        let mut random: u64 = 0x9E37_79B9_7F4A_7C15;
        let mut value = |&(center, size): &(f32, f32)| {
            // Marsaglia's xorshift.
            random ^= random << 13;
            random ^= random >> 7;
            random ^= random << 17;
            let unit = (random >> 40) as f32 / (1 << 24) as f32;
            center + size * (2.0 * unit - 1.0)
        };
        let mut one = || Vec::from_iter((0..count).flat_map(|_| &ranges).map(&mut value));
        Controls {
            made: (0..Self::COUNT).map(|_| one()).collect(),
            turn: 0,
        }
    }

    fn next(&mut self) -> &[f32] {
        self.turn += 1;
        &self.made[self.turn % Self::COUNT]
    }
}

/// Returns the environment steps per second. In the last call the flag is true: it returns when all steps are done.
fn speed(
    count: usize,
    steps: usize,
    mut step: impl FnMut(usize, bool) -> Result<(), Box<dyn Error>>,
) -> Result<f64, Box<dyn Error>> {
    for k in 1..=WARM_UP / HOLD {
        step(HOLD, k == WARM_UP / HOLD)?;
    }
    let (start, mut done, mut last) = (Instant::now(), 0, false);
    while !last {
        done += HOLD;
        last = done >= steps || start.elapsed().as_secs_f64() >= LONGEST;
        step(HOLD, last)?;
    }
    Ok((done * count) as f64 / start.elapsed().as_secs_f64())
}
