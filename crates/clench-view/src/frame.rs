//! Frames: poses, forces and solver statistics of one moment, as bytes that the page reads without conversion.
//!
//! A frame is, in little-endian order: the letters `CLNF`, flags (u32), the time in seconds (f64), the number of
//! sections (u32), the row count of each section (u32 each), then the rows of all sections in order, in f32.
//! [`SECTIONS`] lists the sections.

use crate::drag::{Drag, Turn};
use crate::marks::Mark;
use crate::stages::StageTimes;
use clench::SimError;
use clench::math::{Mask, Real, Scalar, Vec3};
use clench::rigid::constraint::ConstraintSource;
use clench::rigid::readout::{ContactRow, Push, contact_rows, islands, light_poses};
use clench::rigid::{Precision, Sim, Workspace};
use std::time::Duration;

/// The first bytes of a frame.
pub const MAGIC: [u8; 4] = *b"CLNF";
/// The flag of a paused simulation.
pub const PAUSED: u32 = 1;

/// A part of a frame: rows of equal width.
#[derive(Clone, Copy, Debug)]
pub struct Section {
    /// The name by which the page finds the section.
    pub name: &'static str,
    /// The number of values in a row.
    pub width: usize,
}

/// The timing of the last step, which the page plots.
#[derive(Clone, Copy, Debug, Default)]
pub struct Timing {
    /// The duration of a step.
    pub step: Duration,
    /// The ratio of simulated to real time.
    pub speed: f64,
    /// The duration of each of [`STAGES`](crate::stages::STAGES).
    pub stages: StageTimes,
}

/// The state of the viewer that a frame includes: timing, springs, marks, selected environments.
#[derive(Default)]
pub struct FrameExtras<'a> {
    /// Flags, see [`PAUSED`].
    pub flags: u32,
    /// The timing of the last step.
    pub timing: Timing,
    /// The spring that drags a body.
    pub drag: Option<&'a Drag>,
    /// The spring that turns a body.
    pub turn: Option<&'a Turn>,
    /// The first and last time that rewinding can reach, s.
    pub past: Option<[f64; 2]>,
    /// The marks of the user.
    pub marks: Vec<&'a Mark>,
    /// The environment of a batch whose contacts are shown, and the first environment of those side by side.
    pub chosen: Option<[usize; 2]>,
    /// The shown environments of a batch, each with the reason if it cannot continue.
    pub envs: Vec<(usize, Option<String>)>,
    /// The poses of the bodies of all shown environments, if there is more than one.
    pub poses: Vec<f32>,
}

impl FrameExtras<'_> {
    /// Appends the poses of an environment; its last poses if they cannot be computed.
    pub fn add_poses<T: Precision>(&mut self, sim: &mut Sim<T>) {
        let _ = sim.refresh();
        bodies(sim.workspace(), &mut self.poses);
    }

    /// Returns all texts in order: those of marks, then those of environments.
    fn texts(&self) -> impl Iterator<Item = &str> {
        let faults = self
            .envs
            .iter()
            .map(|(_, why)| why.as_deref().unwrap_or(""));
        self.marks.iter().map(|mark| mark.text()).chain(faults)
    }
}

/// The content of a frame.
struct Shown<'a, T: Precision> {
    sim: &'a Sim<T>,
    energy: [f64; 2],
    pushes: Vec<Push>,
    cameras: Vec<[f32; 12]>,
    extras: &'a FrameExtras<'a>,
}

macro_rules! sections {
    ($shown:ident, $out:ident; $($(#[$doc:meta])* $name:ident: $width:expr => $write:expr;)*) => {
        /// The sections of a frame, in order.
        pub const SECTIONS: &[Section] = &[
            $(Section { name: stringify!($name), width: $width },)*
        ];

        /// Appends all sections and returns the row count of each.
        fn write_sections<T: Precision>($shown: &Shown<T>, numbers: &mut Vec<f32>) -> Vec<u32> {
            let mut counts = Vec::with_capacity(SECTIONS.len());
            $({
                let start = numbers.len();
                let $out = &mut *numbers;
                $write;
                counts.push(((numbers.len() - start) / $width) as u32);
            })*
            counts
        }
    };
}

sections! {
    s, out;
    /// Position and orientation of each body.
    bodies: 7 => bodies(s.sim.workspace(), out);
    /// Contacts: position, normal and two tangents, force along these, distance, sliding friction, both geoms,
    /// dimensions, displacement along both tangents since it stuck.
    contacts: 22 => contact_rows(s.sim.workspace(), 0).iter().for_each(|row| contact(row, out));
    /// Constraints except contacts: kind (0 equality, 1 joint limit, 2 tendon limit, 3 dry friction), element, norm of
    /// the force.
    constraints: 3 => constraints(s.sim.workspace(), out);
    /// Forces of constraints except contacts: kind as in `constraints`, element, body, position, force, torque.
    pushes: 12 => s.pushes.iter().for_each(|push| out.extend(push_numbers(push)));
    /// The island of each tree, by the lowest index of its trees; -1 if no constraint acts on the tree.
    islands: 1 => out.extend(islands(s.sim.workspace(), 0).iter().map(|first| first.map_or(-1.0, |tree| tree as f32)));
    /// Cameras: position, and the right, up and backward axes as columns.
    cameras: 12 => s.cameras.iter().for_each(|row| out.extend(row));
    /// Lights: position and direction.
    lights: 6 => out.extend(light_poses(&s.sim.model().visuals.lights, s.sim.workspace()).as_flattened().as_flattened().iter().map(|&x| x as f32));
    /// Straight segments of tendons: the tendon, both ends.
    spans: 7 => tendon_lines(s.sim, out);
    /// Position coordinates of the state.
    qpos: 1 => narrow(&s.sim.state.qpos, out);
    /// Velocities of the state.
    qvel: 1 => narrow(&s.sim.state.qvel, out);
    /// Controls.
    ctrl: 1 => narrow(&s.sim.state.ctrl, out);
    /// The activity of each equality constraint.
    eq_active: 1 => out.extend(s.sim.state.eq_active.iter().map(|&on| f32::from(u8::from(on))));
    /// The sleep state of each tree: at least zero if it sleeps.
    asleep: 1 => narrow(&s.sim.state.tree_asleep, out);
    /// Sensor values.
    sensors: 1 => narrow(&s.sim.workspace().sensors.data, out);
    /// The spring that drags a body: the body, the point, the target, the force.
    drag: 10 => out.extend(s.extras.drag.into_iter().flat_map(|drag| drag.row(s.sim.workspace())));
    /// The spring that turns a body: the body, its centre of mass, the remaining rotation vector (rad), the torque.
    turn: 10 => out.extend(s.extras.turn.into_iter().flat_map(|turn| turn.row(s.sim.workspace())));
    /// The first and last time that rewinding can reach, s.
    past: 2 => out.extend(s.extras.past.iter().flatten().map(|&time| time as f32));
    /// Plotted values: iterations, log10 of the duality gap and of the gradient, maximum penetration (m), contacts,
    /// potential and kinetic energy (J), duration of a step (µs), ratio of simulated to real time.
    plots: 9 => plots(s, out);
    /// The duration of each stage of a step (µs), in the order of `STAGES`.
    stages: 1 => out.extend(s.extras.timing.stages.iter().map(|time| 1e6 * time.as_secs_f32()));
    /// Marks of the user: kind (0 sphere, 1 line, 2 arrow, 3 text), both ends, radius, colour and opacity.
    marks: 12 => s.extras.marks.iter().for_each(|mark| out.extend(mark.row()));
    /// The environment of a batch whose contacts are shown, and the first of the shown ones.
    chosen: 1 => out.extend(s.extras.chosen.iter().flatten().map(|&env| env as f32));
    /// The shown environments of a batch: index, and 1 if it cannot continue.
    envs: 2 => out.extend(s.extras.envs.iter().flat_map(|(env, why)| [*env as f32, f32::from(u8::from(why.is_some()))]));
    /// Position and orientation of each body of each shown environment, if there is more than one.
    poses: 7 => out.extend(&s.extras.poses);
    /// The character counts of the text of each mark, then of the fault message of each environment.
    texts: 1 => out.extend(s.extras.texts().map(|text| text.chars().count() as f32));
    /// The characters of these texts, as code points.
    letters: 1 => out.extend(s.extras.texts().flat_map(str::chars).map(|letter| u32::from(letter) as f32));
}

/// Encodes the present state of a simulation as a frame.
///
/// # Errors
/// Returns an error if the state cannot be evaluated.
pub fn encode<T: Precision>(sim: &mut Sim<T>, extras: &FrameExtras) -> Result<Vec<u8>, SimError> {
    sim.refresh()?;
    let energy = sim.energy()?;
    let pushes = sim.pushes()?;
    let cameras = cameras(sim)?;
    let shown = Shown {
        pushes,
        cameras,
        sim,
        energy: [energy.potential.to_f64(), energy.kinetic.to_f64()],
        extras,
    };
    let mut numbers = Vec::new();
    let counts = write_sections(&shown, &mut numbers);
    let mut bytes = Vec::with_capacity(20 + 4 * (counts.len() + numbers.len()));
    bytes.extend(MAGIC);
    bytes.extend(extras.flags.to_le_bytes());
    bytes.extend(shown.sim.state.time.to_le_bytes());
    bytes.extend((counts.len() as u32).to_le_bytes());
    counts.iter().for_each(|n| bytes.extend(n.to_le_bytes()));
    numbers.iter().for_each(|x| bytes.extend(x.to_le_bytes()));
    Ok(bytes)
}

fn narrow<T: Real>(values: &[T], out: &mut Vec<f32>) {
    out.extend(values.iter().map(|x| x.lane(0).to_f64() as f32));
}

fn point<T: Real>(v: Vec3<T>) -> [f32; 3] {
    v.to_array().map(|x| x.lane(0).to_f64() as f32)
}

fn bodies<T: Real>(ws: &Workspace<T>, out: &mut Vec<f32>) {
    for (&pos, quat) in ws.position.xpos.iter().zip(&ws.position.xquat) {
        out.extend(point(pos));
        narrow(&quat.to_array(), out);
    }
}

fn contact(row: &ContactRow, out: &mut Vec<f32>) {
    let numbers = (row.pos.iter())
        .chain(row.frame.as_flattened())
        .chain(&row.force[..3])
        .chain([&row.dist, &row.friction[0]])
        .map(|&x| x as f32);
    out.extend(numbers);
    out.extend([row.geoms[0] as f32, row.geoms[1] as f32, row.dim as f32]);
    out.extend(row.displacement[..2].iter().map(|&x| x as f32));
}

/// Returns the kind of a constraint in a frame; `None` for contacts.
fn kind(source: ConstraintSource) -> Option<f32> {
    match source.kind() {
        "equality" | "dynamic" => Some(0.0),
        "limit_joint" => Some(1.0),
        "limit_tendon" => Some(2.0),
        "contact" => None,
        _ => Some(3.0),
    }
}

fn push_numbers(push: &Push) -> [f32; 12] {
    let mut row = [push.body as f32; 12];
    row[0] = kind(push.source).unwrap_or(-1.0);
    row[1] = push.source.index() as f32;
    let numbers = push.at.iter().chain(&push.force).chain(&push.torque);
    for (to, &from) in row[3..].iter_mut().zip(numbers) {
        *to = from as f32;
    }
    row
}

fn cameras<T: Precision>(sim: &mut Sim<T>) -> Result<Vec<[f32; 12]>, SimError> {
    if sim.model().cameras.is_empty() {
        return Ok(Vec::new());
    }
    let (places, rotations) = (sim.output("cam_xpos")?, sim.output("cam_xmat")?);
    let row = |(place, turn): (&[T], &[T])| {
        // The matrix is stored in row-major order.
        let axes = (0..9).map(|k| turn[3 * (k % 3) + k / 3]);
        let mut row = [0.0; 12];
        for (to, from) in row.iter_mut().zip(place.iter().copied().chain(axes)) {
            *to = from.to_f64() as f32;
        }
        row
    };
    let both = places.chunks_exact(3).zip(rotations.chunks_exact(9));
    Ok(both.map(row).collect())
}

fn constraints<T: Real>(ws: &Workspace<T>, out: &mut Vec<f32>) {
    let forces = ws.solver.force();
    for (index, record) in ws.record.blocks.iter().enumerate() {
        let Some(kind) = kind(record.source).filter(|_| record.active.lane(0)) else {
            continue;
        };
        let rows = &forces[ws.problem.block(index).rows()];
        let squares = rows.iter().map(|f| f.lane(0).to_f64().powi(2));
        let size = squares.sum::<f64>().sqrt();
        out.extend([kind, record.source.index() as f32, size as f32]);
    }
}

/// Appends the straight segments of all tendons as last computed: the tendon, both ends.
fn tendon_lines<T: Precision>(sim: &Sim<T>, out: &mut Vec<f32>) {
    for line in sim.tendon_lines() {
        out.push(line.tendon as f32);
        out.extend(line.ends.as_flattened());
    }
}

/// The lower limit of plotted gaps and gradients.
const LEAST: f64 = 1e-20;

fn plots<T: Precision>(s: &Shown<T>, out: &mut Vec<f32>) {
    let stats = s.sim.stats();
    let contacts = s.sim.contacts();
    let depths = contacts
        .iter()
        .map(|contact| -contact.dist.lane(0).to_f64());
    let numbers = [
        stats.iterations as f64,
        stats.gap.max(LEAST).log10(),
        stats.gradient.max(LEAST).log10(),
        depths.fold(0.0, f64::max),
        contacts.len() as f64,
        s.energy[0],
        s.energy[1],
        1e6 * s.extras.timing.step.as_secs_f64(),
        s.extras.timing.speed,
    ];
    out.extend(numbers.map(|x| x as f32));
}
