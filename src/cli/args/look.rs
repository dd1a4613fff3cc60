//! What is written, and how it looks.

use super::{AttributesArgs, ColorsArgs, SpaceArgs};
use crate::cli::choices::{CarrierArg, CompressArg, LayoutArg};
use crate::cli::parse::{shown, vector};
use clap::Args;
use glam::DVec3;
use osculate::{AnnotateOptions, Condition, Error};

#[derive(Debug, Args)]
#[command(next_help_heading = "Output")]
pub(in crate::cli) struct LookArgs {
    #[command(flatten)]
    space: SpaceArgs,

    #[command(flatten)]
    attributes: AttributesArgs,

    /// Write only the faces that fulfil a condition, such as class=hyperbolic or "k_max>0.1 and mean=-1:1".
    /// Comparisons, joined by and, of a CSV column with a number in the input's unit (=, !=, <, <=, >, >=),
    /// with a range LOW:HIGH (=, !=), or of class and method with names separated by commas. Values, colours
    /// and --edges stay those of the whole mesh
    #[arg(long, value_name = "CONDITION", allow_hyphen_values = true)]
    select: Option<Condition>,

    #[command(flatten)]
    pub(in crate::cli) colors: ColorsArgs,

    /// Quantities between whose colours a viewer of a glTF file can choose (KHR_materials_variants),
    /// separated by commas: mean, gauss, k_max, k_min, gauss_perimeter, shape_index, curvedness, class, coverage,
    /// confidence; --color-by is shown first where it is among them, otherwise the first is
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = shown)]
    variants: Vec<osculate::Quantity>,

    /// How glTF carries the colours: a palette texture (right everywhere), vertex colours in linear
    /// light (by the specification), vertex colours in sRGB (for MeshLab), or not at all
    #[arg(long, value_enum, value_name = "CARRIER", default_value_t = CarrierArg::Texture)]
    color: CarrierArg,

    /// How glTF attaches values to faces: vertices of its own for every face with values as attributes
    /// (right in every client), or vertices shared as in the input and values in an extension of the
    /// primitive (under half the size, without colours, for readers that know it)
    #[arg(long, value_enum, value_name = "LAYOUT", default_value_t = LayoutArg::Faces)]
    layout: LayoutArg,

    /// Also write values of vertices: the mean of the faces around, by area. glTF: attributes ..._VERTEX;
    /// PLY: vertex quality and properties; NPZ: arrays vertex_...
    #[arg(long)]
    vertex_values: bool,

    /// Also write the values of a glTF file as a table (EXT_mesh_features, EXT_structural_metadata), for
    /// CesiumJS and its kin; some 50 bytes more for each face
    #[arg(long)]
    metadata: bool,

    /// Compress what is added to a glTF file, for delivery over the web (EXT_meshopt_compression). Clients
    /// then lose: opening the file at all where they do not know the extension (MeshLab, Blender,
    /// trimesh, VTK and others refuse it); positions to less than 1/65536 of the mesh's size (those of a
    /// glTF input stay exact); curvatures and radii beyond 16 significant bits; directions, shares and
    /// shape index beyond 1/32768
    #[arg(long, value_enum, value_name = "METHOD", default_value_t = CompressArg::None)]
    compress: CompressArg,

    /// Replace attributes of a glTF input that have one of the names above but come from elsewhere;
    /// without it they stay and Osculate's are left out
    #[arg(long)]
    force: bool,

    /// With --edges: also the silhouette for this direction from the viewer to the mesh, in the
    /// input's axes
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, requires = "edges", allow_hyphen_values = true)]
    view: Option<DVec3>,
}

impl LookArgs {
    /// The library's options, without those of reading and estimating and without files that are written besides.
    pub(in crate::cli) fn options(&self) -> Result<AnnotateOptions, Error> {
        Ok(AnnotateOptions {
            select: self.select.clone(),
            selection: self.attributes.attributes.clone(),
            color_by: self.colors.color_by.into(),
            colormap: self.colors.colormap()?,
            range: self.colors.range,
            carrier: self.color.into(),
            variants: self.variants.clone(),
            layout: self.layout.into(),
            force: self.force,
            metadata: self.metadata,
            compress: self.compress.into(),
            up: self.space.up.map(Into::into),
            unit: self.space.unit.map(Into::into),
            vertex_values: self.vertex_values,
            view: self.view,
            ..AnnotateOptions::default()
        })
    }
}
