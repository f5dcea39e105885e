//! The derivatives of the input of a step, with which a pass starts.

use crate::direction::Direction;
use crate::stage::Stage;
use crate::tangent::{add, move_along};
use clench_dynamics::State;
use clench_dynamics::model::{Model, ParamField, Params};
use clench_math::{Dual, Real};
use std::iter;

/// A part of a direction of a pass: the input changes along `direction` at the rate `rate`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seed {
    /// The index of the direction of the pass.
    pub slot: usize,
    pub direction: Direction,
    pub rate: f64,
}

impl Seed {
    /// Returns the seeds of a pass along some directions, one in each slot.
    pub(crate) fn units(directions: &[(Direction, usize)]) -> impl Iterator<Item = Seed> {
        let directions = directions.iter().enumerate();
        directions.map(|(slot, &(direction, _))| Seed {
            slot,
            direction,
            rate: 1.0,
        })
    }

    /// Returns the first stage whose results change along a seed.
    pub(crate) fn earliest(seeds: &[Seed]) -> Stage {
        let starts = seeds.iter().map(|seed| seed.direction.start());
        starts.min().unwrap_or(Stage::Positions)
    }
}

/// Adds the derivatives of the seeds to a state and to parameters that have none.
pub(crate) fn set<L: Real<Scalar = f64>, const K: usize>(
    model: &Model,
    seeds: &[Seed],
    state: &mut State<Dual<L, K>>,
    params: &mut Params<Dual<L, K>>,
) {
    for seeds in of_one_field(seeds) {
        for &Seed {
            slot,
            direction,
            rate,
        } in seeds
        {
            match direction {
                Direction::Position(dof) => {
                    move_along(model, dof, (slot, rate), &mut state.qpos);
                }
                Direction::Velocity(dof) => add(&mut state.qvel[dof], slot, rate),
                Direction::Activation(a) => add(&mut state.act[a], slot, rate),
                Direction::Control(u) => add(&mut state.ctrl[u], slot, rate),
                Direction::Number(field, index) => add(field.number(state, index), slot, rate),
                Direction::Parameter(..) => {}
            }
        }
        let Direction::Parameter(field, _) = seeds[0].direction else {
            continue;
        };
        let earlier = take_rates(model, field, params);
        let mut row = params.read_lane(field, 0);
        for seed in seeds {
            let Direction::Parameter(_, index) = seed.direction else {
                continue;
            };
            add(&mut row[index], seed.slot, seed.rate);
            if let Some(size) = field.direction_size() {
                // A direction is normalized when it is set.
                let part = seed.rate * row[index].value;
                for x in &mut row[index / size * size..][..size] {
                    add(x, seed.slot, -part * x.value);
                }
            }
        }
        params.write_lane(field, 0, &row);
        params.derive(model, field);
        add_rates(earlier, params);
    }
}

/// The numbers of some parameters.
type Rows<T> = Vec<(ParamField, Vec<T>)>;

/// Removes the derivatives of a parameter and of those that follow from it. Returns their numbers before.
fn take_rates<L: Real<Scalar = f64>, const K: usize>(
    model: &Model,
    field: ParamField,
    params: &mut Params<Dual<L, K>>,
) -> Rows<Dual<L, K>> {
    let fields = iter::once(field).chain(field.followers(model).iter().copied());
    let rows = Vec::from_iter(fields.map(|field| (field, params.read_lane(field, 0))));
    for (field, row) in &rows {
        let values = Vec::from_iter(row.iter().map(|number| Real::new(number.value)));
        params.write_lane(*field, 0, &values);
    }
    rows
}

/// Adds the derivatives of parameters to earlier ones, and restores the earlier values: anchors of equalities differ
/// from their sites after `weld_here`.
fn add_rates<L: Real<Scalar = f64>, const K: usize>(
    earlier: Rows<Dual<L, K>>,
    params: &mut Params<Dual<L, K>>,
) {
    for (field, mut row) in earlier {
        for (number, added) in row.iter_mut().zip(params.read_lane(field, 0)) {
            for (rate, added) in number.tangent.iter_mut().zip(added.tangent) {
                *rate += added;
            }
        }
        params.write_lane(field, 0, &row);
    }
}

/// Removes the derivatives of the seeds from the parameters.
pub(crate) fn clear_params<L: Real<Scalar = f64>, const K: usize>(
    model: &Model,
    seeds: &[Seed],
    params: &mut Params<Dual<L, K>>,
) {
    for seeds in of_one_field(seeds) {
        if let Direction::Parameter(field, _) = seeds[0].direction {
            take_rates(model, field, params);
        }
    }
}

/// Splits seeds into runs of one parameter and runs of others.
fn of_one_field(seeds: &[Seed]) -> impl Iterator<Item = &[Seed]> {
    let field = |seed: &Seed| match seed.direction {
        Direction::Parameter(field, _) => Some(field),
        Direction::Position(_)
        | Direction::Velocity(_)
        | Direction::Activation(_)
        | Direction::Control(_)
        | Direction::Number(..) => None,
    };
    seeds.chunk_by(move |seed, next| field(seed) == field(next))
}
