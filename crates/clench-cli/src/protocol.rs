//! The JSON that `forward` reads and writes: states in, results out.

use anyhow::{Context, Result, bail, ensure};
use clench::Sim;
use clench::math::{Force, Mat3, Quat, Vec3};
use clench::rigid::contact::Contact;
use clench::rigid::readout::{self, ConstraintRow};
use clench::rigid::state::State;
use clench::rigid::state::kind::{self, Kind, StickReference};
use serde::de::{DeserializeOwned, IgnoredAny};
use serde::{Deserialize, Serialize};

/// The JSON representation of a state's element.
trait Written: Kind {
    /// The JSON type: a number, a list of numbers, or a truth value.
    type Json: DeserializeOwned;
    /// Converts the JSON value to the element.
    fn read(json: Self::Json) -> Self::Of<f64>;
}

impl Written for kind::Number {
    type Json = f64;
    fn read(json: f64) -> f64 {
        json
    }
}
impl Written for kind::Integer {
    type Json = i32;
    fn read(json: i32) -> f64 {
        f64::from(json)
    }
}
impl Written for kind::Vector {
    type Json = [f64; 3];
    fn read(json: [f64; 3]) -> Vec3<f64> {
        Vec3::from_array(json)
    }
}
impl Written for kind::Quaternion {
    type Json = [f64; 4];
    fn read(json: [f64; 4]) -> Quat<f64> {
        Quat::from_f64(json)
    }
}
/// Force and torque, as in MuJoCo.
impl Written for kind::Wrench {
    type Json = [f64; 6];
    fn read([fx, fy, fz, tx, ty, tz]: [f64; 6]) -> Force<f64> {
        Force::new(Vec3::new(tx, ty, tz), Vec3::new(fx, fy, fz))
    }
}
/// The geoms, each plus one, then position and orientation.
impl Written for kind::Reference {
    type Json = [f64; 9];
    fn read([first, second, x, y, z, quat @ ..]: [f64; 9]) -> StickReference<f64> {
        StickReference {
            first,
            second,
            position: Vec3::new(x, y, z),
            rotation: Quat::from_f64(quat),
        }
    }
}
impl Written for kind::Truth {
    type Json = Truth;
    fn read(json: Truth) -> bool {
        match json {
            Truth::Bool(b) => b,
            Truth::Number(x) => x != 0.0,
        }
    }
}

macro_rules! declare_line {
    ($($group:ident { $(
        $(#[$doc:meta])* $name:ident $setter:ident: $kind:ident, $size:ident, $bound:ident;
    )* })*) => {
        /// A state; missing fields keep the model's default.
        #[derive(Deserialize)]
        #[serde(deny_unknown_fields, expecting = "a state: an object in braces")]
        pub struct StateLine {
            time: Option<f64>,
            $($($name: Option<Vec<<kind::$kind as Written>::Json>>,)*)*
            /// Replaces collision detection.
            contacts: Option<Vec<ContactLine>>,
        }

        impl StateLine {
            /// Sets the given fields.
            fn assign(&mut self, state: &mut State<f64>) -> Result<()> {
                $($(
                    let given = self.$name.take();
                    assign::<kind::$kind>(stringify!($name), &mut state.$name, given)?;
                )*)*
                Ok(())
            }
        }
    };
}
clench::rigid::state_fields!(declare_line);

/// `true`, `false`, or a number that is not zero, as MuJoCo stores flags.
#[derive(Clone, Copy, Deserialize)]
#[serde(untagged, expecting = "true, false or a number")]
enum Truth {
    Bool(bool),
    Number(f64),
}

/// A contact with the fields of MuJoCo's `mjContact`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, expecting = "a contact: an object in braces")]
struct ContactLine {
    geom: [i64; 2],
    dist: f64,
    pos: [f64; 3],
    frame: [f64; 9],
    includemargin: f64,
    friction: [f64; 5],
    solref: [f64; 2],
    #[serde(default)]
    solreffriction: [f64; 2],
    solimp: [f64; 5],
    dim: usize,
    /// If not zero, the contact is listed but creates no constraint; 1: it is in the gap, 3: no dof is between its
    /// bodies. In these two cases sensors still include it.
    #[serde(default)]
    exclude: i32,
    #[serde(default)]
    surfacevel: [f64; 3],
    #[serde(default)]
    adhesion: f64,
    /// Fields that MuJoCo derives from the others, and Clench's `force`: ignored, so that a whole mjContact or a
    /// contact of a result can be passed.
    #[serde(default, rename = "mu")]
    _mu: IgnoredAny,
    #[serde(default, rename = "H")]
    _hessian: IgnoredAny,
    #[serde(default, rename = "geom1")]
    _geom1: IgnoredAny,
    #[serde(default, rename = "geom2")]
    _geom2: IgnoredAny,
    #[serde(default, rename = "flex")]
    _flex: IgnoredAny,
    #[serde(default, rename = "elem")]
    _elem: IgnoredAny,
    #[serde(default, rename = "vert")]
    _vert: IgnoredAny,
    #[serde(default, rename = "efc_address")]
    _efc_address: IgnoredAny,
    #[serde(default, rename = "force")]
    _force: IgnoredAny,
}

impl StateLine {
    /// Parses one line of standard input.
    pub fn parse(line: &str) -> Result<StateLine> {
        // A plain serde error contains the column; the path adds the field.
        let mut json = serde_json::Deserializer::from_str(line);
        let state = serde_path_to_error::deserialize(&mut json)?;
        json.end()?;
        Ok(state)
    }

    /// Sets the state of a simulation that is at its defaults and returns the contacts that replace collision
    /// detection.
    pub fn apply(mut self, sim: &mut Sim) -> Result<Option<Vec<Contact<f64>>>> {
        if let Some(time) = self.time {
            sim.state.time = time;
        }
        self.assign(&mut sim.state)?;
        let given = self.contacts.map(|lines| {
            (lines.into_iter().enumerate())
                .map(|(i, c)| {
                    c.into_contact(sim)
                        .with_context(|| format!("contacts[{i}]"))
                })
                .collect()
        });
        given.transpose()
    }
}

/// Runs `forward`, with the given contacts if there are any.
pub fn forward(sim: &mut Sim, given: Option<&[Contact<f64>]>) -> Result<()> {
    match given {
        None => sim.forward()?,
        Some(contacts) => sim.forward_with_contacts(contacts)?,
    }
    Ok(())
}

/// The state one step later.
#[derive(Serialize)]
pub struct NextState {
    time: f64,
    qpos: Vec<f64>,
    qvel: Vec<f64>,
    act: Vec<f64>,
    plastic: Vec<f64>,
    tree_asleep: Vec<i32>,
    pose_asleep: Vec<f64>,
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
            tree_asleep: after.tree_asleep.iter().map(|&tree| tree as i32).collect(),
            pose_asleep: after.pose_asleep,
        })
    }
}

fn assign<K: Written>(
    name: &str,
    target: &mut Vec<K::Of<f64>>,
    values: Option<Vec<K::Json>>,
) -> Result<()> {
    let Some(values) = values else { return Ok(()) };
    ensure!(
        values.len() == target.len(),
        "{name}: {} values given, the model has {}",
        values.len(),
        target.len()
    );
    *target = values.into_iter().map(K::read).collect();
    Ok(())
}

impl ContactLine {
    fn into_contact(self, sim: &Sim) -> Result<Contact<f64>> {
        let model = sim.model();
        let ngeom = model.geoms.len();
        let mut geoms = [0; 2];
        for (geom, &given) in geoms.iter_mut().zip(&self.geom) {
            match usize::try_from(given) {
                Ok(g) if g < ngeom => *geom = g,
                _ => bail!("geom: {given} is not one of the model's {ngeom} geoms"),
            }
        }
        ensure!(
            matches!(self.dim, 1 | 3 | 4 | 6),
            "dim: {} is not 1, 3, 4 or 6",
            self.dim
        );
        let f = self.frame;
        Ok(Contact {
            geoms,
            active: match self.exclude {
                0 => true,
                1 => self.dist >= self.includemargin,
                // The geoms move as one, or neither has dofs: a mocap body and the world.
                3 => {
                    let [first, second] = geoms.map(|g| model.bodies[model.geoms[g].body].weld);
                    let stands = |body: usize| model.bodies[body].dofs.is_empty();
                    first == second || stands(first) && stands(second)
                }
                _ => false,
            },
            dim: self.dim,
            dist: self.dist,
            pos: Vec3::from_array(self.pos),
            frame: Mat3::from_rows(
                Vec3::new(f[0], f[1], f[2]),
                Vec3::new(f[3], f[4], f[5]),
                Vec3::new(f[6], f[7], f[8]),
            ),
            includemargin: self.includemargin,
            friction: self.friction,
            solref: self.solref,
            solreffriction: self.solreffriction,
            solimp: self.solimp,
            adhesion: self.adhesion,
            surfacevel: self.surfacevel,
            block: None,
        })
    }
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
