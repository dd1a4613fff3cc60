//! What colours show.

use crate::cli::choices::ColorByArg;
use crate::cli::parse::range;
use clap::Args;
use osculate::{ColorRange, Colormap, Error};

#[derive(Debug, Args)]
#[command(next_help_heading = "Output")]
pub(in crate::cli) struct ColorsArgs {
    /// Quantity that the colours show
    #[arg(long, value_enum, value_name = "QUANTITY", default_value_t = ColorByArg::Mean)]
    pub(in crate::cli) color_by: ColorByArg,

    /// Colours; default: blue-red for signed quantities, viridis for others, one colour per class
    #[arg(long, value_name = "NAME", value_parser = clap::builder::PossibleValuesParser::new(Colormap::names()))]
    colormap: Option<String>,

    /// Values of the first and last colour, in the quantity's unit in the input; auto takes the 95th
    /// percentile of the magnitudes. Of several variants it is the first's
    #[arg(long, value_name = "LOW:HIGH|auto", value_parser = range, default_value = "auto", allow_hyphen_values = true)]
    pub(in crate::cli) range: ColorRange,
}

impl ColorsArgs {
    pub(in crate::cli) fn colormap(&self) -> Result<Option<Colormap>, Error> {
        self.colormap.as_deref().map(Colormap::named).transpose()
    }
}
