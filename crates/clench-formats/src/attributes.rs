//! Typed access to attributes, with MuJoCo's errors: too few numbers, too many, not a number.

use crate::document::Element;
use crate::error::LoadError;
use clench_builder::ElementNumber;
use clench_math::Vec3;
use std::sync::Arc;

/// Keywords of an attribute and their values.
pub(crate) type Keywords<'a, T> = &'a [(&'a str, T)];

const BOOLEANS: Keywords<bool> = &[("false", false), ("true", true)];
const TRISTATES: Keywords<Option<bool>> =
    &[("false", Some(false)), ("true", Some(true)), ("auto", None)];

impl Element {
    /// Creates an error about this element.
    pub(crate) fn error(&self, message: impl Into<String>) -> LoadError {
        LoadError::element(&self.origin, self.label(), message)
    }

    /// Returns the element's label in errors: `joint "knee"`.
    pub(crate) fn label(&self) -> String {
        match self.text("name") {
            Some(name) if !name.is_empty() => format!("{} \"{name}\"", self.tag),
            _ => self.tag.clone(),
        }
    }

    /// Returns the text of an attribute.
    pub(crate) fn text(&self, name: &str) -> Option<&str> {
        #[cfg(test)]
        requested::record(&self.tag, name);
        let found = self.attributes.iter().find(|(key, _)| key == name);
        found.map(|(_, value)| value.as_str())
    }

    /// Returns the text of an attribute, empty if absent.
    pub(crate) fn string(&self, name: &str) -> String {
        self.text(name).unwrap_or_default().to_owned()
    }

    /// Returns the text of a required attribute.
    pub(crate) fn required_text(&self, name: &str) -> Result<&str, LoadError> {
        self.text(name).ok_or_else(|| self.missing(name))
    }

    /// Creates the error of a missing required attribute.
    pub(crate) fn missing(&self, name: &str) -> LoadError {
        self.incomplete(format!("the attribute \"{name}\" is required"))
    }

    /// Creates an error about missing content.
    pub(crate) fn incomplete(&self, message: impl Into<String>) -> LoadError {
        LoadError {
            incomplete: true,
            ..self.error(message)
        }
    }

    /// Parses the numbers of an attribute, at most `max`; `None` if it is absent or blank.
    fn parse_numbers(
        &self,
        name: &str,
        max: usize,
        infinite: bool,
    ) -> Result<Option<Vec<f64>>, LoadError> {
        let mut numbers = Vec::new();
        for word in self.text(name).unwrap_or_default().split_ascii_whitespace() {
            let number = word.parse::<f64>().ok();
            let allowed =
                |n: &f64| n.is_finite() || (infinite && n.is_infinite() && word.contains("inf"));
            match number.filter(allowed) {
                Some(number) => numbers.push(number),
                None => {
                    return Err(self.error(format!("\"{word}\" in {name} is not a finite number")));
                }
            }
            if numbers.len() > max {
                return Err(self.error(format!("{name} has more than {max} numbers")));
            }
        }
        Ok((!numbers.is_empty()).then_some(numbers))
    }

    fn exactly<T, const N: usize>(&self, name: &str, numbers: Vec<T>) -> Result<[T; N], LoadError> {
        let given = numbers.len();
        let wrong = |_: Vec<T>| self.error(format!("{name} needs {N} numbers, not {given}"));
        numbers.try_into().map_err(wrong)
    }

    /// Parses exactly `N` finite numbers.
    pub(crate) fn numbers<const N: usize>(
        &self,
        name: &str,
    ) -> Result<Option<[f64; N]>, LoadError> {
        let numbers = self.parse_numbers(name, N, false)?;
        numbers
            .map(|numbers| self.exactly(name, numbers))
            .transpose()
    }

    /// Parses exactly `N` finite numbers of a required attribute.
    pub(crate) fn required_numbers<const N: usize>(
        &self,
        name: &str,
    ) -> Result<[f64; N], LoadError> {
        self.numbers(name)?.ok_or_else(|| self.missing(name))
    }

    /// Parses any number of finite numbers.
    pub(crate) fn list(&self, name: &str) -> Result<Option<Vec<f64>>, LoadError> {
        self.parse_numbers(name, usize::MAX, false)
    }

    /// Parses exactly `N` finite numbers, in single precision.
    pub(crate) fn singles<const N: usize>(
        &self,
        name: &str,
    ) -> Result<Option<[f32; N]>, LoadError> {
        let numbers = self.list_of_singles(name, N)?;
        numbers
            .map(|numbers| self.exactly(name, numbers))
            .transpose()
    }

    /// Parses up to `max` finite numbers, in single precision.
    pub(crate) fn list_of_singles(
        &self,
        name: &str,
        max: usize,
    ) -> Result<Option<Vec<f32>>, LoadError> {
        let single = |number: f64| {
            let short = number as f32;
            let too_large = || {
                self.error(format!(
                    "{number:e} in {name} is too large for single precision"
                ))
            };
            short.is_finite().then_some(short).ok_or_else(too_large)
        };
        let numbers = self.parse_numbers(name, max, false)?;
        numbers
            .map(|numbers| numbers.into_iter().map(single).collect())
            .transpose()
    }

    /// Parses any number of numbers, which may be infinite or NaN, for user data.
    pub(crate) fn any_numbers(&self, name: &str) -> Result<Vec<f64>, LoadError> {
        let words = self.text(name).unwrap_or_default().split_ascii_whitespace();
        let number = |word: &str| {
            let wrong = |_| self.error(format!("\"{word}\" in {name} is not a number"));
            word.parse().map_err(wrong)
        };
        words.map(number).collect()
    }

    /// Overwrites the user data of an element if present.
    pub(crate) fn set_user(&self, target: &mut Arc<[f64]>) -> Result<(), LoadError> {
        let numbers = self.any_numbers("user")?;
        if !numbers.is_empty() {
            *target = numbers.into();
        }
        Ok(())
    }

    /// Overwrites a number if the attribute is present.
    #[inline(never)] // Every reader calls it.
    pub(crate) fn set_number(&self, name: &str, target: &mut f64) -> Result<(), LoadError> {
        if let Some([number]) = self.numbers(name)? {
            *target = number;
        }
        Ok(())
    }

    /// Overwrites the numbers of some rows of a table that are present.
    pub(crate) fn set_element_numbers(
        &self,
        rows: &[ElementNumber],
        numbers: &mut [&mut f64],
    ) -> Result<(), LoadError> {
        let mut pairs = rows.iter().zip(numbers);
        pairs.try_for_each(|(row, number)| self.set_number(row.name, number))
    }

    /// Rejects single numbers below zero.
    pub(crate) fn refuse_negative(&self, names: &[&str]) -> Result<(), LoadError> {
        for name in names {
            if self.numbers(name)?.is_some_and(|[number]| number < 0.0) {
                return Err(self.error(format!("{name} cannot be negative")));
            }
        }
        Ok(())
    }

    /// Overwrites an entire array if the attribute is present.
    pub(crate) fn set_numbers<const N: usize>(
        &self,
        name: &str,
        target: &mut [f64; N],
    ) -> Result<(), LoadError> {
        if let Some(numbers) = self.numbers(name)? {
            *target = numbers;
        }
        Ok(())
    }

    /// Overwrites a vector if the attribute is present.
    pub(crate) fn set_vector(&self, name: &str, target: &mut Vec3<f64>) -> Result<(), LoadError> {
        if let Some(numbers) = self.numbers(name)? {
            *target = Vec3::from_array(numbers);
        }
        Ok(())
    }

    /// Overwrites a range, whose ends may be infinite, if the attribute is present.
    pub(crate) fn set_range(&self, name: &str, target: &mut [f64; 2]) -> Result<(), LoadError> {
        if let Some(numbers) = self.parse_numbers(name, 2, true)? {
            *target = self.exactly(name, numbers)?;
        }
        Ok(())
    }

    /// Parses one end of a range, which may be infinite.
    pub(crate) fn range_end(&self, name: &str) -> Result<Option<f64>, LoadError> {
        let numbers = self.parse_numbers(name, 1, true)?;
        Ok(numbers.map(|numbers| numbers[0]))
    }

    /// Overwrites the leading entries with the attribute's numbers, 1 to `N`, and returns their count.
    pub(crate) fn overlay<const N: usize>(
        &self,
        name: &str,
        target: &mut [f64; N],
    ) -> Result<usize, LoadError> {
        let numbers = self.parse_numbers(name, N, false)?.unwrap_or_default();
        target[..numbers.len()].copy_from_slice(&numbers);
        Ok(numbers.len())
    }

    /// Like `overlay`, for a value that may be undefined; defining it starts from zeros.
    pub(crate) fn overlay_option<const N: usize>(
        &self,
        name: &str,
        target: &mut Option<[f64; N]>,
    ) -> Result<(), LoadError> {
        let mut values = target.unwrap_or([0.0; N]);
        if self.overlay(name, &mut values)? > 0 {
            *target = Some(values);
        }
        Ok(())
    }

    /// Parses an integer.
    pub(crate) fn integer(&self, name: &str) -> Result<Option<i32>, LoadError> {
        let words: Vec<&str> = self
            .text(name)
            .unwrap_or_default()
            .split_ascii_whitespace()
            .collect();
        match words[..] {
            [] => Ok(None),
            [word] => match word.parse() {
                Ok(number) => Ok(Some(number)),
                Err(_) => Err(self.error(format!("\"{word}\" in {name} is not a 32-bit integer"))),
            },
            _ => Err(self.error(format!("{name} has more than one number"))),
        }
    }

    /// Overwrites an integer if the attribute is present.
    pub(crate) fn set_integer(&self, name: &str, target: &mut i32) -> Result<(), LoadError> {
        if let Some(number) = self.integer(name)? {
            *target = number;
        }
        Ok(())
    }

    /// Parses a nonnegative integer.
    pub(crate) fn count(&self, name: &str) -> Result<Option<usize>, LoadError> {
        let negative = |n: i32| {
            usize::try_from(n).map_err(|_| self.error(format!("{name} cannot be negative")))
        };
        self.integer(name)?.map(negative).transpose()
    }

    /// Parses any number of integers.
    pub(crate) fn integers(&self, name: &str) -> Result<Vec<i32>, LoadError> {
        let words = self.text(name).unwrap_or_default().split_ascii_whitespace();
        words
            .map(|word| {
                let wrong = |_| self.error(format!("\"{word}\" in {name} is not a 32-bit integer"));
                word.parse().map_err(wrong)
            })
            .collect()
    }

    /// Returns the value of a keyword.
    pub(crate) fn keyword<T: Clone>(
        &self,
        name: &str,
        keywords: Keywords<T>,
    ) -> Result<Option<T>, LoadError> {
        let Some(text) = self.text(name) else {
            return Ok(None);
        };
        match keywords.iter().find(|(keyword, _)| *keyword == text) {
            Some((_, value)) => Ok(Some(value.clone())),
            None => {
                let known: Vec<&str> = keywords.iter().map(|(keyword, _)| *keyword).collect();
                Err(self.error(format!(
                    "{name} is \"{text}\", not one of {}",
                    known.join(", ")
                )))
            }
        }
    }

    /// Overwrites a value by that of a keyword if the attribute is present.
    pub(crate) fn set_keyword<T: Clone>(
        &self,
        name: &str,
        keywords: Keywords<T>,
        target: &mut T,
    ) -> Result<(), LoadError> {
        if let Some(value) = self.keyword(name, keywords)? {
            *target = value;
        }
        Ok(())
    }

    /// Overwrites a boolean if the attribute is present.
    pub(crate) fn set_boolean(&self, name: &str, target: &mut bool) -> Result<(), LoadError> {
        self.set_keyword(name, BOOLEANS, target)
    }

    /// Overwrites a "true", "false" or "auto" (`None`) if the attribute is present.
    pub(crate) fn set_tristate(
        &self,
        name: &str,
        target: &mut Option<bool>,
    ) -> Result<(), LoadError> {
        self.set_keyword(name, TRISTATES, target)
    }

    /// Rejects more than one of these attributes.
    pub(crate) fn at_most_one(&self, names: &[&str]) -> Result<(), LoadError> {
        let given: Vec<&str> = names
            .iter()
            .copied()
            .filter(|name| self.text(name).is_some())
            .collect();
        match given[..] {
            [first, second, ..] => {
                Err(self.error(format!("{first} and {second} cannot both be given")))
            }
            _ => Ok(()),
        }
    }
}

/// A record of the attributes that readers query, by element name.
#[cfg(test)]
pub(crate) mod requested {
    use std::cell::RefCell;
    use std::collections::HashSet;

    thread_local! {
        static REQUESTED: RefCell<HashSet<(String, String)>> = RefCell::default();
    }

    pub(super) fn record(tag: &str, name: &str) {
        REQUESTED.with_borrow_mut(|requested| requested.insert((tag.to_owned(), name.to_owned())));
    }

    /// Returns true if this thread has queried the attribute of an element of this name.
    pub(crate) fn was(tag: &str, name: &str) -> bool {
        REQUESTED.with_borrow(|requested| requested.contains(&(tag.to_owned(), name.to_owned())))
    }
}
