//! `clench.Recording`: frames of a simulation, and the page that replays them.

use crate::batch::AnyBatch;
use crate::busy::lock;
use crate::count::{Count, Index, check_env};
use crate::error::sim_error;
use crate::row_sim::AnySim;
use crate::viewed::{Target, each_viewed};
use crate::viewer::page;
use clench::Model;
use clench_view::{Marks, RecordError, Scene, Viewed};
use numpy::PyArray1;
use pyo3::exceptions::{PyMemoryError, PyValueError};
use pyo3::prelude::*;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::PathBuf;
use std::sync::{Arc, Mutex};

/// The default limit of a recording, in bytes.
const LIMIT: usize = 1_000_000_000;

/// A recording of a simulation, frame by frame, with its contacts, forces and sensors.
///
/// `save` writes it as one page that replays in any browser, without a server and without Clench.
///
/// Parameters
/// ----------
/// limit : int
///     Maximum size in bytes.
#[pyclass(frozen, module = "clench")]
pub(crate) struct Recording {
    limit: usize,
    inner: Mutex<Option<Contents>>,
}

struct Contents {
    recording: clench_view::Recording,
    /// The model of the last frame; none if the frames come from a file.
    model: Option<Arc<Model>>,
}

impl Recording {
    /// Returns the recording of a model, and creates it if there is none.
    fn of<'a>(
        &self,
        contents: &'a mut Option<Contents>,
        model: &Arc<Model>,
    ) -> PyResult<&'a mut Contents> {
        let contents = contents.get_or_insert_with(|| Contents {
            recording: clench_view::Recording::new(Scene::new(model), self.limit),
            model: Some(Arc::clone(model)),
        });
        let same = contents
            .model
            .as_ref()
            .is_some_and(|old| Arc::ptr_eq(old, model));
        if !same {
            if !contents.recording.is_of(Scene::new(model)) {
                return Err(PyValueError::new_err(
                    "this recording is of another model: one recording shows one model",
                ));
            }
            contents.model = Some(Arc::clone(model));
        }
        Ok(contents)
    }

    /// Writes the page that replays the recording.
    ///
    /// # Errors
    /// Returns an error if nothing is recorded, there is no page, or the output, which `create` returns, fails.
    fn write<W: Write + Send>(
        &self,
        py: Python<'_>,
        create: impl FnOnce() -> PyResult<W>,
    ) -> PyResult<io::Result<W>> {
        let guard = lock(&self.inner, "recording")?;
        let Some(contents) = &*guard else {
            return Err(PyValueError::new_err("nothing is recorded yet"));
        };
        let (page, recording) = (page(py)?, &contents.recording);
        let mut out = create()?;
        Ok(py.detach(|| recording.write_html(&page, &mut out).map(|()| out)))
    }

    /// Returns the page that replays the recording.
    fn html(&self, py: Python<'_>) -> PyResult<String> {
        let html = self.write(py, || Ok(Vec::new()))??;
        Ok(String::from_utf8(html)?)
    }
}

#[pymethods]
impl Recording {
    #[new]
    #[pyo3(signature = (*, limit = Count(LIMIT)), text_signature = "(*, limit=1000000000)")]
    fn new(limit: Count) -> Self {
        Recording {
            limit: limit.0,
            inner: Mutex::new(None),
        }
    }

    /// Appends a frame with the current state.
    ///
    /// Parameters
    /// ----------
    /// target : Sim or Batch
    ///     The simulation. All frames must be of one model.
    /// env : int
    ///     The index of the environment, for a batch.
    ///
    /// Raises
    /// ------
    /// SimulationError
    ///     If the state cannot be evaluated.
    /// MemoryError
    ///     If the recording has reached its limit.
    /// ValueError
    ///     If the model is another one.
    #[pyo3(signature = (target, env = Index(0)), text_signature = "($self, target, env=0)")]
    fn append(&self, target: &Bound<'_, PyAny>, env: Index) -> PyResult<()> {
        let target = Target::of(target)?;
        let env = env.0;
        check_env(env, target.envs()?)?;
        let mut guard = lock(&self.inner, "recording")?;
        let appended = each_viewed!(&target, viewed => {
            let contents = self.of(&mut guard, viewed.model_of(env))?;
            viewed.query(env, |sim| contents.recording.append(sim, &mut Marks::default()))
        });
        appended.map_err(sim_error)?.map_err(|error| match error {
            RecordError::Sim(error) => sim_error(error),
            RecordError::Full(..) => PyMemoryError::new_err(error.to_string()),
        })
    }

    /// Writes one page that replays the recording, with a time slider, all overlays and plots.
    ///
    /// Parameters
    /// ----------
    /// path : str or os.PathLike
    ///     The file; its name should end in ``.html``. An existing file is replaced.
    ///
    /// Raises
    /// ------
    /// OSError
    ///     If the file cannot be written.
    /// ValueError
    ///     If there are no frames.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let failed = |error: io::Error| at(&path, &error);
        let create = || Ok(BufWriter::new(File::create(&path).map_err(failed)?));
        self.write(py, create)?.map(drop).map_err(failed)
    }

    /// Reads a page that `save` or ``clench simulate --record`` wrote.
    ///
    /// Parameters
    /// ----------
    /// path : str or os.PathLike
    ///     The page.
    /// limit : int
    ///     Maximum size of the recording in bytes.
    ///
    /// Returns
    /// -------
    /// Recording
    ///     The recording. Frames of the same model can be appended to it.
    ///
    /// Raises
    /// ------
    /// OSError
    ///     If the file cannot be read.
    /// ValueError
    ///     If the file is not such a page, or was written by another version of Clench.
    #[staticmethod]
    #[pyo3(signature = (path, *, limit = Count(LIMIT)), text_signature = "(path, *, limit=1000000000)")]
    fn load(py: Python<'_>, path: PathBuf, limit: Count) -> PyResult<Self> {
        let text = py
            .detach(|| fs::read(&path))
            .map_err(|error| at(&path, &error))?;
        let text = String::from_utf8_lossy(&text);
        let read = clench_view::Recording::from_html(&text, limit.0);
        let recording =
            read.map_err(|error| PyValueError::new_err(format!("{}: {error}", path.display())))?;
        Ok(Recording {
            limit: limit.0,
            inner: Mutex::new(Some(Contents {
                recording,
                model: None,
            })),
        })
    }

    /// Replays the recording: in the cell of a Jupyter notebook, else in a browser from a temporary file.
    fn show(&self, py: Python<'_>) -> PyResult<()> {
        let show = py.import("clench._view")?.getattr("_show")?;
        show.call1((self.html(py)?,)).map(drop)
    }

    /// numpy.ndarray : The simulated times of the frames (n), s. A copy.
    #[getter]
    fn times<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let guard = lock(&self.inner, "recording")?;
        let times = guard.as_ref().map(|contents| contents.recording.times());
        Ok(PyArray1::from_vec(py, times.unwrap_or_default()))
    }

    fn __len__(&self) -> PyResult<usize> {
        let guard = lock(&self.inner, "recording")?;
        Ok(guard
            .as_ref()
            .map_or(0, |contents| contents.recording.len()))
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

/// Converts an error of a file operation and adds the file's name.
fn at(path: &std::path::Path, error: &io::Error) -> PyErr {
    PyErr::from(io::Error::new(
        error.kind(),
        format!("{}: {error}", path.display()),
    ))
}
