//! Stored states.

/// A stored state.
#[derive(Clone, Debug)]
pub struct Keyframe {
    /// Name, possibly empty.
    pub name: String,
    /// Time, s.
    pub time: f64,
    /// Positions (nq).
    pub qpos: Vec<f64>,
    /// Velocities (nv).
    pub qvel: Vec<f64>,
    /// Activations (na).
    pub act: Vec<f64>,
    /// Spring rest positions (nplastic).
    pub plastic: Vec<f64>,
    /// Controls (nu).
    pub ctrl: Vec<f64>,
    /// Mocap positions (3 nmocap).
    pub mocap_pos: Vec<f64>,
    /// Mocap orientations (4 nmocap).
    pub mocap_quat: Vec<f64>,
}
