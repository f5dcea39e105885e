//! Prints the words of MJCF for the fuzzer.

fn main() {
    print!("{}", clench_fuzz::dictionary());
}
