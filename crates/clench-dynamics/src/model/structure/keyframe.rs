//! Stored states.

/// A stored state.
#[derive(Clone, Debug)]
pub struct Keyframe {
    /// Name, possibly empty.
    pub name: String,
    /// s.
    pub time: f64,
    /// (nq).
    pub qpos: Vec<f64>,
    /// (nv).
    pub qvel: Vec<f64>,
    /// (na).
    pub act: Vec<f64>,
    /// (nplastic).
    pub plastic: Vec<f64>,
    /// (nu).
    pub ctrl: Vec<f64>,
    /// (3 nmocap).
    pub mocap_pos: Vec<f64>,
    /// (4 nmocap).
    pub mocap_quat: Vec<f64>,
}
