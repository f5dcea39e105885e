//! Conjugate gradients, preconditioned by the mass matrix (Polak–Ribière, restarted where β would be negative).

use crate::descent::{Course, Direction, Progress};
use crate::iterate::dot;
use crate::{Problem, Settings};
use clench_math::{Real, kernel};

/// The last gradient, and its image under M⁻¹.
#[derive(Clone, Debug, Default)]
pub(crate) struct Cg<T> {
    gradient: Vec<T>,
    preconditioned: Vec<T>,
    last: Vec<T>,
    started: bool,
}

impl<T: Real> Direction<T> for Cg<T> {
    const NEWTON: bool = false;
    const PATIENCE: f64 = 20.0;

    #[inline(always)]
    fn prepare(&mut self, _: &Problem<T>, _: &Settings) {
        self.started = false;
    }

    #[inline(always)]
    fn restart(&mut self, mask: T::Mask) {
        for g in &mut self.gradient {
            *g = T::select(mask, T::ZERO, *g);
        }
    }

    #[kernel]
    fn find(&mut self, problem: &Problem<T>, _: &Progress<T>, course: &mut Course<T>) {
        let (iterate, direction) = (&course.iterate, &mut course.ray.direction);
        self.last.clear();
        self.last.extend_from_slice(&self.preconditioned);
        self.preconditioned.clear();
        self.preconditioned.extend_from_slice(&iterate.gradient);
        problem
            .mass_factor
            .solve(problem.tree(), &mut self.preconditioned);
        let mut beta = T::ZERO;
        if self.started {
            let before = dot(&self.gradient, &self.last);
            let mut now = T::ZERO;
            for ((&g, &p), &l) in iterate
                .gradient
                .iter()
                .zip(&self.preconditioned)
                .zip(&self.last)
            {
                now += g * (p - l);
            }
            let positive = now.gt(T::ZERO) & before.gt(T::ZERO);
            beta = T::select(positive, now / before, T::ZERO);
        } else {
            direction.clear();
            direction.resize(problem.nv(), T::ZERO);
        }
        for (d, &p) in direction.iter_mut().zip(&self.preconditioned) {
            *d = beta * *d - p;
        }
        self.gradient.clear();
        self.gradient.extend_from_slice(&iterate.gradient);
        self.started = true;
    }
}
