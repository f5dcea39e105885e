//! Stick references are state: they are saved, sleep, end with their contact, and have a limited number of slots.

use crate::sticking::{ANGLE, BOX, run, scene, slope, start, sticking};
use clench::prelude::*;
use clench::rigid::{Fault, SimError};

#[test]
fn references_are_state() {
    let text = slope(0.002, "", ANGLE, ANGLE.tan() / 0.9, 0.05, BOX);
    let mut sim = start(&text, sticking());
    run(&mut sim, 1.0);
    let references = &sim.state.stick_references;
    let (plane, cube) = (references[0].first, references[0].second);
    assert_eq!((plane, cube), (1.0, 2.0));
    let mut other = start(&text, sticking());
    other.state.copy_from(&sim.state);
    run(&mut sim, 0.5);
    run(&mut other, 0.5);
    assert!(sim.state == other.state, "a restored state moves alike");
    // Contacts that break forget.
    sim.state.qpos[2] += 1.0;
    sim.step().expect("finite");
    assert!(sim.state.stick_references.iter().all(|r| r.first == 0.0));
    other.reset();
    assert!(other.state.stick_references.iter().all(|r| r.first == 0.0));
}

#[test]
fn sleep_keeps_the_references() {
    let text = slope(0.002, "", ANGLE, ANGLE.tan() / 0.9, 0.05, BOX).replace(
        "<worldbody>",
        "<option><flag sleep='enable'/></option><worldbody>",
    );
    let mut sim = start(&text, sticking());
    run(&mut sim, 3.0);
    assert!(sim.state.tree_asleep[0] >= 0.0, "it sleeps");
    let asleep = format!("{:?}", sim.state.stick_references);
    run(&mut sim, 1.0);
    assert_eq!(format!("{:?}", sim.state.stick_references), asleep);
    let mut forgetful = start(&text, sticking());
    forgetful.state.copy_from(&sim.state);
    forgetful.state.stick_references[0].first = 0.0;
    // A force wakes both. The box tilts a little further, for it fell asleep while it still did.
    let slips = [&mut sim, &mut forgetful].map(|sim| {
        let before = sim.state.qpos[0];
        sim.state.xfrc_applied[1].linear = Vec3::new(0.0, 0.0, -1e-3);
        run(sim, 1.0);
        assert!(sim.state.tree_asleep[0] < 0.0, "it is awake");
        (sim.state.qpos[0] - before).abs()
    });
    assert!(slips[0] < 1e-5 && slips[1] > 3e-5, "{slips:?} m");
}

#[test]
fn too_few_slots_are_an_error_that_names_the_option() {
    let foot = "<freejoint/><geom type='box' size='.05 .05 .05'/>";
    let world = format!(
        "<geom type='plane' size='5 5 .1'/><body pos='0 0 .05'>{foot}</body><body pos='1 0 .05'>{foot}</body>"
    );
    let text = scene(0.002, "", &world, "");
    let mut sim = start(&text, sticking().max_stick_pairs(1));
    let error = (0..100).find_map(|_| sim.step().err()).expect("overflows");
    assert!(
        matches!(error, SimError::Fault(Fault::OverBudget { .. })),
        "{error}"
    );
    assert!(error.to_string().contains("max_stick_pairs"), "{error}");
    let mut sim = start(&text, sticking().max_stick_pairs(2));
    run(&mut sim, 1.0);
    let error = sim.set_options(RigidOptions::new()).expect_err("too late");
    assert_eq!(error, SimError::FixedOption("stiction"));
    sim.set_options(sticking().max_stick_pairs(2).iterations(7))
        .expect("other options may change");
}
