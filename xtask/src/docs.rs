//! `cargo xtask docs`: the site, built by Sphinx from pages, notebooks and docstrings.

use crate::package;
use crate::python::{install, interpreter, prepare};
use crate::run::{Profile, command, root, run, target};

/// The folder of the packages that only the site needs.
const FOLDER: &str = ".venv/docs";

/// Builds the site in `target/site`.
///
/// # Errors
/// Returns an error if an installation or a notebook fails, or a page is missing or links to a missing one.
pub(crate) fn build() -> Result<(), String> {
    prepare()?;
    package::install(Profile::Release)?;
    install("docs.txt", &["--upgrade", "--target", FOLDER])?;
    let packages = root().join(FOLDER);
    let mut gallery = command(interpreter(), &["docs/site/gallery.py"]);
    gallery.env("PYTHONPATH", &packages);
    run(gallery)?;
    let site = target().join("site");
    let mut sphinx = command(interpreter(), &["-m", "sphinx", "--quiet", "-W"]);
    sphinx.args(["--keep-going", "-b", "html", "-c", "docs/site", "."]);
    sphinx.arg(&site);
    sphinx.env("PYTHONPATH", &packages);
    // The location of the kernel that runs notebooks.
    sphinx.env("JUPYTER_PATH", packages.join("share/jupyter"));
    run(sphinx)?;
    println!("open {}", site.join("docs/site/index.html").display());
    Ok(())
}
