//! The states of a batch, one table per field, and the copies between rows and lanes.

use super::Rows;
use super::cells::Cells;
use super::rows::try_reserve;
use super::shared::Shared;
use clench_dynamics::check::check_length;
use clench_dynamics::error::{SimError, no_such};
use clench_dynamics::model::Model;
use clench_dynamics::sleep::AWAKE;
use clench_dynamics::state::kind::{self, Kind};
use clench_dynamics::state::{FIELDS, State};
use clench_math::{Clock, Real, Scalar};

/// The cell type of a kind of element.
type Cell<K, S> = <K as Kind>::Cell<S>;

macro_rules! declare_rows {
    (
        moving { $(
            $(#[$moving_doc:meta])* $moving:ident $ms:ident: $moving_kind:ident, $mn:ident, $mb:ident;
        )* }
        inputs { $(
            $(#[$input_doc:meta])* $input:ident $is:ident: $input_kind:ident, $in:ident, $ib:ident;
        )* }
        occasional { $(
            $(#[$occasional_doc:meta])*
            $occasional:ident $os:ident: $occasional_kind:ident, $on:ident, $ob:ident;
        )* }
    ) => {
        /// The states of the environments of a batch, field by field, one row per environment, with the number of cells
        /// per element of its [kind](crate::state::kind). They may be read and written between steps; a step checks its
        /// input first.
        #[derive(Debug)]
        pub struct StateRows<S> {
            /// Time, s (n, 1), in double precision.
            pub time: Rows<f64>,
            $($(#[$moving_doc])* pub $moving: Rows<Cell<kind::$moving_kind, S>>,)*
            $($(#[$input_doc])* pub $input: Rows<Cell<kind::$input_kind, S>>,)*
            $($(#[$occasional_doc])* pub $occasional: Rows<Cell<kind::$occasional_kind, S>>,)*
        }

        impl<S: Scalar + Shared> StateRows<S> {
            /// Allocates `count` states of a model, all zero; [`write`](Self::write) sets them.
            ///
            /// # Errors
            /// Returns an error if memory is insufficient.
            pub fn new(model: &Model, count: usize) -> Result<Self, SimError> {
                try_reserve(count, Self::row_bytes(model))?;
                let mut widths = FIELDS.iter().map(|field| field.numbers(model));
                let mut width = || widths.next().unwrap_or(0);
                let mut error = None;
                let rows = StateRows {
                    time: Rows::new_or((count, 1), 0.0, &mut error),
                    $($moving: Rows::new_or(
                        (count, width()),
                        kind::$moving_kind::zero_cell::<S>(),
                        &mut error,
                    ),)*
                    $($input: Rows::new_or(
                        (count, width()),
                        kind::$input_kind::zero_cell::<S>(),
                        &mut error,
                    ),)*
                    $($occasional: Rows::new_or(
                        (count, width()),
                        kind::$occasional_kind::zero_cell::<S>(),
                        &mut error,
                    ),)*
                };
                error.map_or(Ok(rows), Err)
            }

            /// Returns the size of a state in bytes.
            pub(super) fn row_bytes(model: &Model) -> usize {
                let cells = [
                    $(size_of::<Cell<kind::$moving_kind, S>>(),)*
                    $(size_of::<Cell<kind::$input_kind, S>>(),)*
                    $(size_of::<Cell<kind::$occasional_kind, S>>(),)*
                ];
                let fields = cells.iter().zip(FIELDS);
                let bytes = fields.map(|(size, field)| size * field.numbers(model));
                size_of::<f64>() + bytes.sum::<usize>()
            }

            /// Returns the number of rows and the row width of each table, in the order of [`FIELDS`].
            fn shapes(&self) -> impl Iterator<Item = (usize, usize)> {
                [
                    $((self.$moving.count(), self.$moving.width()),)*
                    $((self.$input.count(), self.$input.width()),)*
                    $((self.$occasional.count(), self.$occasional.width()),)*
                ]
                .into_iter()
            }

            /// Copies row `from` of another table to row `to`.
            pub(super) fn copy_row(&mut self, to: usize, other: &Self, from: usize) {
                self.time.row_mut(to).copy_from_slice(other.time.row(from));
                $(self.$moving.row_mut(to).copy_from_slice(other.$moving.row(from));)*
                $(self.$input.row_mut(to).copy_from_slice(other.$input.row(from));)*
                $(self.$occasional.row_mut(to).copy_from_slice(other.$occasional.row(from));)*
            }

            /// Copies row `env` into a state of the same model. Unlike [`read`](Self::read), it needs no exclusive
            /// access.
            ///
            /// # Errors
            /// Returns an error if the row does not exist or the state has other lengths.
            pub(super) fn copy_to(&self, env: usize, state: &mut State<S>) -> Result<(), SimError> {
                self.check_row(env, state)?;
                state.time = self.time.row(env)[0];
                $(copy_cells::<kind::$moving_kind, S>(self.$moving.row(env), &mut state.$moving);)*
                $(copy_cells::<kind::$input_kind, S>(self.$input.row(env), &mut state.$input);)*
                $(copy_cells::<kind::$occasional_kind, S>(
                    self.$occasional.row(env),
                    &mut state.$occasional,
                );)*
                Ok(())
            }

            /// Copies the values of a field of [`FIELDS`], row by row, to `out`.
            pub(super) fn read_field(&mut self, name: &str, out: &mut Vec<S>) {
                let (motion, inputs) = self.share();
                out.clear();
                $(if name == stringify!($moving) {
                    return out.extend(motion.$moving.all().map(kind::$moving_kind::number::<S>));
                })*
                $(if name == stringify!($input) {
                    return out.extend(inputs.$input.all().map(kind::$input_kind::number::<S>));
                })*
                $(if name == stringify!($occasional) {
                    return out.extend(inputs.$occasional.all().map(kind::$occasional_kind::number::<S>));
                })*
            }

            /// Replaces all rows of a field that steps change.
            pub(super) fn write_field(&mut self, name: &str, values: &[S]) {
                let (motion, _) = self.share();
                $(if name == stringify!($moving) {
                    let cells = values.iter().map(|&x| kind::$moving_kind::from_number::<S>(x));
                    return motion.$moving.set_all(cells);
                })*
            }

            /// The names of the fields that steps change.
            pub(super) const MOVING: &[&str] = &[$(stringify!($moving)),*];

            /// Returns the tables in the form that a step uses.
            pub(super) fn share(&mut self) -> (MovingRows<'_, S>, Inputs<'_, S>) {
                let motion = MovingRows {
                    time: Cells::new(&mut self.time),
                    $($moving: Cells::new(&mut self.$moving),)*
                };
                let inputs = Inputs {
                    $($input: Cells::new(&mut self.$input),)*
                    $($occasional: Cells::new(&mut self.$occasional),)*
                };
                (motion, inputs)
            }
        }

        /// The fields that a step reads and writes.
        pub struct MovingRows<'a, S: Scalar + Shared> {
            time: Cells<'a, f64>,
            $($moving: Cells<'a, Cell<kind::$moving_kind, S>>,)*
        }

        impl<S: Scalar + Shared> MovingRows<'_, S> {
            /// Copies the row of an environment into lane `lane`.
            pub fn read<T: Real<Scalar = S>>(&self, env: usize, lane: usize, state: &mut State<T>) {
                state.time.set_lane(lane, self.time.get(env));
                $(self.$moving.read::<kind::$moving_kind, T>(env, lane, &mut state.$moving);)*
            }

            /// Copies lane `lane` into the row of an environment.
            pub fn write<T: Real<Scalar = S>>(&self, env: usize, lane: usize, state: &State<T>) {
                self.time.set(env, state.time.lane(lane));
                $(self.$moving.write::<kind::$moving_kind, T>(env, lane, &state.$moving);)*
            }
        }

        /// The fields that a step only reads.
        pub struct Inputs<'a, S: Scalar + Shared> {
            $($input: Cells<'a, Cell<kind::$input_kind, S>>,)*
            $($occasional: Cells<'a, Cell<kind::$occasional_kind, S>>,)*
        }

        impl<S: Scalar + Shared> Inputs<'_, S> {
            /// Copies the row of an environment, except occasional inputs, into lane `lane`.
            pub fn read<T: Real<Scalar = S>>(&self, env: usize, lane: usize, state: &mut State<T>) {
                $(self.$input.read::<kind::$input_kind, T>(env, lane, &mut state.$input);)*
            }

            /// Returns true if an environment has any occasional input. −0 counts, because outputs show it.
            pub(crate) fn has_occasional(&self, env: usize) -> bool {
                $(!self.$occasional.is_blank(env))||*
            }

            /// Copies the occasional inputs of an environment into lane `lane`.
            pub(crate) fn read_occasional<T: Real<Scalar = S>>(
                &self,
                env: usize,
                lane: usize,
                state: &mut State<T>,
            ) {
                $(self.$occasional.read::<kind::$occasional_kind, T>(env, lane, &mut state.$occasional);)*
            }

            /// Copies lane `lane` into the row of an environment.
            pub fn write<T: Real<Scalar = S>>(&self, env: usize, lane: usize, state: &State<T>) {
                $(self.$input.write::<kind::$input_kind, T>(env, lane, &state.$input);)*
                $(self.$occasional.write::<kind::$occasional_kind, T>(env, lane, &state.$occasional);)*
            }
        }

        /// Sets the occasional inputs of all lanes to zero.
        pub(super) fn clear_occasional<T: Real>(state: &mut State<T>) {
            $(state.$occasional.fill(kind::$occasional_kind::zero::<T>());)*
        }
    };
}
clench_dynamics::state_fields!(declare_rows);

/// Copies the cells of a row to its elements.
#[inline(never)] // Every field calls it.
fn copy_cells<K: Kind, S: Scalar>(row: &[Cell<K, S>], elements: &mut [K::Of<S>])
where
    Cell<K, S>: Copy,
{
    for (element, cells) in elements.iter_mut().zip(row.chunks_exact(K::WIDTH)) {
        K::set_cells::<S>(element, 0, cells.iter().copied());
    }
}

impl<S: Scalar + Shared> StateRows<S> {
    /// Returns the number of states.
    pub fn count(&self) -> usize {
        self.time.count()
    }

    /// Returns an error if a table does not have the shape of `count` states of this model.
    pub(super) fn check_shapes(&self, model: &Model, count: usize) -> Result<(), SimError> {
        let times = (self.time.count(), self.time.width());
        let expected = FIELDS
            .iter()
            .map(|field| (field.name, field.numbers(model)));
        let shapes = std::iter::once(times).chain(self.shapes());
        for ((rows, width), (field, expected)) in
            shapes.zip([("time", 1)].into_iter().chain(expected))
        {
            check_length(field, rows * width, count * expected)?;
            check_length(field, width, expected)?;
        }
        Ok(())
    }

    /// Checks that the tables have row `env`, with the lengths of this state.
    fn check_row(&self, env: usize, state: &State<S>) -> Result<(), SimError> {
        if env >= self.time.count() {
            return Err(no_such("environment", env, self.time.count()));
        }
        for (((rows, width), field), length) in self.shapes().zip(FIELDS).zip(state.lengths()) {
            if env >= rows {
                return Err(no_such("environment", env, rows));
            }
            check_length(field.name, length, width)?;
        }
        Ok(())
    }

    /// Copies row `env` into a state of the same model. Values are read one by one: concurrent writes through a pointer
    /// may mix old and new values.
    ///
    /// # Errors
    /// Returns an error if the row does not exist or the state has other lengths; the state is then unchanged.
    pub fn read(&mut self, env: usize, state: &mut State<S>) -> Result<(), SimError> {
        self.check_row(env, state)?;
        let (motion, inputs) = self.share();
        motion.read(env, 0, state);
        inputs.read(env, 0, state);
        inputs.read_occasional(env, 0, state);
        Ok(())
    }

    /// Copies a state of the same model into row `env`, value by value like [`read`](Self::read).
    ///
    /// # Errors
    /// Returns an error if the row does not exist or the state has other lengths. The row is then unchanged.
    pub fn write(&mut self, env: usize, state: &State<S>) -> Result<(), SimError> {
        self.check_row(env, state)?;
        let (motion, inputs) = self.share();
        motion.write(env, 0, state);
        inputs.write(env, 0, state);
        Ok(())
    }

    /// Copies the fields of a state that a step only reads into row `env`.
    pub(super) fn write_inputs(&mut self, env: usize, state: &State<S>) {
        self.share().1.write(env, 0, state);
    }
}

impl<S: Scalar + Shared> MovingRows<'_, S> {
    /// Replaces the row of an environment by time, `nq` positions, `nv` velocities and activations. Clears the solver's
    /// warm start and wakes all trees.
    pub fn start(&self, env: usize, row: &[S], nq: usize, nv: usize) {
        let (time, row) = row.split_at(1);
        let (qpos, row) = row.split_at(nq);
        let (qvel, act) = row.split_at(nv);
        self.time.set_row(env, time.iter().map(|t| t.to_f64()));
        self.qpos.set_row(env, qpos.iter().copied());
        self.qvel.set_row(env, qvel.iter().copied());
        self.act.set_row(env, act.iter().copied());
        self.qacc_warmstart
            .set_row(env, std::iter::repeat_n(S::ZERO, nv));
        self.tree_asleep
            .set_row(env, std::iter::repeat(AWAKE as i32));
    }
}
