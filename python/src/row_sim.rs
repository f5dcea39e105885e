//! A simulation in either precision, beside the rows of its state that Python sees.

use crate::precision::Bits;
use clench::rigid::batch::StateRows;
use clench::{Precision, SimError};

/// A simulation beside the rows that Python sees: rows go in before each call, and come out after steps.
pub(crate) struct RowSim<S: Precision> {
    pub(crate) rows: StateRows<S>,
    pub(crate) sim: clench::Sim<S>,
}

impl<S: Precision> RowSim<S> {
    fn new(sim: clench::Sim<S>) -> Result<Self, SimError> {
        let mut rows = StateRows::new(sim.model(), 1)?;
        rows.write(0, &sim.state)?;
        Ok(RowSim { rows, sim })
    }

    /// The simulation, in the state that the rows hold.
    pub(crate) fn current(&mut self) -> Result<&mut clench::Sim<S>, SimError> {
        self.rows.read(0, &mut self.sim.state)?;
        Ok(&mut self.sim)
    }

    /// The same, where all is known that follows from it.
    pub(crate) fn refreshed(&mut self) -> Result<&clench::Sim<S>, SimError> {
        let sim = self.current()?;
        sim.refresh()?;
        Ok(sim)
    }

    /// Steps up to the first that fails, whose state is the one before it.
    pub(crate) fn step(&mut self, steps: usize) -> Result<(), SimError> {
        let sim = self.current()?;
        let done = (0..steps).try_for_each(|_| sim.step());
        self.rows.write(0, &self.sim.state)?;
        done
    }

    /// The second half of a step.
    pub(crate) fn step2(&mut self) -> Result<(), SimError> {
        let done = self.current()?.step2();
        self.rows.write(0, &self.sim.state)?;
        done
    }

    pub(crate) fn reset(&mut self, keyframe: Option<usize>) -> Result<(), SimError> {
        match keyframe {
            None => self.sim.reset(),
            Some(index) => self.sim.reset_to_keyframe(index)?,
        }
        self.rows.write(0, &self.sim.state)
    }
}

/// A simulation in either precision.
pub(crate) enum AnySim {
    F64(Box<RowSim<f64>>),
    F32(Box<RowSim<f32>>),
}

/// Evaluates an expression about a simulation of whichever precision.
macro_rules! each_sim {
    ($any:expr, $own:ident => $value:expr) => {
        match $any {
            AnySim::F64($own) => $value,
            AnySim::F32($own) => $value,
        }
    };
}
pub(crate) use each_sim;

impl AnySim {
    /// A simulation in double precision.
    pub(crate) fn f64(sim: clench::Sim<f64>) -> Result<Self, SimError> {
        RowSim::new(sim).map(|sim| AnySim::F64(Box::new(sim)))
    }
    /// A simulation in single precision.
    pub(crate) fn f32(sim: clench::Sim<f32>) -> Result<Self, SimError> {
        RowSim::new(sim).map(|sim| AnySim::F32(Box::new(sim)))
    }

    pub(crate) fn precision(&self) -> Bits {
        match self {
            AnySim::F64(_) => Bits::B64,
            AnySim::F32(_) => Bits::B32,
        }
    }
}
