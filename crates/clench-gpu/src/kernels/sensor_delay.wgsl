// Sensors with a delay or a period. CPU counterpart: `delay` in `sensor/mod.rs`.

// Stores the measurement, and outputs an earlier one if it is delayed or not due now.
fn delay_sensor(s: u32, prm: u32, out: u32) {
    let h = words[s + SENSOR_HISTORY];
    let late = parameter(prm + SENSOR_PRM_DELAY);
    let past = late > 0.0 || !is_due(h, parameter(prm + SENSOR_PRM_PERIOD));
    for (var k = 0u; k < words[s + SENSOR_DIM]; k++) {
        put(UNDELAYED + words[s + SENSOR_OFFSET] + k, fetch(out + k));
        if (past) {
            put(out + k, read_history(h, -late, k));
        }
    }
}
