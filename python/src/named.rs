//! Elements of simulations and batches by name: methods that return the views of `clench._named`.

use crate::batch::Batch;
use crate::sim::Sim;
use pyo3::prelude::*;

/// Creates a view of an element of `owner`, of a class of `clench._named`.
fn view<'py>(
    owner: &Bound<'py, PyAny>,
    class: &str,
    which: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    let module = owner.py().import("clench._named")?;
    module.getattr(class)?.call1((owner, which))
}

/// The docstring of a method that returns a view.
macro_rules! doc {
    ($kind:literal, $class:literal) => {
        concat!(
            "The ",
            $kind,
            " of that name or index, with what belongs to it: readable, and settable where it can be.\n\n",
            "Parameters\n----------\n",
            "which : str or int\n    Its name or index.\n\n",
            "Returns\n-------\n",
            $class,
            "\n\nRaises\n------\n",
            "ValueError\n    A name that no ",
            $kind,
            " has.\n",
            "IndexError\n    An index that is negative or too large.",
        )
    };
}

macro_rules! named_access {
    ($owner:ident) => {
        #[pymethods]
        impl $owner {
            #[doc = doc!("body", "BodyView")]
            fn body<'py>(
                this: &Bound<'py, Self>,
                which: &Bound<'py, PyAny>,
            ) -> PyResult<Bound<'py, PyAny>> {
                view(this.as_any(), "BodyView", which)
            }
            #[doc = doc!("joint", "JointView")]
            fn joint<'py>(
                this: &Bound<'py, Self>,
                which: &Bound<'py, PyAny>,
            ) -> PyResult<Bound<'py, PyAny>> {
                view(this.as_any(), "JointView", which)
            }
            #[doc = doc!("geom", "GeomView")]
            fn geom<'py>(
                this: &Bound<'py, Self>,
                which: &Bound<'py, PyAny>,
            ) -> PyResult<Bound<'py, PyAny>> {
                view(this.as_any(), "GeomView", which)
            }
            #[doc = doc!("site", "SiteView")]
            fn site<'py>(
                this: &Bound<'py, Self>,
                which: &Bound<'py, PyAny>,
            ) -> PyResult<Bound<'py, PyAny>> {
                view(this.as_any(), "SiteView", which)
            }
            #[doc = doc!("camera", "CameraView")]
            fn camera<'py>(
                this: &Bound<'py, Self>,
                which: &Bound<'py, PyAny>,
            ) -> PyResult<Bound<'py, PyAny>> {
                view(this.as_any(), "CameraView", which)
            }
            #[doc = doc!("tendon", "TendonView")]
            fn tendon<'py>(
                this: &Bound<'py, Self>,
                which: &Bound<'py, PyAny>,
            ) -> PyResult<Bound<'py, PyAny>> {
                view(this.as_any(), "TendonView", which)
            }
            #[doc = doc!("actuator", "ActuatorView")]
            fn actuator<'py>(
                this: &Bound<'py, Self>,
                which: &Bound<'py, PyAny>,
            ) -> PyResult<Bound<'py, PyAny>> {
                view(this.as_any(), "ActuatorView", which)
            }
            #[doc = doc!("equality constraint", "EqualityView")]
            fn equality<'py>(
                this: &Bound<'py, Self>,
                which: &Bound<'py, PyAny>,
            ) -> PyResult<Bound<'py, PyAny>> {
                view(this.as_any(), "EqualityView", which)
            }

            /// Parameters : All parameters by name, as in ``params.gravity``. Reading returns copies; assignments are
            /// validated.
            #[getter]
            fn params<'py>(this: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
                let module = this.py().import("clench._named")?;
                module.getattr("Parameters")?.call1((this,))
            }
        }
    };
}
named_access!(Sim);
named_access!(Batch);
