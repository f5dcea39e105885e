//! `<option>`: time step, medium, integrator, solver and feature flags.
//!
//! Solver options that a file leaves out keep the values of its format, not this library's: a MuJoCo user gets MuJoCo's
//! numbers.

use super::document::Element;
use crate::LoadError;
use clench_rigid::builder::{ContactOverride, DEFAULT_SOLIMP, DEFAULT_SOLREF, ModelBuilder};
use clench_rigid::model::{Flags, Integrator};
use clench_solver::{ConstraintSolver, FrictionCone, RigidOptions, Switch};

/// What MJCF means where it is silent: 100 iterations and time constants as they are written.
///
/// A tolerance is left to the precision that the solve runs in.
pub(crate) fn format_defaults() -> RigidOptions {
    RigidOptions::new()
        .iterations(100)
        .constraint_timeconst(0.0)
}

const SWITCHES: [(&str, bool); 2] = [("disable", false), ("enable", true)];

/// Reads the `<option>`s of a file in turn; later ones override what they give.
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
    pub fn read(&mut self, element: &Element, builder: &mut ModelBuilder) -> Result<(), LoadError> {
        read_physics(element, builder)?;
        self.read_solver(element, &mut builder.options)?;
        element.set_number("o_margin", &mut self.contact.margin)?;
        element.overlay("o_solref", &mut self.contact.solref)?;
        element.overlay("o_solimp", &mut self.contact.solimp)?;
        element.overlay("o_friction", &mut self.contact.friction)?;
        for flag in &element.children {
            element_flags(flag, &mut builder.physics.flags)?;
            solver_flags(flag, &mut builder.options)?;
            flag.set_keyword("override", &SWITCHES, &mut self.contact_override)?;
        }
        if builder.physics.flags.sleep && builder.physics.integrator == Integrator::Rk4 {
            let message = "the flag sleep and the integrator RK4 cannot go together: what falls asleep would wake in the next step";
            return Err(element.error(message));
        }
        Ok(())
    }

    /// What only the last word of all `<option>`s decides.
    pub fn finish(self, builder: &mut ModelBuilder) {
        builder.physics.contact_override = self.contact_override.then_some(self.contact);
        if self.replaced_solver {
            let note = "the file asks for the solver PGS; Newton finds the same minimum and is used instead";
            builder.notes.push(note.to_owned());
        }
    }

    fn read_solver(
        &mut self,
        element: &Element,
        options: &mut RigidOptions,
    ) -> Result<(), LoadError> {
        let solvers = [
            ("PGS", None),
            ("CG", Some(ConstraintSolver::Cg)),
            ("Newton", Some(ConstraintSolver::Newton)),
        ];
        if let Some(solver) = element.keyword("solver", &solvers)? {
            self.replaced_solver = solver.is_none();
            options.constraint_solver = Some(solver.unwrap_or(ConstraintSolver::Newton));
        }
        let cones = [
            ("pyramidal", FrictionCone::Pyramidal),
            ("elliptic", FrictionCone::Elliptic),
        ];
        options.friction_cone = element.keyword("cone", &cones)?.or(options.friction_cone);
        let jacobians = [
            ("dense", Switch::Off),
            ("sparse", Switch::On),
            ("auto", Switch::Auto),
        ];
        options.sparse_solve = element
            .keyword("jacobian", &jacobians)?
            .or(options.sparse_solve);
        let number = |name| Ok::<_, LoadError>(element.numbers(name)?.map(|[n]| n));
        element.refuse_negative(&["impratio", "tolerance", "ls_tolerance", "noslip_tolerance"])?;
        options.impratio = number("impratio")?.or(options.impratio);
        if options.impratio == Some(0.0) {
            return Err(element.error("impratio must be positive"));
        }
        options.tolerance = number("tolerance")?.or(options.tolerance);
        options.ls_tolerance = number("ls_tolerance")?.or(options.ls_tolerance);
        options.noslip_tolerance = number("noslip_tolerance")?.or(options.noslip_tolerance);
        options.iterations = element.count("iterations")?.or(options.iterations);
        options.ls_iterations = element.count("ls_iterations")?.or(options.ls_iterations);
        options.noslip_iterations = element
            .count("noslip_iterations")?
            .or(options.noslip_iterations);
        Ok(())
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
        ("Euler", Some(Integrator::Euler)),
        ("RK4", Some(Integrator::Rk4)),
        ("implicitfast", Some(Integrator::ImplicitFast)),
        ("implicit", Some(Integrator::Implicit)),
        ("discrete", None),
    ];
    match element.keyword("integrator", &integrators)? {
        Some(Some(integrator)) => physics.integrator = integrator,
        Some(None) => {
            let name = element.string("integrator");
            return Err(element.error(format!("the integrator \"{name}\" is not supported yet")));
        }
        None => {}
    }
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

/// Flags of the physics.
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

/// Flags that are options here, so that a user's own options win over the file.
fn solver_flags(element: &Element, options: &mut RigidOptions) -> Result<(), LoadError> {
    if let Some(constraint) = element.keyword("constraint", &SWITCHES)? {
        options.disable_constraint = Some(!constraint);
    }
    options.warmstart = element
        .keyword("warmstart", &SWITCHES)?
        .or(options.warmstart);
    // Only what a file says: where it says nothing, a simulation that diverges stops.
    options.autoreset = element
        .keyword("autoreset", &SWITCHES)?
        .or(options.autoreset);
    if let Some(island) = element.keyword("island", &SWITCHES)? {
        options.islands = Some(if island { Switch::Auto } else { Switch::Off });
    }
    Ok(())
}
