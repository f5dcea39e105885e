//! Buffers of past controls and of what sensors measured.

use super::{NONE, Tables};
use clench_rigid::model::{History, Interpolation};

/// The words of a buffer: its first number, its samples, the numbers of each, and how it is read between two.
fn row(history: &History) -> [usize; 4] {
    let between = match history.interpolation {
        Interpolation::Hold => 0,
        Interpolation::Linear => 1,
        Interpolation::Cubic => 2,
    };
    [history.start, history.samples, history.width, between]
}

impl Tables {
    /// Adds a table of buffers, and tells where that of each owner is: `NONE` where it has none.
    pub(super) fn histories<'a>(
        &mut self,
        name: &str,
        owners: impl Iterator<Item = Option<&'a History>> + Clone,
    ) -> Vec<usize> {
        let mut next = self.words.len();
        self.words(name, owners.clone().flatten().flat_map(row));
        let mut place = |history: Option<&History>| {
            let place = next;
            next += 4 * usize::from(history.is_some());
            history.map_or(NONE as usize, |_| place)
        };
        owners.map(&mut place).collect()
    }

    /// How a buffer is read between two samples.
    pub(super) fn interpolations(&mut self) {
        for (code, name) in ["HOLD", "LINEAR", "CUBIC"].into_iter().enumerate() {
            self.constant(name, code);
        }
    }
}
