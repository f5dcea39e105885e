//! The numbers of elements of a model.

use super::Model;
use pyo3::prelude::*;

#[pymethods]
impl Model {
    /// int : Number of position coordinates.
    #[getter]
    fn nq(&self) -> usize {
        self.0.nq
    }
    /// int : Number of degrees of freedom.
    #[getter]
    fn nv(&self) -> usize {
        self.0.nv
    }
    /// int : Number of controls. Most actuators have one.
    #[getter]
    fn nu(&self) -> usize {
        self.0.nu()
    }

    /// int : Number of actuators; one may have several controls.
    #[getter]
    fn nactuator(&self) -> usize {
        self.0.actuators.len()
    }
    /// int : Number of actuator forces: one per actuator, but three for an orientation servo.
    #[getter]
    fn nout(&self) -> usize {
        self.0.nout()
    }
    /// int : Size of the buffers of delayed actuators and sensors.
    #[getter]
    fn nhistory(&self) -> usize {
        self.0.nhistory
    }
    /// int : Number of activations.
    #[getter]
    fn na(&self) -> usize {
        self.0.na
    }
    /// int : Number of values that store the rest positions of plastic springs.
    #[getter]
    fn nplastic(&self) -> usize {
        self.0.nplastic
    }
    /// int : Number of bodies, the world included.
    #[getter]
    fn nbody(&self) -> usize {
        self.0.nbody()
    }
    /// int : Number of joints.
    #[getter]
    fn njnt(&self) -> usize {
        self.0.joints.len()
    }
    /// int : Number of geoms.
    #[getter]
    fn ngeom(&self) -> usize {
        self.0.geoms.len()
    }
    /// int : Number of sites.
    #[getter]
    fn nsite(&self) -> usize {
        self.0.sites.len()
    }
    /// int : Number of cameras.
    #[getter]
    fn ncam(&self) -> usize {
        self.0.cameras.len()
    }
    /// int : Number of tendons.
    #[getter]
    fn ntendon(&self) -> usize {
        self.0.tendons.len()
    }
    /// int : Number of equality constraints.
    #[getter]
    fn neq(&self) -> usize {
        self.0.equalities.len()
    }
    /// int : Maximum number of simultaneous constraints that are added at run time.
    #[getter]
    fn max_dynamic_constraints(&self) -> usize {
        self.0.max_dynamic_constraints
    }
    /// int : Number of sensors.
    #[getter]
    fn nsensor(&self) -> usize {
        self.0.sensors.len()
    }
    /// int : Number of values of all sensors.
    #[getter]
    fn nsensordata(&self) -> usize {
        self.0.nsensordata()
    }
    /// int : Number of keyframes.
    #[getter]
    fn nkey(&self) -> usize {
        self.0.keyframes.len()
    }
    /// int : Number of mocap bodies.
    #[getter]
    fn nmocap(&self) -> usize {
        self.0.nmocap
    }
    /// int : Number of explicit geom pairs.
    #[getter]
    fn npair(&self) -> usize {
        self.0.pairs.len()
    }
    /// int : Number of meshes.
    #[getter]
    fn nmesh(&self) -> usize {
        self.0.meshes.len()
    }
    /// int : Number of height fields.
    #[getter]
    fn nhfield(&self) -> usize {
        self.0.height_fields.len()
    }
}
