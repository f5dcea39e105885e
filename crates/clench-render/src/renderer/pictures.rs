//! Pictures of many simulations.

use super::{Picture, Renderer};
use crate::canvas::{Canvas, FLIGHTS, Form};
use crate::device::RenderError;
use crate::dispatch::{Dispatch, Snapshot};
use crate::image::Planes;
use crate::items::Item;
use crate::looks::Looks;
use clench::rigid::{Precision, Sim};
use std::collections::VecDeque;
use std::fmt::Display;
use wgpu::{MapMode, PollType, SubmissionIndex};

/// Pictures of simulations of one model, which are drawn many at a time.
///
/// Each has the bits of a picture alone.
pub struct Pictures<'a> {
    renderer: &'a mut Renderer,
    wanted: &'a Picture,
    out: Planes<'a>,
    /// `None` if the size of all pictures is zero.
    canvas: Option<Canvas>,
    dispatch: Dispatch,
    flights: VecDeque<Flight>,
    submitted: usize,
}

/// A dispatch that the device is drawing.
struct Flight {
    number: usize,
    submission: SubmissionIndex,
    slots: Vec<usize>,
}

impl<'a> Pictures<'a> {
    pub(super) fn new(
        renderer: &'a mut Renderer,
        wanted: &'a Picture,
        count: usize,
        out: Planes<'a>,
    ) -> Self {
        wanted.check_memory(count, &out);
        let form = Form {
            size: [wanted.width, wanted.height],
            colors: !out.rgb.is_empty(),
            facts: !out.depth.is_empty() || !out.geoms.is_empty(),
        };
        let any = form.colors || form.facts;
        let canvas = any.then(|| renderer.take_canvas(form, count * wanted.views.len()));
        Pictures {
            renderer,
            wanted,
            out,
            canvas,
            dispatch: Dispatch::default(),
            flights: VecDeque::new(),
            submitted: 0,
        }
    }

    /// Draws the present state of a simulation, the `index`-th of all, with the looks of the model or with others.
    ///
    /// # Errors
    /// Returns an error if a camera does not exist, the state cannot be evaluated, or the device fails.
    pub fn add<T: Precision>(
        &mut self,
        sim: &mut Sim<T>,
        index: usize,
        looks: Option<&Looks>,
    ) -> Result<(), RenderError> {
        let shown = Snapshot::new(&self.renderer.scene, sim, &self.wanted.groups, looks)?;
        let views = &self.wanted.views;
        let mut entered = false;
        for (k, view) in views.iter().enumerate() {
            let camera = view.pose(sim)?;
            let Some(canvas) = &self.canvas else {
                continue;
            };
            let full = self.dispatch.shots.len() == canvas.pictures as usize;
            if full || (!entered && !self.holds(&shown)) {
                self.submit()?;
                entered = false;
            }
            let Some(canvas) = &self.canvas else {
                continue;
            };
            let scene = &self.renderer.scene;
            if !entered {
                self.dispatch.add_environment(scene, &shown, &canvas.form);
                entered = true;
            }
            let slot = index * views.len() + k;
            (self.dispatch).add(scene, &shown, &camera, &canvas.form, slot);
        }
        Ok(())
    }

    /// Draws what is left and writes all pictures.
    ///
    /// # Errors
    /// Returns an error if the device fails.
    pub fn finish(mut self) -> Result<(), RenderError> {
        self.submit()?;
        while let Some(flight) = self.flights.pop_front() {
            self.land(flight)?;
        }
        if let Some(canvas) = self.canvas.take() {
            self.renderer.store_canvas(canvas);
        }
        Ok(())
    }

    /// Returns true if the device's buffer has space for the items of another environment.
    fn holds(&self, shown: &Snapshot) -> bool {
        let items = self.dispatch.items.len() + shown.items.len();
        let bytes = (items * size_of::<Item>()) as u64;
        let limits = self.renderer.gpu.device.limits();
        self.dispatch.shots.is_empty() || bytes <= limits.max_storage_buffer_binding_size
    }

    /// Submits the dispatch.
    fn submit(&mut self) -> Result<(), RenderError> {
        let dispatch = std::mem::take(&mut self.dispatch);
        if dispatch.shots.is_empty() {
            return Ok(());
        }
        if self.flights.len() == FLIGHTS
            && let Some(flight) = self.flights.pop_front()
        {
            self.land(flight)?;
        }
        let Some(canvas) = &self.canvas else {
            return Ok(());
        };
        let gpu = &self.renderer.gpu;
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        self.renderer.encode(&mut encoder, &dispatch, canvas);
        let number = self.submitted;
        canvas.store(&mut encoder, number, dispatch.shots.len());
        let submission = gpu.queue.submit([encoder.finish()]);
        canvas.copy(number).map_async(MapMode::Read, .., |_| {});
        self.submitted += 1;
        self.flights.push_back(Flight {
            number,
            submission,
            slots: dispatch.shots.iter().map(|shot| shot.slot).collect(),
        });
        Ok(())
    }

    /// Waits for a dispatch and writes its pictures.
    fn land(&mut self, flight: Flight) -> Result<(), RenderError> {
        let gpu = &self.renderer.gpu;
        let failed = |error: &dyn Display| RenderError::Failed(gpu.name.clone(), error.to_string());
        let wait = PollType::Wait {
            submission_index: Some(flight.submission),
            timeout: None,
        };
        gpu.device.poll(wait).map_err(|error| failed(&error))?;
        if let Some(canvas) = &self.canvas {
            let read = canvas.read(flight.number, &flight.slots, &mut self.out);
            read.map_err(|error| failed(&error))?;
            canvas.copy(flight.number).unmap();
        }
        Ok(())
    }
}
