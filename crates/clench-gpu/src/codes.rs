//! Numbers that the host and the kernels both know: codes of kinds, and offsets within the rows of a table. Each is one
//! line of a table; the host's type and the kernels' constants follow from it.
//!
//! A variant without a constant does not compile, and neither does a kernel that names a constant that does not exist.
//! A test checks that the kernels name every constant.

/// An enumeration with a constant of the kernels for each variant.
pub(crate) trait Code: Copy + PartialEq + 'static {
    /// All variants, in the order of their codes.
    const ALL: &'static [Self];

    /// Returns the name of its constant.
    fn constant(self) -> &'static str;

    /// Returns its code.
    fn code(self) -> usize {
        let before = Self::ALL.iter().take_while(|&&other| other != self);
        before.count()
    }

    /// Returns the variant with a code.
    fn of(code: u32) -> Option<Self> {
        Self::ALL.get(code as usize).copied()
    }
}

/// Gives the variants of an enumeration their constants: `of` an existing one, or a new one.
macro_rules! codes {
    (of $name:ident { $($variant:ident = $constant:literal,)* }) => {
        impl $crate::codes::Code for $name {
            const ALL: &'static [Self] = &[$($name::$variant),*];

            fn constant(self) -> &'static str {
                match self { $($name::$variant => $constant,)* }
            }
        }
    };
    ($(#[$doc:meta])* enum $name:ident { $($(#[$item:meta])* $variant:ident = $constant:literal,)* }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub(crate) enum $name {
            $($(#[$item])* $variant,)*
        }
        $crate::codes::codes!(of $name { $($variant = $constant,)* });
    };
}
pub(crate) use codes;

/// A row of a table, of words or numbers. The kernels know the offset of each field as the prefix and the field's name,
/// and the size of the row as the prefix and `SIZE`.
pub(crate) trait Row {
    /// The prefix of its constants.
    const PREFIX: &'static str;
    /// The name and the width of each field.
    const FIELDS: &'static [(&'static str, usize)];

    /// Returns the names and values of its constants.
    fn constants() -> Vec<(String, usize)> {
        let mut constants = Vec::new();
        let mut offset = 0;
        for (field, width) in Self::FIELDS {
            let name = format!("{}_{}", Self::PREFIX, field.to_uppercase());
            constants.push((name, offset));
            offset += width;
        }
        constants.push((format!("{}_SIZE", Self::PREFIX), offset));
        constants
    }
}

/// Declares a row: of one word a field, or of the given count of numbers.
macro_rules! row {
    ($(#[$doc:meta])* words $name:ident, $prefix:literal { $($(#[$item:meta])* $field:ident,)* }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        pub(crate) struct $name {
            $($(#[$item])* pub $field: usize,)*
        }

        impl $name {
            /// The number of words.
            pub(crate) const SIZE: usize = [$(stringify!($field)),*].len();

            /// Returns the words in their order.
            pub(crate) fn words(self) -> [usize; Self::SIZE] {
                [$(self.$field),*]
            }
        }

        impl $crate::codes::Row for $name {
            const PREFIX: &'static str = $prefix;
            const FIELDS: &'static [(&'static str, usize)] = &[$((stringify!($field), 1)),*];
        }
    };
    ($(#[$doc:meta])* numbers $name:ident, $prefix:literal { $($(#[$item:meta])* $field:ident: $width:literal,)* }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        pub(crate) struct $name {
            $($(#[$item])* pub $field: [f64; $width],)*
        }

        impl $name {
            /// The number of numbers.
            pub(crate) const SIZE: usize = 0 $(+ $width)*;

            /// Returns the numbers in their order.
            pub(crate) fn numbers(self) -> [f64; Self::SIZE] {
                let mut all = [0.0; Self::SIZE];
                let fields: &[&[f64]] = &[$(&self.$field),*];
                for (to, from) in all.iter_mut().zip(fields.iter().copied().flatten()) {
                    *to = *from;
                }
                all
            }
        }

        impl $crate::codes::Row for $name {
            const PREFIX: &'static str = $prefix;
            const FIELDS: &'static [(&'static str, usize)] = &[$((stringify!($field), $width)),*];
        }
    };
}
pub(crate) use row;
