//! The JSON that `forward` writes: results.

use anyhow::Result;
use clench::Sim;
use clench::rigid::contact::Contact;
use clench::rigid::readout::{self, ConstraintRow};
use clench::rigid::state::kind::StickReference;
use serde::Serialize;

/// Runs `forward`, with the given contacts if there are any.
pub fn forward(sim: &mut Sim, given: Option<&[Contact<f64>]>) -> Result<()> {
    match given {
        None => sim.forward()?,
        Some(contacts) => sim.forward_with_contacts(contacts)?,
    }
    Ok(())
}

/// The state one step later: all that the motion depends on, except for the inputs.
#[derive(Serialize)]
pub struct NextState {
    time: f64,
    qpos: Vec<f64>,
    qvel: Vec<f64>,
    act: Vec<f64>,
    plastic: Vec<f64>,
    history: Vec<f64>,
    qacc_warmstart: Vec<f64>,
    tree_asleep: Vec<i32>,
    pose_asleep: Vec<f64>,
    stick_references: Vec<[f64; 9]>,
    stick_friction: Vec<f64>,
}

impl NextState {
    /// Takes a step, with the given contacts if there are any, and restores the state.
    pub fn after(sim: &mut Sim, given: Option<&[Contact<f64>]>) -> Result<Self> {
        let before = sim.state.clone();
        match given {
            None => sim.step()?,
            Some(contacts) => sim.step_with_contacts(contacts)?,
        }
        let after = std::mem::replace(&mut sim.state, before);
        Ok(NextState {
            time: after.time,
            qpos: after.qpos,
            qvel: after.qvel,
            act: after.act,
            plastic: after.plastic,
            history: after.history,
            qacc_warmstart: after.qacc_warmstart,
            tree_asleep: after.tree_asleep.iter().map(|&tree| tree as i32).collect(),
            pose_asleep: after.pose_asleep,
            stick_references: after.stick_references.iter().map(stick_numbers).collect(),
            stick_friction: after.stick_friction,
        })
    }
}

/// Returns a stick reference as a state line has it: the geoms, each plus one, then position and orientation.
fn stick_numbers(reference: &StickReference<f64>) -> [f64; 9] {
    let [x, y, z] = reference.position.to_array();
    let [w, i, j, k] = reference.rotation.to_array();
    [reference.first, reference.second, x, y, z, w, i, j, k]
}

/// The result of one state.
#[derive(Serialize)]
pub struct ResultLine<'a> {
    time: f64,
    qacc: &'a [f64],
    qacc_smooth: &'a [f64],
    qfrc_constraint: &'a [f64],
    qfrc_bias: &'a [f64],
    qfrc_passive: &'a [f64],
    qfrc_actuator: &'a [f64],
    /// The sensor values.
    #[serde(skip_serializing_if = "<[f64]>::is_empty")]
    sensordata: &'a [f64],
    contacts: Vec<ContactResult>,
    /// True if more contacts were found than the options allow, and some were omitted.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    contact_overflow: bool,
    constraints: Vec<RowResult<'a>>,
    solver: SolverResult,
    #[serde(skip_serializing_if = "Option::is_none")]
    next: Option<NextState>,
    #[serde(skip_serializing_if = "Option::is_none")]
    mass: Option<Vec<Vec<f64>>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    jacobian: Option<Vec<Vec<f64>>>,
}

#[derive(Serialize)]
struct ContactResult {
    geom: [usize; 2],
    dist: f64,
    pos: [f64; 3],
    frame: [f64; 9],
    /// The distance below which the contact produces a force.
    includemargin: f64,
    dim: usize,
    friction: [f64; 5],
    adhesion: f64,
    /// The surface velocity of the second geom minus that of the first: along both tangents, about the normal.
    surfacevel: [f64; 3],
    /// The force in the contact frame: normal, two tangents, spin, two rolls.
    force: [f64; 6],
}

#[derive(Serialize)]
struct RowResult<'a> {
    kind: &'static str,
    source: Source<'a>,
    pos: f64,
    vel: f64,
    aref: f64,
    #[serde(rename = "D")]
    d: f64,
    force: f64,
}

/// The name of the element that creates a constraint, or its index if it has none.
#[derive(Serialize)]
#[serde(untagged)]
enum Source<'a> {
    Name(&'a str),
    Index(usize),
}

#[derive(Serialize)]
struct SolverResult {
    status: &'static str,
    iterations: usize,
    gradient: f64,
    improvement: f64,
    gap: f64,
}

impl<'a> ResultLine<'a> {
    /// Collects the results of a simulation's last `forward`, and the state one step later if it is given.
    pub fn new(sim: &'a Sim, next: Option<NextState>, mass: bool, jacobian: bool) -> Self {
        let ws = sim.workspace();
        let nv = sim.model().nv;
        let stats = sim.stats();
        ResultLine {
            time: sim.state.time,
            qacc: &ws.qacc,
            qacc_smooth: &ws.problem.qacc_smooth,
            qfrc_constraint: &ws.qfrc_constraint,
            qfrc_bias: &ws.force.qfrc_bias,
            qfrc_passive: &ws.force.qfrc_passive,
            qfrc_actuator: &ws.force.qfrc_actuator,
            sensordata: &ws.sensors.data,
            contacts: (0..sim.contacts().len())
                .map(|i| ContactResult::new(sim, i))
                .collect(),
            contact_overflow: sim.contact_overflow(),
            constraints: (readout::constraint_rows(ws, 0).iter())
                .map(|row| RowResult::new(sim, row))
                .collect(),
            solver: SolverResult {
                status: stats.status.name(),
                iterations: stats.iterations,
                gradient: stats.gradient,
                improvement: stats.improvement,
                gap: stats.gap,
            },
            next,
            mass: mass.then(|| rows(&readout::mass_matrix(ws, 0), nv)),
            jacobian: jacobian.then(|| rows(&readout::jacobian(ws, 0), nv)),
        }
    }
}

impl ContactResult {
    fn new(sim: &Sim, index: usize) -> Self {
        let contact = &sim.contacts()[index];
        let mut frame = [0.0; 9];
        for (out, row) in frame.chunks_exact_mut(3).zip(contact.frame.rows) {
            row.write(out);
        }
        ContactResult {
            geom: contact.geoms,
            dist: contact.dist,
            pos: contact.pos.to_array(),
            frame,
            includemargin: contact.includemargin,
            dim: contact.dim,
            friction: contact.friction,
            adhesion: contact.adhesion,
            surfacevel: contact.surfacevel,
            force: readout::contact_force(sim.workspace(), index, 0),
        }
    }
}

impl<'a> RowResult<'a> {
    fn new(sim: &'a Sim, row: &ConstraintRow) -> Self {
        let name = row.source.name(sim.model());
        RowResult {
            kind: row.source.kind(),
            source: match name {
                "" => Source::Index(row.source.index()),
                name => Source::Name(name),
            },
            pos: row.pos,
            vel: row.vel,
            aref: row.aref,
            d: row.d,
            force: row.force,
        }
    }
}

/// Splits a dense row-major matrix into rows; empty if there are no columns.
fn rows(dense: &[f64], columns: usize) -> Vec<Vec<f64>> {
    dense
        .chunks_exact(columns.max(1))
        .map(<[f64]>::to_vec)
        .collect()
}
