//! The page that browsers load: one HTML document that includes its script.
//!
//! Node builds it from `web/`. A page that exists when this crate is compiled is embedded; otherwise a checkout builds
//! it on first use.

use flate2::read::GzDecoder;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::{fs, io};

/// The page that existed when this crate was compiled, compressed by gzip; empty if there was none.
const EMBEDDED: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/page.html.gz"));
/// The source folder of the page.
const SOURCE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../web");

/// The markers before and after the data of a recording; in a page without data they are adjacent.
const BEFORE_DATA: &str = "<script id=\"recording\" type=\"application/json\">";
const AFTER_DATA: &str = "</script>";

/// The page.
#[derive(Clone, Debug)]
pub struct Page(String);

/// An error of finding the page.
#[derive(Debug, thiserror::Error)]
pub enum PageError {
    /// The page was not built, and its source is not available.
    #[error(
        "the viewer's page is not part of this build: build it with `npm ci && npm run build` in web/ and compile again"
    )]
    NotBuilt,
    /// A program of the build cannot be started.
    #[error(
        "the viewer's page must be built once, which needs Node.js 20 or later with npm: {0}; install it, \
         on Debian with `apt-get install nodejs npm`"
    )]
    NoNode(io::Error),
    /// A program of the build failed.
    #[error("`{0}` failed in {1}:\n{2}")]
    Failed(String, PathBuf, String),
    /// The page lacks the markers for data because another version built it.
    #[error(
        "the viewer's page was built by another version: build it with `npm ci && npm run build` in web/ and compile again"
    )]
    Version,
    /// The embedded page cannot be decompressed.
    #[error("the viewer's page in this program is damaged ({0}): compile it again")]
    Damaged(io::Error),
    /// The page cannot be read.
    #[error("{0}: {1}")]
    Unreadable(PathBuf, io::Error),
}

impl Page {
    /// Returns the embedded page, or else the one in the source folder, which is built first if it is missing; `report`
    /// receives a message before a build.
    ///
    /// # Errors
    /// Returns an error with a remedy if no page is available.
    pub fn find(report: impl Fn(&str)) -> Result<Self, PageError> {
        if !EMBEDDED.is_empty() {
            let mut text = String::new();
            let read = GzDecoder::new(EMBEDDED).read_to_string(&mut text);
            return Page::of(read.map(|_| text).map_err(PageError::Damaged)?);
        }
        let source = Path::new(SOURCE);
        if !source.join("package.json").is_file() {
            return Err(PageError::NotBuilt);
        }
        let built = source.join("dist/index.html");
        if !built.is_file() {
            report(
                "building the viewer's page, once (npm fetches three packages and their tools) ...",
            );
            npm(source, &["ci", "--no-audit", "--no-fund"])?;
            npm(source, &["run", "build"])?;
        }
        let text = fs::read_to_string(&built);
        Page::of(text.map_err(|error| PageError::Unreadable(built, error))?)
    }

    /// Creates a page from HTML.
    ///
    /// # Errors
    /// Returns an error if the text lacks the markers for data.
    pub fn of(text: impl Into<String>) -> Result<Self, PageError> {
        let text = text.into();
        let placeholder = format!("{BEFORE_DATA}{AFTER_DATA}");
        match text.contains(&placeholder) {
            true => Ok(Page(text)),
            false => Err(PageError::Version),
        }
    }

    /// Returns the HTML.
    pub fn html(&self) -> &str {
        &self.0
    }

    /// Returns the parts before and after embedded data, which the page shows instead of connecting to a server.
    pub(crate) fn around_data(&self) -> (&str, &str) {
        let before = self
            .0
            .find(BEFORE_DATA)
            .map_or(0, |at| at + BEFORE_DATA.len());
        self.0.split_at(before)
    }

    /// Returns the data embedded in such a page.
    pub(crate) fn data(html: &str) -> Option<&str> {
        let (_, rest) = html.split_once(BEFORE_DATA)?;
        let (data, _) = rest.split_once(AFTER_DATA)?;
        (!data.is_empty()).then_some(data)
    }
}

fn npm(source: &Path, arguments: &[&str]) -> Result<(), PageError> {
    let mut npm = Command::new("npm");
    npm.args(arguments).current_dir(source);
    let output = npm.output().map_err(PageError::NoNode)?;
    if output.status.success() {
        return Ok(());
    }
    let output = [output.stdout, output.stderr].concat();
    let output = String::from_utf8_lossy(&output).trim().to_owned();
    let command = format!("npm {}", arguments.join(" "));
    Err(PageError::Failed(command, source.to_path_buf(), output))
}
