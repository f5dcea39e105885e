//! Buffers of past controls and measurements.

use super::{NONE, Tables};
use crate::codes::{Code, codes, row};
use clench_rigid::model::{History, Interpolation};

row! {
    /// The words of a buffer.
    words HistoryWords, "HISTORY" {
        /// Its offset in the state.
        start,
        samples,
        /// The numbers of each sample.
        width,
        interpolation,
    }
}
codes! {
    of Interpolation {
        Hold = "HOLD",
        Linear = "LINEAR",
        Cubic = "CUBIC",
    }
}

fn row(history: &History) -> [usize; HistoryWords::SIZE] {
    let row = HistoryWords {
        start: history.start,
        samples: history.samples,
        width: history.width,
        interpolation: history.interpolation.code(),
    };
    row.words()
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
        let mut offset = |history: Option<&History>| {
            let offset = next;
            next += HistoryWords::SIZE * usize::from(history.is_some());
            history.map_or(NONE as usize, |_| offset)
        };
        owners.map(&mut offset).collect()
    }

    /// Declares the rows of buffers.
    pub(super) fn history_rows(&mut self) {
        self.row::<HistoryWords>();
        self.codes::<Interpolation>();
    }
}
