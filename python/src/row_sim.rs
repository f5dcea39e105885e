//! A simulation in either precision, with the state rows that Python sees.

use crate::precision::Bits;
use clench::rigid::batch::StateRows;
use clench::{Precision, SimError};

/// A simulation with the rows that Python sees. Rows are read before each call, and written after steps.
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

    /// Returns the simulation in the state of the rows.
    pub(crate) fn current(&mut self) -> Result<&mut clench::Sim<S>, SimError> {
        self.rows.read(0, &mut self.sim.state)?;
        Ok(&mut self.sim)
    }

    /// Returns the simulation in the state of the rows, with all derived quantities up to date.
    pub(crate) fn refreshed(&mut self) -> Result<&clench::Sim<S>, SimError> {
        let sim = self.current()?;
        sim.refresh()?;
        Ok(sim)
    }

    /// Takes steps. At the first that fails, the state is the one before it.
    pub(crate) fn step(&mut self, steps: usize) -> Result<(), SimError> {
        let sim = self.current()?;
        let done = (0..steps).try_for_each(|_| sim.step());
        self.rows.write(0, &self.sim.state)?;
        done
    }

    /// Does the first half of a step, which changes the state if it resets it.
    pub(crate) fn step1(&mut self) -> Result<(), SimError> {
        let done = self.current()?.step1();
        self.rows.write(0, &self.sim.state)?;
        done
    }

    /// Does the second half of a step.
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

/// Evaluates an expression about a simulation of either precision.
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
    /// Wraps a simulation in double precision.
    pub(crate) fn f64(sim: clench::Sim<f64>) -> Result<Self, SimError> {
        RowSim::new(sim).map(|sim| AnySim::F64(Box::new(sim)))
    }
    /// Wraps a simulation in single precision.
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
