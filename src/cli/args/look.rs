//! What is written, and how it looks.

use super::SpaceArgs;
use crate::cli::choices::{CarrierArg, ColorByArg, LayoutArg};
use crate::cli::parse::{quantity, range};
use clap::Args;
use osculate::{Colormap, Range, Selection};

#[derive(Debug, Args)]
#[command(next_help_heading = "Output")]
pub(in crate::cli) struct LookArgs {
    #[command(flatten)]
    pub(super) space: SpaceArgs,

    /// Quantities to write, separated by commas: face, class, k_max, k_min, mean, gauss,
    /// gauss_perimeter, shape_index, curvedness, dir_max, dir_min, radius, coverage, method, confidence; or default, all,
    /// none
    #[arg(long, value_name = "LIST", value_parser = Selection::parse, default_value = "default")]
    pub(super) attributes: Selection,

    /// Quantity that the colours show
    #[arg(long, value_enum, value_name = "QUANTITY", default_value_t = ColorByArg::Mean)]
    pub(super) color_by: ColorByArg,

    /// Quantities between whose colours a viewer of a glTF file can choose (KHR_materials_variants),
    /// separated by commas; --color-by is shown first where it is among them, otherwise the first is
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = quantity)]
    pub(super) variants: Vec<osculate::Quantity>,

    /// Colours; default: blue-red for signed quantities, viridis for others, one colour per class
    #[arg(long, value_name = "NAME", value_parser = clap::builder::PossibleValuesParser::new(Colormap::names()))]
    pub(super) colormap: Option<String>,

    /// Values of the first and last colour, in the quantity's unit in the input; auto takes the 95th
    /// percentile of the magnitudes. Of several variants it is the first's
    #[arg(long, value_name = "LOW:HIGH|auto", value_parser = range, default_value = "auto", allow_hyphen_values = true)]
    pub(super) range: Range,

    /// How glTF carries the colours: a palette texture (right everywhere), vertex colours in linear
    /// light (by the specification), vertex colours in sRGB (for MeshLab), or not at all
    #[arg(long, value_enum, value_name = "CARRIER", default_value_t = CarrierArg::Texture)]
    pub(super) color: CarrierArg,

    /// How glTF attaches values to faces: vertices of its own for every face with values as attributes
    /// (right in every client), or vertices shared as in the input and values in an extension of the
    /// primitive (under half the size, without colours, for readers that know it)
    #[arg(long, value_enum, value_name = "LAYOUT", default_value_t = LayoutArg::Faces)]
    pub(super) layout: LayoutArg,

    /// Also write values of vertices: the mean of the faces around, by area. glTF: attributes ..._VERTEX;
    /// PLY: vertex quality and properties; NPZ: arrays vertex_...
    #[arg(long)]
    pub(super) vertex_values: bool,

    /// Replace attributes of a glTF input that have one of the names above but come from elsewhere;
    /// without it they stay and Osculate's are left out
    #[arg(long)]
    pub(super) force: bool,
}
