// The simulation time of an environment, s.

fn clock() -> f32 {
    return fetch_state(START_TIME) + f32(reports[STEPS * envs + env]) * TIMESTEP;
}
