//! The page that browsers load: one HTML document with its script in it.
//!
//! It is built from `web/` by Node and embedded when this crate is compiled, if it was there by then. In a checkout where it
//! was not, it is built when it is first needed.

use flate2::read::GzDecoder;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::{fs, io};

/// The page that was there when this crate was compiled, by gzip; empty if none was.
const EMBEDDED: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/page.html.gz"));
/// The folder of its source.
const SOURCE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../web");

/// Where data stand in a page: between these, and nothing in the page itself.
const BEFORE_DATA: &str = "<script id=\"recording\" type=\"application/json\">";
const AFTER_DATA: &str = "</script>";

/// The page.
#[derive(Clone, Debug)]
pub struct Page(String);

/// No page could be had.
#[derive(Debug, thiserror::Error)]
pub enum PageError {
    /// It was not built, and its source is not here.
    #[error(
        "the viewer's page is not part of this build: build it with `npm ci && npm run build` in web/ and compile again"
    )]
    NotBuilt,
    /// A program that builds it cannot be started.
    #[error(
        "the viewer's page has to be built once, which needs Node.js 20 or later with npm: {0}; install it, \
         on Debian with `apt-get install nodejs npm`"
    )]
    NoNode(io::Error),
    /// A program that builds it failed.
    #[error("`{0}` failed in {1}:\n{2}")]
    Failed(String, PathBuf, String),
    /// What was built has no place for the data of a recording: its source was another version's.
    #[error(
        "the viewer's page was built by another version: build it with `npm ci && npm run build` in web/ and compile again"
    )]
    Version,
    /// The embedded page cannot be decompressed.
    #[error("the viewer's page in this program is damaged ({0}): compile it again")]
    Damaged(io::Error),
    /// What was built cannot be read.
    #[error("{0}: {1}")]
    Unreadable(PathBuf, io::Error),
}

impl Page {
    /// The embedded page, else the one in the source folder, which is built first if it is not there; `tell` is told when.
    ///
    /// # Errors
    /// That there is none, and what to do about it.
    pub fn find(tell: impl Fn(&str)) -> Result<Self, PageError> {
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
            tell(
                "building the viewer's page, once (npm fetches three packages and their tools) ...",
            );
            npm(source, &["ci", "--no-audit", "--no-fund"])?;
            npm(source, &["run", "build"])?;
        }
        let text = fs::read_to_string(&built);
        Page::of(text.map_err(|error| PageError::Unreadable(built, error))?)
    }

    /// The page of this text.
    ///
    /// # Errors
    /// A text without a place for data.
    pub fn of(text: impl Into<String>) -> Result<Self, PageError> {
        let text = text.into();
        let place = format!("{BEFORE_DATA}{AFTER_DATA}");
        match text.contains(&place) {
            true => Ok(Page(text)),
            false => Err(PageError::Version),
        }
    }

    /// Its HTML.
    pub fn html(&self) -> &str {
        &self.0
    }

    /// The page with data in it, which it shows instead of connecting to a server.
    pub(crate) fn with_data(&self, json: &str) -> String {
        // A script ends at `</`, wherever that stands.
        let data = json.replace("</", "<\\/");
        (self.0).replacen(BEFORE_DATA, &format!("{BEFORE_DATA}{data}"), 1)
    }

    /// The data that such a page has.
    pub(crate) fn data(html: &str) -> Option<&str> {
        let (_, rest) = html.split_once(BEFORE_DATA)?;
        // JSON may hold `<\/` wherever it holds `</`.
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
    let said = [output.stdout, output.stderr].concat();
    let said = String::from_utf8_lossy(&said).trim().to_owned();
    let command = format!("npm {}", arguments.join(" "));
    Err(PageError::Failed(command, source.to_path_buf(), said))
}
