//! Files beside a scene's: nothing outside its folder is opened.

use std::path::{Component, Path, PathBuf};

use toml::Spanned;

use crate::text::diagnostic::{Checked, Located, at};
use crate::text::fault::Fault;
use crate::text::limits;
use crate::text::suggestion::shortened;

/// Where a file in the scene's folder is.
pub(crate) fn found(folder: Option<&Path>, file: &Spanned<String>) -> Checked<PathBuf> {
    let outside = || at(file.span(), Fault::OutsideFolder(shortened(file.get_ref())));
    let name = Path::new(file.get_ref());
    let is_inside = |part| matches!(part, Component::Normal(_) | Component::CurDir);
    let inside = name.components().all(is_inside);
    let Some(folder) = folder.filter(|_| inside && !file.get_ref().is_empty()) else {
        return Err(outside());
    };
    let path = folder.join(name);
    let folder = if folder == Path::new("") { Path::new(".") } else { folder };
    let real = |path: &Path| path.canonicalize().map_err(|error| failed(file, error.to_string()));
    if !real(&path)?.starts_with(real(folder)?) {
        return Err(outside());
    }
    let bytes = path.metadata().map_err(|error| failed(file, error.to_string()))?;
    if !bytes.is_file() || bytes.len() > limits::MESH_BYTES {
        let why = format!("it is no file of at most {} bytes", limits::MESH_BYTES);
        return Err(failed(file, why));
    }
    Ok(path)
}

/// What is wrong with a file.
pub(crate) fn failed(file: &Spanned<String>, why: String) -> Box<Located> {
    at(file.span(), Fault::FileBeside { file: shortened(file.get_ref()), why })
}
