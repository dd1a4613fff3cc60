//! What settings there are, for bindings that check or document them.

use super::super::args::{
    AnnotateArgs, ArraysCall, BatchArgs, BuildCall, ColorsArgs, DiskCall, EstimateCall, InspectCall, PlaneArgs,
    ReadCall, TraceCall,
};
use clap::{Arg, ArgAction, Args, Command};
use serde::Serialize;

/// How the values of a setting become one text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Separator {
    /// There are none: it is on or off.
    Switch,
    /// The option stands once for each value.
    Repeated,
    /// They are joined by this text.
    Text(&'static str),
}

/// What is known of a setting.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct SettingFacts {
    /// Its name, with underscores.
    pub name: String,
    /// The group that the help puts it in.
    pub group: String,
    /// What it does: its range, unit and remarks.
    pub help: String,
    /// What stands for its value in the help, such as `LENGTH|auto`; empty for a switch.
    pub value: String,
    /// Its default as text; `None` where the help tells.
    pub default: Option<String>,
    /// The values it may have; empty where they cannot be listed.
    pub choices: Vec<String>,
    /// How several values become one text.
    pub separator: Separator,
}

/// The settings of a call: `Mesh`, `read`, `annotate` (of arrays), `estimate` (of a mesh), `colors`, `convert`,
/// `batch`, `inspect`, `disk`, `trace` or `section`. `None` for another name.
pub fn facts(call: &str) -> Option<Vec<SettingFacts>> {
    let of = match call {
        "Mesh" => of::<BuildCall>,
        "read" => of::<ReadCall>,
        "annotate" => of::<ArraysCall>,
        "estimate" => of::<EstimateCall>,
        "convert" => of::<AnnotateArgs>,
        "batch" => of::<BatchArgs>,
        "inspect" => of::<InspectCall>,
        "colors" => of::<ColorsArgs>,
        "disk" => of::<DiskCall>,
        "trace" => of::<TraceCall>,
        "section" => of::<PlaneArgs>,
        _ => return None,
    };
    Some(of())
}

fn of<T: Args>() -> Vec<SettingFacts> {
    settings_of(&T::augment_args(Command::new("settings")))
}

/// Options that say where to and how loudly, which a call says otherwise.
const NO_SETTINGS: [&str; 5] = ["output", "resume", "verbose", "quiet", "log"];

pub(super) fn settings_of(command: &Command) -> Vec<SettingFacts> {
    let is_setting = |arg: &&Arg| !arg.is_positional() && !NO_SETTINGS.contains(&arg.get_id().as_str());
    command.get_arguments().filter(is_setting).map(SettingFacts::of).collect()
}

impl SettingFacts {
    fn of(arg: &Arg) -> Self {
        let help = arg.get_long_help().or(arg.get_help()).map(ToString::to_string).unwrap_or_default();
        let takes_value = arg.get_action().takes_values();
        let value = arg.get_value_names().and_then(<[_]>::first).map(ToString::to_string);
        let value = if takes_value { value.unwrap_or_default() } else { String::new() };
        let choices = arg.get_possible_values().into_iter().map(|choice| choice.get_name().to_owned());
        SettingFacts {
            name: arg.get_id().as_str().to_owned(),
            group: arg.get_help_heading().unwrap_or_default().to_owned(),
            help: help.split_whitespace().collect::<Vec<_>>().join(" "),
            separator: match value.as_str() {
                _ if !takes_value => Separator::Switch,
                _ if is_repeated(arg) => Separator::Repeated,
                value if value.contains(':') => Separator::Text(":"),
                _ => Separator::Text(","),
            },
            default: arg.get_default_values().first().filter(|_| takes_value).map(|d| d.to_string_lossy().into_owned()),
            choices: if takes_value { choices.collect() } else { Vec::new() },
            value,
        }
    }
}

fn is_repeated(arg: &Arg) -> bool {
    matches!(arg.get_action(), ArgAction::Append) && arg.get_value_delimiter().is_none()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_call_has_settings_with_help() {
        for call in [
            "Mesh", "read", "annotate", "estimate", "colors", "convert", "batch", "inspect", "disk", "trace", "section",
        ] {
            let facts = facts(call).unwrap_or_default();
            assert!(!facts.is_empty(), "{call}");
            for fact in facts {
                assert!(!fact.help.is_empty() && fact.name.chars().all(|c| c.is_ascii_lowercase() || c == '_'));
                assert_eq!(fact.value.is_empty() && fact.choices.is_empty(), fact.separator == Separator::Switch);
            }
        }
        assert_eq!(facts("dance"), None);
    }

    #[test]
    fn what_stands_in_help_stands_in_facts() {
        let convert = facts("convert").unwrap_or_default();
        let of = |name: &str| convert.iter().find(|fact| fact.name == name).expect("a setting");
        assert_eq!((of("radius").default.as_deref(), of("radius").group.as_str()), (Some("auto"), "Estimation"));
        assert_eq!(of("estimator").choices, ["auto", "osculating", "osculating3", "tangent"]);
        assert_eq!(of("allow_folder").separator, Separator::Repeated);
        assert_eq!(of("variants").separator, Separator::Text(","));
        assert_eq!(of("range").separator, Separator::Text(":"));
        assert_eq!((of("force").separator, of("force").default.as_deref()), (Separator::Switch, None));
        assert!(convert.iter().all(|fact| fact.name != "output" && fact.name != "quiet"));
    }
}
