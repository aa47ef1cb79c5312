//! Grids of values over the map: heights, classes of soil, moistures.
//!
//! A grid is read from an ASCII grid (`.asc`), a GeoTIFF (`.tif`) or a grey picture (`.png`), and is refused, by the name of
//! the parameter and with what was found, where it does not say what it has to. What a file marks as not known is NaN.

mod ascii;
mod ellipsoid;
mod geotiff;
mod grid;
mod picture;
mod smooth;

pub use ellipsoid::plane;
pub use grid::Raster;
pub use picture::Picture;
pub use smooth::{Smooth, Smoothed};

use headland_plugin::Refusal;
use std::path::Path;

/// Reads `folder/file`; `picture` says what a picture cannot say itself, and is for pictures alone.
///
/// # Errors
/// [`Refusal`] of `file`, or of `cell_m` where a picture has none or another file has one.
pub fn read(folder: &Path, file: &str, picture: Option<&Picture>) -> Result<Raster, Refusal> {
    let source = Source { path: &folder.join(file), file };
    let extension = Path::new(file).extension().and_then(|extension| extension.to_str()).unwrap_or("");
    let kind = extension.to_ascii_lowercase();
    if kind == "png" {
        let Some(picture) = picture else {
            return Err(refuse(
                "cell_m",
                "not given".to_owned(),
                "it: a picture does not say how far its pixels are apart",
            ));
        };
        return picture::read(&source, picture);
    }
    if picture.is_some() {
        return Err(refuse(
            "cell_m",
            format!("given beside `{file}`"),
            "it for pictures alone: the file knows",
        ));
    }
    match kind.as_str() {
        "asc" => ascii::read(&source),
        "tif" | "tiff" => geotiff::read(&source),
        _ => Err(source.refuse("of a kind that is not known", "a file that ends in .asc, .tif or .png")),
    }
}

fn refuse(parameter: &str, found: String, expected: &str) -> Refusal {
    Refusal { parameter: parameter.to_owned(), found, expected: expected.to_owned() }
}

/// A file that is read.
pub(crate) struct Source<'a> {
    pub path: &'a Path,
    /// As the scenario names it.
    pub file: &'a str,
}

impl Source<'_> {
    pub fn refuse(&self, found: &str, expected: &str) -> Refusal {
        refuse("file", format!("`{}`, {found}", self.file), expected)
    }

    pub fn unreadable(&self, error: &dyn std::fmt::Display, expected: &str) -> Refusal {
        self.refuse(&format!("which cannot be read: {error}"), expected)
    }
}
