//! Options of the command line by name, for bindings: each call takes settings as names and texts, which the
//! definitions of the command line parse. So names, defaults, checks and messages have one source.

mod facts;
mod parse;

pub use super::batch::{Batch, Counts, Done, Status};
pub use facts::{Separator, SettingFacts, facts};

use super::annotate::Target;
use super::args::{
    AnnotateArgs, ArraysCall, BatchArgs, BuildCall, ColorsArgs, DiskCall, EstimateCall, EstimationArgs, InspectCall,
    MeshArgs, PathArgs, PlaceArgs, PlaneArgs, ReadCall, ReadingArgs, TraceCall, WriteCall,
};
use glam::DVec3;
use osculate::{
    AnnotateOptions, Annotated, ColorScale, CurvatureOptions, Error, FaceCurvature, Mesh, MeshOptions, Place, Plane,
    Progress, Quantity, ReadOptions, Selection, Summary, TraceOptions, Written,
};
use parse::parse;
use serde_json::Value;
use std::ffi::OsString;
use std::path::Path;

/// A setting: its name as on the command line with underscores for hyphens, such as `radius_factor`, and its
/// values. A switch that is on has none; items of a list are values each.
pub type Setting = (String, Vec<OsString>);

/// How a mesh is built from arrays.
#[derive(Clone, Debug)]
pub struct Build {
    /// Welding and edge kinds.
    pub mesh: MeshOptions,
    /// Threads to use; `None` for one per core.
    pub threads: Option<usize>,
}

impl Build {
    /// From `weld`, `feature_angle` and `threads`.
    ///
    /// # Errors
    /// [`Error::Usage`], as for all calls here: one sentence that names the setting.
    pub fn parse(settings: &[Setting]) -> Result<Self, Error> {
        let BuildCall { mesh, threads } = parse(settings)?;
        Ok(Build { mesh: mesh.options(), threads: threads.threads })
    }
}

/// How a mesh is read from a file.
#[derive(Clone, Debug)]
pub struct Read {
    /// The file's format and what else may be read.
    pub read: ReadOptions,
    /// Welding and edge kinds.
    pub mesh: MeshOptions,
    /// For [`inspect_with`](crate::inspect_with): the direction whose silhouette is counted.
    pub view: Option<DVec3>,
    /// Threads to use; `None` for one per core.
    pub threads: Option<usize>,
}

impl Read {
    /// From `input_format`, `allow_folder`, `weld`, `feature_angle` and `threads`.
    ///
    /// # Errors
    /// [`Error::Usage`].
    pub fn parse(settings: &[Setting]) -> Result<Self, Error> {
        let ReadCall { reading, mesh, threads } = parse(settings)?;
        Read::of(&reading, &mesh, None, threads.threads)
    }

    /// The same and `view`.
    ///
    /// # Errors
    /// [`Error::Usage`].
    pub fn parse_inspect(settings: &[Setting]) -> Result<Self, Error> {
        let InspectCall { reading, view, mesh, threads } = parse(settings)?;
        Read::of(&reading, &mesh, view.view, threads.threads)
    }

    fn of(reading: &ReadingArgs, mesh: &MeshArgs, view: Option<DVec3>, threads: Option<usize>) -> Result<Self, Error> {
        Ok(Read { read: reading.options()?, mesh: mesh.options(), view, threads })
    }
}

/// How curvature is estimated.
#[derive(Clone, Debug)]
pub struct Estimate {
    /// Estimation. The perimeter estimate is among it where a quantity asks for it.
    pub curvature: CurvatureOptions,
    /// Quantities asked for; without the perimeter estimate where nothing asks for it.
    pub selection: Selection,
    /// Threads to use; `None` for one per core.
    pub threads: Option<usize>,
}

impl Estimate {
    /// From `estimator`, `radius`, `radius_factor`, `diameters`, `class_tolerance`, `attributes` and `threads`.
    ///
    /// # Errors
    /// [`Error::Usage`].
    pub fn parse(settings: &[Setting]) -> Result<Self, Error> {
        let EstimateCall { estimation, attributes, threads } = parse(settings)?;
        Ok(Estimate::of(&estimation, attributes.attributes, threads.threads))
    }

    fn of(estimation: &EstimationArgs, selection: Selection, threads: Option<usize>) -> Self {
        let options = AnnotateOptions { curvature: estimation.options(), selection, ..AnnotateOptions::default() };
        let options = options.with_perimeter_if_wanted();
        Estimate { curvature: options.curvature, selection: options.selection, threads }
    }
}

/// Building and estimating at once: the settings of [`Build`] and [`Estimate`].
///
/// # Errors
/// [`Error::Usage`].
pub fn parse_arrays(settings: &[Setting]) -> Result<(Build, Estimate), Error> {
    let ArraysCall { estimation, mesh, attributes, threads } = parse(settings)?;
    let build = Build { mesh: mesh.options(), threads: threads.threads };
    Ok((build, Estimate::of(&estimation, attributes.attributes, threads.threads)))
}

/// Where a disk is laid, or where traces begin and how they go.
#[derive(Debug)]
pub struct Walk {
    /// Estimation.
    pub curvature: CurvatureOptions,
    /// How a trace goes.
    pub trace: TraceOptions,
    /// Threads to use; `None` for one per core.
    pub threads: Option<usize>,
    place: PlaceArgs,
    path: Option<PathArgs>,
}

impl Walk {
    /// From `face`, `at`, `point` and the settings of estimation.
    ///
    /// # Errors
    /// [`Error::Usage`].
    pub fn parse_disk(settings: &[Setting]) -> Result<Self, Error> {
        let DiskCall { place, estimation, threads } = parse(settings)?;
        let (curvature, threads) = (estimation.options(), threads.threads);
        Ok(Walk { curvature, trace: TraceOptions::default(), threads, place, path: None })
    }

    /// The same and `along`, `steps`, `both`, `seeds`.
    ///
    /// # Errors
    /// [`Error::Usage`].
    pub fn parse_trace(settings: &[Setting]) -> Result<Self, Error> {
        let TraceCall { path, place, estimation, threads } = parse(settings)?;
        let (curvature, threads) = (estimation.options(), threads.threads);
        Ok(Walk { curvature, trace: path.options(), threads, place, path: Some(path) })
    }

    /// The places asked for: one for a disk.
    ///
    /// # Errors
    /// [`Error::Usage`] where the mesh does not have the place.
    pub fn places(&self, mesh: &Mesh) -> Result<Vec<Place>, Error> {
        match &self.path {
            Some(path) => path.seeds_on(mesh, &self.place),
            None => Ok(vec![self.place.find(mesh)?]),
        }
    }
}

/// The plane of the setting `plane`.
///
/// # Errors
/// [`Error::Usage`].
pub fn parse_plane(mesh: &Mesh, settings: &[Setting]) -> Result<Plane, Error> {
    let PlaneArgs { plane } = parse(settings)?;
    Ok(Plane::of_equation(mesh, plane))
}

/// The colour scale of the settings `color_by`, `colormap` and `range`.
///
/// # Errors
/// [`Error::Usage`].
pub fn parse_colors(values: &[FaceCurvature], settings: &[Setting]) -> Result<ColorScale, Error> {
    let colors: ColorsArgs = parse(settings)?;
    let quantity: Option<Quantity> = colors.color_by.into();
    let quantity = quantity.ok_or_else(|| Error::Usage("color_by must name a quantity".into()))?;
    let map = colors.colormap()?;
    if quantity == Quantity::Class && map.is_some() {
        return Err(Error::Usage("classes have colours of their own; leave colormap out".into()));
    }
    ColorScale::new(quantity, map, colors.range, values)
}

/// `osculate annotate` as a call: one file to another.
pub struct Convert {
    args: AnnotateArgs,
    options: AnnotateOptions,
    target: Target,
}

impl Convert {
    /// From the options of the command.
    ///
    /// # Errors
    /// [`Error::Usage`].
    pub fn parse(input: &Path, output: &Path, settings: &[Setting]) -> Result<Self, Error> {
        let args: AnnotateArgs = parse::parse_with(settings, &[("output", output)], Some(input))?;
        Ok(Convert { options: args.options()?, target: Target::of(&args.outputs, args.stats.clone())?, args })
    }

    /// Threads to use; `None` for one per core.
    pub fn threads(&self) -> Option<usize> {
        self.args.common.threads.threads
    }

    /// Whether the summary is to have the percentiles of the values, which cost some sorting.
    pub fn summarise(&mut self) {
        self.options.summarise = true;
    }

    /// Does it.
    ///
    /// # Errors
    /// Those of [`annotate`](crate::annotate()), and [`Error::Exists`].
    pub fn run(&self, progress: &dyn Progress) -> Result<Summary, Error> {
        self.target.annotate(&self.args.input.path, &self.options, progress)
    }
}

/// The writing of `osculate annotate` as a call: a mesh and its values to a file.
pub struct Write {
    options: AnnotateOptions,
    target: Target,
    /// Threads to use; `None` for one per core.
    pub threads: Option<usize>,
}

impl Write {
    /// From the options of the command that say what is written and how it looks. Without `attributes` the quantities
    /// are `selection`.
    ///
    /// # Errors
    /// [`Error::Usage`].
    pub fn parse(output: &Path, settings: &[Setting], selection: &Selection) -> Result<Self, Error> {
        let WriteCall { look, outputs, threads } = parse::parse_with(settings, &[("output", output)], None)?;
        let mut options = outputs.add_to(look.options()?);
        if !settings.iter().any(|(name, _)| name == "attributes") {
            options.selection = selection.clone();
        }
        Ok(Write { options, target: Target::of(&outputs, None)?, threads: threads.threads })
    }

    /// Does it. `settings` are those that the values were estimated with.
    ///
    /// # Errors
    /// Those of [`Annotated::write`], and [`Error::Exists`].
    pub fn run(&self, annotated: &Annotated<'_>, settings: &Value, progress: &dyn Progress) -> Result<Written, Error> {
        self.target.check_existing(&self.options)?;
        let Target { destination, format, .. } = &self.target;
        annotated.write(settings, destination, *format, &self.options, progress)
    }
}

/// `osculate batch` without its finding, sharing and logging: what it does with each file, and the threads to use;
/// `None` for one per core.
///
/// # Errors
/// [`Error::Usage`].
pub fn parse_batch(settings: &[Setting]) -> Result<(Batch, Option<usize>), Error> {
    // What files there are and where they go is not its business.
    let args: BatchArgs = parse::parse_with(settings, &[("output", Path::new("-"))], Some(Path::new("-")))?;
    Ok((Batch::new(&args)?, args.common.threads.threads))
}
