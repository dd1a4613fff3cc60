//! How a face came by its values.

/// Where the values of a face come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Method {
    /// Nowhere: the face has no estimate, or the values were read from a file.
    None,
    /// Plane sections of the mesh: the paper's formulas.
    Sections,
    /// A surface fitted around the face itself.
    Fit,
    /// A surface fitted beside the face: one side of a jump of curvature.
    OneSided,
    /// A surface fitted to the facets in a row with the face: long facets side by side.
    Strip,
    /// The plane of the face and those coplanar with it: what folds at its sides belongs to the surfaces beyond.
    Flat,
    /// Patches of a noisy surface, in windows of a size chosen from the data, blended.
    Patches,
    /// Windows of one size for the whole mesh: a surface that is rough at every scale, or a given radius.
    Window,
}

impl Method {
    /// All methods, in the order of their declaration.
    pub const ALL: [Method; 8] = [
        Method::None,
        Method::Sections,
        Method::Fit,
        Method::OneSided,
        Method::Strip,
        Method::Flat,
        Method::Patches,
        Method::Window,
    ];

    /// The name in CSV files; empty for none.
    pub fn name(self) -> &'static str {
        match self {
            Method::None => "",
            Method::Sections => "sections",
            Method::Fit => "fit",
            Method::OneSided => "one_sided",
            Method::Strip => "strip",
            Method::Flat => "flat",
            Method::Patches => "patches",
            Method::Window => "window",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_methods_stand_at_their_place() {
        assert!(Method::ALL.iter().enumerate().all(|(i, &method)| method as usize == i));
        assert_eq!(Method::ALL[Method::ALL.len() - 1], Method::Window, "a new method belongs into ALL");
    }
}
