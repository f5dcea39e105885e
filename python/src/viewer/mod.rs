//! `clench.Viewer`: a page in the browser beside a loop in Python.

mod draws;

use crate::arrays::shaped;
use crate::batch::AnyBatch;
use crate::busy::lock;
use crate::error::{classes::ClenchError, sim_error};
use crate::row_sim::AnySim;
use crate::viewed::{Target, each_viewed};
use clench_view::command::{MAX_SIDE_BY_SIDE, SPEEDS};
use clench_view::interaction::Interaction;
use clench_view::{Page, PassiveViewer, ServeError, ServerOptions};
use pyo3::exceptions::{PyIndexError, PyOSError, PyValueError};
use pyo3::prelude::*;
use std::sync::{Mutex, MutexGuard};
use std::thread::sleep;

/// The page that is part of this package, else one that is built now where it can be.
///
/// # Errors
/// `clench.ClenchError` that says what to do.
pub(crate) fn page(py: Python<'_>) -> PyResult<Page> {
    let tell = |text: &str| {
        // Without standard error nobody can be told, and nobody needs to be.
        let _ = Python::attach(|py| {
            let stderr = py.import("sys")?.getattr("stderr")?;
            stderr
                .call_method1("write", (format!("{text}\n"),))
                .map(drop)
        });
    };
    (py.detach(|| Page::find(tell))).map_err(|error| ClenchError::new_err(error.to_string()))
}

/// A page in the browser that shows a simulation while a loop of one's own steps it.
///
/// `clench.view` makes one. Users of the page can let the loop stand still or go step by step, pull at bodies, set controls and
/// joints, switch equalities, reset, and choose how fast time goes; all of it happens in `sync`, which the loop calls between
/// steps. Without a viewer a simulation pays nothing for it, and with one that nobody looks at hardly anything.
///
/// In a Jupyter notebook a viewer as the last value of a cell is seen there.
#[pyclass(frozen, module = "clench")]
pub(crate) struct Viewer {
    target: Target,
    envs: usize,
    url: String,
    state: Mutex<Option<PassiveViewer>>,
}

impl Viewer {
    fn lock(&self) -> PyResult<MutexGuard<'_, Option<PassiveViewer>>> {
        lock(&self.state, "viewer")
    }

    /// Does something with a viewer that is open.
    fn open<R>(&self, work: impl FnOnce(&mut PassiveViewer) -> R) -> PyResult<R> {
        let mut guard = self.lock()?;
        let open = guard.as_mut();
        open.map(work)
            .ok_or_else(|| ClenchError::new_err("this viewer is closed"))
    }
}

/// One of so many environments.
pub(crate) fn check_env(env: usize, envs: usize) -> PyResult<()> {
    if env < envs {
        return Ok(());
    }
    let text = format!("environments go from 0 to {envs}, without it");
    Err(PyIndexError::new_err(text))
}

/// A factor that users of the page can choose too.
fn check_speed(speed: f64) -> PyResult<f64> {
    let [low, high] = SPEEDS;
    if speed == 0.0 || (low..=high).contains(&speed) {
        return Ok(speed);
    }
    Err(PyValueError::new_err(format!(
        "speed is {speed}, but must be between {low} and {high}, or 0 for as fast as the loop goes"
    )))
}

fn vector(name: &str, value: &Bound<'_, PyAny>) -> PyResult<[f64; 3]> {
    let array = shaped::<f64>(name, value, &[3])?;
    let values = array.as_array();
    Ok([values[0], values[1], values[2]])
}

#[pymethods]
impl Viewer {
    #[new]
    #[pyo3(signature = (target, *, env = 0, host = "127.0.0.1", port = 0, paused = false, speed = 1.0))]
    fn new(
        target: &Bound<'_, PyAny>,
        env: usize,
        host: &str,
        port: u16,
        paused: bool,
        speed: f64,
    ) -> PyResult<Self> {
        let py = target.py();
        let target = Target::of(target)?;
        let envs = target.envs()?;
        check_env(env, envs)?;
        let options = ServerOptions {
            host: host.to_owned(),
            port,
            ..ServerOptions::default()
        };
        let speed = check_speed(speed)?;
        let page = page(py)?;
        let mut chosen = Interaction::new(paused);
        chosen.factor = speed;
        chosen.selection.env = env;
        let viewer =
            each_viewed!(&target, viewed => PassiveViewer::start(&options, page, chosen, viewed));
        let viewer = viewer.map_err(|error| match error {
            ServeError::Listen { .. } => PyOSError::new_err(error.to_string()),
            ServeError::System(_) | ServeError::Token => ClenchError::new_err(error.to_string()),
        })?;
        Ok(Viewer {
            target,
            envs,
            url: viewer.server().url(),
            state: Mutex::new(Some(viewer)),
        })
    }

    /// Shows what is now, and does what users of the page did since the last call.
    ///
    /// A pull at a body is written into `xfrc_applied`, in place of what is there, until the body is let go. A frame goes out at
    /// most sixty times a second, and only where a page asks for it, so that `sync` can be called after each step.
    ///
    /// Parameters
    /// ----------
    /// block : bool
    ///     Whether to wait while a user of the page lets the simulation stand still (until it goes on, or one step is asked for),
    ///     and while it is ahead of real time times `speed`. Without it `paused` tells what users want.
    ///
    /// Raises
    /// ------
    /// SimulationError
    ///     A state that cannot be evaluated, and is pulled at.
    /// BusyError
    ///     While another thread is in a call of what is shown.
    #[pyo3(signature = (*, block = true))]
    fn sync(&self, py: Python<'_>, block: bool) -> PyResult<()> {
        loop {
            let wait = {
                let mut guard = self.lock()?;
                let Some(viewer) = &mut *guard else {
                    return Ok(());
                };
                each_viewed!(&self.target, viewed => viewer.sync(viewed)).map_err(sim_error)?
            };
            let Some(wait) = wait.filter(|_| block) else {
                return Ok(());
            };
            py.detach(|| sleep(wait));
            py.check_signals()?;
        }
    }

    /// Ends the viewer: pages that show it say so. What is pulled at is let go.
    fn close(&self, py: Python<'_>) -> PyResult<()> {
        let Some(mut viewer) = self.lock()?.take() else {
            return Ok(());
        };
        let released =
            (|| each_viewed!(&self.target, viewed => viewer.leave(viewed)).map_err(sim_error))();
        py.detach(|| drop(viewer));
        released
    }

    fn __enter__(this: Py<Self>) -> Py<Self> {
        this
    }

    #[pyo3(signature = (*_raised))]
    fn __exit__(&self, py: Python<'_>, _raised: &Bound<'_, pyo3::types::PyTuple>) -> PyResult<()> {
        self.close(py)
    }

    /// bool : Whether it was closed.
    #[getter]
    fn closed(&self) -> PyResult<bool> {
        Ok(self.lock()?.is_none())
    }

    /// str : Where browsers find it; with the token without which nobody is let in.
    #[getter]
    fn url(&self) -> &str {
        &self.url
    }

    /// int : How many connections of pages there are.
    #[getter]
    fn clients(&self) -> PyResult<usize> {
        let guard = self.lock()?;
        Ok(guard.as_ref().map_or(0, |viewer| viewer.server().clients()))
    }

    /// bool : Whether the loop should stand still. Users of the page set it too.
    #[getter]
    fn paused(&self) -> PyResult<bool> {
        self.open(|viewer| viewer.interaction.paused)
    }

    #[setter]
    fn set_paused(&self, paused: bool) -> PyResult<()> {
        self.open(|viewer| viewer.interaction.paused = paused)
    }

    /// float : Simulated over real time, which `sync` holds the loop to; 0 for as fast as it goes. Users of the page set it too.
    #[getter]
    fn speed(&self) -> PyResult<f64> {
        self.open(|viewer| viewer.interaction.factor)
    }

    #[setter]
    fn set_speed(&self, speed: f64) -> PyResult<()> {
        let speed = check_speed(speed)?;
        self.open(|viewer| viewer.interaction.factor = speed)
    }

    /// int : The environment whose contacts and numbers are shown, and that is touched. Users of the page set it too.
    #[getter]
    fn env(&self) -> PyResult<usize> {
        self.open(|viewer| viewer.interaction.selection.env)
    }

    #[setter]
    fn set_env(&self, env: usize) -> PyResult<()> {
        check_env(env, self.envs)?;
        self.open(|viewer| viewer.interaction.selection.env = env)
    }

    /// Shows environments of a batch side by side.
    ///
    /// Parameters
    /// ----------
    /// count : int
    ///     How many, at most 64; 1 for the chosen one alone.
    /// first : int
    ///     The first of them.
    #[pyo3(signature = (count, first = 0))]
    fn show_grid(&self, count: usize, first: usize) -> PyResult<()> {
        check_env(first, self.envs)?;
        if !(1..=MAX_SIDE_BY_SIDE).contains(&count) {
            return Err(PyValueError::new_err(format!(
                "count is {count}, but from 1 to {MAX_SIDE_BY_SIDE} environments can be seen side by side"
            )));
        }
        self.open(|viewer| {
            let selection = &mut viewer.interaction.selection;
            (selection.first, selection.count) = (first, count);
        })
    }

    fn _repr_html_(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        let frame = py.import("clench._view")?.getattr("_frame")?;
        Ok(frame.call1((self.url.as_str(),))?.unbind())
    }

    fn __repr__(&self) -> PyResult<String> {
        let guard = self.lock()?;
        Ok(match &*guard {
            None => "<clench.Viewer, closed>".to_owned(),
            Some(_) => format!("<clench.Viewer at {}>", self.url),
        })
    }
}
