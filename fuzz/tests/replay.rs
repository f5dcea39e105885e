//! Replays the committed inputs of every target: seeds, which it accepts unless they are called `bad-...`, and
//! regressions, which once failed.

use clench_fuzz::TARGETS;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// The time limit of an input, for a slow and busy machine without optimisation: the same as in `cargo xtask fuzz`.
const LONGEST: Duration = Duration::from_secs(10);

fn here() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten();
    let paths = entries.map(|entry| entry.expect("a readable folder").path());
    let mut files: Vec<PathBuf> = paths.filter(|path| path.is_file()).collect();
    files.sort();
    files
}

fn run(target: &str, path: &Path) -> bool {
    let (_, read) = (TARGETS.into_iter().find(|(name, _)| *name == target)).expect("a target");
    let bytes = fs::read(path).expect("a readable file");
    println!("{}", path.display());
    let begin = Instant::now();
    let accepted = read(&bytes);
    let took = begin.elapsed();
    assert!(took < LONGEST, "{} took {took:?}", path.display());
    accepted
}

fn replay(target: &str) {
    let seeds = files(&here().join("seeds").join(target));
    assert!(!seeds.is_empty(), "no seeds of {target}");
    for path in seeds {
        let name = path.file_name().expect("a name").to_string_lossy();
        let good = !name.starts_with("bad-");
        assert_eq!(run(target, &path), good, "{}", path.display());
    }
    for path in files(&here().join("regressions").join(target)) {
        run(target, &path);
    }
}

macro_rules! replays {
    ($($target:ident)*) => {
        $(
            #[test]
            fn $target() {
                replay(stringify!($target));
            }
        )*

        #[test]
        fn no_target_is_omitted() {
            let replayed = [$(stringify!($target)),*];
            assert_eq!(TARGETS.map(|(name, _)| name), replayed);
        }
    };
}

replays! { mjcf urdf stl obj msh dae gltf png grid npy states contacts }

#[test]
fn the_models_of_the_repository_are_seeds_too() {
    for folder in ["models", "parity/models"] {
        for path in files(&here().join("..").join(folder)) {
            if path.extension().is_some_and(|extension| extension == "xml") {
                let read = run("mjcf", &path);
                // The target lacks the files that these models refer to.
                let text = std::fs::read_to_string(&path).expect("a model of ours is text");
                assert!(read || text.contains(" file=\""), "{}", path.display());
            }
        }
    }
}
