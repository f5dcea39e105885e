//! Accelerations of bodies and forces between them, constraints included, and the momenta of subtrees.
//!
//! A recursive Newton–Euler pass with the solved joint accelerations (Featherstone 2008, §5.3). A body with
//! acceleration a requires the force I a + v ×* I v. External forces supply one part, the joints to its parent and
//! children the remainder.

use super::read::Reading;
use crate::output::forces::external_forces;
use crate::output::source::Source;
use clench_dynamics::model::{Model, Params};
use clench_dynamics::state::State;
use clench_dynamics::workspace::Workspace;
use clench_math::{Force, Motion, Real, Vec3, kernel};

/// Computes body accelerations from the last forward pass. The bias accelerations contain gravity and all velocity
/// terms; the joint accelerations are added to them.
#[kernel]
pub(super) fn update_accelerations<T: Real>(model: &Model, ws: &mut Workspace<T>) {
    let bodies = &mut ws.sensors.bodies;
    bodies.allocate(model.nbody());
    bodies.cacc[0] = Motion::ZERO;
    for (b, body) in model.bodies.iter().enumerate().skip(1) {
        let mut cacc = bodies.cacc[body.parent];
        for i in body.dofs.clone() {
            cacc += ws.position.cdof[i] * ws.qacc[i];
        }
        bodies.cacc[b] = cacc;
    }
    for b in 0..model.nbody() {
        bodies.cacc[b] += ws.force.cacc[b];
    }
}

/// Computes body accelerations and joint forces from the last forward pass.
#[kernel]
pub(crate) fn update<T: Real>(
    model: &Model,
    params: &Params<T>,
    state: &State<T>,
    ws: &mut Workspace<T>,
) {
    update_accelerations(model, ws);
    let mut bodies = std::mem::take(&mut ws.sensors.bodies);
    let source = Source {
        model,
        params,
        state,
        ws,
    };
    external_forces(&source, &mut bodies.external);
    bodies.cfrc_int[0] = Force::ZERO;
    for b in 1..model.nbody() {
        let cacc = bodies.cacc[b];
        let (inertia, cvel) = (ws.position.cinert[b], ws.velocity.cvel[b]);
        let external = &bodies.external[6 * b..6 * b + 6];
        let external = Force::new(Vec3::from_slice(external), Vec3::from_slice(&external[3..]));
        bodies.cfrc_int[b] = inertia * cacc + cvel.cross_force(inertia * cvel) - external;
    }
    for b in (1..model.nbody()).rev() {
        let parent = model.bodies[b].parent;
        let force = bodies.cfrc_int[b];
        bodies.cfrc_int[parent] += force;
    }
    ws.sensors.bodies = bodies;
}

/// The motion of a body's subtree.
pub(super) struct Subtree<T> {
    /// Velocity of its centre of mass.
    pub velocity: Vec3<T>,
    /// Angular momentum about its centre of mass.
    pub(crate) angular_momentum: Vec3<T>,
}

impl<T: Real> Reading<'_, T> {
    /// Returns the joint reaction on a site's body, world axes, about the site.
    #[kernel]
    pub(super) fn force_at(&self, site: usize) -> Force<T> {
        let body = self.model.sites[site].body;
        let force = self.ws.sensors.bodies.cfrc_int[body];
        let root = self.model.bodies[body].root;
        let arm = self.ws.position.site_xpos[site] - self.ws.position.subtree_com[root];
        Force::new(force.angular - arm.cross(force.linear), force.linear)
    }

    /// Adds up the momenta of a body's subtree.
    #[kernel]
    pub(super) fn subtree(&self, body: usize) -> Subtree<T> {
        let (model, pos) = (self.model, &self.ws.position);
        let mut momentum = Force::ZERO;
        for b in model.subtree(body) {
            let root = pos.subtree_com[model.bodies[b].root];
            let own = pos.cinert[b] * self.ws.velocity.cvel[b];
            // Momentum about the world's origin, which all trees share.
            momentum += Force::new(own.angular + root.cross(own.linear), own.linear);
        }
        let mass = self.params.body_subtreemass[body];
        let com = pos.subtree_com[body];
        let massless = mass.le(T::ZERO);
        let inverse = T::ONE / T::select(massless, T::ONE, mass);
        Subtree {
            velocity: Vec3::select(massless, Vec3::ZERO, momentum.linear * inverse),
            angular_momentum: momentum.angular - com.cross(momentum.linear),
        }
    }
}
