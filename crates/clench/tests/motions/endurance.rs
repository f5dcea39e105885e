//! The option `stiction` over minutes: a load that friction carries stays where it is.

use crate::sticking::{
    ball_between_fingers, car, drift, ladder, pendulum, run, scene, stack, start, sticking,
};
use clench::prelude::*;

const PYRAMIDS: (ContactModel, FrictionCone) = (ContactModel::Convex, FrictionCone::Pyramidal);
const CONES: (ContactModel, FrictionCone) = (ContactModel::Convex, FrictionCone::Elliptic);
const COULOMB: (ContactModel, FrictionCone) = (ContactModel::Coulomb, FrictionCone::Elliptic);

/// A capsule of 45 g between two pads that press with 30 N: friction could carry 95 times its weight.
fn pinched_capsule(timestep: f64) -> String {
    let pad = |name: &str, side: f64| {
        format!(
            "<body pos='{} 0 .5'><joint name='{name}' type='slide' axis='{} 0 0' damping='50'/>
             <geom type='box' size='.01 .03 .02' mass='.1' friction='.7'/></body>",
            0.014 * side,
            -side
        )
    };
    let world = format!(
        "{}{}<body pos='0 0 .5'><freejoint/>
           <geom type='capsule' size='.004' fromto='0 -.02 0 0 .02 0' mass='.045' friction='.7'/></body>",
        pad("left", -1.0),
        pad("right", 1.0)
    );
    let motors = "<actuator><motor joint='left'/><motor joint='right'/></actuator>";
    scene(timestep, "", &world, motors)
}

#[test]
fn a_pinched_capsule_stays_for_a_minute_and_for_ten() {
    for (law, cone) in [PYRAMIDS, CONES, COULOMB] {
        for impratio in [1.0, 10.0, 100.0] {
            for timestep in [0.002, 0.005] {
                // Pyramids hop at a high impratio or a long step (docs/contact.md).
                if cone == FrictionCone::Pyramidal && (timestep > 0.002 || impratio > 10.0) {
                    continue;
                }
                let options = sticking().contact_model(law).friction_cone(cone);
                let mut sim = start(&pinched_capsule(timestep), options.impratio(impratio));
                sim.state.ctrl.fill(30.0);
                run(&mut sim, 1.0);
                let what = format!("{law:?}, {cone:?}, impratio {impratio}, {timestep} s");
                let crept = drift(&mut sim, 60.0) / 60.0;
                assert!(crept < 1e-8, "{what}: {crept} m/s");
                if (impratio, timestep) == (10.0, 0.005) {
                    let moved = drift(&mut sim, 540.0);
                    assert!(moved < 1e-5, "{what}: {moved} m in ten minutes");
                }
            }
        }
    }
    let mut sim = start(&pinched_capsule(0.002), sticking().stiction(false));
    sim.state.ctrl.fill(30.0);
    run(&mut sim, 1.0);
    let crept = drift(&mut sim, 1.0);
    assert!(crept > 1e-4, "without stiction it creeps: {crept} m/s");
}

#[test]
fn four_fingers_hold_a_ball_for_a_minute() {
    for (law, cone) in [CONES, COULOMB] {
        for condim in [4, 6] {
            let options = sticking().contact_model(law).friction_cone(cone);
            let mut sim = start(&ball_between_fingers(0.002, condim), options);
            run(&mut sim, 20.0);
            let moved = drift(&mut sim, 60.0);
            assert!(moved < 1e-7, "{law:?}, condim {condim}: {moved} m");
        }
    }
}

#[test]
fn what_friction_carries_stands_for_ten_minutes() {
    for (name, text) in [
        ("ladder", ladder(0.005)),
        ("stack", stack(0.005)),
        ("car", car(0.005)),
        ("pendulum", pendulum(0.005)),
    ] {
        let (law, cone) = COULOMB;
        let mut sim = start(&text, sticking().contact_model(law).friction_cone(cone));
        run(&mut sim, 20.0);
        let moved = drift(&mut sim, 600.0);
        assert!(moved < 1e-6, "{name}: {moved} m or rad");
    }
}
