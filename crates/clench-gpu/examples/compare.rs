//! Prints the distance of the device from the processor on random states of a model, field by field:
//! `compare MODEL [STATES] [SPREAD]`.

#[path = "../tests/device/common/mod.rs"]
mod common;

use std::sync::Arc;
use std::time::Instant;

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let number = |i: usize, default: f64| {
        arguments
            .get(i)
            .map_or(default, |a| a.parse().expect("a number"))
    };
    let model = Arc::new(clench_formats::load(&arguments[1]).expect("a model"));
    let count = number(2, 32.0) as usize;
    let mut random = common::Random::new(7);
    let states: Vec<_> = (0..count)
        .map(|_| common::random_state(&model, &mut random, number(3, 1.0)))
        .collect();
    let mut batch = match clench_gpu::GpuBatch::new(model, count, Default::default()) {
        Ok(batch) => batch,
        Err(e) => return println!("{e}"),
    };
    common::upload(&mut batch, &states);
    println!(
        "{}: {} bytes an environment",
        batch.device(),
        batch.bytes_per_env()
    );
    for pass in ["first, with compilation", "second"] {
        let start = Instant::now();
        batch.forward().expect("a device");
        println!("{pass}: {:.1} ms", start.elapsed().as_secs_f64() * 1e3);
    }
    let worst = |d: &[common::Distance], of: fn(&common::Distance) -> f64| {
        d.iter().map(of).fold(0.0f64, f64::max)
    };
    for (name, found) in common::distances(&batch, &states) {
        let far = found
            .iter()
            .filter(|d| !d.is_near(common::usual_noise(&found), common::TOLERANCE));
        println!(
            "{name:18} from single precision {:8.1e}, from double {:8.1e}; these from each other {:8.1e}; {} states beyond",
            worst(&found, |d| d.single),
            worst(&found, |d| d.double),
            worst(&found, |d| d.noise),
            far.count(),
        );
    }
    let solves = batch.solves().expect("a device");
    let mean = |f: fn(&clench_gpu::GpuSolve) -> usize| {
        solves.iter().map(f).sum::<usize>() as f64 / count as f64
    };
    println!(
        "contacts {:.1}, rows {:.1}, iterations {:.1}",
        mean(|s| s.contacts),
        mean(|s| s.rows),
        mean(|s| s.iterations)
    );
    for status in [
        clench_solver::Status::NonFinite,
        clench_solver::Status::IterationLimit,
        clench_solver::Status::NoProgress,
    ] {
        println!(
            "{}: {}",
            status.name(),
            solves.iter().filter(|s| s.status == status).count()
        );
    }
}
