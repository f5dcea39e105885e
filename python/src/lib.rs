//! The compiled part of the Python package `clench`: the classes and functions that `clench/__init__.py` exports. The
//! crates do the computation; this crate converts, checks and forwards values.

#![deny(unreachable_pub)]

mod answer;
mod arrays;
mod assets;
mod batch;
mod batch_models;
mod block;
mod busy;
mod changes;
mod constraints;
mod contact;
mod contacts;
mod count;
#[cfg_attr(not(feature = "derivatives"), path = "no_derivatives.rs")]
mod derivatives;
mod device;
mod differentiated;
#[cfg_attr(not(feature = "render"), path = "no_drawing.rs")]
mod drawing;
mod element;
mod envs;
mod error;
mod field;
mod fields;
mod free_camera;
#[cfg(feature = "derivatives")]
mod gradients;
mod ik;
mod ik_targets;
mod inertia_queries;
mod jvp;
mod kind;
mod linearization;
mod linearize;
#[cfg(feature = "render")]
mod looks;
mod model;
mod motion_queries;
mod named;
mod names;
mod one_or_many;
mod option_values;
mod options;
mod picture;
mod positions;
mod precision;
mod queries;
mod recorded;
mod recording;
mod renderer;
mod rollout;
mod row_sim;
mod scan;
mod scan_queries;
#[cfg(feature = "derivatives")]
mod signals;
mod sim;
mod solve;
mod state_views;
mod stats;
mod table;
#[cfg(feature = "derivatives")]
mod tangents;
mod target;
mod view;
mod viewed;
mod viewer;
mod vjp;

use pyo3::prelude::*;

#[cfg(not(feature = "derivatives"))]
use {derivatives as gradients, derivatives as tangents};

#[pymodule]
mod _core {
    use crate::state_views;
    use clench::Output;
    use clench::rigid::model::ParamField;
    use pyo3::prelude::*;
    use pyo3::types::PyTuple;

    #[pymodule_export]
    use crate::batch::Batch;
    #[pymodule_export]
    use crate::block::Block;
    #[pymodule_export]
    use crate::constraints::Constraints;
    #[pymodule_export]
    use crate::contact::Contact;
    #[pymodule_export]
    use crate::contacts::Contacts;
    #[pymodule_export]
    use crate::device::devices;
    #[pymodule_export]
    use crate::drawing::render_device;
    #[pymodule_export]
    use crate::element::Element;
    #[pymodule_export]
    use crate::free_camera::FreeCamera;
    #[pymodule_export]
    use crate::ik::IkResult;
    #[pymodule_export]
    use crate::ik_targets::{ComTarget, FrameTarget, PostureTarget};
    #[pymodule_export]
    use crate::linearization::Linearization;
    #[pymodule_export]
    use crate::model::Model;
    #[pymodule_export]
    use crate::options::RigidOptions;
    #[pymodule_export]
    use crate::queries::{RayHit, Separation};
    #[pymodule_export]
    use crate::recording::Recording;
    #[pymodule_export]
    use crate::scan::RayHits;
    #[pymodule_export]
    use crate::sim::Sim;
    #[pymodule_export]
    use crate::solve::{Solution, solve};
    #[pymodule_export]
    use crate::state_views::StateViews;
    #[pymodule_export]
    use crate::stats::SolverStats;
    #[pymodule_export]
    use crate::viewer::Viewer;
    #[pymodule_export]
    #[allow(non_upper_case_globals)] // The name that Python prescribes.
    const __version__: &str = env!("CARGO_PKG_VERSION");

    #[pymodule_init]
    fn names(module: &Bound<'_, PyModule>) -> PyResult<()> {
        let outputs = Output::ALL.iter().map(|output| output.name());
        let parameters = ParamField::ALL.iter().map(|field| field.name());
        module.add("OUTPUTS", PyTuple::new(module.py(), outputs)?)?;
        module.add("PARAMETERS", PyTuple::new(module.py(), parameters)?)?;
        // For `clench.State` and for the tool that writes the stub. `add` would list it in `__all__`, so it is set.
        let fields = state_views::FIELDS.iter().map(|field| {
            let shape = match field.width {
                1 => format!("{},", field.size.symbol()),
                width => format!("{}, {width}", field.size.symbol()),
            };
            (
                field.name,
                field.dtype,
                format!("({shape})"),
                field.doc.trim(),
            )
        });
        let fields = PyTuple::new(module.py(), fields.collect::<Vec<_>>())?;
        module.setattr("_STATE_FIELDS", fields)
    }
}
