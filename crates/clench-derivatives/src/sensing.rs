//! The derivatives of kinematic sensors, after recursions found those of the acceleration.
//!
//! Poses, velocities and actuator forces in dual numbers suffice for these sensors. Contacts and constraints, whose
//! passes take longest, have no part in them.

use crate::kinematic::last_stage;
use crate::pass::DualPass;
use crate::seed::{self, Seed};
use crate::source::Source;
use crate::stage::Stage;
use clench_dynamics::dynamics::actuation::actuation;
use clench_dynamics::dynamics::kinematics::Computed;
use clench_dynamics::dynamics::velocity::velocities;
use clench_dynamics::part::Part;
use clench_dynamics::pipeline::{poses, velocity_stage};
use clench_math::Real;
use clench_rigid::evaluate_sensors;

impl<L: Real<Scalar = f64>> DualPass<L> {
    /// Computes the derivatives of the sensors along directions, one in each seed's slot. `columns` are their columns
    /// in the derivatives of the acceleration. `write` receives those of each number of the sensors.
    pub(crate) fn read_sensors(
        &mut self,
        source: Source<'_>,
        (seeds, columns): (&[Seed], &[usize]),
        write: &mut dyn FnMut(usize, &[f64]),
    ) {
        let Source {
            model, settings, ..
        } = source;
        if source.first {
            self.before.set_values(source.state);
        } else {
            self.clear_state(model, source.request);
        }
        seed::set(model, seeds, &mut self.before, &mut self.params);
        let last = std::mem::replace(&mut self.last, source.start);
        let DualPass {
            params,
            before,
            ws,
            recursive,
            ..
        } = self;
        match source.start {
            Stage::Positions => {
                ws.invalidate_poses();
                ws.contacts.clear();
                let whole = [Part::whole(model)];
                poses(
                    model,
                    params,
                    before,
                    Computed::all(&whole),
                    &mut ws.position,
                );
            }
            Stage::Velocities | Stage::Forces if last == Stage::Positions => {
                ws.remove_position_derivatives()
            }
            Stage::Velocities | Stage::Forces => {}
        }
        if source.start == Stage::Forces && last != Stage::Forces {
            ws.remove_velocity_derivatives();
        }
        match model.sensors.iter().filter_map(last_stage).max() {
            None | Some(Stage::Positions) => {}
            Some(Stage::Velocities) => {
                let (pos, qvel) = (&ws.position, &before.qvel);
                velocities(model, &[Part::whole(model)], pos, qvel, &mut ws.velocity);
            }
            Some(Stage::Forces) => {
                if source.start < Stage::Forces {
                    velocity_stage(model, params, before, ws);
                }
                let (pos, vel) = (&ws.position, &ws.velocity);
                actuation(model, params, before, pos, vel, Real::ZERO, &mut ws.force);
                for (dof, qacc) in ws.qacc.iter_mut().enumerate() {
                    *qacc = Real::new(recursive.qacc[dof]);
                    let rates = recursive.acceleration(dof);
                    for (slot, &column) in columns.iter().enumerate() {
                        qacc.set_derivative(slot, rates[column]);
                    }
                }
            }
        }
        ws.sensors.wanted = true;
        evaluate_sensors(model, params, settings, before, ws);
        for (row, number) in ws.sensors.data.iter().enumerate() {
            write(row, &L::as_scalars(&number.tangent)[..columns.len()]);
        }
    }
}
