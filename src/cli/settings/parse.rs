//! Settings through the command line's parser, and its errors in words of settings.

use super::Setting;
use super::facts::{Separator, settings_of};
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Args, Command};
use osculate::Error;
use std::error::Error as _;
use std::ffi::OsString;
use std::path::Path;

/// Parses settings of a group of options.
pub(super) fn parse<T: Args>(settings: &[Setting]) -> Result<T, Error> {
    parse_with(settings, &[], None)
}

/// The same, with further options and a positional argument that are no settings.
pub(super) fn parse_with<T: Args>(
    settings: &[Setting],
    files: &[(&str, &Path)],
    positional: Option<&Path>,
) -> Result<T, Error> {
    let command = T::augment_args(Command::new("settings")).no_binary_name(true).disable_help_flag(true);
    let known = settings_of(&command);
    let mut arguments: Vec<OsString> = Vec::new();
    for (name, values) in settings {
        let Some(fact) = known.iter().find(|fact| fact.name == *name) else {
            let names: Vec<&str> = known.iter().map(|fact| fact.name.as_str()).collect();
            let what = format!("there is no setting {name} here; there are {}", names.join(", "));
            return Err(Error::Usage(what));
        };
        let option = format!("--{}", name.replace('_', "-"));
        match (fact.separator, values.as_slice()) {
            (Separator::Switch, []) => arguments.push(option.into()),
            (Separator::Switch, _) => return Err(Error::Usage(format!("{name} must be true or false"))),
            (_, []) => return Err(Error::Usage(format!("{name} needs a value"))),
            (Separator::Repeated, values) => arguments.extend(values.iter().map(|value| given(&option, value))),
            (Separator::Text(separator), values) => {
                arguments.push(given(&option, &values.join(std::ffi::OsStr::new(separator))));
            }
        }
    }
    arguments.extend(files.iter().map(|(name, file)| given(&format!("--{name}"), file.as_os_str())));
    arguments.extend(positional.into_iter().flat_map(|path| ["--".into(), path.as_os_str().to_owned()]));
    let matches = command.try_get_matches_from(arguments).map_err(|e| Error::Usage(sentence(&e)))?;
    T::from_arg_matches(&matches).map_err(|e| Error::Usage(sentence(&e)))
}

fn given(option: &str, value: &std::ffi::OsStr) -> OsString {
    let mut argument = OsString::from(option);
    argument.push("=");
    argument.push(value);
    argument
}

/// What the parser did not like, naming settings instead of options.
fn sentence(error: &clap::Error) -> String {
    let text = |kind: ContextKind| match error.get(kind) {
        Some(ContextValue::String(text)) => vec![text.clone()],
        Some(ContextValue::Strings(texts)) => texts.clone(),
        _ => Vec::new(),
    };
    let names = |kind: ContextKind| text(kind).iter().map(|option| name_of(option)).collect::<Vec<_>>().join(", ");
    let value = text(ContextKind::InvalidValue).join(",");
    let argument = names(ContextKind::InvalidArg);
    match error.kind() {
        ErrorKind::InvalidValue if !text(ContextKind::ValidValue).is_empty() => {
            format!("{argument} must be one of {}, not \"{value}\"", text(ContextKind::ValidValue).join(", "))
        }
        ErrorKind::ValueValidation => {
            let reason = error.source().map(ToString::to_string).unwrap_or_default();
            format!("{argument}: \"{value}\" will not do: {reason}")
        }
        ErrorKind::ArgumentConflict => {
            format!("{argument} cannot be given together with {}", names(ContextKind::PriorArg))
        }
        ErrorKind::MissingRequiredArgument => format!("{argument} must be given as well"),
        _ => error.to_string().lines().next().unwrap_or_default().trim_start_matches("error: ").to_owned(),
    }
}

/// The setting of an option as the parser writes it, such as `--radius-factor <F>`.
fn name_of(option: &str) -> String {
    option.split([' ', '=']).next().unwrap_or_default().trim_start_matches('-').replace('-', "_")
}

#[cfg(test)]
mod tests {
    use super::super::{Convert, Setting, parse_arrays};
    use osculate::{AnnotateOptions, Radius};
    use std::path::Path;

    fn settings(list: &[(&str, &[&str])]) -> Vec<Setting> {
        list.iter().map(|(name, values)| (name.to_string(), values.iter().map(Into::into).collect())).collect()
    }

    #[test]
    fn no_settings_are_the_librarys_defaults() {
        let (build, estimate) = parse_arrays(&[]).expect("valid");
        let defaults = AnnotateOptions::default();
        assert_eq!((build.mesh, estimate.curvature), (defaults.mesh, defaults.curvature));
        let convert = Convert::parse(Path::new("-a.stl"), Path::new("b.glb"), &[]).expect("valid");
        assert_eq!(convert.args.input.path, Path::new("-a.stl"));
    }

    #[test]
    fn values_are_what_the_command_line_takes_them_for() {
        let given = settings(&[
            ("radius_factor", &["2.5:mesh"]),
            ("feature_angle", &["180"]),
            ("attributes", &["default", "gauss_perimeter"]),
        ]);
        let (build, estimate) = parse_arrays(&given).expect("valid");
        assert_eq!((build.mesh.feature_angle, estimate.curvature.radius), (180.0, Radius::MeshFactor(2.5)));
        assert!(estimate.curvature.perimeter);
        let given = settings(&[("range", &["-1", "2"]), ("variants", &["mean", "class"]), ("vertex_values", &[])]);
        let convert = Convert::parse(Path::new("a.stl"), Path::new("b.glb"), &given).expect("valid");
        assert_eq!(convert.options.range, osculate::ColorRange::Fixed(-1.0, 2.0));
        assert!(convert.options.variants.len() == 2 && convert.options.vertex_values);
    }

    #[test]
    fn errors_are_sentences_that_name_the_setting() {
        let error = |list: &[(&str, &[&str])]| parse_arrays(&settings(list)).expect_err("invalid").to_string();
        assert!(
            error(&[("estimater", &["auto"])]).starts_with("there is no setting estimater here; there are estimator")
        );
        let text = "estimator must be one of auto, osculating, osculating3, tangent, not \"best\"";
        assert_eq!(error(&[("estimator", &["best"])]), text);
        assert_eq!(error(&[("radius", &["wide"])]), "radius: \"wide\" will not do: give a length or auto");
        let both = error(&[("radius", &["1"]), ("radius_factor", &["3"])]);
        assert_eq!(both, "radius cannot be given together with radius_factor");
        assert_eq!(error(&[("threads", &[])]), "threads needs a value");
        assert!(error(&[("diameters", &["many"])]).starts_with("diameters: \"many\" will not do: "));
        let given = settings(&[("view", &["1", "0", "0"])]);
        let convert = Convert::parse(Path::new("a.stl"), Path::new("b.glb"), &given);
        assert!(convert.is_err_and(|e| e.to_string() == "edges must be given as well"));
    }
}
