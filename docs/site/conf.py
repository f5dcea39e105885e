"""Settings of the site, which `cargo xtask docs` builds with Sphinx from the root of the repository."""

import clench

project = "Clench"
author = "The Clench authors"
release = clench.__version__

extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
root_doc = "docs/site/index"
# Pages stay at their paths in the repository, so that links between them work there and on the site.
include_patterns = [
    "README.md",
    "docs/*.md",
    "docs/lab/*.md",
    "docs/notebooks/*.ipynb",
    "docs/site/index.md",
    "docs/site/python.md",
    "docs/site/gallery/index.md",
    "python/README.md",
    "models/README.md",
]
exclude_patterns = ["target", ".venv", ".git", "web", "crates", "fuzz", "parity", "bench", "xtask"]

html_theme = "furo"
html_title = "Clench"

myst_heading_anchors = 3
nb_execution_mode = "force"
nb_execution_raise_on_error = True
autodoc_member_order = "bysource"
autodoc_typehints = "none"
autodoc_mock_imports = ["torch", "jax", "unisim"]  # Large, and not needed to read its docstrings.
napoleon_google_docstring = False
# Links to code and folders lead to files that are not pages, and the highlighter does not know all syntax of Rust.
suppress_warnings = ["myst.xref_missing", "misc.highlighting_failure"]
