//! Sensors, evaluated after a forward pass and before the state is integrated.
//!
//! The kinds are a table in `model/sensor.rs`; this module reads them, one file per subject: frames in motion, forces
//! between bodies, limits, volumes of sites and protrusion from them, distances, rays, tactile skins.

pub(crate) mod bodies;
mod camera;
mod contact;
mod distance;
pub(crate) mod enclosed;
mod frame;
mod limit;
mod ray;
mod read;
pub(crate) mod tactile;
mod volume;

use clench_dynamics::context::StepContext;
use clench_dynamics::model::{Model, Params, Sensor, SensorData, SensorKind};
use clench_dynamics::state::State;
use clench_dynamics::workspace::Workspace;
use clench_math::{Mask, Real, kernel};
use read::Reading;

/// Evaluates all sensors of the model if they are read now or later.
#[kernel]
pub fn evaluate<T: Real>(context: StepContext<T>, state: &State<T>, ws: &mut Workspace<T>) {
    let StepContext { model, params, .. } = context;
    let stores_past = !ws.sensors.measured.is_empty();
    if !(ws.sensors.wanted || stores_past) || !model.flags.sensor {
        return;
    }
    let mut data = std::mem::take(&mut ws.sensors.data);
    let sensed = |reads: fn(SensorKind) -> bool| model.sensors.iter().any(|s| reads(s.kind));
    if sensed(|kind| matches!(kind, SensorKind::Force | SensorKind::Torque)) {
        bodies::update(model, params, state, ws);
    } else if sensed(SensorKind::needs_body_forces) {
        bodies::update_accelerations(model, ws);
    }
    let source = Reading {
        model,
        params,
        settings: context.settings,
        state,
        ws,
    };
    for sensor in &model.sensors {
        let out = &mut data[sensor.numbers.clone()];
        source.read(sensor, out);
        if sensor.cutoff > 0.0 && is_clipped(sensor.kind) {
            clip(sensor, out);
        }
    }
    if stores_past {
        delay(model, params, state, &mut data, &mut ws.sensors.measured);
    }
    ws.sensors.data = data;
}

/// Stores the present measurements, and replaces delayed readings, and those not due now, by earlier measurements.
#[kernel]
fn delay<T: Real>(
    model: &Model,
    params: &Params<T>,
    state: &State<T>,
    data: &mut [T],
    measured: &mut [T],
) {
    measured.copy_from_slice(data);
    for (s, sensor) in model.sensors.iter().enumerate() {
        let Some(history) = &sensor.history else {
            continue;
        };
        let late = params.sensor_delay[s];
        let due = history.is_due(
            &state.history,
            params.sensor_interval[s],
            state.rounded_time(),
        );
        let past = late.gt(T::ZERO) | !due;
        if past.any() {
            let reading = &mut data[sensor.numbers.clone()];
            history.read(&state.history, -late, reading);
            for (reading, &now) in reading.iter_mut().zip(&measured[sensor.numbers.clone()]) {
                *reading = T::select(past, *reading, now);
            }
        }
    }
}

/// Returns true if the cutoff clips the values of this kind of sensor.
fn is_clipped(kind: SensorKind) -> bool {
    !matches!(kind, SensorKind::FromTo | SensorKind::Contact)
}

/// Clips values to the cutoff.
#[kernel]
fn clip<T: Real>(sensor: &Sensor, out: &mut [T]) {
    let cutoff = T::new(sensor.cutoff);
    for x in out {
        *x = match sensor.data {
            SensorData::Real => x.min(cutoff).max(-cutoff),
            SensorData::Positive => x.min(cutoff),
            SensorData::Axis | SensorData::Quaternion => *x,
        };
    }
}
