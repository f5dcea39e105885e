//! `<compiler>` and `<option>`: nothing is left to derive, and the physics of the world.

use super::SaveError;
use super::xml::Xml;
use clench_rigid::Model;
use clench_rigid::model::{Flags, Integrator};
use clench_solver::{ConstraintSolver, FrictionCone, MaxContacts, RigidOptions, Switch};
use std::collections::BTreeSet;

pub(super) fn write(model: &Model, xml: &mut Xml) -> Result<(), SaveError> {
    check_time_constants(model)?;
    xml.tag("compiler")
        .text("angle", "radian")
        .boolean("autolimits", false)
        .text("inertiafromgeom", "false")
        .numbers("boundmass", &[0.0])
        .numbers("boundinertia", &[0.0])
        .boolean("balanceinertia", false)
        .boolean("alignfree", false)
        .boolean("fusestatic", false)
        .boolean("discardvisual", false)
        .open();
    xml.tag("lengthrange").text("mode", "none").end();
    xml.close();
    write_option(model, xml)
}

fn unwritable(option: &str, reason: &str) -> SaveError {
    SaveError::new(format!("the option {option}"), reason)
}

/// MJCF has no floor of time constants; where one acts, the file would mean another motion.
fn check_time_constants(model: &Model) -> Result<(), SaveError> {
    let floor = model.options.constraint_timeconst.unwrap_or(0.01);
    let p = &model.params;
    let fields = [
        &p.jnt_solref,
        &p.dof_solref,
        &p.geom_solref,
        &p.tendon_solref_lim,
        &p.tendon_solref_fri,
        &p.eq_solref,
        &p.pair_solref,
        &p.pair_solreffriction,
    ];
    let below = |solref: &&[f64; 2]| solref[0] > 0.0 && solref[1] > 0.0 && solref[0] < floor;
    match fields.into_iter().flatten().find(below) {
        Some([timeconst, _]) => Err(unwritable(
            "constraint_timeconst",
            &format!(
                "it raises the time constant {timeconst} of a solref to {floor}; load or build the model with it at 0, or raise the solref"
            ),
        )),
        None => Ok(()),
    }
}

fn write_option(model: &Model, xml: &mut Xml) -> Result<(), SaveError> {
    let RigidOptions {
        constraint_solver,
        iterations,
        tolerance,
        ls_iterations,
        ls_tolerance,
        constraint_timeconst: _,
        enable_joint_limit,
        disable_constraint: _,
        sparse_solve,
        noslip_iterations,
        noslip_tolerance,
        max_contacts,
        friction_cone,
        impratio,
        islands,
        warmstart: _,
        autoreset: _,
    } = model.options;
    if enable_joint_limit == Some(false) {
        return Err(unwritable("enable_joint_limit", "MJCF has none"));
    }
    if let Some(MaxContacts::Limit(_)) = max_contacts {
        return Err(unwritable("max_contacts", "MJCF has none"));
    }
    if islands == Some(Switch::On) {
        return Err(unwritable(
            "islands",
            "MJCF can turn islands off, but not force them",
        ));
    }
    let p = &model.params;
    let integrator = match model.integrator {
        Integrator::Euler => "Euler",
        Integrator::ImplicitFast => "implicitfast",
        Integrator::Implicit => "implicit",
        Integrator::Rk4 => "RK4",
    };
    let mut tag = xml
        .tag("option")
        .numbers("timestep", &[p.timestep])
        .numbers("gravity", &p.gravity.to_array())
        .numbers_unless("wind", &p.wind.to_array(), &[0.0; 3])
        .numbers_unless("magnetic", &p.magnetic.to_array(), &[0.0, -0.5, 0.0])
        .number_unless("density", p.density, 0.0)
        .number_unless("viscosity", p.viscosity, 0.0)
        .text("integrator", integrator)
        .integer("iterations", iterations.unwrap_or(50) as i64);
    if let Some(solver) = constraint_solver {
        tag = tag.text(
            "solver",
            match solver {
                ConstraintSolver::Newton => "Newton",
                ConstraintSolver::Cg => "CG",
            },
        );
    }
    if let Some(cone) = friction_cone {
        tag = tag.text(
            "cone",
            match cone {
                FrictionCone::Pyramidal => "pyramidal",
                FrictionCone::Elliptic => "elliptic",
            },
        );
    }
    if let Some(sparse) = sparse_solve {
        tag = tag.text(
            "jacobian",
            match sparse {
                Switch::Auto => "auto",
                Switch::On => "sparse",
                Switch::Off => "dense",
            },
        );
    }
    let numbers = [
        ("impratio", impratio),
        ("tolerance", tolerance),
        ("ls_tolerance", ls_tolerance),
        ("noslip_tolerance", noslip_tolerance),
    ];
    for (name, value) in numbers {
        if let Some(value) = value {
            tag = tag.numbers(name, &[value]);
        }
    }
    let counts = [
        ("ls_iterations", ls_iterations),
        ("noslip_iterations", noslip_iterations),
    ];
    for (name, value) in counts {
        if let Some(value) = value {
            tag = tag.integer(name, value as i64);
        }
    }
    if model.flags.sleep {
        tag = tag.numbers("sleep_tolerance", &[p.sleep_tolerance]);
    }
    if model.override_contacts {
        tag = tag
            .numbers("o_margin", &[p.override_margin])
            .numbers("o_solref", &p.override_solref)
            .numbers("o_solimp", &p.override_solimp)
            .numbers("o_friction", &p.override_friction);
    }
    let disabled = model.actuators.iter().filter(|actuator| actuator.disabled);
    let groups: BTreeSet<i32> = disabled.map(|actuator| actuator.group).collect();
    if !groups.is_empty() {
        tag = tag.integers("actuatorgroupdisable", groups.into_iter().map(i64::from));
    }
    let flags = flags(model);
    if flags.is_empty() {
        tag.end();
        return Ok(());
    }
    tag.open();
    let mut tag = xml.tag("flag");
    for (name, on) in flags {
        tag = tag.text(name, if on { "enable" } else { "disable" });
    }
    tag.end();
    xml.close();
    Ok(())
}

/// Flags that are not as MJCF has them where nothing is said.
fn flags(model: &Model) -> Vec<(&'static str, bool)> {
    let Flags {
        constraint,
        equality,
        frictionloss,
        limit,
        contact,
        spring,
        damper,
        gravity,
        clampctrl,
        warmstart,
        filterparent,
        actuation,
        refsafe,
        island,
        eulerdamp,
        sensor,
        multiccd,
        diagexact,
        sleep,
        invdiscrete,
    } = model.flags;
    let options = &model.options;
    let on = [
        (
            "constraint",
            constraint && options.disable_constraint != Some(true),
        ),
        ("equality", equality),
        ("frictionloss", frictionloss),
        ("limit", limit),
        ("contact", contact),
        ("spring", spring),
        ("damper", damper),
        ("gravity", gravity),
        ("clampctrl", clampctrl),
        ("warmstart", warmstart && options.warmstart != Some(false)),
        ("filterparent", filterparent),
        ("actuation", actuation),
        ("refsafe", refsafe),
        ("island", island && options.islands != Some(Switch::Off)),
        ("eulerdamp", eulerdamp),
        ("sensor", sensor),
        ("multiccd", multiccd),
    ];
    let mut flags: Vec<_> = on.into_iter().filter(|(_, on)| !on).collect();
    flags.extend(options.autoreset.map(|autoreset| ("autoreset", autoreset)));
    flags.extend(diagexact.then_some(("diagexact", true)));
    flags.extend(sleep.then_some(("sleep", true)));
    flags.extend(invdiscrete.then_some(("invdiscrete", true)));
    flags.extend(model.override_contacts.then_some(("override", true)));
    flags
}
