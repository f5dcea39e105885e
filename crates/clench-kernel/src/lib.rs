//! The attribute `#[kernel]`, which compiles a numerical function for the instruction set of its lanes. A procedural
//! macro needs a crate of its own; `clench_math::kernel` re-exports it, with examples.

use proc_macro::{Delimiter, Group, TokenStream, TokenTree};

/// Compiles a function for the instruction set of its number type: a generic parameter of the function or of its `impl`
/// that must be called `T`.
///
/// The body moves into `T::vectorize(...)`. Each function that it calls must either be inlined (`#[inline(always)]`) or
/// be a kernel itself: a plain function in between would be compiled for the oldest processor of its architecture, with
/// a call for every operation on lanes. That costs speed, never correctness. For `f64` and `f32` the attribute keeps
/// the body a separate function, which would otherwise be copied into each of its callers.
///
/// The same applies to closures and the functions that they are passed to. If they contain operations on lanes, prefer
/// a loop: iterator adaptors, `std::array::from_fn` and an array's `map` are functions in between if the closure is
/// large. A closure passed to a function that is always inlined takes the attribute itself:
/// `f(#[inline(always)] |x| x + x)`.
///
/// Mark functions that are worth a call as kernels: a stage, a product, a factorization. Mark functions that are small
/// compared with a call `#[inline(always)]`. Each kernel is compiled for every instruction set that it is used with.
#[proc_macro_attribute]
pub fn kernel(arguments: TokenStream, function: TokenStream) -> TokenStream {
    if !arguments.is_empty() {
        return error("#[kernel] takes no arguments");
    }
    let mut tokens: Vec<TokenTree> = function.into_iter().collect();
    let is_function = tokens
        .iter()
        .any(|token| matches!(token, TokenTree::Ident(word) if word.to_string() == "fn"));
    let Some(TokenTree::Group(body)) = tokens.pop().filter(|_| is_function) else {
        return error("#[kernel] belongs on a function with a body");
    };
    let mut closure = source("#[inline(always)] move ||");
    closure.extend([TokenTree::Group(body)]);
    let mut call = source("<T as ::clench_math::Real>::vectorize");
    call.extend([group(Delimiter::Parenthesis, closure)]);
    tokens.push(group(Delimiter::Brace, call));
    tokens.into_iter().collect()
}

fn source(text: &str) -> TokenStream {
    text.parse().unwrap_or_default()
}

fn group(delimiter: Delimiter, content: TokenStream) -> TokenTree {
    TokenTree::Group(Group::new(delimiter, content))
}

fn error(message: &str) -> TokenStream {
    source(&format!("compile_error!({message:?});"))
}
