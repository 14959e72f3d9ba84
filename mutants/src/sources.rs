//! The files of a crate, found as the compiler finds them: from `lib.rs` along `mod name;`.
//!
//! Modules of tests are left out.

use std::fs;
use std::path::{Path, PathBuf};

use syn::{Attribute, Item, ItemMod};

use crate::error::MutantsError;

/// A parsed file.
pub struct Source {
    /// Its path inside the crate.
    pub path: PathBuf,
    /// Its text.
    pub text: String,
    /// Its syntax tree, whose spans are byte ranges of the text.
    pub tree: syn::File,
}

/// All files below `src/lib.rs` of the crate in `root`, in the order of their `mod` lines.
pub fn read(root: &Path) -> Result<Vec<Source>, MutantsError> {
    let mut sources = Vec::new();
    follow(root, Path::new("src/lib.rs"), Path::new("src"), &mut sources)?;
    Ok(sources)
}

/// Whether the tests of all features compile what has these attributes as code that is to be tested.
pub fn counts(attributes: &[Attribute]) -> bool {
    !attributes.iter().filter(|a| a.path().is_ident("cfg")).any(|a| {
        let condition = a.meta.require_list().map(|list| list.tokens.to_string());
        condition.is_ok_and(|c| c == "test" || c == "doc" || c.starts_with("not"))
    })
}

/// Reads `path`, whose modules lie in `folder`, and then those.
fn follow(
    root: &Path,
    path: &Path,
    folder: &Path,
    sources: &mut Vec<Source>,
) -> Result<(), MutantsError> {
    let text = fs::read_to_string(root.join(path)).map_err(MutantsError::file(path))?;
    let tree = syn::parse_file(&text)
        .map_err(|source| MutantsError::Parse { path: path.into(), source })?;
    let modules = modules(&tree.items, folder);
    sources.push(Source { path: path.into(), text, tree });
    for (module, folder) in modules {
        let files = [folder.join(format!("{module}.rs")), folder.join(&module).join("mod.rs")];
        let Some(file) = files.iter().find(|file| root.join(file).is_file()) else {
            return Err(MutantsError::Module { path: path.into(), module });
        };
        follow(root, file, &folder.join(&module), sources)?;
    }
    Ok(())
}

/// The names of the modules that have a file of their own, each with the folder where that lies.
fn modules(items: &[Item], folder: &Path) -> Vec<(String, PathBuf)> {
    let declared = items.iter().filter_map(|item| match item {
        Item::Mod(module) if counts(&module.attrs) => Some(module),
        _ => None,
    });
    declared
        .flat_map(|ItemMod { ident, content, .. }| match content {
            None => vec![(ident.to_string(), folder.to_path_buf())],
            Some((_, items)) => modules(items, &folder.join(ident.to_string())),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_rust_and_what_is_not_there_is_an_error_that_names_the_file() {
        let root = std::env::temp_dir().join(format!("mutants-{}", std::process::id()));
        fs::create_dir_all(root.join("src")).unwrap();
        let error = |text: &str| {
            fs::write(root.join("src/lib.rs"), text).unwrap();
            read(&root).err().unwrap().to_string()
        };
        assert!(error("fn (").starts_with("src/lib.rs: cannot parse"));
        assert_eq!(error("mod away;"), "src/lib.rs: module `away` has no file");
        fs::remove_dir_all(&root).unwrap();
        assert!(read(&root).err().unwrap().to_string().starts_with("src/lib.rs: "));
    }
}
