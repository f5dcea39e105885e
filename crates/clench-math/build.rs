//! Chooses the instruction sets that lanes are compiled for.
//!
//! A build from source usually runs on the machine that builds it, so by default only the widest lanes of this
//! processor are compiled. `CLENCH_INSTRUCTIONS` chooses others: `native` (the default), `all`, `scalar` (no
//! lanes), or the name of one set. The feature `all-instruction-sets` is the same as `all`. A build for another
//! machine compiles all sets of its architecture.

use std::env::var;
use std::process::exit;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed=CLENCH_INSTRUCTIONS");
    println!(
        "cargo::rustc-check-cfg=cfg(lanes, values(\"avx2\", \"avx512\", \"neon\", \"portable\"))"
    );
    for name in ["single", "derivatives"] {
        println!(
            "cargo::rustc-check-cfg=cfg({name}, values(\"scalar\", \"avx2\", \"avx512\", \"neon\", \"portable\"))"
        );
    }
    // Narrowest first.
    let sets: &[&str] = match &*var("CARGO_CFG_TARGET_ARCH").unwrap_or_default() {
        "x86_64" => &["avx2", "avx512"],
        "aarch64" => &["neon"],
        _ => &["portable"],
    };
    let wish = match var("CARGO_FEATURE_ALL_INSTRUCTION_SETS") {
        Ok(_) => "all".to_owned(),
        Err(_) => var("CLENCH_INSTRUCTIONS").unwrap_or_default(),
    };
    let is_native = var("HOST") == var("TARGET");
    let chosen: &[&str] = match &*wish {
        "scalar" => &[],
        "" | "native" if is_native => {
            let widest = sets.iter().rposition(|set| is_available(set));
            widest.map_or(&[], |at| &sets[at..=at])
        }
        "" | "native" | "all" => sets,
        name => match sets.iter().position(|set| *set == name) {
            Some(at) => &sets[at..=at],
            None => {
                let known = sets.join(", ");
                println!(
                    "cargo::error=CLENCH_INSTRUCTIONS is `{name}`; it can be native, all, scalar, {known}"
                );
                exit(1);
            }
        },
    };
    for set in chosen {
        println!("cargo::rustc-cfg=lanes=\"{set}\"");
    }
    // Where one set is compiled, one environment in single precision uses it too: its kernels need no scalar form.
    let single = match chosen {
        [set] => set,
        _ => "scalar",
    };
    println!("cargo::rustc-cfg=single=\"{single}\"");
    // Derivatives of a step are the longest to compile, and their scalar form takes almost three times as long as lanes.
    // They are compiled for one set: in a debug build, which runs where it is built, for the widest; in a build for all
    // sets for the narrowest.
    let is_debug = var("PROFILE").is_ok_and(|profile| profile == "debug");
    let of_derivatives = match is_debug {
        true => chosen.iter().rfind(|set| is_available(set)),
        false => chosen.first(),
    };
    let of_derivatives = of_derivatives.unwrap_or(&"scalar");
    println!("cargo::rustc-cfg=derivatives=\"{of_derivatives}\"");
}

/// Returns whether the building processor has an instruction set, as `Avx2::detected` and `Avx512::detected` decide it.
fn is_available(set: &str) -> bool {
    #[cfg(target_arch = "x86_64")]
    let available = match set {
        "avx2" => is_x86_feature_detected!("avx2"),
        "avx512" => {
            is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512dq")
                && is_x86_feature_detected!("avx512bw")
                && is_x86_feature_detected!("avx512vl")
                && is_x86_feature_detected!("avx2")
                && is_x86_feature_detected!("fma")
                && is_x86_feature_detected!("f16c")
        }
        _ => false,
    };
    #[cfg(not(target_arch = "x86_64"))]
    let available = set == "neon" || set == "portable";
    available
}
