// The simulation time of an environment, s.

fn clock() -> f32 {
    return given(START_TIME) + f32(reports[STEPS * envs + env]) * TIMESTEP;
}
