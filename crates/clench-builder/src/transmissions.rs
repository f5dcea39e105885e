//! The transmissions of actuators.

use super::element::Element;
use super::resolve::AllNames;
use super::{ActuatorSpec, BuildError, TransmissionSpec};
use clench_dynamics::dynamics::chains::Chains;
use clench_dynamics::model::{Model, Transmission};

/// Returns the transmission of an actuator.
///
/// # Errors
/// Returns an error for an unknown name, a slider-crank without length, or an orientation servo of a target that does
/// not rotate.
pub(super) fn find(spec: &ActuatorSpec, names: &AllNames) -> Result<Transmission, BuildError> {
    let site = |name: &String| names.sites.find(name, spec);
    let is_rotational = spec.gain.is_rotation();
    Ok(match &spec.transmission {
        TransmissionSpec::Joint(name) if is_rotational => {
            Transmission::Rotation(names.joints.find(name, spec)?)
        }
        TransmissionSpec::SiteInFrame {
            site: name,
            reference,
        } if is_rotational => Transmission::RotationInFrame([site(name)?, site(reference)?]),
        _ if is_rotational => {
            return Err(
                spec.error("an orientation servo needs a ball joint, or a site with a refsite")
            );
        }
        TransmissionSpec::Joint(name) => Transmission::Joint(names.joints.find(name, spec)?),
        TransmissionSpec::JointInParent(name) => {
            Transmission::JointInParent(names.joints.find(name, spec)?)
        }
        TransmissionSpec::Tendon(name) => Transmission::Tendon(names.tendons.find(name, spec)?),
        TransmissionSpec::Site(name) => Transmission::Site(site(name)?),
        TransmissionSpec::SiteInFrame {
            site: name,
            reference,
        } => Transmission::SiteInFrame([site(name)?, site(reference)?]),
        TransmissionSpec::SliderCrank { crank, slider } => {
            let length = spec.cranklength;
            if length <= 0.0 {
                return Err(spec.error(format!("cranklength must be positive, but is {length}")));
            }
            Transmission::SliderCrank([site(crank)?, site(slider)?])
        }
        TransmissionSpec::Body(name) => Transmission::Body(names.bodies.find(name, spec)?),
    })
}

/// Records the dofs that a transmission acts on, for each of its lengths.
pub(super) fn push_dofs(transmission: Transmission, model: &mut Model) {
    let body = |site: usize| model.sites[site].body;
    let between = |bodies: Chains| -> Vec<u32> {
        let parts = bodies.parts().into_iter();
        parts.flat_map(|(part, _)| part).copied().collect()
    };
    let dofs: Vec<u32> = match transmission {
        Transmission::Rotation(j) => {
            // Each axis of the joint is a dof.
            let first = model.joints[j].dof as u32;
            (0..3).for_each(|axis| model.actuator_dofs.push([first + axis]));
            return;
        }
        Transmission::RotationInFrame(sites) => {
            let dofs = between(Chains::new(model, sites.map(body)).without_common());
            (0..3).for_each(|_| model.actuator_dofs.push(dofs.clone()));
            return;
        }
        Transmission::Joint(j) | Transmission::JointInParent(j) => {
            let joint = &model.joints[j];
            let dofs = joint.dof..joint.dof + joint.kind.nv();
            dofs.map(|dof| dof as u32).collect()
        }
        Transmission::Tendon(t) => model.tendon_dofs.dofs(t).to_vec(),
        Transmission::Site(site) => between(Chains::new(model, [body(site), 0])),
        Transmission::SiteInFrame(sites) | Transmission::SliderCrank(sites) => {
            between(Chains::new(model, sites.map(body)).without_common())
        }
        // A body can be in contact with any other.
        Transmission::Body(_) => (0..model.nv as u32).collect(),
    };
    model.actuator_dofs.push(dofs);
}
