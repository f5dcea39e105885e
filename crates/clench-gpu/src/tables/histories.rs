//! Buffers of past controls and measurements.

use super::{NONE, Tables};
use clench_rigid::model::{History, Interpolation};

/// Returns the words of a buffer: its offset, its samples, the numbers of each, and the interpolation.
fn row(history: &History) -> [usize; 4] {
    let between = match history.interpolation {
        Interpolation::Hold => 0,
        Interpolation::Linear => 1,
        Interpolation::Cubic => 2,
    };
    [history.start, history.samples, history.width, between]
}

impl Tables {
    /// Adds a table of buffers. Returns the offset of each owner's, or `NONE`.
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

    /// Adds the kinds of interpolation.
    pub(super) fn interpolations(&mut self) {
        for (code, name) in ["HOLD", "LINEAR", "CUBIC"].into_iter().enumerate() {
            self.constant(name, code);
        }
    }
}
