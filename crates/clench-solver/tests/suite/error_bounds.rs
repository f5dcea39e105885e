//! Bounds of the errors of a minimiser and of its derivatives, of problems with one dof.

use clench_math::{Dual, Real};
use clench_solver::{Cost, ErrorBound, ErrorBounds, Problem, SolverOptions, Tree};
use std::sync::Arc;

type Number = Dual<f64, 1>;

const MASS: f64 = 4.0;
const STIFFNESS: f64 = 12.0;

/// Returns ½ M (a − a_unc)² + s(a), where a_unc has the derivative 1.
fn problem(cost: Cost, qacc_smooth: f64) -> Problem<Number> {
    let mut problem = Problem::new(Arc::new(Tree::dense(1)));
    problem.mass.values[0] = Number::new(MASS);
    problem.qacc_smooth[0] = Number::new(qacc_smooth);
    problem.qacc_smooth[0].set_derivative(0, 1.0);
    assert!(problem.factor_mass());
    let block = problem.push(cost, 1, &[0]);
    block.jacobian[0] = Number::ONE;
    block.r[0] = Number::new(1.0 / STIFFNESS);
    block.d[0] = Number::new(STIFFNESS);
    problem
}

/// Returns the bounds at an acceleration with a derivative.
fn bound(problem: &Problem<Number>, qacc: f64, derivative: f64) -> ErrorBound {
    let mut qacc = Number::new(qacc);
    qacc.set_derivative(0, derivative);
    let settings = SolverOptions::new().resolve::<f64>();
    let (mut bounds, mut bound) = (ErrorBounds::default(), ErrorBound::default());
    bounds.start(problem, &settings, &[qacc], &mut bound);
    bounds.push_directions(problem, &[qacc], 1, &mut bound);
    bound
}

fn assert_near(found: f64, expected: f64) {
    let error = (found - expected).abs();
    assert!(error < 1e-12, "{found} is not {expected}");
}

#[test]
fn bounds_of_one_dof_follow_from_their_formulas() {
    // The minimiser is M a_unc / (M + D), with the derivative M / (M + D).
    let exact = MASS / (MASS + STIFFNESS);
    for cost in [Cost::Quadratic, Cost::OneSided] {
        let found = bound(&problem(cost, -2.0), -2.0 * exact + 0.1, exact + 0.01);
        assert_near(found.acceleration, 0.1 * MASS.sqrt());
        // (M + D) times the error of the derivative, in the norm of forces.
        assert_near(found.directions[0], 0.01 * (MASS + STIFFNESS) / MASS.sqrt());
        assert_near(found.dofs[0], 1.0 / MASS.sqrt());
        assert_near(found.reach[0], 0.1);
    }
}

#[test]
fn a_row_that_switches_within_the_error_is_on_its_exact_side() {
    // The minimiser is 1, where the constraint does not act and the derivative is 1; at −0.1 it acts.
    let found = bound(&problem(Cost::OneSided, 1.0), -0.1, 0.25);
    assert_near(found.directions[0], 0.75 * MASS.sqrt());
    assert!(found.reach[0] > 0.1);
}

#[test]
fn a_minimiser_at_a_switch_has_no_derivative() {
    let found = bound(&problem(Cost::OneSided, 0.0), 0.0, 1.0);
    assert_eq!(found.acceleration, 0.0);
    assert_eq!(found.directions, [f64::INFINITY]);
}
