//! Shares of a report joined into the report that one machine would have written.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;

use super::files::Folder;
use super::shard::{FILE, Stored, StoredOutcome};
use super::{Machine, Outcome, Plan, Progress, ReportError, Shard, select, write};
use crate::study::Entry;

/// Shares that do not join.
#[derive(Debug, thiserror::Error)]
pub enum MergeError {
    /// No folder was named.
    #[error("no folder of a share was named")]
    Nothing,
    /// A folder holds no share.
    #[error("cannot read {}: {source}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// A file is no share, or a share of another version of the tools.
    #[error("{}: no share of this kind: {reason}", path.display())]
    NoShare {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// Shares of different reports.
    #[error("{}: {what} than in {}", path.display(), first.display())]
    Different {
        /// The file.
        path: PathBuf,
        /// The first file.
        first: PathBuf,
        /// What differs.
        what: &'static str,
    },
    /// The same share twice.
    #[error("share {shard} is in {} and in {}", first.display(), path.display())]
    Twice {
        /// The share.
        shard: Shard,
        /// The file.
        path: PathBuf,
        /// The earlier file.
        first: PathBuf,
    },
    /// A study, or a run, that no share has.
    #[error("no share has {0}: shares are missing")]
    Missing(String),
    /// The report cannot be written.
    #[error(transparent)]
    Report(#[from] ReportError),
}

/// Joins the shares in these folders and writes the report into `out`. The studies are those of
/// `studies` that the shares name.
///
/// # Errors
/// [`MergeError`]; nothing is written unless every study of the report is in one share.
pub fn merge<'a>(
    folders: &[PathBuf],
    studies: &[Entry<'a>],
    methods: &[&'static str],
    out: &Path,
) -> Result<Vec<Outcome<'a>>, MergeError> {
    let shares = gather::<Stored>(folders)?;
    if let Some((path, _)) = shares.iter().find(|(_, share)| !share.is_sound()) {
        let reason = "its studies are not those of its share".to_owned();
        return Err(MergeError::NoShare { path: path.clone(), reason });
    }
    let (size, ids) = (shares[0].1.size, shares[0].1.ids.clone());
    let machine = joined(shares.iter().map(|(_, share)| &share.machine));
    let mut stored: Vec<StoredOutcome> =
        shares.into_iter().flat_map(|(_, share)| share.outcomes).collect();
    let entries = select(studies, &ids)?;
    let mut outcomes = Vec::new();
    for entry in &entries {
        let place = stored.iter().position(|outcome| outcome.id == entry.id);
        let place =
            place.ok_or_else(|| MergeError::Missing(format!("the study `{}`", entry.id)))?;
        outcomes.push(stored.swap_remove(place).outcome(*entry));
    }
    let (methods, out) = (methods.to_vec(), out.to_owned());
    let plan = Plan { entries, methods, size, out, progress: Progress::Hidden };
    write(&Folder::open(&plan.out)?, &machine, &plan, &outcomes)?;
    Ok(outcomes)
}

/// What a share leaves in its folder: of a report, or of a sweep.
pub(crate) trait Shared: DeserializeOwned {
    /// The name of its file.
    const FILE: &'static str;

    /// Which share it is.
    fn shard(&self) -> Shard;

    /// What keeps it from being joined with the first share.
    fn differs(&self, first: &Self) -> Option<&'static str>;
}

impl Shared for Stored {
    const FILE: &'static str = FILE;

    fn shard(&self) -> Shard {
        self.shard
    }

    fn differs(&self, first: &Self) -> Option<&'static str> {
        let differ =
            [(self.size != first.size, "other horizons"), (self.ids != first.ids, "other studies")];
        differ.into_iter().find(|(differs, _)| *differs).map(|(_, what)| what)
    }
}

/// The shares in these folders, at least one, which are parts of one whole and each another.
pub(crate) fn gather<S: Shared>(folders: &[PathBuf]) -> Result<Vec<(PathBuf, S)>, MergeError> {
    let shares = folders.iter().map(|folder| read(folder)).collect::<Result<Vec<(_, S)>, _>>()?;
    let Some(((first, share), others)) = shares.split_first() else {
        return Err(MergeError::Nothing);
    };
    let mut seen = vec![(share.shard(), first)];
    for (path, other) in others {
        let shard = other.shard();
        let count = (shard.of != share.shard().of).then_some("another number of shares");
        if let Some(what) = count.or_else(|| other.differs(share)) {
            return Err(MergeError::Different { path: path.clone(), first: first.clone(), what });
        }
        if let Some((_, first)) = seen.iter().find(|(other, _)| *other == shard) {
            let (path, first) = (path.clone(), (*first).clone());
            return Err(MergeError::Twice { shard, path, first });
        }
        seen.push((shard, path));
    }
    Ok(shares)
}

fn read<S: Shared>(folder: &Path) -> Result<(PathBuf, S), MergeError> {
    let path = folder.join(S::FILE);
    let text = fs::read_to_string(&path)
        .map_err(|source| MergeError::Unreadable { path: path.clone(), source })?;
    match toml::from_str(&text) {
        Ok(stored) => Ok((path, stored)),
        Err(error) => {
            let reason = error.message().chars().take(200).collect();
            Err(MergeError::NoShare { path, reason })
        }
    }
}

/// The machines as one: what they have in common, and where they differ each of what they have.
fn joined<'m>(machines: impl Iterator<Item = &'m Machine>) -> Machine {
    let machines: Vec<&Machine> = machines.collect();
    let each = |of: fn(&Machine) -> Option<&str>| {
        let mut words: Vec<&str> = Vec::new();
        for word in machines.iter().filter_map(|machine| of(machine)) {
            if !words.contains(&word) {
                words.push(word);
            }
        }
        (!words.is_empty()).then(|| words.join("; "))
    };
    Machine {
        os: each(|machine| Some(&machine.os)).unwrap_or_default(),
        arch: each(|machine| Some(&machine.arch)).unwrap_or_default(),
        cores: machines.iter().map(|machine| machine.cores).max().unwrap_or(0),
        rustc: each(|machine| machine.rustc.as_deref()),
        cpu: each(|machine| machine.cpu.as_deref()),
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::report::{fake, report, shard};
    use crate::study::Size;

    fn folder(name: &str) -> PathBuf {
        let path = std::env::temp_dir().join(format!("xtask-merge-{name}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&path);
        path
    }

    fn plan<'a>(studies: &[Entry<'a>], only: &[&str], out: &Path) -> Plan<'a> {
        let only: Vec<String> = only.iter().map(|id| (*id).to_owned()).collect();
        let entries = select(studies, &only).unwrap();
        let (size, progress) = (Size::Default, Progress::Hidden);
        Plan { entries, methods: Vec::new(), size, out: out.to_owned(), progress }
    }

    fn files(folder: &Path) -> BTreeMap<String, String> {
        let read = |file: io::Result<fs::DirEntry>| {
            let path = file.unwrap().path();
            let name = path.file_name().unwrap().to_str().unwrap().to_owned();
            (name, fs::read_to_string(path).unwrap())
        };
        fs::read_dir(folder).unwrap().map(read).collect()
    }

    /// The folders of all shares of a plan.
    fn shares(studies: &[Entry<'_>], only: &[&str], of: usize, root: &Path) -> Vec<PathBuf> {
        let run = |share: usize| {
            let out = root.join(share.to_string());
            shard(&plan(studies, only, &out), Shard { share, of }).unwrap();
            out
        };
        (1..=of).map(run).collect()
    }

    #[test]
    fn shares_join_into_the_files_of_one_run_bit_for_bit() {
        let root = folder("same");
        report(&plan(fake::STUDIES, &[], &root.join("whole"))).unwrap();
        let folders = shares(fake::STUDIES, &[], 3, &root);
        merge(&folders, fake::STUDIES, &[], &root.join("joined")).unwrap();
        let (whole, joined) = (files(&root.join("whole")), files(&root.join("joined")));
        assert_eq!(whole.keys().collect::<Vec<_>>(), joined.keys().collect::<Vec<_>>());
        for (name, text) in &whole {
            assert_eq!(text, &joined[name], "{name}");
        }
        fs::remove_dir_all(&root).unwrap();
    }

    #[test]
    fn shares_that_do_not_join_are_refused_with_the_reason() {
        let root = folder("refused");
        let folders = shares(fake::STUDIES, &["fake-portrait", "fake-map"], 2, &root);
        let out = root.join("out");
        let refused =
            |folders: &[PathBuf]| merge(folders, fake::STUDIES, &[], &out).unwrap_err().to_string();
        assert_eq!(refused(&[]), "no folder of a share was named");
        let missing = "no share has the study `fake-map`: shares are missing";
        assert_eq!(refused(&folders[..1]), missing);
        let twice = refused(&[folders[0].clone(), folders[0].clone()]);
        assert!(twice.starts_with("share 1/2 is in "), "{twice}");
        let others = shares(fake::STUDIES, &["fake-portrait"], 1, &root.join("others"));
        let different = refused(&[folders[0].clone(), others[0].clone()]);
        assert!(different.contains("another number of shares than in"), "{different}");
        let none = refused(&[root.join("nowhere")]);
        assert!(none.starts_with("cannot read "), "{none}");
        let [one, two] = [0, 1].map(|k| fs::read_to_string(folders[k].join(FILE)).unwrap());
        let outcomes = &one[one.find("[[outcomes]]").unwrap()..];
        fs::write(folders[1].join(FILE), format!("{two}\n{outcomes}")).unwrap();
        let foreign = refused(&folders);
        assert!(foreign.contains("its studies are not those of its share"), "{foreign}");
        fs::write(folders[1].join(FILE), "a = ").unwrap();
        let broken = refused(&folders);
        assert!(broken.contains("no share of this kind"), "{broken}");
        assert!(!out.exists());
        fs::remove_dir_all(&root).unwrap();
    }
}
