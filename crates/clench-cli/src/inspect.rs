//! `clench inspect`: sizes, tree, options, active constraints, and contacts.

use crate::description::describe;
use crate::options::ModelArguments;
use crate::table::Table;
use anyhow::{Context, Result};
use clap::Args;
use clench::rigid::constraint::ConstraintSource;
use clench::rigid::model::JointKind;
use clench::rigid::readout::{ConstraintRow, constraint_rows, contact_rows};
use clench::{Model, Sim};
use std::io::{self, Write};

/// Prints a model's sizes, its tree of bodies, the effective options, and a table of the active constraints with their
/// forces, violations and impedances.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Number of steps before the constraints are listed
    #[arg(long, value_name = "N", default_value_t = 0)]
    steps: usize,
    /// List the contacts too: geoms, distance, position, frame and forces
    #[arg(long)]
    contacts: bool,
    /// Print sizes and elements as one JSON object, and nothing else
    #[arg(long, conflicts_with_all = ["steps", "contacts"])]
    json: bool,

    // Last, because its help heading applies to all following arguments.
    #[command(flatten)]
    model: ModelArguments,
}

/// Prints everything to standard output.
pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let mut sim = arguments.model.sim()?;
    let mut out = io::stdout().lock();
    if arguments.json {
        return Ok(writeln!(out, "{:#}", describe(&sim))?);
    }
    print_sizes(&mut out, sim.model())?;
    print_tree(&mut out, sim.model())?;
    print_options(&mut out, &sim)?;
    for step in 0..arguments.steps {
        sim.step().with_context(|| format!("step {step}"))?;
    }
    sim.forward()?;
    print_constraints(&mut out, &sim)?;
    if arguments.contacts {
        print_contacts(&mut out, &sim)?;
    }
    Ok(())
}

fn name_or_index(name: &str, kind: &str, index: usize) -> String {
    if name.is_empty() {
        format!("{kind} {index}")
    } else {
        name.to_string()
    }
}

fn print_sizes(out: &mut impl Write, model: &Model) -> io::Result<()> {
    let mass: f64 = model.params.body_mass.iter().sum();
    writeln!(
        out,
        "{}: {:.4} kg",
        name_or_index(&model.name, "model", 0),
        mass
    )?;
    let sizes = [
        ("position coordinates (nq)", model.nq),
        ("degrees of freedom (nv)", model.nv),
        ("controls (nu)", model.nu()),
        ("activations (na)", model.na),
        ("bodies, the world included", model.nbody()),
        ("joints", model.joints.len()),
        ("geoms", model.geoms.len()),
        ("meshes", model.meshes.len()),
        ("height fields", model.height_fields.len()),
        ("tendons", model.tendons.len()),
        ("equality constraints", model.equalities.len()),
        ("keyframes", model.keyframes.len()),
        ("kinematic trees", model.tree.ntree()),
    ];
    for (name, size) in sizes {
        writeln!(out, "  {name:<28} {size}")?;
    }
    Ok(())
}

fn print_tree(out: &mut impl Write, model: &Model) -> io::Result<()> {
    writeln!(out, "\nbodies")?;
    let mut depth = vec![0; model.nbody()];
    for (b, body) in model.bodies.iter().enumerate().skip(1) {
        depth[b] = depth[body.parent] + 1;
        let joints: Vec<_> = (body.joints.clone())
            .map(|j| {
                let joint = &model.joints[j];
                let kind = match joint.kind {
                    JointKind::Free => "free",
                    JointKind::Ball => "ball",
                    JointKind::Slide => "slide",
                    JointKind::Hinge => "hinge",
                };
                format!("{kind} {}", name_or_index(&joint.name, "joint", j))
            })
            .collect();
        let attached = match (joints.is_empty(), body.mocap) {
            (false, _) => joints.join(", "),
            (true, Some(_)) => "mocap".into(),
            (true, None) => "fixed".into(),
        };
        writeln!(
            out,
            "  {:indent$}{}  ({attached}; {:.4} kg; geoms: {})",
            "",
            name_or_index(&body.name, "body", b),
            model.params.body_mass[b],
            body.geoms.len(),
            indent = 2 * (depth[b] - 1),
        )?;
    }
    Ok(())
}

fn print_options(out: &mut impl Write, sim: &Sim) -> io::Result<()> {
    let settings = &sim.settings().solver;
    writeln!(out, "\noptions")?;
    writeln!(
        out,
        "  timestep {} s, integrator {:?}",
        sim.params().timestep,
        sim.model().integrator
    )?;
    // The derived listing, `Settings { name: value, ... }`, one option per line.
    let listing = format!("{settings:?}");
    let fields = listing.split_once('{').map_or("", |(_, fields)| fields);
    for field in fields.trim_end_matches('}').split(", ") {
        writeln!(out, "  {}", field.trim())?;
    }
    Ok(())
}

fn print_constraints(out: &mut impl Write, sim: &Sim) -> io::Result<()> {
    let rows = constraint_rows(sim.workspace(), 0);
    let count = rows.len();
    writeln!(
        out,
        "\nconstraints at {:.4} s: {count} rows",
        sim.state.time
    )?;
    if sim.contact_overflow() {
        writeln!(out, "  contacts beyond --max-contacts are omitted")?;
    }
    if rows.is_empty() {
        return Ok(());
    }
    let headings = [
        "kind",
        "source",
        "force",
        "violation",
        "velocity",
        "impedance",
    ];
    let mut table = Table::new(&headings);
    for row in &rows {
        table.row(vec![
            row.source.kind().into(),
            source(sim, row),
            format!("{:.6}", row.force),
            format!("{:.6}", row.pos - row.margin),
            format!("{:.6}", row.vel),
            format!("{:.4}", row.impedance),
        ]);
    }
    write!(out, "{table}")
}

/// Returns a readable source of a row: its name, or the two geoms of a contact.
fn source(sim: &Sim, row: &ConstraintRow) -> String {
    let model = sim.model();
    match row.source {
        ConstraintSource::Contact(i) => geoms(model, sim.contacts()[i].geoms),
        source => match source.name(model) {
            "" => source.index().to_string(),
            name => name.to_string(),
        },
    }
}

fn geoms(model: &Model, geoms: [usize; 2]) -> String {
    let [a, b] = geoms.map(|g| model.geom_label(g));
    format!("{a} – {b}")
}

/// Prints one line per contact. Its second tangent is the cross product of the normal and the first.
fn print_contacts(out: &mut impl Write, sim: &Sim) -> io::Result<()> {
    let rows = contact_rows(sim.workspace(), 0);
    let (time, count) = (sim.state.time, rows.len());
    writeln!(out, "\ncontacts at {time:.4} s: {count}")?;
    if rows.is_empty() {
        return Ok(());
    }
    let headings = [
        "geoms",
        "distance",
        "position",
        "normal",
        "tangent",
        "force (normal, tangents)",
        "torque",
    ];
    let numbers = |v: &[f64]| format!("{:.6} {:.6} {:.6}", v[0], v[1], v[2]);
    let mut table = Table::new(&headings);
    for row in &rows {
        table.row(vec![
            geoms(sim.model(), row.geoms),
            format!("{:.6}", row.dist),
            numbers(&row.pos),
            numbers(&row.frame[0]),
            numbers(&row.frame[1]),
            numbers(&row.force[..3]),
            numbers(&row.force[3..]),
        ]);
    }
    write!(out, "{table}")
}
