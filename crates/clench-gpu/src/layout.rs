//! Offsets into the arrays of a model, counts and options: numbers that differ from model to model. Kernels read them
//! from a small array, so that models of one kind share their kernels. Whatever affects a kernel's text is a constant,
//! except in kernels that serve any model.
//!
//! The texts name them in capitals, like constants.

use crate::precision::replace_words;
use clench_math::Scalar;
use std::collections::HashSet;
use std::fmt::Write;
use zerocopy::{Immutable, IntoBytes};

/// Names and values, in the order in which the device reads them.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Layout {
    counts: Vec<(String, u32)>,
    flags: Vec<(String, bool)>,
    reals: Vec<(String, f64)>,
}

impl Layout {
    /// Adds a count or an offset.
    pub(crate) fn count(&mut self, name: &str, value: usize) {
        self.counts.push((name.to_owned(), value as u32));
    }

    /// Adds a flag.
    pub(crate) fn flag(&mut self, name: &str, value: bool) {
        self.flags.push((name.to_owned(), value));
    }

    /// Adds a real number.
    pub(crate) fn real(&mut self, name: &str, value: f64) {
        self.reals.push((name.to_owned(), value));
    }

    /// Returns the WGSL declaration of the array.
    pub(crate) fn declaration(&self) -> String {
        let mut text = "struct Layout {\n".to_owned();
        let counts = self.counts.iter().map(|(name, _)| name);
        for name in counts.chain(self.flags.iter().map(|(name, _)| name)) {
            let _ = writeln!(text, "    {name}: u32,");
        }
        for (name, _) in &self.reals {
            let _ = writeln!(text, "    {name}: f32,");
        }
        text + "}\n@group(0) @binding(7) var<uniform> of_model: Layout;\n"
    }

    /// Replaces each name in a text by its element of the array.
    pub(crate) fn resolve(&self, text: &str) -> String {
        let counts = self.counts.iter().map(|(name, _)| name.as_str());
        let reals = self.reals.iter().map(|(name, _)| name.as_str());
        let numbers: HashSet<&str> = counts.chain(reals).collect();
        let flags: HashSet<&str> = self.flags.iter().map(|(name, _)| name.as_str()).collect();
        replace_words(text, |word| {
            let holds = || format!("(of_model.{word} != 0u)");
            let number = numbers.contains(word).then(|| format!("of_model.{word}"));
            number.or_else(|| flags.contains(word).then(holds))
        })
    }

    /// Returns the array: counts and flags, then real numbers, aligned as WGSL requires.
    pub(crate) fn bytes<S: Scalar + IntoBytes + Immutable>(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        for (_, count) in &self.counts {
            bytes.extend(count.to_ne_bytes());
        }
        for &(_, flag) in &self.flags {
            bytes.extend(u32::from(flag).to_ne_bytes());
        }
        bytes.resize(bytes.len().next_multiple_of(size_of::<S>()), 0);
        for &(_, real) in &self.reals {
            bytes.extend(S::new(real).as_bytes());
        }
        bytes.resize(bytes.len().next_multiple_of(16), 0);
        bytes
    }
}

#[cfg(test)]
mod tests {
    use super::Layout;

    #[test]
    fn names_stand_for_numbers_of_an_aligned_array() {
        let mut layout = Layout::default();
        layout.count("NV", 7);
        layout.real("STEP", 0.5);
        layout.flag("WARM", true);
        assert_eq!(
            layout.resolve("WARM && f(NV, NVS) * STEP"),
            "(of_model.WARM != 0u) && f(of_model.NV, NVS) * of_model.STEP"
        );
        assert!(
            layout
                .declaration()
                .contains("    NV: u32,\n    WARM: u32,\n    STEP: f32,\n}")
        );
        let single = [7u32.to_ne_bytes(), 1u32.to_ne_bytes(), 0.5f32.to_ne_bytes()].concat();
        assert_eq!(layout.bytes::<f32>()[..12], single);
        assert_eq!(layout.bytes::<f64>()[8..16], 0.5f64.to_ne_bytes());
        assert_eq!(layout.bytes::<f32>().len(), 16);
    }
}
