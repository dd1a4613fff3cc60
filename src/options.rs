//! All settings of a run, what of them can be checked before a file is read, and how files tell of them.

use crate::annotation::{ColorCarrier, LARGEST_EXACT_FACE, Layout};
use crate::color::{self, ColorRange, Colormap};
use crate::condition::Condition;
use crate::curvature::{CurvatureOptions, Estimator, Radius};
use crate::error::Error;
use crate::io::{self, Destination, InputFormat, OutputFormat, ReadOptions};
use crate::legend;
use crate::mesh::MeshOptions;
use crate::quantity::{Quantity, Selection};
use crate::space::{Space, Unit, UpAxis};
use glam::DVec3;
use serde_json::{Value, json};
use std::path::PathBuf;

/// Settings for [`annotate`](crate::annotate()).
#[derive(Clone, Debug, PartialEq)]
pub struct AnnotateOptions {
    /// How to read the input.
    pub read: ReadOptions,
    /// Welding and edge kinds.
    pub mesh: MeshOptions,
    /// Estimation.
    pub curvature: CurvatureOptions,
    /// The faces that the output gets; `None`: all. Values, colours and `edges` are those of the whole mesh.
    pub select: Option<Condition>,
    /// Quantities to write.
    pub selection: Selection,
    /// The quantity that colours show; `None` for no colours. Default: mean.
    pub color_by: Option<Quantity>,
    /// Quantities between whose colours a viewer of a glTF file can choose. Where `color_by` is among
    /// them it is the one shown first, otherwise the first is. Empty: only `color_by`.
    pub variants: Vec<Quantity>,
    /// The colour map; `None` for the quantity's own.
    pub colormap: Option<Colormap>,
    /// The values at the ends of the colour map of the quantity shown first; other variants have
    /// automatic ones.
    pub range: ColorRange,
    /// How a glTF file carries colours.
    pub carrier: ColorCarrier,
    /// How a glTF file attaches values to faces.
    pub layout: Layout,
    /// Replace attributes of a glTF input that have a name of ours but were not written by Osculate;
    /// otherwise they stay and ours are left out.
    pub force: bool,
    /// Also write the values into a glTF file as a table of `EXT_structural_metadata`, whose rows the faces
    /// name by `EXT_mesh_features`.
    pub metadata: bool,
    /// Compress a glTF file with `EXT_meshopt_compression`, which rounds positions and values
    /// (docs/file-format.md).
    pub compress: bool,
    /// The input's up axis; `None` for Z in STL and 3MF and Y in everything else.
    pub up: Option<UpAxis>,
    /// The input's unit; `None` leaves lengths as they are.
    pub unit: Option<Unit>,
    /// Take the values that a glTF input carries from an earlier run instead of estimating.
    pub reuse: bool,
    /// Also write the area-weighted mean of the faces around every vertex.
    pub vertex_values: bool,
    /// A `.png` or `.svg` that gets a picture of the colour scales.
    pub legend: Option<PathBuf>,
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
            select: None,
            selection: Selection::default(),
            color_by: Some(Quantity::Mean),
            variants: Vec::new(),
            colormap: None,
            range: ColorRange::Auto,
            carrier: ColorCarrier::Texture,
            layout: Layout::Faces,
            force: false,
            metadata: false,
            compress: false,
            up: None,
            unit: None,
            reuse: false,
            vertex_values: false,
            legend: None,
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
        if let Some(path) = &self.legend {
            legend::check(path)?;
            if self.shown().is_empty() {
                return Err(Error::Usage("--color-by none has no legend; leave --legend out".into()));
            }
        }
        if self.variants.len() > 1 && self.carrier != ColorCarrier::Texture {
            return Err(Error::Usage("several variants need --color texture; vertices have one colour".into()));
        }
        if !self.variants.is_empty() && self.layout == Layout::Indexed {
            return Err(Error::Usage("layout indexed carries no colours; leave --variants out".into()));
        }
        if self.metadata && self.layout == Layout::Indexed {
            let what =
                "--metadata numbers the vertices of each face, which layout indexed shares; leave one of them out";
            return Err(Error::Usage(what.into()));
        }
        let shown = self.shown();
        if shown == [Quantity::Class] && self.colormap.is_some() {
            return Err(Error::Usage("classes have colours of their own; leave --colormap out".into()));
        }
        (shown.into_iter().enumerate()).try_for_each(|(i, quantity)| color::check(quantity, self.range_of(i)))
    }

    /// The same for an output of a format.
    ///
    /// # Errors
    /// [`Error::Usage`] with the option.
    pub fn check_for(&self, format: OutputFormat) -> Result<(), Error> {
        self.check()?;
        if !format.is_gltf() && (self.metadata || self.compress) {
            return Err(Error::Usage("--metadata and --compress are for .glb and .gltf; leave them out".into()));
        }
        Ok(())
    }

    /// All files that a run writes: the output with what lies beside it, and what is written besides. A `.gltf` past
    /// two gigabytes has further buffers.
    pub fn files(&self, destination: &Destination, format: OutputFormat) -> Vec<PathBuf> {
        let has_palettes = self.carrier == ColorCarrier::Texture && self.layout == Layout::Faces;
        let shown = if has_palettes { self.shown() } else { Vec::new() };
        let maps: Vec<Colormap> = shown.into_iter().map(|quantity| Colormap::of(quantity, self.colormap)).collect();
        let besides = self.legend.iter().chain(&self.edges).chain(&self.reserved).cloned();
        destination.usual_files(format, &maps).into_iter().chain(besides).collect()
    }

    /// The default estimator has the perimeter estimate only where it is asked for: it costs a walk.
    pub(crate) fn with_perimeter_if_wanted(&self) -> AnnotateOptions {
        let mut options = self.clone();
        if options.curvature.estimator == Estimator::Auto {
            let quantity = Quantity::GaussPerimeter;
            options.curvature.perimeter |= options.selection.names(quantity) || options.shown().contains(&quantity);
            if !options.curvature.perimeter {
                options.selection = options.selection.without(quantity);
            }
            options.curvature.perimeter |= options.select.as_ref().is_some_and(|select| select.uses(quantity));
        }
        options
    }

    /// The quantities that colours show, the first one first, each once.
    pub(crate) fn shown(&self) -> Vec<Quantity> {
        let first = match self.variants.as_slice() {
            [] => self.color_by,
            [first, ..] => Some(self.color_by.filter(|quantity| self.variants.contains(quantity)).unwrap_or(*first)),
        };
        let mut shown: Vec<Quantity> = Vec::new();
        for quantity in first.into_iter().chain(self.variants.iter().copied()) {
            if !shown.contains(&quantity) {
                shown.push(quantity);
            }
        }
        shown
    }

    /// The range of a colour scale: the one asked for is that of the first, whose unit it has.
    pub(crate) fn range_of(&self, scale: usize) -> ColorRange {
        if scale == 0 { self.range } else { ColorRange::Auto }
    }

    /// Refuses more faces than the format can hold.
    pub(crate) fn check_size(&self, format: OutputFormat, faces: usize) -> Result<(), Error> {
        if self.metadata && faces > LARGEST_EXACT_FACE {
            return Err(Error::TooLarge(format!(
                "--metadata numbers faces in 32-bit floats, exact to {LARGEST_EXACT_FACE}, and there are {faces}: leave it out, or write fewer faces with --select"
            )));
        }
        // Compressed it will be smaller, nobody knows by how much.
        let smallest = if self.compress { 0 } else { faces };
        io::check_size(format, self.layout, smallest, &self.selection, self.color_bytes())
    }

    /// Bytes that colours take in each vertex.
    fn color_bytes(&self) -> u64 {
        match self.carrier {
            _ if self.layout == Layout::Indexed => 0,
            ColorCarrier::Texture => 8 * self.shown().len() as u64,
            ColorCarrier::Vertex | ColorCarrier::VertexSrgb => 4,
            ColorCarrier::None => 0,
        }
    }

    /// From the input's axes and units to those of the output; CSV and PLY keep the input's.
    pub(crate) fn space(&self, input: InputFormat, output: OutputFormat) -> Result<Space, Error> {
        let space = Space::to_gltf(input, self.up, self.unit)?;
        Ok(if output.is_gltf() { space } else { space.kept() })
    }

    /// The settings that decide the values, as they stand in files and statistics.
    pub fn settings_of_estimation(&self) -> Value {
        let mut all = self.provenance();
        OF_ESTIMATION.into_iter().map(|name| (name, all[name].take())).collect()
    }

    /// All that is needed to repeat a run, as it stands in files and statistics.
    pub(crate) fn provenance(&self) -> Value {
        let curvature = &self.curvature;
        let (radius, radius_factor) = match curvature.radius {
            Radius::Auto => (Some(json!("auto")), None),
            Radius::Length(length) => (Some(json!(length)), None),
            Radius::FaceFactor(factor) => (None, Some(format!("{factor}:face"))),
            Radius::MeshFactor(factor) => (None, Some(format!("{factor}:mesh"))),
        };
        let mut all = json!({
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
                ColorRange::Auto => json!("auto"),
                ColorRange::Fixed(low, high) => json!([low, high]),
            },
            "color": self.carrier,
            "variants": self.variants,
            "layout": self.layout,
        });
        if self.metadata {
            all["metadata"] = true.into();
        }
        if self.compress {
            all["compress"] = "meshopt".into();
        }
        if let Some(select) = &self.select {
            all["select"] = select.to_string().into();
        }
        all
    }
}

/// The settings that decide the values, by their names in files, which are those of the command line too.
pub(crate) const OF_ESTIMATION: [&str; 7] =
    ["estimator", "radius", "radius_factor", "diameters", "class_tolerance", "feature_angle", "weld"];

/// Values that are used again were estimated with the settings of their own run.
pub(crate) fn keep_settings(provenance: &mut Value, own: &Value) {
    for name in OF_ESTIMATION {
        provenance[name] = own.get(name).cloned().unwrap_or_default();
    }
}
