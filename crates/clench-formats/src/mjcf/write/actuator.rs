//! Actuators, each written as `<general>`.

use super::names::{SaveError, body_name, label, named};
use super::xml::{Tag, Xml};
use clench_dynamics::Model;
use clench_dynamics::model::{
    Actuator, ControlInput, DynamicsKind, GainKind, History, Interpolation, Transmission,
};

pub(super) fn write(model: &Model, xml: &mut Xml) -> Result<(), SaveError> {
    for u in 0..model.actuators.len() {
        write_actuator(model, u, xml)?;
    }
    Ok(())
}

fn write_actuator(model: &Model, u: usize, xml: &mut Xml) -> Result<(), SaveError> {
    let Actuator {
        name,
        transmission: _,
        dynamics,
        acts,
        gain,
        bias,
        states: _,
        outputs: _,
        controls,
        inputs,
        ctrllimited,
        history,
        forcelimited,
        actlimited,
        actearly,
        disabled: _,
        group,
        user,
    } = &model.actuators[u];
    let p = &model.params;
    let pulls_back = bias.pulls_back(*gain, &p.actuator_gainprm[u], &p.actuator_biasprm[u]);
    if pulls_back && p.actuator_biasprm[u][2] > 0.0 {
        let reason = "MJCF reads its positive velocity coefficient as a damping ratio";
        return Err(SaveError::new(label("actuator", name, u), reason));
    }
    let [quadratic, cubic] = p.actuator_dampingpoly[u];
    let tag = write_transmission(model, u, xml.tag("general").name(name))?;
    let ranges = &p.actuator_ctrlrange[controls.clone()];
    let mut tag = write_controls(*gain, inputs, ctrllimited, ranges, tag)
        .numbers_unless("forcerange", &p.actuator_forcerange[u], &[0.0; 2])
        .boolean("forcelimited", *forcelimited)
        .numbers_unless("actrange", &p.actuator_actrange[u], &[0.0; 2])
        .boolean("actlimited", *actlimited)
        .numbers("gear", &p.actuator_gear[u])
        .numbers_unless("user", user, &[])
        .numbers_unless("lengthrange", &p.actuator_lengthrange[u], &[0.0; 2])
        .text("dyntype", dynamics.name())
        .text("gaintype", gain.name())
        .text("biastype", bias.name())
        .numbers("dynprm", &p.actuator_dynprm[u])
        .numbers("gainprm", &p.actuator_gainprm[u])
        .numbers("biasprm", &p.actuator_biasprm[u])
        .polynomial("damping", [p.actuator_damping[u], quadratic, cubic])
        .number_unless("armature", p.actuator_armature[u], 0.0)
        .integer_unless("group", (*group).into(), 0);
    let usual = usize::from(*dynamics != DynamicsKind::None);
    // The counts of controllers, motors and orientation servos derive from their parameters.
    let follows = matches!(gain, GainKind::Pid | GainKind::DcMotor | GainKind::So3);
    if acts.len() != usual && !follows {
        tag = tag.integer("actdim", acts.len() as i64);
    }
    if let Some(history) = history {
        tag = write_history(history, p.actuator_delay[u], tag);
    }
    if *actearly {
        tag = tag.boolean("actearly", true);
    }
    tag.end();
    Ok(())
}

/// Writes the transmission of actuator `u`.
fn write_transmission<'a>(model: &Model, u: usize, tag: Tag<'a>) -> Result<Tag<'a>, SaveError> {
    let joint = |j: usize| named("joint", &model.joints[j].name, j);
    let site = |s: usize| named("site", &model.sites[s].name, s);
    Ok(match model.actuators[u].transmission {
        Transmission::Joint(j) => tag.text("joint", joint(j)?),
        Transmission::JointInParent(j) => tag.text("jointinparent", joint(j)?),
        Transmission::Tendon(t) => tag.text("tendon", named("tendon", &model.tendons[t].name, t)?),
        Transmission::Site(s) => tag.text("site", site(s)?),
        Transmission::Rotation(j) => tag.text("joint", joint(j)?),
        Transmission::SiteInFrame([s, reference])
        | Transmission::RotationInFrame([s, reference]) => {
            tag.text("site", site(s)?).text("refsite", site(reference)?)
        }
        Transmission::SliderCrank([crank, slider]) => tag
            .text("cranksite", site(crank)?)
            .text("slidersite", site(slider)?)
            .numbers("cranklength", &[model.params.actuator_cranklength[u]]),
        Transmission::Body(b) => tag.text("body", body_name(model, b)?),
    })
}

/// Writes the control inputs and their ranges.
fn write_controls<'a>(
    gain: GainKind,
    inputs: &[ControlInput],
    limited: &[bool],
    ranges: &[[f64; 2]],
    mut tag: Tag<'a>,
) -> Tag<'a> {
    let names = inputs.iter().filter_map(|input| match input {
        ControlInput::Command => None,
        ControlInput::Position => Some("pos"),
        ControlInput::Velocity => Some("vel"),
        ControlInput::Feedforward => Some("ff"),
        ControlInput::Voltage => Some("voltage"),
        ControlInput::RotationVector => Some("expmap"),
        ControlInput::Quaternion => Some("quat"),
    });
    let mut names: Vec<&str> = names.collect();
    names.dedup();
    if inputs.is_empty() {
        names.push("none");
    }
    if !names.is_empty() {
        tag = tag.words("input", names.iter().copied());
    }
    // Velocity and feedforward of a PID controller have separate ranges; all other controls share one.
    let own = |input: &ControlInput| match (gain, input) {
        (GainKind::Pid, ControlInput::Velocity) => "velrange",
        (GainKind::Pid, ControlInput::Feedforward) => "ffrange",
        _ => "ctrlrange",
    };
    let mut written: Vec<&str> = Vec::new();
    for ((input, range), &limited) in inputs.iter().zip(ranges).zip(limited) {
        let attribute = own(input);
        if written.contains(&attribute) {
            continue;
        }
        written.push(attribute);
        tag = tag.numbers_unless(attribute, range, &[0.0; 2]);
        if attribute == "ctrlrange" {
            tag = tag.boolean("ctrllimited", limited);
        }
    }
    tag
}

/// Writes the history settings and the delay.
pub(super) fn write_history<'a>(history: &History, delay: f64, tag: Tag<'a>) -> Tag<'a> {
    let History {
        start: _,
        samples,
        width: _,
        interpolation: between,
    } = history;
    tag.integer("nsample", *samples as i64)
        .text("interp", interpolation(*between))
        .numbers("delay", &[delay])
}

fn interpolation(between: Interpolation) -> &'static str {
    match between {
        Interpolation::Hold => "zoh",
        Interpolation::Linear => "linear",
        Interpolation::Cubic => "cubic",
    }
}
