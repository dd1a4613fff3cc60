//! Commands and options: a file for each command, and one for each group of options that several share.
//! Defaults come from the library; ranges and units stand on each line.

mod annotate;
mod attributes;
mod batch;
mod calls;
mod colors;
mod common;
mod disk;
mod estimation;
mod input;
mod inspect;
mod look;
mod mesh;
mod outputs;
mod path;
mod place;
mod report;
mod section;
mod settings;
mod space;
mod synth;
mod threads;
mod trace;

use clap::{Parser, Subcommand};

pub(super) use annotate::AnnotateArgs;
pub(super) use attributes::AttributesArgs;
pub(super) use batch::BatchArgs;
pub(super) use calls::{ArraysCall, BuildCall, DiskCall, EstimateCall, InspectCall, ReadCall, TraceCall, WriteCall};
pub(super) use colors::ColorsArgs;
pub(super) use common::CommonArgs;
pub(super) use disk::DiskArgs;
pub(super) use estimation::EstimationArgs;
pub(super) use input::{InputArgs, ReadingArgs};
pub(super) use inspect::{InspectArgs, ViewArgs};
pub(super) use look::LookArgs;
pub(super) use mesh::MeshArgs;
pub(super) use outputs::OutputsArgs;
pub(super) use path::PathArgs;
pub(super) use place::PlaceArgs;
pub(super) use report::ReportArgs;
pub(super) use section::{PlaneArgs, SectionArgs};
pub(super) use settings::SettingsArgs;
pub(super) use space::SpaceArgs;
pub(super) use synth::SynthArgs;
pub(super) use threads::ThreadsArgs;
pub(super) use trace::TraceArgs;

const AFTER_HELP: &str = "\
Exit codes: 0 done; 1 failed, nothing written; 2 bad usage; 3 done, but the input
was repaired or has defects (they are listed on standard error); 130 interrupted.
batch: 1 if any file failed (all others are written), otherwise 3 if any has defects.

Examples:
  osculate annotate scan.ply -o scan.glb
  osculate annotate part.stl -o part.glb --unit mm --color-by k_max
  osculate annotate part.stl -o part.csv
  osculate batch scans -o annotated --resume
  osculate inspect part.stl
  osculate report part.stl -o part.html
  osculate section part.stl --plane 0,0,1,-5 -o cut.svg

By default (--estimator auto) surfaces are fitted to the vertices around every face, as
many and of the kind that explain the mesh best; sharp edges end the window, and
confidence tells how far to trust a face. --radius asks for curvature at a scale: all
vertices within that distance. The other estimators lay a disk around every face instead:
legs of one length, the radius, walked over the mesh in normal planes.";

/// Curvature of every face of a triangle mesh, written as glTF attributes and colour maps.
#[derive(Debug, Parser)]
#[command(name = "osculate", version, about, after_help = AFTER_HELP, max_term_width = 100)]
pub(super) struct Cli {
    #[command(subcommand)]
    pub(super) command: Command,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Estimate the curvature of every face and write it to a .glb, .gltf, .ply, .csv or .npz
    Annotate(Box<AnnotateArgs>),
    /// Annotate many files: folders and patterns, a mirrored tree, a log, and --resume
    Batch(Box<BatchArgs>),
    /// Say what is in a mesh file: counts, extent, edge kinds, defects, suggested settings
    Inspect(InspectArgs),
    /// Show a mesh and its curvature, or two side by side, in one HTML file: 3D view, plots, tables; or as a picture
    Report(Box<ReportArgs>),
    /// Draw the disk of one face: its legs, rim and principal directions, as glTF lines
    ///
    /// Curvature is read off the disk's sections here, with `--estimator auto` too: as `osculating` does it.
    Disk(Box<DiskArgs>),
    /// Step along a principal direction, from one face or many, as glTF lines or CSV
    ///
    /// Directions are those of disks here, with `--estimator auto` too: as `osculating` reads them.
    Trace(Box<TraceArgs>),
    /// Cut the whole mesh with a plane, as glTF lines or SVG
    Section(SectionArgs),
    /// Make a synthetic mesh whose curvature is known exactly
    Synth(SynthArgs),
    /// Print a completion script for a shell
    Completions {
        /// The shell.
        shell: clap_complete::Shell,
    },
    /// Print the manual page (roff); view with: osculate man | man -l -
    Man,
}

impl Command {
    pub(super) fn common(&self) -> Option<&CommonArgs> {
        match self {
            Command::Annotate(args) => Some(&args.common),
            Command::Batch(args) => Some(&args.common),
            Command::Inspect(args) => Some(&args.common),
            Command::Report(args) => Some(&args.common),
            Command::Disk(args) => Some(&args.common),
            Command::Trace(args) => Some(&args.common),
            Command::Section(args) => Some(&args.common),
            Command::Synth(args) => Some(&args.common),
            Command::Completions { .. } | Command::Man => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;
    use osculate::{AnnotateOptions, ColorRange};

    #[test]
    fn the_definitions_are_sound() {
        Cli::command().debug_assert();
    }

    #[test]
    fn defaults_are_the_librarys() {
        let cli = Cli::try_parse_from(["osculate", "annotate", "a.stl", "-o", "a.glb"]).expect("valid");
        let Command::Annotate(args) = cli.command else { panic!("another command") };
        let expected = AnnotateOptions { summarise: false, ..AnnotateOptions::default() };
        assert_eq!(args.options().expect("valid"), expected);
    }

    #[test]
    fn values_may_begin_with_a_hyphen() {
        let cli =
            Cli::try_parse_from(["osculate", "annotate", "a.stl", "-o", "-", "--format", "csv", "--range", "-5:5"]);
        let Ok(Cli { command: Command::Annotate(args) }) = cli else { panic!("{cli:?}") };
        assert_eq!(args.settings.look.colors.range, ColorRange::Fixed(-5.0, 5.0));
    }
}
