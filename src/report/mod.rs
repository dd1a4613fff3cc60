//! The report: one HTML file that shows a mesh and its curvature, and pictures without a browser.

mod display;
mod facts;
mod pack;
mod page;
mod raster;
mod subject;
mod thin;

pub use raster::{PictureOptions, ViewFrom};

use crate::color::{self, ColorRange, ColorScale, Colormap};
use crate::curvature::CurvatureOptions;
use crate::error::Error;
use crate::io::{Output, ReadOptions};
use crate::mesh::{MeshOptions, MeshReport};
use crate::progress::{Progress, Stage};
use crate::quantity::Quantity;
use crate::soup::Note;
use crate::space::{Unit, UpAxis};
use display::Display;
use page::Model;
use std::path::{Path, PathBuf};
use std::time::Instant;
use subject::Subject;

/// Settings for [`report`].
#[derive(Clone, Debug, PartialEq)]
pub struct ReportOptions {
    /// How to read the inputs.
    pub read: ReadOptions,
    /// Welding and edge kinds.
    pub mesh: MeshOptions,
    /// Estimation.
    pub curvature: CurvatureOptions,
    /// Take the values that a glTF input carries from an earlier run, where it does; the default.
    pub reuse: bool,
    /// The quantity that colours show first.
    pub color_by: Quantity,
    /// The colour map to begin with; `None` for the quantity's own.
    pub colormap: Option<Colormap>,
    /// The values at the ends of the colour map to begin with.
    pub range: ColorRange,
    /// The inputs' up axis; `None` for Z in STL and 3MF and Y in everything else.
    pub up: Option<UpAxis>,
    /// The inputs' unit, which numbers are shown with; `None` where it is not known.
    pub unit: Option<Unit>,
    /// Faces that a page draws of each mesh; one with more is thinned for display.
    pub most_faces: usize,
    /// The picture, where one is wanted.
    pub picture: PictureOptions,
}

/// Browsers on ordinary machines hold and draw so many faces with ease.
const MOST_FACES: usize = 3_000_000;

impl Default for ReportOptions {
    fn default() -> Self {
        ReportOptions {
            read: ReadOptions::default(),
            mesh: MeshOptions::default(),
            curvature: CurvatureOptions::default(),
            reuse: true,
            color_by: Quantity::Mean,
            colormap: None,
            range: ColorRange::Auto,
            up: None,
            unit: None,
            most_faces: MOST_FACES,
            picture: PictureOptions::default(),
        }
    }
}

impl ReportOptions {
    /// Checks all that can be checked before a file is read.
    ///
    /// # Errors
    /// [`Error::Usage`] with the option and its range.
    pub fn check(&self) -> Result<(), Error> {
        self.mesh.check()?;
        self.curvature.check()?;
        self.picture.check()?;
        if !(1000..=16_000_000).contains(&self.most_faces) {
            return Err(Error::Usage("--max-faces must be 1000 to 16000000".into()));
        }
        if self.color_by == Quantity::Class && self.colormap.is_some() {
            return Err(Error::Usage("classes have colours of their own; leave --colormap out".into()));
        }
        color::check(self.color_by, self.range)
    }
}

/// What a report was made of.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Reported {
    /// The meshes and their defects, in the order of the inputs.
    pub reports: Vec<MeshReport>,
    /// What is worth knowing of each.
    pub notes: Vec<Vec<Note>>,
    /// True when something was repaired or skipped, or a mesh has defects (exit code 3).
    pub has_defects: bool,
    /// Wall-clock seconds of everything.
    pub seconds: f64,
}

/// Makes a page of one mesh, or of two side by side, and a picture of the first. `-` is standard input.
///
/// The picture is a PNG as the page would show the mesh, rendered without a browser.
///
/// # Errors
/// Any [`Error`]; nothing is then written, and what stood at the destinations is still there.
pub fn report(
    inputs: &[PathBuf],
    page: Option<Output>,
    picture: Option<Output>,
    options: &ReportOptions,
    progress: &dyn Progress,
) -> Result<Reported, Error> {
    options.check()?;
    if inputs.is_empty() || inputs.len() > 2 {
        return Err(Error::Usage("a report shows one mesh, or two side by side".into()));
    }
    if inputs.iter().filter(|input| *input == Path::new("-")).count() > 1 {
        return Err(Error::Usage("standard input can be read only once".into()));
    }
    let start = Instant::now();
    let outputs: Vec<PathBuf> = [&page, &picture].into_iter().flatten().map(|out| out.path().to_path_buf()).collect();
    let mut done = Reported { reports: Vec::new(), notes: Vec::new(), has_defects: false, seconds: 0.0 };
    let mut models = Vec::new();
    let mut pictured = Vec::new();
    for (i, input) in inputs.iter().enumerate() {
        let subject = Subject::load(input, &outputs, options, progress)?;
        progress.begin(Stage::Write, 0);
        if picture.is_some() && i == 0 {
            pictured = picture_of(&subject, options)?;
        }
        if page.is_some() {
            models.push(model(&subject, options));
        }
        progress.end();
        done.has_defects |= subject.has_defects();
        done.reports.push(subject.mesh.report().clone());
        done.notes.push(subject.notes);
    }
    let mut page = page;
    let mut picture = picture;
    if let Some(out) = &mut page {
        page::write(out, &facts::shared(options), &models).map_err(|e| out.error(e))?;
    }
    if let Some(out) = &mut picture {
        std::io::Write::write_all(out, &pictured).map_err(|e| out.error(e))?;
    }
    Output::finish_all(page.into_iter().chain(picture).collect())?;
    done.seconds = start.elapsed().as_secs_f64();
    Ok(done)
}

fn model(subject: &Subject, options: &ReportOptions) -> Model {
    let display = Display::new(subject, options.most_faces);
    let packed = pack::pack(&subject.mesh, &subject.values, &display);
    Model { facts: facts::of(subject, &display, &packed), arrays: packed.arrays }
}

fn picture_of(subject: &Subject, options: &ReportOptions) -> Result<Vec<u8>, Error> {
    let colors = ColorScale::new(options.color_by, options.colormap, options.range, &subject.values)?;
    let display = Display::new(subject, usize::MAX);
    Ok(raster::picture(subject, &display, &colors, &options.picture))
}
