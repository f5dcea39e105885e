//! The attribute `#[kernel]`, which compiles a numerical function for the instruction set that its lanes are made of.
//! Nothing else lives here: a procedural macro needs a crate of its own.

use proc_macro::{Delimiter, Group, TokenStream, TokenTree};

/// Compiles a function for the instruction set of its number type, which must be called `T`.
///
/// The body moves into `T::vectorize(...)`, and what it calls must either be inlined into it (`#[inline(always)]`) or be a
/// kernel itself: a plain function in between would be compiled for the oldest processor of its architecture, and every
/// operation on lanes in it would be a call. For `f64` and `f32` the attribute changes nothing.
///
/// Mark as kernels the functions that are worth a call: a stage, a product, a factorization. Mark `#[inline(always)]`
/// what is small beside its call.
#[proc_macro_attribute]
pub fn kernel(_: TokenStream, function: TokenStream) -> TokenStream {
    let mut tokens: Vec<TokenTree> = function.into_iter().collect();
    let Some(TokenTree::Group(body)) = tokens.pop() else {
        return "compile_error!(\"#[kernel] belongs on a function with a body\");"
            .parse()
            .unwrap_or_default();
    };
    let mut call: TokenStream = "<T as ::clench_math::Real>::vectorize"
        .parse()
        .unwrap_or_default();
    let mut closure: TokenStream = "#[inline(always)] move ||".parse().unwrap_or_default();
    closure.extend([TokenTree::Group(body)]);
    call.extend([TokenTree::Group(Group::new(
        Delimiter::Parenthesis,
        closure,
    ))]);
    tokens.push(TokenTree::Group(Group::new(Delimiter::Brace, call)));
    tokens.into_iter().collect()
}
