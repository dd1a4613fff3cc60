//! Reading a mesh and finding a place on it: what `disk`, `trace` and `section` begin with.

use super::args::{InputArgs, MeshArgs, PathArgs, PlaceArgs};
use super::messages::Messages;
use super::progress::Bars;
use osculate::{Error, InputFormat, Mesh, Place};
use std::path::{Path, PathBuf};

/// A mesh and what its file was like.
pub(super) struct Input {
    pub(super) mesh: Mesh,
    pub(super) format: InputFormat,
    pub(super) has_defects: bool,
}

/// Reads a mesh and says what is wrong with it. None of `outputs` may belong to the input.
pub(super) fn read_mesh(
    input: &InputArgs,
    outputs: &[&Path],
    mesh: &MeshArgs,
    messages: &Messages,
) -> Result<Input, Error> {
    outputs.iter().try_for_each(|output| osculate::check_folder(output))?;
    let path = &input.path;
    let bars = Bars::new(messages.wants_progress());
    let (soup, format) = osculate::read_with(path, &input.reading.options()?, &bars)?;
    let outputs: Vec<PathBuf> = outputs.iter().map(|output| output.to_path_buf()).collect();
    osculate::check_outputs(&outputs, path, &soup.files)?;
    let mesh = Mesh::from_soup(&soup, &mesh.options()).map_err(|e| e.in_file(path))?;
    soup.notes.iter().for_each(|note| messages.note(note));
    mesh.report().defects().iter().for_each(|defect| messages.warning(defect));
    let has_defects = mesh.report().has_defects() || soup.notes.iter().any(|note| note.repaired);
    Ok(Input { mesh, format, has_defects })
}

impl PlaceArgs {
    /// The place asked for.
    pub(super) fn find(&self, mesh: &Mesh) -> Result<Place, Error> {
        match (self.face, self.point) {
            (Some(face), _) => {
                let [u, v] = self.at.unwrap_or([1.0 / 3.0; 2]);
                Place::in_face(mesh, face, [u, v])
            }
            (None, Some(point)) => Place::nearest(mesh, point),
            (None, None) => Err(Error::Usage("say where: --face N, perhaps with --at U,V, or --point X,Y,Z".into())),
        }
    }
}

impl PathArgs {
    /// The places that traces begin at.
    pub(super) fn seeds_on(&self, mesh: &Mesh, place: &PlaceArgs) -> Result<Vec<Place>, Error> {
        match self.seeds {
            Some(count) => Ok(osculate::spread_seeds(mesh, count)),
            None => Ok(vec![place.find(mesh)?]),
        }
    }
}

/// Refuses an output whose extension is none of those listed.
pub(super) fn extension(path: &Path, known: &[&'static str]) -> Result<&'static str, Error> {
    let extension = path.extension().unwrap_or_default();
    let found = known.iter().find(|known| extension.eq_ignore_ascii_case(known)).copied();
    found.ok_or_else(|| Error::Usage(format!("{}: the extension must be .{}", path.display(), known.join(" or ."))))
}
