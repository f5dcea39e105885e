//! `cargo xtask docs`: the site, made by Sphinx of pages, notebooks and docstrings.

use crate::package;
use crate::python::{install, interpreter, prepare};
use crate::run::{Profile, command, root, run, target};

/// Where the packages lie that build the site: nothing else needs them.
const FOLDER: &str = ".venv/docs";

/// Builds the site in `target/site`.
///
/// # Errors
/// What could not be installed, a notebook that fails, a page that is missing or links to one that is.
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
    // Where the kernel is that runs notebooks.
    sphinx.env("JUPYTER_PATH", packages.join("share/jupyter"));
    run(sphinx)?;
    println!("open {}", site.join("docs/site/index.html").display());
    Ok(())
}
