//! `<option>`: time step, medium, integrator, solver and feature flags. The table of options defines which attributes
//! are options.
//!
//! Solver options that a file omits have the defaults of its format, not this library's: a MuJoCo user gets MuJoCo's
//! numbers.

use crate::document::Element;
use crate::error::LoadError;
use clench_builder::{ContactOverride, DEFAULT_SOLIMP, DEFAULT_SOLREF, ModelBuilder};
use clench_dynamics::model::{Flags, Integrator};
use clench_dynamics::options::{Mjcf, OptionValue, RigidOption, RigidOptions};
use clench_solver::Switch;

/// Returns MJCF's defaults: 100 iterations, and time constants as written.
///
/// The tolerance depends on the precision of the solve.
pub(crate) fn format_defaults() -> RigidOptions {
    RigidOptions::new()
        .iterations(100)
        .constraint_timeconst(0.0)
}

const SWITCHES: [(&str, bool); 2] = [("disable", false), ("enable", true)];

/// A reader of the `<option>`s of a file; later ones override earlier ones.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OptionReader {
    contact: ContactOverride,
    contact_override: bool,
    replaced_solver: bool,
}

impl Default for OptionReader {
    fn default() -> Self {
        OptionReader {
            contact: ContactOverride {
                margin: 0.0,
                solref: DEFAULT_SOLREF,
                solimp: DEFAULT_SOLIMP,
                friction: [1.0, 1.0, 0.005, 0.0001, 0.0001],
            },
            contact_override: false,
            replaced_solver: false,
        }
    }
}

impl OptionReader {
    /// Reads one `<option>`.
    pub(crate) fn read(
        &mut self,
        element: &Element,
        builder: &mut ModelBuilder,
    ) -> Result<(), LoadError> {
        read_physics(element, builder)?;
        read_options(element, &mut builder.options, attribute)?;
        if let Some(solver) = element.text("solver") {
            self.replaced_solver = solver == "PGS";
        }
        element.set_number("o_margin", &mut self.contact.margin)?;
        element.overlay("o_solref", &mut self.contact.solref)?;
        element.overlay("o_solimp", &mut self.contact.solimp)?;
        element.overlay("o_friction", &mut self.contact.friction)?;
        for flag in &element.children {
            element_flags(flag, &mut builder.physics.flags)?;
            read_options(flag, &mut builder.options, flag_value)?;
            flag.set_keyword("override", &SWITCHES, &mut self.contact_override)?;
        }
        if builder.physics.flags.sleep && builder.physics.integrator == Integrator::Rk4 {
            let message = "the flag sleep and the integrator RK4 cannot be combined: trees that fall asleep would wake up in the \
                next step";
            return Err(element.error(message));
        }
        if builder.physics.integrator == Integrator::Discrete && self.replaced_solver {
            let message = "the solver PGS and the integrator discrete cannot be combined: MuJoCo then steps in another metric, \
                without tendons and actuators; choose Newton or CG";
            return Err(element.error(message));
        }
        if builder.physics.integrator == Integrator::Discrete
            && builder.physics.flags.sleep
            && builder.options.islands == Some(Switch::Off)
        {
            let message = "the integrator discrete needs islands where the flag sleep is on: trees that its metric couples must \
                sleep and wake together";
            return Err(element.error(message));
        }
        Ok(())
    }

    /// Applies the settings that depend on all `<option>`s together.
    pub(crate) fn finish(self, builder: &mut ModelBuilder) {
        builder.physics.contact_override = self.contact_override.then_some(self.contact);
        if self.replaced_solver {
            let note = "the file asks for the solver PGS; Newton finds the same minimum and is used instead";
            builder.notes.push(note.to_owned());
        }
    }
}

/// Reads the options of an element, each by `read`.
fn read_options(
    element: &Element,
    options: &mut RigidOptions,
    read: fn(&Element, RigidOption) -> Result<Option<OptionValue>, LoadError>,
) -> Result<(), LoadError> {
    for &option in RigidOption::ALL {
        if let Some(value) = read(element, option)? {
            (options.set(option, value)).map_err(|wrong| element.error(wrong.to_string()))?;
        }
    }
    Ok(())
}

/// Returns the value of an option that is an attribute of `<option>`.
fn attribute(element: &Element, option: RigidOption) -> Result<Option<OptionValue>, LoadError> {
    match (option.mjcf(), option.default(false)) {
        (Mjcf::Attribute(name), OptionValue::Count(_)) => {
            Ok(element.count(name)?.map(OptionValue::Count))
        }
        (Mjcf::Attribute(name), OptionValue::Number(_)) => {
            Ok(element.numbers(name)?.map(|[x]| OptionValue::Number(x)))
        }
        (Mjcf::Attribute(name), default) => element.keyword(name, default.keywords()),
        (Mjcf::Words(name, words), _) => element.keyword(name, words),
        (Mjcf::Flag(..) | Mjcf::Text(_) | Mjcf::Nowhere, _) => Ok(None),
    }
}

/// Returns the value of an option that is an attribute of `<flag>`.
fn flag_value(element: &Element, option: RigidOption) -> Result<Option<OptionValue>, LoadError> {
    match option.mjcf() {
        Mjcf::Flag(name, [disabled, enabled]) => {
            element.keyword(name, &[("disable", disabled), ("enable", enabled)])
        }
        Mjcf::Attribute(_) | Mjcf::Words(..) | Mjcf::Text(_) | Mjcf::Nowhere => Ok(None),
    }
}

fn read_physics(element: &Element, builder: &mut ModelBuilder) -> Result<(), LoadError> {
    let physics = &mut builder.physics;
    element.set_number("timestep", &mut physics.timestep)?;
    if physics.timestep <= 0.0 {
        return Err(element.error("timestep must be positive"));
    }
    element.set_numbers("gravity", &mut physics.gravity)?;
    element.set_numbers("wind", &mut physics.wind)?;
    element.set_numbers("magnetic", &mut physics.magnetic)?;
    element.refuse_negative(&["density", "viscosity"])?;
    element.set_number("density", &mut physics.density)?;
    element.set_number("viscosity", &mut physics.viscosity)?;
    element.set_number("sleep_tolerance", &mut physics.sleep_tolerance)?;
    let integrators = [
        ("Euler", Integrator::Euler),
        ("RK4", Integrator::Rk4),
        ("implicitfast", Integrator::ImplicitFast),
        ("implicit", Integrator::Implicit),
        ("discrete", Integrator::Discrete),
    ];
    element.set_keyword("integrator", &integrators, &mut physics.integrator)?;
    for group in element.integers("actuatorgroupdisable")? {
        match u32::try_from(group) {
            Ok(group @ 0..=30) if !physics.disabled_actuator_groups.contains(&group) => {
                physics.disabled_actuator_groups.push(group);
            }
            Ok(0..=30) => {}
            _ => return Err(element.error(format!("the actuator group {group} is not in 0 to 30"))),
        }
    }
    Ok(())
}

/// Reads the physics flags.
fn element_flags(element: &Element, flags: &mut Flags) -> Result<(), LoadError> {
    let targets = [
        ("equality", &mut flags.equality),
        ("frictionloss", &mut flags.frictionloss),
        ("limit", &mut flags.limit),
        ("contact", &mut flags.contact),
        ("spring", &mut flags.spring),
        ("damper", &mut flags.damper),
        ("gravity", &mut flags.gravity),
        ("clampctrl", &mut flags.clampctrl),
        ("filterparent", &mut flags.filterparent),
        ("actuation", &mut flags.actuation),
        ("refsafe", &mut flags.refsafe),
        ("eulerdamp", &mut flags.eulerdamp),
        ("multiccd", &mut flags.multiccd),
        ("diagexact", &mut flags.diagexact),
        ("sensor", &mut flags.sensor),
        ("sleep", &mut flags.sleep),
        ("invdiscrete", &mut flags.invdiscrete),
    ];
    for (name, target) in targets {
        element.set_keyword(name, &SWITCHES, target)?;
    }
    Ok(())
}
