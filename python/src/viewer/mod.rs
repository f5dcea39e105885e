//! `clench.Viewer`: a page in the browser for a loop in Python.

mod draws;

use crate::arrays::shaped;
use crate::batch::AnyBatch;
use crate::busy::lock;
use crate::count::{Count, Index, check_env};
use crate::error::{classes::ClenchError, sim_error};
use crate::row_sim::AnySim;
use crate::viewed::{Target, each_viewed};
use clench_view::command::{MAX_SIDE_BY_SIDE, SPEEDS};
use clench_view::interaction::Interaction;
use clench_view::{Page, PassiveViewer, ServeError, ServerOptions};
use pyo3::exceptions::{PyOSError, PyValueError};
use pyo3::prelude::*;
use std::sync::{Mutex, MutexGuard};
use std::thread::sleep;

/// Returns the page that is part of this package, else one that is built now, if possible.
///
/// # Errors
/// Returns a `clench.ClenchError` that says what to do.
pub(crate) fn page(py: Python<'_>) -> PyResult<Page> {
    let notify = |text: &str| {
        // A message without standard error is dropped.
        let _ = Python::attach(|py| {
            let stderr = py.import("sys")?.getattr("stderr")?;
            stderr
                .call_method1("write", (format!("{text}\n"),))
                .map(drop)
        });
    };
    (py.detach(|| Page::find(notify))).map_err(|error| ClenchError::new_err(error.to_string()))
}

/// A page in the browser that shows a simulation while a Python loop steps it.
///
/// `clench.view` creates one. Users of the page can pause the loop or single-step it, drag bodies, set controls and
/// joints, switch equalities, reset, and choose the speed; all of it happens in `sync`, which the loop calls between
/// steps. Without a viewer there is no cost to a simulation, and hardly any with a viewer that no page shows.
///
/// In a Jupyter notebook, a viewer as the last value of a cell is displayed there.
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

    /// Calls `work` with the viewer if it is open.
    fn open<R>(&self, work: impl FnOnce(&mut PassiveViewer) -> R) -> PyResult<R> {
        let mut guard = self.lock()?;
        let open = guard.as_mut();
        open.map(work)
            .ok_or_else(|| ClenchError::new_err("this viewer is closed"))
    }
}

/// Validates a speed factor; the range is that of the page.
fn check_speed(speed: f64) -> PyResult<f64> {
    let [low, high] = SPEEDS;
    if speed == 0.0 || (low..=high).contains(&speed) {
        return Ok(speed);
    }
    Err(PyValueError::new_err(format!(
        "speed is {speed}, but must be between {low} and {high}, or 0 for as fast as the loop goes"
    )))
}

fn check_port(port: i64) -> PyResult<u16> {
    let wrong = |_| PyValueError::new_err(format!("port is {port}, but must be 0 to 65535"));
    u16::try_from(port).map_err(wrong)
}

fn vector(name: &str, value: &Bound<'_, PyAny>) -> PyResult<[f64; 3]> {
    let array = shaped::<f64>(name, value, &[3])?;
    let values = array.as_array();
    Ok([values[0], values[1], values[2]])
}

#[pymethods]
impl Viewer {
    #[new]
    #[pyo3(signature = (target, *, env = Index(0), host = "127.0.0.1", port = 0, paused = false, speed = 1.0),
           text_signature = "(target, *, env=0, host='127.0.0.1', port=0, paused=False, speed=1.0)")]
    fn new(
        target: &Bound<'_, PyAny>,
        env: Index,
        host: &str,
        port: i64,
        paused: bool,
        speed: f64,
    ) -> PyResult<Self> {
        let py = target.py();
        let target = Target::of(target)?;
        target.require_one_model()?;
        let envs = target.envs()?;
        check_env(env.0, envs)?;
        let options = ServerOptions {
            host: host.to_owned(),
            port: check_port(port)?,
            ..ServerOptions::default()
        };
        let speed = check_speed(speed)?;
        let page = page(py)?;
        let mut chosen = Interaction::new(paused);
        chosen.factor = speed;
        chosen.selection.env = env.0;
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

    /// Shows the current state, and applies the actions of the page's users since the last call.
    ///
    /// A pull on a body is written into `xfrc_applied`, and replaces its value, until the body is released. A frame is
    /// sent at most sixty times a second, and only if a page requests it, so that `sync` can be called after each step.
    ///
    /// Parameters
    /// ----------
    /// block : bool
    ///     True to wait while a user of the page has paused the simulation (until it continues, or one step is
    ///     requested), and while it is ahead of real time times `speed`. Otherwise `paused` reports the users' choice,
    ///     and is false for one iteration per requested step.
    ///
    /// Raises
    /// ------
    /// SimulationError
    ///     If the state cannot be evaluated while a body is pulled.
    /// BusyError
    ///     While another thread is in a call of the simulation or batch.
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

    /// Closes the viewer; its pages report that. Bodies that are pulled are released.
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

    /// bool : True if the viewer was closed.
    #[getter]
    fn closed(&self) -> PyResult<bool> {
        Ok(self.lock()?.is_none())
    }

    /// str : The address for browsers, with the token that grants access.
    #[getter]
    fn url(&self) -> &str {
        &self.url
    }

    /// int : Number of connections of pages.
    #[getter]
    fn clients(&self) -> PyResult<usize> {
        let guard = self.lock()?;
        Ok(guard.as_ref().map_or(0, |viewer| viewer.server().clients()))
    }

    /// bool : True if the loop should pause. Users of the page set it too; it is false until the next `sync` when they
    /// request a step.
    #[getter]
    fn paused(&self) -> PyResult<bool> {
        self.open(|viewer| viewer.paused())
    }

    #[setter]
    fn set_paused(&self, paused: bool) -> PyResult<()> {
        self.open(|viewer| viewer.set_paused(paused))
    }

    /// float : The ratio of simulated to real time that `sync` maintains; 0 for as fast as possible. Users of the page
    /// set it too.
    #[getter]
    fn speed(&self) -> PyResult<f64> {
        self.open(|viewer| viewer.interaction.factor)
    }

    #[setter]
    fn set_speed(&self, speed: f64) -> PyResult<()> {
        let speed = check_speed(speed)?;
        self.open(|viewer| viewer.interaction.factor = speed)
    }

    /// int : The environment whose contacts and numbers are shown, and with which users interact. Users of the page set
    /// it too.
    #[getter]
    fn env(&self) -> PyResult<usize> {
        self.open(|viewer| viewer.interaction.selection.env)
    }

    #[setter]
    fn set_env(&self, env: Index) -> PyResult<()> {
        let env = env.0;
        check_env(env, self.envs)?;
        self.open(|viewer| viewer.interaction.selection.env = env)
    }

    /// Shows environments of a batch side by side.
    ///
    /// Parameters
    /// ----------
    /// count : int
    ///     Number of environments, at most 64; 1 for only the chosen one.
    /// first : int
    ///     The index of the first one.
    #[pyo3(signature = (count, first = Index(0)), text_signature = "($self, count, first=0)")]
    fn show_grid(&self, count: Count, first: Index) -> PyResult<()> {
        let (count, first) = (count.0, first.0);
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
