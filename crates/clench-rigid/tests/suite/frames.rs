//! Motion of objects: Jacobians against velocities and differences, and joint forces from body forces.

use crate::machines::{Numbers, distance, everything, floating, shake, sim};
use clench_math::Vec3;
use clench_rigid::dynamics::integrate::{differentiate_positions, integrate_positions};
use clench_rigid::model::FrameObject;
use clench_rigid::{Anchor, Axes, Sim, SimError};
use std::sync::Arc;

fn machines() -> Vec<Sim> {
    let mut sims = [everything(), floating()].map(|builder| sim(&builder));
    for (seed, sim) in sims.iter_mut().enumerate() {
        shake(sim, seed as u64 + 3);
    }
    sims.into()
}

fn objects(sim: &Sim) -> Vec<FrameObject> {
    let model = sim.model();
    let bodies = (0..model.nbody()).flat_map(|b| [FrameObject::Body(b), FrameObject::Inertial(b)]);
    let geoms = (0..model.geoms.len()).map(FrameObject::Geom);
    let sites = (0..model.sites.len()).map(FrameObject::Site);
    bodies.chain(geoms).chain(sites).collect()
}

fn jacobian(sim: &mut Sim, anchor: Anchor<f64>) -> Vec<f64> {
    let mut jacobian = vec![f64::NAN; 6 * sim.model().nv];
    sim.jacobian(anchor, &mut jacobian).unwrap();
    jacobian
}

fn times(matrix: &[f64], x: &[f64]) -> Vec<f64> {
    let dot = |row: &[f64]| row.iter().zip(x).map(|(a, b)| a * b).sum();
    matrix.chunks_exact(x.len()).map(dot).collect()
}

fn numbers(vectors: &[Vec3<f64>]) -> Vec<f64> {
    vectors.iter().flat_map(|v| v.to_array()).collect()
}

/// Returns a simulation advanced by the velocities only.
fn moved(sim: &Sim, time: f64) -> Sim {
    let mut other = Sim::new(Arc::clone(sim.model())).unwrap();
    other.state.copy_from(&sim.state);
    let velocity = sim.state.qvel.clone();
    integrate_positions(sim.model(), &mut other.state.qpos, &velocity, time);
    other
}

#[test]
fn a_jacobian_times_the_velocities_of_dofs_is_the_velocity() {
    for mut sim in machines() {
        for object in objects(&sim) {
            let found = times(
                &jacobian(&mut sim, Anchor::Object(object)),
                &sim.state.qvel.clone(),
            );
            let velocity = sim.velocity(object, Axes::World).unwrap();
            assert!(distance(&found, &numbers(&velocity)) < 1e-12, "{object:?}");
        }
    }
}

#[test]
fn the_rate_of_a_jacobian_is_its_difference_over_time() {
    const H: f64 = 1e-5;
    for mut sim in machines() {
        let (mut before, mut after) = (moved(&sim, -H), moved(&sim, H));
        for object in objects(&sim) {
            let anchor = Anchor::Object(object);
            let (a, b) = (jacobian(&mut before, anchor), jacobian(&mut after, anchor));
            let expected: Vec<f64> = a.iter().zip(&b).map(|(a, b)| (b - a) / (2.0 * H)).collect();
            let mut rate = vec![0.0; a.len()];
            sim.jacobian_rate(anchor, &mut rate).unwrap();
            assert!(distance(&rate, &expected) < 1e-7, "{object:?}");
        }
    }
}

#[test]
fn the_jacobian_of_a_subtree_is_the_mean_of_those_of_its_masses() {
    for mut sim in machines() {
        let model = Arc::clone(sim.model());
        for body in 0..model.nbody() {
            let mut expected = vec![0.0; 3 * model.nv];
            for b in model.subtree(body) {
                let share = model.params.body_mass[b] / model.params.body_subtreemass[body];
                let own = jacobian(&mut sim, Anchor::Object(FrameObject::Inertial(b)));
                for (sum, own) in expected.iter_mut().zip(own) {
                    *sum += share * own;
                }
            }
            let mut found = vec![f64::NAN; 3 * model.nv];
            sim.subtree_jacobian(body, &mut found).unwrap();
            assert!(distance(&found, &expected) < 1e-12, "body {body}");
        }
    }
}

#[test]
fn local_axes_are_those_of_the_object() {
    let mut sim = machines().remove(0);
    for object in objects(&sim) {
        let world = sim.acceleration(object, Axes::World).unwrap();
        let local = sim.acceleration(object, Axes::Local).unwrap();
        let rotation = match object {
            FrameObject::Body(b) => sim.workspace().position.xmat[b],
            FrameObject::Inertial(b) => sim.workspace().position.ximat[b],
            FrameObject::Geom(g) => sim.workspace().position.geom_xmat[g],
            _ => continue,
        };
        let back = local.map(|v| rotation * v);
        assert!(distance(&numbers(&back), &numbers(&world)) < 1e-11);
    }
}

#[test]
fn a_force_does_along_the_dofs_the_work_that_it_does_at_its_point() {
    let mut random = Numbers(5);
    for mut sim in machines() {
        let nv = sim.model().nv;
        for body in 0..sim.model().nbody() {
            let mut v = [0.0; 9];
            random.fill(&mut v, 1.0);
            let [place, force, torque] = [0, 3, 6].map(|i| Vec3::from_slice(&v[i..]));
            let mut qfrc = vec![0.0; nv];
            (sim.add_joint_forces(body, place, (force, torque), &mut qfrc)).unwrap();
            let jacobian = jacobian(&mut sim, Anchor::Point { body, place });
            let velocity = times(&jacobian, &sim.state.qvel);
            let power: f64 = velocity.iter().zip(&v[3..]).map(|(a, b)| a * b).sum();
            let along: f64 = qfrc.iter().zip(&sim.state.qvel).map(|(a, b)| a * b).sum();
            assert!((power - along).abs() < 1e-11, "body {body}");
        }
    }
}

#[test]
fn the_mass_matrix_is_undone_by_its_inverse() {
    let mut random = Numbers(7);
    for mut sim in machines() {
        let nv = sim.model().nv;
        let mut x = vec![0.0; nv];
        random.fill(&mut x, 1.0);
        let mut product = vec![f64::NAN; nv];
        sim.mul_mass(&x, &mut product).unwrap();
        assert!(distance(&product, &times(&sim.mass_matrix().unwrap(), &x)) < 1e-12);
        sim.solve_mass(&mut product).unwrap();
        assert!(distance(&product, &x) < 1e-9);
    }
}

#[test]
fn differentiating_positions_undoes_integrating_them() {
    let mut random = Numbers(9);
    for sim in machines() {
        let model = sim.model();
        let mut velocity = vec![0.0; model.nv];
        random.fill(&mut velocity, 1.5);
        let mut to = sim.state.qpos.clone();
        integrate_positions(model, &mut to, &velocity, 0.7);
        let mut found = vec![f64::NAN; model.nv];
        differentiate_positions(model, &sim.state.qpos, &to, 0.7, &mut found);
        assert!(distance(&found, &velocity) < 1e-12);
    }
}

#[test]
fn questions_change_no_bit_of_later_steps() {
    for (mut asked, mut other) in machines().into_iter().zip(machines()) {
        for _ in 0..5 {
            let nv = asked.model().nv;
            jacobian(&mut asked, Anchor::Object(FrameObject::Body(1)));
            asked.velocity(FrameObject::Body(1), Axes::Local).unwrap();
            asked
                .acceleration(FrameObject::Body(1), Axes::World)
                .unwrap();
            asked.mul_mass(&vec![1.0; nv], &mut vec![0.0; nv]).unwrap();
            asked.step().unwrap();
            other.step().unwrap();
            assert_eq!(asked.state.qpos, other.state.qpos);
            assert_eq!(asked.state.qvel, other.state.qvel);
        }
    }
}

#[test]
fn unknown_elements_are_errors() {
    let mut sim = machines().remove(0);
    let nv = sim.model().nv;
    let mut room = vec![0.0; 6 * nv];
    let unknown = Anchor::Object(FrameObject::Site(1000));
    let found = sim.jacobian(unknown, &mut room).unwrap_err();
    assert!(matches!(
        found,
        SimError::NoSuchElement { kind: "site", .. }
    ));
    let point = Anchor::Point {
        body: 1000,
        place: Vec3::ZERO,
    };
    assert!(sim.jacobian(point, &mut room).is_err());
    let body = Anchor::Object(FrameObject::Body(0));
    assert!(sim.jacobian(body, &mut room[1..]).is_err());
    assert!(sim.subtree_jacobian(1000, &mut room[..3 * nv]).is_err());
    assert!(sim.solve_mass(&mut vec![f64::NAN; nv]).is_err());
}
