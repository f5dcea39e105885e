//! Contact sensors: the contacts between two sides, a fixed number of them or their sum.
//!
//! A contact matches if one of its geoms belongs to the first side and the other to the second. Its normal then points
//! from the first side to the second: if the geoms are in the opposite order, normal and first tangent change their
//! sign. The force is negated as well, so that in the new frame only its component along the second tangent changes its
//! sign. The same holds for the torque and the velocities.

use super::read::Reading;
use crate::output::forces::of_contact;
use clench_dynamics::contact::Contact;
use clench_dynamics::model::{ContactField, ContactQuery, ContactReduction, ContactSide};
use clench_math::{Force, Mask, Motion, Real, Vec3, kernel};

/// The maximum number of values per contact.
const MAX_SIZE: usize = 23;

/// A matching contact.
struct Match<'a, T: Real> {
    contact: &'a Contact<T>,
    /// The index of the contact.
    index: T,
    /// The lanes in which it matches.
    lanes: T::Mask,
    /// −1 if the normal is reversed, otherwise 1.
    sign: T,
}

impl<T: Real> Reading<'_, T> {
    /// Writes the reading of a contact sensor; unused slots are zero.
    #[kernel]
    pub(super) fn read_contacts(&self, query: &ContactQuery, out: &mut [T]) {
        out.fill(T::ZERO);
        let mut count = T::ZERO;
        self.each_match(query, |found| {
            count += T::select(found.lanes, T::ONE, T::ZERO);
        });
        let size = query.size();
        if query.reduction == ContactReduction::NetForce {
            return self.read_net_force(query, count, &mut out[..size]);
        }
        // Each slot takes the next contact after the previous slot's, ordered by key, then by index.
        let mut last = [T::new(f64::NEG_INFINITY), -T::ONE];
        for slot in out.chunks_exact_mut(size) {
            let mut best = [T::new(f64::INFINITY), -T::ONE];
            self.each_match(query, |found| {
                let key = self.key(query.reduction, found.contact);
                let tied = key.le(last[0]) & key.ge(last[0]) & found.index.gt(last[1]);
                let taken = found.lanes & (key.gt(last[0]) | tied) & key.lt(best[0]);
                if !taken.any() {
                    return;
                }
                best[0] = T::select(taken, key, best[0]);
                best[1] = T::select(taken, found.index, best[1]);
                let mut row = [T::ZERO; MAX_SIZE];
                self.write_contact(query, &found, count, &mut row[..size]);
                for (to, from) in slot.iter_mut().zip(row) {
                    *to = T::select(taken, from, *to);
                }
            });
            if !best[1].ge(T::ZERO).any() {
                return;
            }
            last = best;
        }
    }

    /// Returns the sort key of a contact; the smallest comes first.
    fn key(&self, reduction: ContactReduction, contact: &Contact<T>) -> T {
        match reduction {
            ContactReduction::MinDist => contact.dist,
            ContactReduction::MaxForce => -self.wrench(contact).linear.norm_squared(),
            ContactReduction::None | ContactReduction::NetForce => T::ZERO,
        }
    }

    /// Calls `show` for the matching contacts, in order.
    #[kernel]
    fn each_match(&self, query: &ContactQuery, mut show: impl FnMut(Match<'_, T>)) {
        for (index, contact) in self.ws.contacts.iter().enumerate() {
            let Some(sign) = self.direction(query, contact.geoms) else {
                continue;
            };
            let mut lanes = contact.active;
            if let Some(site) = query.site {
                lanes &= self.is_inside(site, contact.pos).gt(T::ZERO);
            }
            if lanes.any() {
                let index = T::new(index as f64);
                show(Match {
                    contact,
                    index,
                    lanes,
                    sign: T::new(sign),
                });
            }
        }
    }

    /// Returns the sign of the normal if the geoms match.
    fn direction(&self, query: &ContactQuery, geoms: [usize; 2]) -> Option<f64> {
        let belongs = |geom: usize, side: &ContactSide| match side {
            ContactSide::Any => true,
            ContactSide::Geom(wanted) => geom == *wanted,
            ContactSide::Body(body) => self.model.geoms[geom].body == *body,
            ContactSide::Subtree(bodies) => bodies.contains(&self.model.geoms[geom].body),
        };
        let [first, second] = &query.sides;
        match geoms {
            [a, b] if belongs(a, first) && belongs(b, second) => Some(1.0),
            [a, b] if belongs(b, first) && belongs(a, second) => Some(-1.0),
            _ => None,
        }
    }

    /// Returns force and torque of a contact on its second geom in the contact frame; zero without constraint.
    fn wrench(&self, contact: &Contact<T>) -> Force<T> {
        let Some(force) = of_contact(self.ws, contact) else {
            return Force::ZERO;
        };
        Force::new(Vec3::from_slice(&force[3..]), Vec3::from_slice(&force))
    }

    /// Writes the fields of one contact.
    fn write_contact(
        &self,
        query: &ContactQuery,
        found: &Match<'_, T>,
        count: T,
        mut out: &mut [T],
    ) {
        let contact = found.contact;
        let turned = |v: Vec3<T>| Vec3::new(v.x, v.y, v.z * found.sign);
        for field in &query.fields {
            let (numbers, rest) = out.split_at_mut(field.size());
            match field {
                ContactField::Found => numbers[0] = count,
                ContactField::Force => turned(self.wrench(contact).linear).write(numbers),
                ContactField::Torque => turned(self.wrench(contact).angular).write(numbers),
                ContactField::Dist => numbers[0] = contact.dist,
                ContactField::Pos => contact.pos.write(numbers),
                ContactField::Normal => (contact.frame.rows[0] * found.sign).write(numbers),
                ContactField::Tangent => (contact.frame.rows[1] * found.sign).write(numbers),
                ContactField::LinVel => {
                    turned(self.relative_motion(contact).linear).write(numbers);
                }
                ContactField::AngVel => {
                    turned(self.relative_motion(contact).angular).write(numbers);
                }
            }
            out = rest;
        }
    }

    /// Returns the velocity of the second body relative to the first at the contact point, in the contact frame.
    #[kernel]
    fn relative_motion(&self, contact: &Contact<T>) -> Motion<T> {
        let [first, second] = contact.geoms.map(|geom| {
            let body = self.model.geoms[geom].body;
            let cvel = self.ws.velocity.cvel[body];
            let root = self.model.bodies[body].root;
            let arm = contact.pos - self.ws.position.subtree_com[root];
            Motion::new(cvel.angular, cvel.velocity_at(arm))
        });
        Motion::new(
            contact.frame * (second.angular - first.angular),
            contact.frame * (second.linear - first.linear),
        )
    }

    /// Writes the matching contacts as one contact in world axes. It acts at the mean of their positions, weighted by
    /// their forces.
    #[kernel]
    fn read_net_force(&self, query: &ContactQuery, count: T, mut out: &mut [T]) {
        let (mut force, mut torque) = (Vec3::ZERO, Vec3::ZERO);
        let (mut weight, mut pos) = (T::ZERO, Vec3::ZERO);
        let world = |found: &Match<'_, T>| {
            let wrench = self.wrench(found.contact);
            let turn = |v: Vec3<T>| found.contact.frame.transpose_mul(v) * found.sign;
            let none = |v: Vec3<T>| Vec3::select(found.lanes, v, Vec3::ZERO);
            [none(turn(wrench.linear)), none(turn(wrench.angular))]
        };
        self.each_match(query, |found| {
            let [linear, _] = world(&found);
            let size = linear.norm();
            force += linear;
            weight += size;
            pos += Vec3::select(found.lanes, found.contact.pos, Vec3::ZERO) * size;
        });
        let pressed = weight.gt(T::ZERO);
        pos = pos * (T::ONE / T::select(pressed, weight, T::ONE));
        self.each_match(query, |found| {
            let [linear, angular] = world(&found);
            let arm = Vec3::select(found.lanes, found.contact.pos - pos, Vec3::ZERO);
            torque += angular + arm.cross(linear);
        });
        let touched = count.gt(T::ZERO);
        let axis = |i: usize| {
            let mut unit = Vec3::<T>::ZERO;
            unit[i] = T::select(touched, T::ONE, T::ZERO);
            unit
        };
        for field in &query.fields {
            let (numbers, rest) = out.split_at_mut(field.size());
            match field {
                ContactField::Found => numbers[0] = count,
                ContactField::Force => force.write(numbers),
                ContactField::Torque => torque.write(numbers),
                ContactField::Pos => pos.write(numbers),
                ContactField::Normal => axis(0).write(numbers),
                ContactField::Tangent => axis(1).write(numbers),
                ContactField::Dist | ContactField::LinVel | ContactField::AngVel => {}
            }
            out = rest;
        }
    }
}
