//! `<compiler>`, whose settings derive nothing, and `<option>`, the physics of the world.

use super::names::SaveError;
use super::xml::{Tag, Xml};
use crate::mjcf::option::format_defaults;
use clench_dynamics::Model;
use clench_dynamics::model::{Flags, Integrator};
use clench_dynamics::options::{Mjcf, OptionValue, RigidOption};
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

/// Rejects an active floor of time constants: MJCF has none, so the saved model would move differently.
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
    let p = &model.params;
    let integrator = match model.integrator {
        Integrator::Euler => "Euler",
        Integrator::ImplicitFast => "implicitfast",
        Integrator::Implicit => "implicit",
        Integrator::Rk4 => "RK4",
        Integrator::Discrete => "discrete",
    };
    let mut tag = xml
        .tag("option")
        .numbers("timestep", &[p.timestep])
        .numbers("gravity", &p.gravity.to_array())
        .numbers_unless("wind", &p.wind.to_array(), &[0.0; 3])
        .numbers_unless("magnetic", &p.magnetic.to_array(), &[0.0, -0.5, 0.0])
        .number_unless("density", p.density, 0.0)
        .number_unless("viscosity", p.viscosity, 0.0)
        .number_unless("sleep_tolerance", p.sleep_tolerance, 1e-3)
        .text("integrator", integrator);
    for &option in RigidOption::ALL {
        tag = write_attribute(model, option, tag)?;
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
    let flags = flags(model)?;
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

/// Returns the value of an option if a reader would otherwise assume another.
fn value_to_write(model: &Model, option: RigidOption) -> Option<OptionValue> {
    let differs = format_defaults().get(option).is_some();
    (model.options.get(option)).or_else(|| differs.then(|| option.default(false)))
}

/// Writes an option that is an attribute of `<option>`.
fn write_attribute<'x>(
    model: &Model,
    option: RigidOption,
    tag: Tag<'x>,
) -> Result<Tag<'x>, SaveError> {
    let Some(value) = value_to_write(model, option) else {
        return Ok(tag);
    };
    Ok(match (option.mjcf(), value) {
        (Mjcf::Attribute(name), OptionValue::Count(n)) => tag.integer(name, n as i64),
        (Mjcf::Attribute(name), OptionValue::Number(x)) => tag.numbers(name, &[x]),
        (Mjcf::Attribute(name), value) => tag.text(name, keyword(option, value, value.keywords())?),
        (Mjcf::Words(name, keywords), value) => tag.text(name, keyword(option, value, keywords)?),
        (Mjcf::Flag(..) | Mjcf::Text(_), _) => tag,
        // Its effect was checked before.
        (Mjcf::Nowhere, _) if option == RigidOption::constraint_timeconst => tag,
        (Mjcf::Nowhere, value) if value == option.default(false) => tag,
        (Mjcf::Nowhere, _) => return Err(unwritable(option.name(), "MJCF has none")),
    })
}

fn keyword(
    option: RigidOption,
    value: OptionValue,
    keywords: &[(&'static str, OptionValue)],
) -> Result<&'static str, SaveError> {
    let missing = || unwritable(option.name(), &format!("MJCF has no keyword for {value}"));
    value.keyword_in(keywords).ok_or_else(missing)
}

/// Returns the flags that differ from MJCF's defaults.
fn flags(model: &Model) -> Result<Vec<(&'static str, bool)>, SaveError> {
    let mut flags = Vec::new();
    for &option in RigidOption::ALL {
        if let (Mjcf::Flag(name, [disabled, enabled]), Some(value)) =
            (option.mjcf(), model.options.get(option))
        {
            let keywords = [("disable", disabled), ("enable", enabled)];
            flags.push((name, keyword(option, value, &keywords)? == "enable"));
        }
    }
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
    let on = [
        ("constraint", constraint),
        ("equality", equality),
        ("frictionloss", frictionloss),
        ("limit", limit),
        ("contact", contact),
        ("spring", spring),
        ("damper", damper),
        ("gravity", gravity),
        ("clampctrl", clampctrl),
        ("warmstart", warmstart),
        ("filterparent", filterparent),
        ("actuation", actuation),
        ("refsafe", refsafe),
        ("island", island),
        ("eulerdamp", eulerdamp),
        ("sensor", sensor),
        ("multiccd", multiccd),
    ];
    for (off, _) in on.into_iter().filter(|(_, on)| !on) {
        flags.retain(|(name, _)| *name != off);
        flags.push((off, false));
    }
    flags.extend(diagexact.then_some(("diagexact", true)));
    flags.extend(sleep.then_some(("sleep", true)));
    flags.extend(invdiscrete.then_some(("invdiscrete", true)));
    flags.extend(model.override_contacts.then_some(("override", true)));
    Ok(flags)
}
