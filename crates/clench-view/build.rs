//! Embeds the viewer's page, if it was built: see `src/page.rs`.

use std::path::Path;
use std::{env, fs};

fn main() {
    // The folder is always there; cargo looks into it for what is new.
    let folder = Path::new("../../web/dist");
    println!("cargo::rerun-if-changed={}", folder.display());
    let page = fs::read(folder.join("index.html.gz")).unwrap_or_default();
    let out = env::var_os("OUT_DIR").expect("cargo sets it");
    fs::write(Path::new(&out).join("page.html.gz"), page).expect("the folder of a build script");
}
