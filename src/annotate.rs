//! The main job as a list of verbs: read, weld, estimate, colour, write.

use crate::annotation::{Annotation, ColorCarrier, Space, Unit, UpAxis};
use crate::color::{self, ColorScale, Colormap, Range};
use crate::curvature::{self, CurvatureOptions, FaceClass, FaceCurvature, Radius};
use crate::edge_lines::edge_layers;
use crate::error::Error;
use crate::io::{self, Destination, InputFormat, LineScene, Output, OutputFormat, ReadOptions};
use crate::mesh::{Mesh, MeshOptions};
use crate::progress::Progress;
use crate::quantity::{Quantity, Selection};
use crate::soup::Note;
use crate::statistics::{CurvatureSummary, Seconds, Summary};
use glam::DVec3;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Settings for [`annotate`].
#[derive(Clone, Debug, PartialEq)]
pub struct AnnotateOptions {
    /// How to read the input.
    pub read: ReadOptions,
    /// Welding and edge kinds.
    pub mesh: MeshOptions,
    /// Estimation.
    pub curvature: CurvatureOptions,
    /// Quantities to write.
    pub selection: Selection,
    /// The quantity that colours show; `None` for no colours. Default: mean.
    pub color_by: Option<Quantity>,
    /// The colour map; `None` for the quantity's own.
    pub colormap: Option<Colormap>,
    /// The values at the ends of the colour map.
    pub range: Range,
    /// How a glTF file carries colours.
    pub carrier: ColorCarrier,
    /// The input's up axis; `None` for Z in STL and Y in everything else.
    pub up: Option<UpAxis>,
    /// The input's unit; `None` leaves lengths as they are.
    pub unit: Option<Unit>,
    /// A `.glb` that gets the boundary, feature and non-manifold edges as lines.
    pub edges: Option<PathBuf>,
    /// With `edges`: the silhouette as well, for this direction from the viewer to the mesh, in the
    /// input's axes.
    pub view: Option<DVec3>,
    /// Files that the caller writes besides: none of them may be an input or another output.
    pub reserved: Vec<PathBuf>,
    /// Whether the summary is to have the percentiles of the values, which cost some sorting.
    pub summarise: bool,
}

impl Default for AnnotateOptions {
    fn default() -> Self {
        AnnotateOptions {
            read: ReadOptions::default(),
            mesh: MeshOptions::default(),
            curvature: CurvatureOptions::default(),
            selection: Selection::default(),
            color_by: Some(Quantity::Mean),
            colormap: None,
            range: Range::Auto,
            carrier: ColorCarrier::Texture,
            up: None,
            unit: None,
            edges: None,
            view: None,
            reserved: Vec::new(),
            summarise: true,
        }
    }
}

impl AnnotateOptions {
    /// Checks all that can be checked before a file is read.
    ///
    /// # Errors
    /// [`Error::Usage`] with the option and its range.
    pub fn check(&self) -> Result<(), Error> {
        self.mesh.check()?;
        if self.view == Some(DVec3::ZERO) {
            return Err(Error::Usage("a view direction must not be zero".into()));
        }
        if self.edges.as_ref().is_some_and(|path| path.extension().is_none_or(|e| !e.eq_ignore_ascii_case("glb"))) {
            return Err(Error::Usage("the edges are written as .glb; give their file that extension".into()));
        }
        self.curvature.check()?;
        if self.color_by == Some(Quantity::Class) && self.colormap.is_some() {
            return Err(Error::Usage("classes have colours of their own; leave --colormap out".into()));
        }
        self.color_by.map_or(Ok(()), |quantity| color::check(quantity, self.range))
    }

    /// The carrier, where there is something to carry.
    fn used_carrier(&self) -> Option<ColorCarrier> {
        self.color_by.map(|_| self.carrier)
    }

    /// From the input's axes and units to those of the output; CSV and PLY keep the input's.
    fn space(&self, input: InputFormat, output: OutputFormat) -> Result<Space, Error> {
        let space = Space::to_gltf(input, self.up, self.unit)?;
        Ok(if output.is_gltf() { space } else { Space::default() })
    }

    /// All that is needed to repeat a run, as it stands in files and statistics.
    fn provenance(&self) -> Value {
        let curvature = &self.curvature;
        let (radius, radius_factor) = match curvature.radius {
            Radius::Auto => (Some(json!("auto")), None),
            Radius::Length(length) => (Some(json!(length)), None),
            Radius::FaceFactor(factor) => (None, Some(format!("{factor}:face"))),
            Radius::MeshFactor(factor) => (None, Some(format!("{factor}:mesh"))),
        };
        json!({
            "estimator": curvature.estimator.name(),
            "radius": radius,
            "radius_factor": radius_factor,
            "diameters": curvature.diameters,
            "class_tolerance": curvature.class_tolerance,
            "feature_angle": self.mesh.feature_angle,
            "weld": self.mesh.weld,
            "up": self.up,
            "unit": self.unit,
            "attributes": self.selection,
            "color_by": self.color_by.map(Quantity::token),
            "colormap": self.colormap.map(Colormap::name),
            "range": match self.range {
                Range::Auto => json!("auto"),
                Range::Fixed(low, high) => json!([low, high]),
            },
            "color": self.carrier,
        })
    }
}

/// Annotates one file; `-` is standard input.
///
/// # Errors
/// Any [`Error`]; nothing is then written, and what stood at the destination is still there.
pub fn annotate(
    input: &Path,
    destination: &Destination,
    format: OutputFormat,
    options: &AnnotateOptions,
    progress: &dyn Progress,
) -> Result<Summary, Error> {
    options.check()?;
    destination.check_folder()?;
    let start = Instant::now();
    let (soup, input_format) = io::read_with(input, &options.read, progress)?;
    let space = options.space(input_format, format)?;
    let others: Vec<PathBuf> = options.edges.iter().chain(&options.reserved).cloned().collect();
    destination.check(format, &others, input, &soup)?;
    io::check_size(format, soup.face_count(), &options.selection, options.used_carrier())?;
    // Opened before any work, put in its place after the main output.
    let mut edges = options.edges.as_deref().map(Output::create).transpose()?;
    let mut notes = soup.notes.clone();
    let read = start.elapsed();

    let mesh = Mesh::from_soup(&soup, &options.mesh).map_err(|e| e.in_file(input))?;
    drop(soup);
    let weld = start.elapsed();

    let values = curvature::estimate(&mesh, &options.curvature, progress)?;
    let estimate = start.elapsed();

    let colors = match options.color_by {
        Some(quantity) => Some(ColorScale::new(quantity, options.colormap, options.range, &values)?),
        None => None,
    };
    let annotation = Annotation {
        mesh: &mesh,
        values: &values,
        name: io::mesh_name(input),
        selection: options.selection.clone(),
        colors,
        carrier: options.carrier,
        space,
        provenance: options.provenance(),
    };
    notes.extend(mesh.report().remarks().into_iter().map(Note::info));
    notes.extend(note_of_low_coverage(&values));
    notes.extend(annotation.note_of_missing_face_numbers(format));
    if let Some(out) = &mut edges {
        let layers = edge_layers(&mesh, options.view);
        let space = Space::to_gltf(input_format, options.up, options.unit)?;
        let scene = LineScene { layers: &layers, origin: mesh.origin(), space, extras: annotation.extras() };
        io::write_lines(&scene, out)?;
    }
    io::write(&annotation, format, destination, progress)?;
    edges.map_or(Ok(()), Output::finish)?;
    let write = start.elapsed();

    Ok(Summary {
        schema: 1,
        version: env!("CARGO_PKG_VERSION"),
        input: input.display().to_string(),
        format: input_format,
        report: mesh.report().clone(),
        notes,
        settings: annotation.provenance.clone(),
        legend: annotation.legend(),
        units: annotation.units(),
        curvature: options.summarise.then(|| CurvatureSummary::of(&values)),
        seconds: Seconds::from_marks(read, weld, estimate, write),
    })
}

/// Says so where borders and sharp edges leave many disks less than half.
fn note_of_low_coverage(values: &[FaceCurvature]) -> Option<Note> {
    let estimated = values.iter().filter(|v| v.is_estimated());
    // Flat faces lose nothing by it.
    let low = estimated.filter(|v| v.coverage < 0.5 && v.class != FaceClass::Flat).count();
    (10 * low > values.len()).then(|| {
        Note::info(format!(
            "{low} of {} faces are not flat and have coverage below 0.5: borders or sharp edges cut most of their disk off; a smaller --radius may tell more of them",
            values.len()
        ))
    })
}
