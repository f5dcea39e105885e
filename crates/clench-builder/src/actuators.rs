//! Actuators.

use super::controllers::{Controller, controller};
use super::element::{Element, resolve_range};
use super::model_builder::ModelBuilder;
use super::resolve::AllNames;
use super::tendons::require_scalar;
use super::{ActuatorSpec, BuildError, TransmissionSpec, histories, transmissions};
use clench_dynamics::budget::RAISE;
use clench_dynamics::dynamics::orientation;
use clench_dynamics::model::{
    Actuator, BiasKind, ControlInput, DynamicsKind, GainKind, JointKind, Model, Params,
    Transmission,
};
use std::sync::Arc;

/// Adds all actuators, and numbers their activations.
///
/// # Errors
/// Returns an error if a target is unknown, a range is not ascending, an activation range has no activation, or there
/// is no range to inherit.
pub(super) fn add_all(
    builder: &ModelBuilder,
    names: &AllNames,
    model: &mut Model,
) -> Result<(), BuildError> {
    for spec in &builder.actuators {
        let mut spec = spec.clone();
        let transmission = transmissions::find(&spec, names)?;
        inherit_range(&mut spec, transmission, model)?;
        add(builder, &spec, transmission, model)?;
    }
    Ok(())
}

fn add(
    builder: &ModelBuilder,
    spec: &ActuatorSpec,
    transmission: Transmission,
    model: &mut Model,
) -> Result<(), BuildError> {
    let auto = builder.compiler.autolimits;
    let forcelimited = resolve_range(spec, "force", spec.forcelimited, spec.forcerange, auto)?;
    let ctrllimited = resolve_range(spec, "ctrl", spec.ctrllimited, spec.ctrlrange, auto)?;
    let actlimited = resolve_range(spec, "act", spec.actlimited, spec.actrange, auto)?;
    if spec.dampratio.is_some() && !pulls_back(spec) {
        return Err(spec.error("dampratio needs an affine bias with gainprm[0] = -biasprm[1]"));
    }
    if spec.dampratio.is_some() && spec.biasprm[1] > 0.0 {
        return Err(spec.error("dampratio needs a gain that is not negative"));
    }
    let outputs = match spec.gain.is_rotation() {
        true => orientation::OUTPUTS,
        false => 1,
    };
    let controller = controller(spec, model.na)?;
    let activations = activations(spec, &controller)?;
    let (all, limit) = (
        model.na.saturating_add(activations),
        builder.budget.elements,
    );
    if all as u64 > limit {
        return Err(spec.error(format!(
            "with it the model has {all} activations, more than the maximum of {limit}; {RAISE}"
        )));
    }
    let controls = model.nu()..model.nu() + controller.inputs.len();
    let ranges: Vec<_> = (controller.inputs.iter())
        .map(|&input| control_range(spec, input, ctrllimited))
        .collect();
    if actlimited && activations == 0 {
        return Err(spec.error("has an actrange, but no activation"));
    }
    check_parts(spec, transmission, forcelimited, model)?;
    let history = histories::add(builder, spec, spec.history, controls.len(), model)?;
    model.actuators.push(Actuator {
        name: spec.name.clone(),
        transmission,
        dynamics: spec.dynamics,
        acts: model.na..model.na + activations,
        outputs: model.nout()..model.nout() + outputs,
        gain: spec.gain,
        bias: spec.bias,
        states: controller.states,
        controls,
        inputs: controller.inputs,
        ctrllimited: ranges.iter().map(|(limited, _)| *limited).collect(),
        history,
        forcelimited,
        actlimited,
        actearly: spec.actearly,
        disabled: (builder.physics.disabled_actuator_groups.iter())
            .any(|&group| i64::from(group) == i64::from(spec.group)),
        group: spec.group,
        user: Arc::clone(&spec.user),
    });
    model.na += activations;
    transmissions::push_dofs(transmission, model);
    push_params(
        spec,
        ranges.iter().map(|(_, range)| *range),
        &mut model.params,
    );
    reflect(spec, transmission, model)
}

/// Checks the kinds of gain and bias against the transmission and their parameters.
fn check_parts(
    spec: &ActuatorSpec,
    transmission: Transmission,
    forcelimited: bool,
    model: &Model,
) -> Result<(), BuildError> {
    if let Transmission::Rotation(j) = transmission
        && model.joints[j].kind != JointKind::Ball
    {
        return Err(spec.error("an orientation servo needs a ball joint"));
    }
    if spec.gain.is_rotation() && forcelimited && spec.forcerange[0] != 0.0 {
        return Err(
            spec.error("the forcerange of an orientation servo limits a norm: it must start at 0")
        );
    }
    if spec.gain == GainKind::Muscle {
        check_muscle(spec, "gainprm", &spec.gainprm)?;
    }
    if spec.bias == BiasKind::Muscle {
        check_muscle(spec, "biasprm", &spec.biasprm)?;
    }
    Ok(())
}

fn push_params(
    spec: &ActuatorSpec,
    ctrlranges: impl Iterator<Item = [f64; 2]>,
    p: &mut Params<f64>,
) {
    p.actuator_gear.push(spec.gear);
    p.actuator_cranklength.push(spec.cranklength);
    p.actuator_dynprm.push(spec.dynprm);
    p.actuator_gainprm.push(spec.gainprm);
    p.actuator_biasprm.push(spec.biasprm);
    p.actuator_ctrlrange.extend(ctrlranges);
    p.actuator_forcerange.push(spec.forcerange);
    p.actuator_actrange.push(spec.actrange);
    p.actuator_lengthrange.push(spec.lengthrange);
    p.actuator_delay.push(spec.history.delay);
    let [linear, quadratic, cubic] = spec.damping;
    p.actuator_damping.push(linear);
    p.actuator_dampingpoly.push([quadratic, cubic]);
    p.actuator_armature.push(spec.armature);
}

/// Lets the last actuator damp its target and add inertia to it, if it has damping or armature.
fn reflect(
    spec: &ActuatorSpec,
    transmission: Transmission,
    model: &mut Model,
) -> Result<(), BuildError> {
    if spec.damping != [0.0; 3] || spec.armature != 0.0 {
        // As in MuJoCo, the ball joint of an orientation servo gets neither.
        use Transmission::{Joint, JointInParent, Rotation, Tendon};
        let (Joint(_) | JointInParent(_) | Tendon(_) | Rotation(_)) = transmission else {
            return Err(spec.error("damping and armature of an actuator need a joint or a tendon"));
        };
        model.let_reflect(model.actuators.len() - 1);
    }
    Ok(())
}

/// Returns true if a control is clamped, and its range. For a PID controller `ctrlrange` is that of the position.
fn control_range(spec: &ActuatorSpec, input: ControlInput, ctrllimited: bool) -> (bool, [f64; 2]) {
    let own = match (spec.gain, input) {
        (GainKind::Pid, ControlInput::Velocity) => spec.velrange,
        (GainKind::Pid, ControlInput::Feedforward) => spec.ffrange,
        _ => return (ctrllimited, spec.ctrlrange),
    };
    (own[0] < own[1], own)
}

impl ActuatorSpec {
    /// Returns the meaning of the controls of the actuator, in their order.
    ///
    /// # Errors
    /// Returns an error if the kinds of dynamics, gain and bias are incompatible, or do not support the inputs.
    pub fn controls(&self) -> Result<Vec<ControlInput>, BuildError> {
        Ok(controller(self, 0)?.inputs)
    }

    /// Returns the number of activations of the actuator.
    ///
    /// # Errors
    /// Also returns an error if `actdim` differs from that of these dynamics.
    pub fn activations(&self) -> Result<usize, BuildError> {
        activations(self, &controller(self, 0)?)
    }
}

/// Returns the number of activations of the actuator.
fn activations(spec: &ActuatorSpec, controller: &Controller) -> Result<usize, BuildError> {
    let own = match spec.dynamics {
        DynamicsKind::None => 0,
        DynamicsKind::Pid | DynamicsKind::DcMotor => controller.count,
        DynamicsKind::Integrator if spec.gain.is_rotation() => orientation::OUTPUTS,
        DynamicsKind::Integrator
        | DynamicsKind::Filter
        | DynamicsKind::FilterExact
        | DynamicsKind::Muscle
        | DynamicsKind::User => 1,
    };
    let actdim = spec.actdim.unwrap_or(own);
    let any = spec.dynamics == DynamicsKind::User && actdim > 0;
    if actdim != own && !any {
        return Err(spec.error(format!(
            "actdim is {actdim}, but these dynamics have {own} activations"
        )));
    }
    Ok(actdim)
}

/// Checks the parameters of a muscle.
fn check_muscle(spec: &ActuatorSpec, field: &str, prm: &[f64; 10]) -> Result<(), BuildError> {
    let [low, high, _, scale, lmin, lmax, vmax, fpmax, fvmax, _] = *prm;
    let wrong = match () {
        () if low >= high => "its range must be increasing (range[0] < range[1])",
        () if lmin >= 1.0 || lmax <= 1.0 => "lmin must be below 1 and lmax above",
        () if scale.min(vmax).min(fpmax).min(fvmax) <= 0.0 => {
            "scale, vmax, fpmax and fvmax must be positive"
        }
        () => return Ok(()),
    };
    Err(spec.error(format!("{field} is invalid for a muscle: {wrong}")))
}

fn pulls_back(spec: &ActuatorSpec) -> bool {
    (spec.bias).pulls_back(spec.gain, &spec.gainprm, &spec.biasprm)
}

/// Returns true if the actuator is a servo: its force vanishes if the control equals the length.
fn is_servo(spec: &ActuatorSpec) -> bool {
    matches!(spec.gain, GainKind::Fixed | GainKind::Pid) && pulls_back(spec)
}

/// Applies MuJoCo's `inheritrange`: a servo's setpoint range is a fraction of its target's range, about the same
/// middle.
fn inherit_range(
    spec: &mut ActuatorSpec,
    transmission: Transmission,
    model: &Model,
) -> Result<(), BuildError> {
    if spec.inheritrange == 0.0 {
        return Ok(());
    }
    if !is_servo(spec) {
        return Err(spec.error("inheritrange needs a position servo (gainprm[0] = -biasprm[1])"));
    }
    let [low, high] = match (transmission, &spec.transmission) {
        (Transmission::Joint(j), TransmissionSpec::Joint(name)) => {
            require_scalar(spec, name, j, model)?;
            model.params.jnt_range[j]
        }
        (Transmission::Tendon(t), _) => model.params.tendon_range[t],
        _ => return Err(spec.error("inheritrange needs a joint or tendon in its own frame")),
    };
    if low == high {
        return Err(spec.error("inheritrange needs a target that has a range"));
    }
    let (mean, radius) = (0.5 * (high + low), 0.5 * (high - low) * spec.inheritrange);
    let range = [mean - radius, mean + radius];
    match spec.dynamics {
        DynamicsKind::None | DynamicsKind::FilterExact | DynamicsKind::Pid => {
            spec.ctrlrange = range;
        }
        DynamicsKind::Integrator => spec.actrange = range,
        DynamicsKind::Filter
        | DynamicsKind::Muscle
        | DynamicsKind::DcMotor
        | DynamicsKind::User => {
            return Err(spec.error("inheritrange does not support this kind of dynamics"));
        }
    }
    Ok(())
}
