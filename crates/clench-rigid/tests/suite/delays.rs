//! Controls and sensors with delays.

use clench_rigid::builder::{
    ActuatorSpec, BodySpec, GeomSpec, HistorySpec, JointSpec, ModelBuilder, SensorSpec,
    TransmissionSpec,
};
use clench_rigid::model::{Interpolation, SensorKind};
use clench_rigid::{Batch, Model, Sim, State};
use std::sync::Arc;

const STEP: f64 = 0.002;

/// Builds a slider without gravity and a motor with `nsample` past controls.
fn slider(nsample: usize, delay: f64, interp: Interpolation) -> Result<Arc<Model>, String> {
    slider_with(
        HistorySpec {
            nsample,
            interp,
            delay,
        },
        HistorySpec::default(),
    )
}

/// Builds it with past controls and positions, which a second sensor reports with a delay.
fn slider_with(of_motor: HistorySpec, of_sensor: HistorySpec) -> Result<Arc<Model>, String> {
    let mut builder = ModelBuilder::new("slider");
    builder.physics.gravity = [0.0; 3];
    builder.physics.timestep = STEP;
    builder.add_body(
        ModelBuilder::WORLD,
        BodySpec::new("block")
            .joint(JointSpec::slide("slide", [1.0, 0.0, 0.0]))
            .geom(GeomSpec::sphere(0.1).mass(2.0)),
    );
    let mut motor = ActuatorSpec::motor("motor", TransmissionSpec::Joint("slide".into()), 1.0);
    motor.history = of_motor;
    let now = SensorSpec::new(SensorKind::JointPos, "slide");
    let mut late = now.clone();
    late.history = of_sensor;
    builder.sensors.extend([now, late]);
    builder.actuators.push(motor);
    builder
        .build()
        .map(Arc::new)
        .map_err(|error| error.to_string())
}

/// Returns the forces of steps whose controls are 1, 2, 3, ...
fn forces(model: Arc<Model>, count: usize) -> Vec<f64> {
    let mut sim = Sim::new(model).expect("valid");
    (1..=count)
        .map(|k| {
            sim.state.ctrl[0] = k as f64;
            sim.step().expect("finite");
            sim.workspace().force.actuator_force[0]
        })
        .collect()
}

#[test]
fn a_delay_of_whole_steps_brings_controls_as_they_were() {
    for interp in [
        Interpolation::Hold,
        Interpolation::Linear,
        Interpolation::Cubic,
    ] {
        let model = slider(5, 3.0 * STEP, interp).expect("valid");
        assert_eq!(forces(model, 6), [0.0, 0.0, 0.0, 1.0, 2.0, 3.0]);
    }
}

#[test]
fn between_steps_a_control_holds_or_changes_on_a_line() {
    let held = slider(5, 2.5 * STEP, Interpolation::Hold).expect("valid");
    assert_eq!(forces(held, 6), [0.0, 0.0, 0.0, 1.0, 2.0, 3.0]);
    let line = slider(5, 2.5 * STEP, Interpolation::Linear).expect("valid");
    let expected = [0.0, 0.0, 0.5, 1.5, 2.5, 3.5];
    for (found, expected) in forces(line, 6).iter().zip(expected) {
        assert!((found - expected).abs() < 1e-12);
    }
}

#[test]
fn nothing_older_than_the_oldest_sample_is_known() {
    let model = slider(2, 10.0 * STEP, Interpolation::Hold).expect("valid");
    assert_eq!(forces(model, 5), [0.0, 0.0, 1.0, 2.0, 3.0]);
}

#[test]
fn past_controls_are_part_of_the_state() {
    let model = slider(4, 3.0 * STEP, Interpolation::Linear).expect("valid");
    let mut sim = Sim::new(model.clone()).expect("valid");
    sim.state.ctrl[0] = 1.0;
    sim.step().expect("finite");
    let kept: State<f64> = sim.state.clone();
    let on = |sim: &mut Sim| {
        for _ in 0..5 {
            sim.step().expect("finite");
        }
        sim.state.qpos[0]
    };
    let expected = on(&mut sim);
    let mut other = Sim::new(model.clone()).expect("valid");
    other.state.copy_from(&kept);
    assert_eq!(on(&mut other).to_bits(), expected.to_bits());
    let mut batch = Batch::<f64>::new(model, 3).expect("valid");
    for env in 0..3 {
        batch.state.write(env, &kept).expect("fits");
    }
    batch.step_n(5).expect("finite");
    assert_eq!(batch.state.qpos.as_slice(), [expected; 3]);
}

#[test]
fn delays_that_cannot_be_are_refused() {
    let without = slider(0, STEP, Interpolation::Hold);
    assert!(without.unwrap_err().contains("nsample"));
    let before = slider(3, -STEP, Interpolation::Hold);
    assert!(before.unwrap_err().contains("delay"));
    let endless = slider(usize::MAX / 4, STEP, Interpolation::Hold);
    assert!(endless.unwrap_err().contains("more than"));
}

#[test]
fn a_delayed_sensor_reports_an_earlier_measurement() {
    let late = HistorySpec {
        nsample: 4,
        interp: Interpolation::Hold,
        delay: 3.0 * STEP,
    };
    let model = slider_with(HistorySpec::default(), late).expect("valid");
    let mut sim = Sim::new(model).expect("valid");
    sim.state.qvel[0] = 1.0;
    let mut seen = Vec::new();
    for _ in 0..8 {
        sim.step().expect("finite");
        seen.push((
            sim.workspace().sensors.data[0],
            sim.workspace().sensors.data[1],
        ));
    }
    assert!(seen[..3].iter().all(|&(_, late)| late == 0.0));
    for k in 3..8 {
        assert_eq!(seen[k].1, seen[k - 3].0);
    }
}

/// Builds a slider with steps of 1 s, whose position a sensor reports at this interval and with this delay.
fn sampled(interval: [f64; 2], delay: f64) -> Arc<Model> {
    let mut builder = ModelBuilder::new("slider");
    builder.physics.gravity = [0.0; 3];
    builder.physics.timestep = 1.0;
    builder.add_body(
        ModelBuilder::WORLD,
        BodySpec::new("block")
            .joint(JointSpec::slide("slide", [1.0, 0.0, 0.0]))
            .geom(GeomSpec::sphere(0.1).mass(2.0)),
    );
    let mut periodic = SensorSpec::new(SensorKind::JointPos, "slide");
    periodic.interval = interval;
    periodic.history = HistorySpec {
        nsample: 3,
        interp: Interpolation::Hold,
        delay,
    };
    builder.sensors.push(periodic);
    Arc::new(builder.build().expect("valid"))
}

/// Returns the readings, minus 100, of a position that grows from 100 by 1 per step of 1 s, at this interval and delay.
fn ticks(interval: [f64; 2], delay: f64, steps: usize) -> Vec<f64> {
    let model = sampled(interval, delay);
    let told = |sim: &Sim| sim.workspace().sensors.data[0];
    let mut sim = Sim::new(model.clone()).expect("valid");
    sim.state.qpos[0] = 100.0;
    sim.state.qvel[0] = 1.0;
    let mut batch = Batch::<f64>::new(model, 3).expect("valid");
    for env in 0..3 {
        batch.state.write(env, &sim.state).expect("fits");
    }
    let seen = (0..steps)
        .map(|_| {
            sim.step().expect("finite");
            told(&sim) - 100.0
        })
        .collect();
    batch.step_n(steps).expect("finite");
    let mut one = sim.state.clone();
    for env in 0..3 {
        batch.state.read(env, &mut one).expect("there");
        assert_eq!(one.history, sim.state.history);
    }
    seen
}

#[test]
fn a_period_that_is_no_multiple_of_the_step_alternates() {
    // These two examples are from MuJoCo's documentation.
    let seen = ticks([2.5, 0.0], 0.0, 14);
    assert_eq!(seen[..6], [0.0, 0.0, 0.0, 3.0, 3.0, 5.0]);
    assert_eq!(seen[6..], [5.0, 5.0, 8.0, 8.0, 10.0, 10.0, 10.0, 13.0]);
    let seen = ticks([2.5, -1.5], 0.0, 10);
    assert_eq!(seen[..4], [-100.0, 1.0, 1.0, 1.0]);
    assert_eq!(seen[4..], [4.0, 4.0, 6.0, 6.0, 6.0, 9.0]);
}

#[test]
fn a_period_shorter_than_a_step_gives_one_sample_a_step() {
    let times = |interval| State::<f64>::new(&sampled(interval, 0.0)).history[1..4].to_vec();
    assert_eq!(times([0.7, 0.0]), [-3.0, -2.0, -1.0]);
    assert_eq!(times([0.7, -0.2]), [-2.0, -1.0, 0.0]);
    assert_eq!(times([2.5, 0.0]), [-7.0, -5.0, -2.0]);
}

#[test]
fn periodic_measurements_can_be_delayed() {
    let seen = ticks([3.0, 0.0], 2.0, 9);
    assert_eq!(seen[..6], [-100.0, -100.0, 0.0, 0.0, 0.0, 3.0]);
    assert_eq!(seen[6..], [3.0, 3.0, 6.0]);
}

#[test]
fn a_phase_lies_within_one_period() {
    let refused = |interval: [f64; 2]| {
        let mut builder = ModelBuilder::new("clock");
        let mut clock = SensorSpec::new(SensorKind::Clock, "");
        clock.subject = clench_rigid::builder::SensorSubject::Nothing;
        clock.interval = interval;
        builder.sensors.push(clock);
        builder.build().expect_err("wrong").to_string()
    };
    assert!(refused([-1.0, 0.0]).contains("interval"));
    assert!(refused([1.0, 0.5]).contains("phase"));
    assert!(refused([1.0, -1.0]).contains("phase"));
}
