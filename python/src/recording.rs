//! `clench.Recording`: moments of a simulation, and the page that replays them.

use crate::batch::AnyBatch;
use crate::busy::lock;
use crate::error::sim_error;
use crate::row_sim::AnySim;
use crate::viewed::{Target, each_viewed};
use crate::viewer::{check_env, page};
use clench::Model;
use clench_view::{Marks, RecordError, Scene, Viewed};
use numpy::PyArray1;
use pyo3::exceptions::{PyMemoryError, PyValueError};
use pyo3::prelude::*;
use std::path::PathBuf;
use std::sync::{Arc, Mutex};
use std::{fs, io};

/// Bytes that a recording may take where nothing else is said.
const LIMIT: usize = 1_000_000_000;

/// What happened in a simulation, moment by moment, with its contacts, forces and sensors.
///
/// `save` makes one page of it that replays in any browser, without a server and without Clench.
///
/// Parameters
/// ----------
/// limit : int
///     The most bytes that it may take.
#[pyclass(frozen, module = "clench")]
pub(crate) struct Recording {
    limit: usize,
    inner: Mutex<Option<Kept>>,
}

struct Kept {
    recording: clench_view::Recording,
    /// The model of the last frame; none where they come from a file.
    model: Option<Arc<Model>>,
}

impl Recording {
    /// The recording of a model, begun where there is none.
    fn of<'a>(&self, kept: &'a mut Option<Kept>, model: &Arc<Model>) -> PyResult<&'a mut Kept> {
        let kept = kept.get_or_insert_with(|| Kept {
            recording: clench_view::Recording::new(Scene::new(model), self.limit),
            model: Some(Arc::clone(model)),
        });
        let same = kept
            .model
            .as_ref()
            .is_some_and(|old| Arc::ptr_eq(old, model));
        if !same {
            if !kept.recording.is_of(Scene::new(model)) {
                return Err(PyValueError::new_err(
                    "this recording is of another model: one recording shows one model",
                ));
            }
            kept.model = Some(Arc::clone(model));
        }
        Ok(kept)
    }

    /// The page that replays it.
    fn html(&self, py: Python<'_>) -> PyResult<String> {
        let guard = lock(&self.inner, "recording")?;
        let Some(kept) = &*guard else {
            return Err(PyValueError::new_err("nothing is recorded yet"));
        };
        Ok(kept.recording.to_html(&page(py)?))
    }
}

#[pymethods]
impl Recording {
    #[new]
    #[pyo3(signature = (*, limit = LIMIT), text_signature = "(*, limit=1000000000)")]
    fn new(limit: usize) -> Self {
        Recording {
            limit,
            inner: Mutex::new(None),
        }
    }

    /// Keeps what is now.
    ///
    /// Parameters
    /// ----------
    /// target : Sim or Batch
    ///     All that is appended must be of one model.
    /// env : int
    ///     Which environment of a batch.
    ///
    /// Raises
    /// ------
    /// SimulationError
    ///     A state that cannot be evaluated.
    /// MemoryError
    ///     A recording that has reached its limit.
    /// ValueError
    ///     Another model.
    #[pyo3(signature = (target, env = 0))]
    fn append(&self, target: &Bound<'_, PyAny>, env: usize) -> PyResult<()> {
        let target = Target::of(target)?;
        check_env(env, target.envs()?)?;
        let mut guard = lock(&self.inner, "recording")?;
        let appended = each_viewed!(&target, viewed => {
            let kept = self.of(&mut guard, viewed.model())?;
            viewed.ask(env, |sim| kept.recording.append(sim, &mut Marks::default()))
        });
        appended.map_err(sim_error)?.map_err(|error| match error {
            RecordError::Sim(error) => sim_error(error),
            RecordError::Full(..) => PyMemoryError::new_err(error.to_string()),
        })
    }

    /// Writes one page that replays the recording, with a slider for time, all overlays and plots.
    ///
    /// Parameters
    /// ----------
    /// path : str or os.PathLike
    ///     Where to; the name should end in ``.html``. What is there is replaced.
    ///
    /// Raises
    /// ------
    /// OSError
    ///     A file that cannot be written.
    /// ValueError
    ///     Nothing to write.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let html = self.html(py)?;
        let written = py.detach(|| fs::write(&path, html));
        written.map_err(|error| at(&path, &error))
    }

    /// Reads what `save` or ``clench simulate --record`` wrote.
    ///
    /// Parameters
    /// ----------
    /// path : str or os.PathLike
    ///     The page.
    /// limit : int
    ///     The most bytes that the recording may take.
    ///
    /// Returns
    /// -------
    /// Recording
    ///     More can be appended to it, of the same model.
    ///
    /// Raises
    /// ------
    /// OSError
    ///     A file that cannot be read.
    /// ValueError
    ///     A file that is no such page, or one of another version of Clench.
    #[staticmethod]
    #[pyo3(signature = (path, *, limit = LIMIT), text_signature = "(path, *, limit=1000000000)")]
    fn load(py: Python<'_>, path: PathBuf, limit: usize) -> PyResult<Self> {
        let text = py
            .detach(|| fs::read(&path))
            .map_err(|error| at(&path, &error))?;
        let text = String::from_utf8_lossy(&text);
        let read = clench_view::Recording::from_html(&text, limit);
        let recording =
            read.map_err(|error| PyValueError::new_err(format!("{}: {error}", path.display())))?;
        Ok(Recording {
            limit,
            inner: Mutex::new(Some(Kept {
                recording,
                model: None,
            })),
        })
    }

    /// Replays it: in a Jupyter notebook in the cell, else in a browser, from a temporary file.
    fn show(&self, py: Python<'_>) -> PyResult<()> {
        let show = py.import("clench._view")?.getattr("_show")?;
        show.call1((self.html(py)?,)).map(drop)
    }

    /// numpy.ndarray : The simulated times of its moments (n), s. A copy.
    #[getter]
    fn times<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let guard = lock(&self.inner, "recording")?;
        let times = guard.as_ref().map(|kept| kept.recording.times());
        Ok(PyArray1::from_vec(py, times.unwrap_or_default()))
    }

    fn __len__(&self) -> PyResult<usize> {
        let guard = lock(&self.inner, "recording")?;
        Ok(guard.as_ref().map_or(0, |kept| kept.recording.len()))
    }

    fn _repr_html_(&self, py: Python<'_>) -> PyResult<Option<Py<PyAny>>> {
        if self.__len__()? == 0 {
            return Ok(None);
        }
        let frame = py.import("clench._view")?.getattr("_frame_of_html")?;
        Ok(Some(frame.call1((self.html(py)?,))?.unbind()))
    }

    fn __repr__(&self) -> PyResult<String> {
        Ok(format!("<clench.Recording of {} moments>", self.__len__()?))
    }
}

/// What went wrong with a file, with its name.
fn at(path: &std::path::Path, error: &io::Error) -> PyErr {
    PyErr::from(io::Error::new(
        error.kind(),
        format!("{}: {error}", path.display()),
    ))
}
