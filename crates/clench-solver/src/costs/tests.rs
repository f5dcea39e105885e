//! Properties of every cost: its force is minus its gradient, its Hessian block is the derivative of that, and its
//! values along a ray agree with those at points.

use super::*;
use crate::costs::Cost;

struct Sample {
    cost: Cost,
    d: Vec<f64>,
    r: Vec<f64>,
    shape: Vec<f64>,
    lambda: f64,
    y: Vec<f64>,
    dy: Vec<f64>,
}

impl Sample {
    fn rows(&self) -> Rows<'_, f64> {
        Rows {
            d: &self.d,
            r: &self.r,
            shape: &self.shape,
            softer: 0.0,
            lambda: self.lambda,
        }
    }

    fn at(&self, y: &[f64]) -> (f64, Vec<f64>, Vec<f64>) {
        let mut force = vec![0.0; y.len()];
        let mut piece = vec![0.0; active_len(self.cost, y.len())];
        let mut totals = Totals::new();
        with_cost!(self.cost, C => C::evaluate(self.rows(), y, &mut force, &mut piece, &mut totals));
        (totals.cost, force, piece)
    }

    fn along(&self, alpha: f64) -> Vec<f64> {
        self.y
            .iter()
            .zip(&self.dy)
            .map(|(y, dy)| y + alpha * dy)
            .collect()
    }

    fn slope(&self, alpha: f64) -> Slope<f64> {
        let mut slope = Slope {
            growth: 0.0,
            second: 0.0,
        };
        with_cost!(self.cost, C => C::slope(self.rows(), &self.y, &self.dy, alpha, &mut slope));
        slope
    }

    fn divergence(&self, alpha: f64) -> f64 {
        with_cost!(self.cost, C => C::divergence(self.rows(), &self.y, &self.dy, alpha))
    }

    fn hessian(&self) -> Vec<Vec<f64>> {
        let dim = self.y.len();
        let (_, _, piece) = self.at(&self.y);
        let mut weight = [[f64::NAN; MAX_DIM]; MAX_DIM];
        let form =
            with_cost!(self.cost, C => C::hessian(self.rows(), &self.y, &piece, &mut weight));
        let entry = |i: usize, j: usize| match form {
            Form::Diagonal if i == j => weight[i][i],
            Form::Arrow if i == 0 || j == 0 => weight[0][i.max(j)],
            Form::Arrow if i == j => weight[i][i],
            Form::Full => weight[i][j],
            _ => 0.0,
        };
        (0..dim)
            .map(|i| (0..dim).map(|j| entry(i, j)).collect())
            .collect()
    }
}

/// Thousands of points over all pieces of all costs.
fn samples() -> Vec<Sample> {
    let mut state = 7u64;
    let mut unit = move || {
        state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let mut samples = Vec::new();
    for k in 0..6000 {
        let (round, cost) = (k / Cost::ALL.len(), Cost::ALL[k % Cost::ALL.len()]);
        let dim = match cost.is_cone() {
            true => 2 + round % 5,
            false => 1 + round % 3,
        };
        let d0 = 0.5 + 3.0 * unit();
        let mut shape: Vec<f64> = (0..dim).map(|_| 0.3 + unit()).collect();
        let mut d = vec![d0; dim];
        if cost == Cost::Elliptic {
            (1..dim).for_each(|j| d[j] = d0 * (shape[j] / shape[0]).powi(2));
        }
        if cost == Cost::Coulomb {
            (2..dim).for_each(|j| d[j] = d[1] * (shape[j] / shape[1]).powi(2));
        }
        let lambda = match cost {
            Cost::Coulomb => 2.0 * unit() - 0.2,
            _ => 0.0,
        };
        if !cost.has_shape() {
            shape.fill(0.0);
        }
        let r = d.iter().map(|d| 1.0 / d).collect();
        let y = (0..dim).map(|_| 2.0 * unit() - 1.0).collect();
        let dy = (0..dim).map(|_| 2.0 * unit() - 1.0).collect();
        samples.push(Sample {
            cost,
            d,
            r,
            shape,
            lambda: lambda.max(0.0),
            y,
            dy,
        });
    }
    samples
}

const STEP: f64 = 1e-6;

#[test]
fn force_is_minus_the_gradient_of_the_cost() {
    for s in samples() {
        let (_, force, _) = s.at(&s.y);
        for i in 0..s.y.len() {
            let (mut up, mut down) = (s.y.clone(), s.y.clone());
            up[i] += STEP;
            down[i] -= STEP;
            let gradient = (s.at(&up).0 - s.at(&down).0) / (2.0 * STEP);
            assert!(
                (gradient + force[i]).abs() < 1e-5,
                "{:?} row {i}: {gradient} {}",
                s.cost,
                force[i]
            );
        }
    }
}

#[test]
fn hessian_is_the_derivative_of_the_gradient() {
    let mut checked = 0;
    for s in samples() {
        let hessian = s.hessian();
        let piece = s.at(&s.y).2;
        for j in 0..s.y.len() {
            let (mut up, mut down) = (s.y.clone(), s.y.clone());
            up[j] += STEP;
            down[j] -= STEP;
            let (up, down) = (s.at(&up), s.at(&down));
            if up.2 != piece || down.2 != piece {
                continue; // the Hessian jumps between active sets
            }
            checked += 1;
            for i in 0..s.y.len() {
                let numeric = (down.1[i] - up.1[i]) / (2.0 * STEP);
                assert!(
                    (numeric - hessian[i][j]).abs() < 2e-4,
                    "{:?} {i},{j}: {numeric} {}",
                    s.cost,
                    hessian[i][j]
                );
            }
        }
    }
    assert!(checked > 10_000);
}

#[test]
fn a_ray_says_what_its_points_say() {
    for s in samples() {
        let derivative =
            |force: Vec<f64>| -force.iter().zip(&s.dy).map(|(f, dy)| f * dy).sum::<f64>();
        let (start, force, _) = s.at(&s.y);
        let first = derivative(force);
        for alpha in [0.0, 0.3, 1.0, 2.5] {
            let y = s.along(alpha);
            let (cost, force, piece) = s.at(&y);
            let divergence = s.divergence(alpha);
            let expected = cost - start - alpha * first;
            assert!(
                (divergence - expected).abs() < 1e-12 * (1.0 + cost + start),
                "{:?}: {divergence} {expected}",
                s.cost
            );
            let slope = s.slope(alpha);
            let expected = derivative(force) - first;
            assert!(
                (slope.growth - expected).abs() < 1e-12 * (1.0 + expected.abs()),
                "{:?}: {} {expected}",
                s.cost,
                slope.growth
            );
            let near = [s.along(alpha + STEP), s.along(alpha - STEP)];
            if near.iter().all(|y| s.at(y).2 == piece) {
                let numeric =
                    (s.slope(alpha + STEP).growth - s.slope(alpha - STEP).growth) / (2.0 * STEP);
                assert!(
                    (slope.second - numeric).abs() < 2e-4 * (1.0 + numeric),
                    "{:?}: {numeric}",
                    s.cost
                );
            }
        }
    }
}

#[test]
fn a_ray_keeps_its_digits_for_tiny_steps() {
    let mut curved = 0;
    for s in samples() {
        let alpha = 1e-9;
        let (slope, divergence) = (s.slope(alpha), s.divergence(alpha));
        if s.at(&s.along(alpha)).2 != s.at(&s.y).2 {
            continue; // the Hessian jumps between active sets
        }
        let second = slope.second;
        curved += usize::from(matches!(s.cost, Cost::Elliptic | Cost::Coulomb) && second > 0.0);
        for (name, value, expected) in [
            ("growth", slope.growth, alpha * second),
            ("divergence", divergence, 0.5 * alpha * alpha * second),
        ] {
            assert!(
                (value - expected).abs() <= 1e-7 * expected,
                "{name} of {:?}: {value:e} {expected:e}",
                s.cost
            );
        }
    }
    assert!(curved > 700);
}

#[test]
fn forces_lie_in_their_cones() {
    for s in samples() {
        let (cost, f, _) = s.at(&s.y);
        assert!(cost >= 0.0);
        match s.cost {
            Cost::Quadratic => {}
            Cost::OneSided => assert!(f.iter().all(|&f| f >= 0.0)),
            Cost::Huber => assert!(
                f.iter()
                    .zip(&s.shape)
                    .all(|(f, eta)| f.abs() <= eta * (1.0 + 1e-15))
            ),
            Cost::Pyramid => {
                let sum: f64 = (1..f.len()).map(|j| f[j].abs() / s.shape[j]).sum();
                assert!(sum <= f[0] + 1e-14);
            }
            Cost::Elliptic => {
                let sum: f64 = (1..f.len()).map(|j| (f[j] / s.shape[j]).powi(2)).sum();
                assert!(sum.sqrt() <= f[0] + 1e-14);
            }
            Cost::Coulomb => {
                let sum: f64 = (1..f.len()).map(|j| (f[j] / s.shape[j]).powi(2)).sum();
                assert!(f[0] >= 0.0 && sum.sqrt() <= s.lambda + 1e-14);
            }
        }
    }
}

#[test]
fn a_lane_without_the_constraint_adds_nothing() {
    for mut s in samples() {
        s.d.fill(0.0);
        s.r.fill(1.0);
        s.shape.fill(0.0);
        s.lambda = 0.0;
        let (cost, force, piece) = s.at(&s.y);
        assert!(
            cost == 0.0 && force.iter().all(|&f| f == 0.0) && piece.iter().all(|&p| p == 0.0),
            "{:?}",
            s.cost
        );
        let slope = s.slope(0.5);
        assert!(slope.growth == 0.0 && slope.second == 0.0 && s.divergence(0.5) == 0.0);
        assert!(s.hessian().iter().flatten().all(|&w| w == 0.0));
    }
}
