//! The number types of device computations, and the kernel texts in each.
//!
//! Kernels are written in single precision. The double-precision texts differ only in their types; elementary functions
//! and roundings have a file for each.

use clench_rigid::batch::Precision;
use std::borrow::Cow;
use zerocopy::{FromBytes, Immutable, IntoBytes};

/// A number type of device computations: `f32`, or `f64` if the device has double precision.
pub trait GpuReal: Precision + IntoBytes + FromBytes + Immutable + Texts {}
impl GpuReal for f32 {}
impl GpuReal for f64 {}

/// The texts of kernels in a number type; only the name is public.
pub trait Texts {
    /// Elementary functions and roundings.
    #[doc(hidden)]
    const ELEMENTARY: &'static str;
    /// The required device features.
    #[doc(hidden)]
    const FEATURES: wgpu::Features;
    /// Converts a text to this type. Literals stay: WGSL infers their type unless the text states it.
    #[doc(hidden)]
    fn text(single: &str) -> Cow<'_, str>;
}

impl Texts for f32 {
    const ELEMENTARY: &'static str = include_str!("kernels/elementary.wgsl");
    const FEATURES: wgpu::Features = wgpu::Features::empty();

    fn text(single: &str) -> Cow<'_, str> {
        Cow::Borrowed(single)
    }
}

impl Texts for f64 {
    const ELEMENTARY: &'static str = include_str!("kernels/elementary_double.wgsl");
    const FEATURES: wgpu::Features = wgpu::Features::SHADER_F64;

    fn text(single: &str) -> Cow<'_, str> {
        Cow::Owned(replace_words(single, type_in_double))
    }
}

/// Returns the double-precision counterpart of a type: `f32`, `vec3f` and `mat3x3f` become `f64`, `vec3<f64>` and
/// `mat3x3<f64>`.
fn type_in_double(word: &str) -> Option<String> {
    if word == "f32" {
        return Some("f64".to_owned());
    }
    let shape = word.strip_suffix('f')?;
    let is_size = |part: &str| matches!(part, "2" | "3" | "4");
    let is_vector = shape.strip_prefix("vec").is_some_and(is_size);
    let sizes = shape.strip_prefix("mat").and_then(|s| s.split_once('x'));
    let is_matrix = sizes.is_some_and(|(columns, rows)| is_size(columns) && is_size(rows));
    (is_vector || is_matrix).then(|| format!("{shape}<f64>"))
}

/// Returns true for the characters of names, keywords and numbers.
fn is_of_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// Returns the words of a text.
pub(crate) fn words(text: &str) -> impl Iterator<Item = &str> {
    let parts = text.split(|c: char| !is_of_word(c));
    parts.filter(|word| !word.is_empty())
}

/// Replaces words of a text.
pub(crate) fn replace_words(text: &str, replace: impl Fn(&str) -> Option<String>) -> String {
    let mut result = String::with_capacity(text.len() + text.len() / 4);
    let mut rest = text;
    while let Some(start) = rest.find(is_of_word) {
        let length = rest[start..].find(|c| !is_of_word(c));
        let end = length.map_or(rest.len(), |length| start + length);
        let word = &rest[start..end];
        result += &rest[..start];
        match replace(word) {
            Some(other) => result += &other,
            None => result += word,
        }
        rest = &rest[end..];
    }
    result + rest
}

#[cfg(test)]
mod tests {
    use super::Texts;

    #[test]
    fn types_are_replaced_and_nothing_else() {
        let single = "fn f(v: vec3f, u: vec3u) -> mat2x3f { return buf32 * f32(u.x); } // matf";
        let double =
            "fn f(v: vec3<f64>, u: vec3u) -> mat2x3<f64> { return buf32 * f64(u.x); } // matf";
        assert_eq!(f64::text(single), double);
    }
}
