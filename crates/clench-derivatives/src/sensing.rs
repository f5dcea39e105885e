//! The derivatives of sensors and outputs, after recursions found those of accelerations and of constraint forces.
//!
//! Poses, velocities and actuator forces of the bodies that y reads, in dual numbers, suffice. Constraints, whose
//! passes take longest, have no part in them.

use crate::pass::{DualPass, remove_reused_derivatives};
use crate::reads::Reads;
use crate::seed::{self, Seed};
use crate::source::Source;
use crate::stage::Stage;
use clench_dynamics::contact::{Contact, detect};
use clench_dynamics::dynamics::actuation::actuation;
use clench_dynamics::dynamics::bias::bias_forces;
use clench_dynamics::dynamics::kinematics::Computed;
use clench_dynamics::dynamics::passive::passive_forces;
use clench_dynamics::dynamics::tendon_armature::add_tendon_bias;
use clench_dynamics::dynamics::velocity::velocities;
use clench_dynamics::part::Part;
use clench_dynamics::pipeline::poses;
use clench_dynamics::record::BlockRecord;
use clench_math::{Dual, Mask, Mat3, Real, Vec3};
use clench_rigid::{OutputSource, evaluate_sensors};

impl<L: Real<Scalar = f64>> DualPass<L> {
    /// Computes the derivatives of y along directions, one in each seed's slot. `columns` are their columns in the
    /// derivatives of the acceleration. `write` receives those of each number of y.
    pub(crate) fn read_results(
        &mut self,
        source: Source<'_>,
        reads: Reads,
        (seeds, columns): (&[Seed], &[usize]),
        write: &mut dyn FnMut(usize, &[f64]),
    ) {
        let (model, request) = (source.model, source.request);
        if source.first {
            self.before.set_values(source.state);
        } else {
            self.clear_state(model, request);
        }
        seed::set(model, seeds, &mut self.before, &mut self.params);
        let last = std::mem::replace(&mut self.last, source.start);
        remove_reused_derivatives(&mut self.ws, last, source);
        self.run_stages(source, reads);
        if reads.forces {
            self.set_forces(source, reads, columns);
        }
        let DualPass {
            params,
            before,
            ws,
            outputs,
            recursive,
            ..
        } = self;
        for (dof, qacc) in ws.qacc.iter_mut().enumerate() {
            let rates = recursive.acceleration(dof);
            set(qacc, recursive.qacc[dof], rates, columns);
        }
        if !request.omits_sensors {
            ws.sensors.wanted = true;
            evaluate_sensors(source.context(params), before, ws);
        }
        outputs.clear();
        outputs.extend_from_slice(&ws.sensors.data[..request.sensors_len(model)]);
        let mut from = OutputSource {
            model,
            params,
            state: before,
            ws,
        };
        for output in &request.outputs {
            output.read(&mut from, outputs);
        }
        for (row, number) in outputs.iter().enumerate() {
            write(row, &L::as_scalars(&number.tangent)[..columns.len()]);
        }
    }

    /// Runs the stages that y reads, from the first that changes on.
    fn run_stages(&mut self, source: Source<'_>, reads: Reads) {
        let (model, start) = (source.model, source.start);
        let (params, before, ws) = (&self.params, &self.before, &mut self.ws);
        let parts = [Part::first(model, reads.bodies)];
        if start == Stage::Positions {
            ws.invalidate_poses();
            let computed = Computed::all(&parts);
            poses(model, params, before, computed, &mut ws.position);
            if reads.contacts {
                detect(source.context(params), ws);
            }
        }
        let (pos, vel, force) = (&ws.position, &mut ws.velocity, &mut ws.force);
        if start < Stage::Forces && reads.stage >= Stage::Velocities {
            velocities(model, &parts, pos, &before.qvel, vel);
            if reads.accelerations {
                bias_forces(model, params, &parts, pos, vel, &before.qvel, force);
                if reads.bodies == model.nbody() {
                    add_tendon_bias(model, params, pos, vel, &before.qvel, force);
                }
            }
            // Gravity compensation may act through actuators, which then read all bodies.
            if reads.stage == Stage::Forces && reads.bodies == model.nbody() {
                let at = (pos, &*vel);
                passive_forces(model, params, &parts, at, before, &[], force);
            }
        }
        if reads.stage == Stage::Forces {
            actuation(model, params, before, pos, vel, Real::ZERO, force);
        }
    }

    /// Sets the forces of constraints, as if a solve had found them.
    fn set_forces(&mut self, source: Source<'_>, reads: Reads, columns: &[usize]) {
        let DualPass { ws, recursive, .. } = self;
        let plain = &recursive.plain;
        for (contact, plain) in ws.contacts.iter_mut().zip(&plain.contacts) {
            contact.block = plain.block;
        }
        if source.first {
            if !reads.contacts {
                let contacts = plain.contacts.iter();
                ws.contacts.clear();
                (ws.contacts).extend(contacts.map(|contact| Contact::convert(contact, Real::new)));
            }
            // Sites of other bodies only select contacts, so that their poses need no derivatives.
            for (s, site) in source.model.sites.iter().enumerate() {
                if site.body >= reads.bodies {
                    let (from, to) = (&plain.position, &mut ws.position);
                    let axes = from.site_xmat[s].rows.map(Vec3::to_array);
                    to.site_xpos[s] = Vec3::from_f64(from.site_xpos[s].to_array());
                    to.site_xmat[s] = Mat3::from_f64(axes);
                }
            }
            ws.problem.clear_constraints();
            ws.record.blocks.clear();
            for (block, record) in plain.problem.blocks().zip(&plain.record.blocks) {
                let to = ws.problem.push(block.cost, block.dim, block.dofs);
                for (to, &from) in to.jacobian.iter_mut().zip(block.jacobian) {
                    *to = Real::new(from);
                }
                ws.record.blocks.push(BlockRecord {
                    source: record.source,
                    active: Mask::splat(record.active),
                    margin: Real::new(record.margin),
                    impedance: Real::new(record.impedance),
                });
            }
            ws.record.pos.resize(plain.problem.nrow(), Real::ZERO);
            ws.record.vel.resize(plain.problem.nrow(), Real::ZERO);
        }
        let forces = ws.solver.force_mut();
        forces.resize(plain.problem.nrow(), Real::ZERO);
        for (row, (force, &value)) in forces.iter_mut().zip(plain.solver.force()).enumerate() {
            set(force, value, recursive.row_forces().row(row), columns);
        }
    }
}

/// Sets a number and its derivatives, which are some columns of a row.
fn set<L: Real<Scalar = f64>, const K: usize>(
    number: &mut Dual<L, K>,
    value: f64,
    row: &[f64],
    columns: &[usize],
) {
    *number = Real::new(value);
    for (slot, &column) in columns.iter().enumerate() {
        number.set_derivative(slot, row[column]);
    }
}
