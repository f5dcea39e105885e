//! Outputs that the host computes from downloaded fields.

use crate::batch::GpuBatch;
use crate::error::GpuError;
use crate::precision::GpuReal;
use clench_math::{Motion, Real, Vec3};
use clench_rigid::model::RowPattern;

/// Expands sparse rows of each environment to rows over all `nv` dofs.
fn spread<S: GpuReal>(
    nv: usize,
    (pattern, rows): (&RowPattern, usize),
    sparse: &[S],
    dense: &mut [S],
) {
    dense.fill(S::ZERO);
    let envs = dense.chunks_exact_mut((rows * nv).max(1));
    for (out, values) in envs.zip(sparse.chunks_exact(pattern.len().max(1))) {
        for row in 0..rows {
            for (&dof, &value) in pattern.dofs(row).iter().zip(&values[pattern.range(row)]) {
                out[row * nv + dof as usize] = value;
            }
        }
    }
}

/// Groups numbers into 3-vectors.
fn vectors<S: GpuReal>(numbers: &[S]) -> Vec<Vec3<S>> {
    let vectors = numbers.chunks_exact(3);
    vectors.map(|v| Vec3::new(v[0], v[1], v[2])).collect()
}

impl<S: GpuReal> GpuBatch<S> {
    /// Computes a row over all dofs for each tendon of each environment.
    pub(crate) fn tendon_jacobians(&self, rows: &mut [S]) -> Result<(), GpuError> {
        let model = self.model();
        let pattern = (&model.tendon_dofs, model.tendons.len());
        spread(model.nv, pattern, &self.read("ten_jacobian")?, rows);
        Ok(())
    }

    /// Does the same for each actuator output.
    pub(crate) fn moment_arms(&self, rows: &mut [S]) -> Result<(), GpuError> {
        let model = self.model();
        let pattern = (&model.actuator_dofs, model.nout());
        spread(model.nv, pattern, &self.read("actuator_moment")?, rows);
        Ok(())
    }

    /// Computes the total positive power of the actuators of each environment; braking ones are omitted.
    pub(crate) fn driving_powers(&self, rows: &mut [S]) -> Result<(), GpuError> {
        let forces = self.read("actuator_force")?;
        let velocities = self.read("actuator_velocity")?;
        let powers = Vec::from_iter(forces.iter().zip(velocities).map(|(&f, v)| f * v));
        let each = powers.chunks(self.model().nout().max(1));
        for (row, powers) in rows.iter_mut().zip(each) {
            let driving = powers.iter().map(|&power| Real::max(power, S::ZERO));
            *row = driving.fold(S::ZERO, |sum, power| sum + power);
        }
        Ok(())
    }

    /// Computes three rows over all dofs for each site of each environment: the given part of each dof's motion at the
    /// site.
    pub(crate) fn site_jacobians(
        &self,
        part: impl Fn(Motion<S>, Vec3<S>) -> Vec3<S>,
        rows: &mut [S],
    ) -> Result<(), GpuError> {
        let axes = vectors(&self.read("cdof")?);
        let points = vectors(&self.read("site_xpos")?);
        let centres = vectors(&self.read("subtree_com")?);
        let m = self.model();
        rows.fill(S::ZERO);
        let jacobians = rows.chunks_exact_mut((3 * m.nv).max(1)).enumerate();
        for (k, jacobian) in jacobians {
            let (env, body) = (
                k / m.sites.len(),
                &m.bodies[m.sites[k % m.sites.len()].body],
            );
            let offset = points[k] - centres[env * m.nbody() + body.root];
            for &dof in body.last_dof.map_or(&[][..], |last| m.tree.row(last)) {
                let axis = &axes[2 * (env * m.nv + dof as usize)..][..2];
                let motion = Motion {
                    angular: axis[0],
                    linear: axis[1],
                };
                let column = part(motion, offset).to_array();
                for (row, number) in column.into_iter().enumerate() {
                    jacobian[row * m.nv + dof as usize] = number;
                }
            }
        }
        Ok(())
    }
}
