//! Options with a fixed set of values, and what each value stands for in the library.

use clap::ValueEnum;
use osculate::{Along, ColorCarrier, Estimator, InputFormat, Layout, OutputFormat, Quantity, Unit, UpAxis};

/// Declares a value of an option and what it stands for in the library.
macro_rules! choices {
    ($name:ident => $target:ty { $($(#[$meta:meta])* $variant:ident => $value:expr,)+ }) => {
        #[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
        pub(super) enum $name { $($(#[$meta])* $variant,)+ }

        impl From<$name> for $target {
            fn from(choice: $name) -> $target {
                match choice { $($name::$variant => $value,)+ }
            }
        }
    };
}

choices!(EstimatorArg => Estimator {
    /// Surfaces fitted to the vertices around each face, by whatever explains them best
    Auto => Estimator::Auto,
    /// The circle with the section's chord and arc
    Osculating => Estimator::Osculating,
    /// The same to third order, as in the paper
    Osculating3 => Estimator::Osculating3,
    /// Turning of the section's tangent over its length, averaged over the radii
    Tangent => Estimator::Tangent,
});

impl From<Estimator> for EstimatorArg {
    fn from(estimator: Estimator) -> Self {
        EstimatorArg::value_variants()
            .iter()
            .copied()
            .find(|&arg| Estimator::from(arg) == estimator)
            .unwrap_or(EstimatorArg::Auto)
    }
}

choices!(AlongArg => Along {
    /// Where the surface bends most
    Max => Along::Max,
    /// Where it bends least
    Min => Along::Min,
});

choices!(FormatArg => OutputFormat {
    Glb => OutputFormat::Glb,
    Gltf => OutputFormat::Gltf,
    Ply => OutputFormat::Ply,
    Csv => OutputFormat::Csv,
    Npz => OutputFormat::Npz,
});

choices!(InputFormatArg => InputFormat {
    Stl => InputFormat::Stl,
    Obj => InputFormat::Obj,
    Ply => InputFormat::Ply,
    Off => InputFormat::Off,
    #[value(name = "3mf")]
    ThreeMf => InputFormat::ThreeMf,
    /// .gltf or .glb
    #[value(alias = "glb")]
    Gltf => InputFormat::Gltf,
});

choices!(UpArg => UpAxis {
    Y => UpAxis::Y,
    Z => UpAxis::Z,
});

choices!(UnitArg => Unit {
    Mm => Unit::Millimetre,
    Cm => Unit::Centimetre,
    M => Unit::Metre,
    In => Unit::Inch,
});

choices!(CarrierArg => ColorCarrier {
    Texture => ColorCarrier::Texture,
    Vertex => ColorCarrier::Vertex,
    VertexSrgb => ColorCarrier::VertexSrgb,
    None => ColorCarrier::None,
});

choices!(CompressArg => bool {
    None => false,
    Meshopt => true,
});

choices!(LayoutArg => Layout {
    Faces => Layout::Faces,
    Indexed => Layout::Indexed,
});

choices!(ColorByArg => Option<Quantity> {
    Mean => Some(Quantity::Mean),
    Gauss => Some(Quantity::Gauss),
    #[value(name = "k_max")]
    KMax => Some(Quantity::KMax),
    #[value(name = "k_min")]
    KMin => Some(Quantity::KMin),
    #[value(name = "gauss_perimeter")]
    GaussPerimeter => Some(Quantity::GaussPerimeter),
    #[value(name = "shape_index")]
    ShapeIndex => Some(Quantity::ShapeIndex),
    Curvedness => Some(Quantity::Curvedness),
    Class => Some(Quantity::Class),
    Coverage => Some(Quantity::Coverage),
    Confidence => Some(Quantity::Confidence),
    None => None,
});

/// How messages are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum LogFormat {
    Text,
    Json,
}

/// How a report is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum ReportFormat {
    Text,
    Json,
}

/// How a picture is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum PictureFormat {
    Png,
    Svg,
}

/// A synthetic shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum ShapeArg {
    /// The square from -1 to 1
    Plane,
    /// --radius
    Sphere,
    /// Open at both ends; --radius, --height
    Cylinder,
    /// --radius, --tube
    Torus,
    /// --size
    Ellipsoid,
    /// z = x^2 - y^2 over the square from -1 to 1
    Saddle,
    /// z = x^3 - 3 x y^2 over the square from -1 to 1
    MonkeySaddle,
    /// z = 0.1 sin(pi x) cos(pi y) over the square from -1 to 1
    Wave,
    /// Sharp edges; --size
    Box,
    /// Rounded edges and corners; --size, --fillet
    FilletBox,
}
