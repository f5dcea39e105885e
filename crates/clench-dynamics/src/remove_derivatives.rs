//! Removal of derivatives from the results of stages that do not change along the directions of the next pass.

use crate::contact::Contact;
use crate::record::BlockRecord;
use crate::stages::{Forces, Positions, Velocities};
use crate::workspace::Workspace;
use clench_math::{Inertia, Mat3, Motion, Quat, Real, Vec3};

impl<T: Real> Workspace<T> {
    /// Removes the derivatives of the position stage and of contacts. The factor of the mass matrix must have none.
    pub fn remove_position_derivatives(&mut self) {
        self.position.remove_derivatives();
        remove_derivatives(&mut self.problem.mass.values, number);
        remove_derivatives(&mut self.contacts, contact);
    }

    /// Removes the derivatives of constraints, which the next pass reuses. (With the integrator `discrete` they depend
    /// on the forces of actuators.)
    pub fn remove_constraint_derivatives(&mut self) {
        self.problem.remove_constraint_derivatives();
        remove_derivatives(&mut self.record.pos, number);
        remove_derivatives(&mut self.record.vel, number);
        remove_derivatives(&mut self.record.blocks, |block| BlockRecord {
            margin: number(&block.margin),
            impedance: number(&block.impedance),
            ..*block
        });
    }

    /// Removes the derivatives of the velocity stage.
    pub fn remove_velocity_derivatives(&mut self) {
        let Velocities {
            cvel,
            cdof_dot,
            ten_velocity,
            actuator_velocity,
        } = &mut self.velocity;
        remove_derivatives(cvel, motion);
        remove_derivatives(cdof_dot, motion);
        remove_derivatives(ten_velocity, number);
        remove_derivatives(actuator_velocity, number);
        let Forces {
            qfrc_bias,
            qfrc_spring,
            ten_spring,
            ten_bias,
            qfrc_damper,
            qfrc_gravcomp,
            qfrc_fluid,
            qfrc_adhesion,
            qfrc_passive,
            cacc,
            // Those of the next stage, and scratch.
            qfrc_actuator: _,
            qfrc_smooth: _,
            actuator_force: _,
            ten_actuator_force: _,
            ctrl: _,
            act_dot: _,
            cfrc_body: _,
        } = &mut self.force;
        remove_derivatives(cacc, motion);
        for forces in [
            qfrc_bias,
            qfrc_spring,
            ten_spring,
            ten_bias,
            qfrc_damper,
            qfrc_gravcomp,
            qfrc_fluid,
            qfrc_adhesion,
            qfrc_passive,
        ] {
            remove_derivatives(forces, number);
        }
    }
}

impl<T: Real> Positions<T> {
    fn remove_derivatives(&mut self) {
        for points in [
            &mut self.xpos,
            &mut self.xipos,
            &mut self.xanchor,
            &mut self.xaxis,
            &mut self.geom_xpos,
            &mut self.site_xpos,
            &mut self.subtree_com,
            &mut self.subtree_moment,
        ] {
            remove_derivatives(points, vector);
        }
        for frames in [
            &mut self.xmat,
            &mut self.ximat,
            &mut self.geom_xmat,
            &mut self.site_xmat,
        ] {
            remove_derivatives(frames, frame);
        }
        for rotations in [&mut self.xquat, &mut self.jnt_rotation] {
            remove_derivatives(rotations, rotation);
        }
        remove_derivatives(&mut self.cdof, motion);
        for inertias in [&mut self.cinert, &mut self.crb] {
            remove_derivatives(inertias, inertia);
        }
        for numbers in [
            &mut self.ten_length,
            &mut self.ten_jacobian,
            &mut self.actuator_length,
            &mut self.actuator_moment,
        ] {
            remove_derivatives(numbers, number);
        }
    }
}

/// Replaces every element by its value.
#[inline(always)]
fn remove_derivatives<X>(elements: &mut [X], value: impl Fn(&X) -> X) {
    for element in elements {
        *element = value(element);
    }
}

#[inline(always)]
fn number<T: Real>(x: &T) -> T {
    T::from_value(x.value())
}

#[inline(always)]
fn vector<T: Real>(v: &Vec3<T>) -> Vec3<T> {
    Vec3::new(number(&v.x), number(&v.y), number(&v.z))
}

#[inline(always)]
fn frame<T: Real>(m: &Mat3<T>) -> Mat3<T> {
    let [x, y, z] = &m.rows;
    Mat3::from_rows(vector(x), vector(y), vector(z))
}

#[inline(always)]
fn rotation<T: Real>(q: &Quat<T>) -> Quat<T> {
    Quat::from_slice(&q.to_array().map(|x| number(&x)))
}

#[inline(always)]
fn motion<T: Real>(m: &Motion<T>) -> Motion<T> {
    Motion::new(vector(&m.angular), vector(&m.linear))
}

#[inline(always)]
fn inertia<T: Real>(i: &Inertia<T>) -> Inertia<T> {
    Inertia {
        rotational: i.rotational.map(|x| number(&x)),
        moment: vector(&i.moment),
        mass: number(&i.mass),
    }
}

fn contact<T: Real>(c: &Contact<T>) -> Contact<T> {
    Contact {
        dist: number(&c.dist),
        pos: vector(&c.pos),
        frame: frame(&c.frame),
        includemargin: number(&c.includemargin),
        friction: c.friction.map(|x| number(&x)),
        solref: c.solref.map(|x| number(&x)),
        solreffriction: c.solreffriction.map(|x| number(&x)),
        solimp: c.solimp.map(|x| number(&x)),
        adhesion: number(&c.adhesion),
        surfacevel: c.surfacevel.map(|x| number(&x)),
        ..*c
    }
}
