//! A share of a sweep, run on one of many machines, and the shares joined.
//!
//! ```text
//! share I of N     the runs I - 1, I - 1 + N, I - 1 + 2 N, ... from 0
//! ```

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::{Family, Row, SweepError, show};
use crate::report::{Folder, MergeError, Progress, ReportError, Shard, Shared, gather};

/// The name of the file.
const FILE: &str = "sweep.toml";

#[derive(Debug, Serialize, Deserialize)]
struct Stored {
    shard: Shard,
    family: Family,
    #[serde(default)]
    rows: Vec<Row>,
}

impl Shared for Stored {
    const FILE: &'static str = FILE;

    fn shard(&self) -> Shard {
        self.shard
    }

    fn differs(&self, first: &Self) -> Option<&'static str> {
        (self.family != first.family).then_some("another scene, observable or values")
    }
}

impl Stored {
    /// Whether its rows are runs of the share and have what the family's have: the file is not trusted.
    fn is_sound(&self) -> bool {
        let (Shard { share, of }, own) = (self.shard, &self.family);
        let of_share = |row: &Row| {
            let columns = row.result.as_ref().map_or(own.headings.len(), Vec::len);
            row.run % of == share - 1 && row.run < own.runs() && columns == own.headings.len()
        };
        let mut runs: Vec<usize> = self.rows.iter().map(|row| row.run).collect();
        runs.sort_unstable();
        runs.dedup();
        (1..=of).contains(&share)
            && own.is_sound()
            && self.rows.iter().all(of_share)
            && runs.len() == self.rows.len()
    }
}

/// Whether a folder has a share of a sweep.
pub fn is_share(folder: &Path) -> bool {
    folder.join(FILE).is_file()
}

/// Runs a share of the family and leaves it in the folder.
///
/// # Errors
/// [`SweepError::Report`], before the first run if the folder is to blame.
pub fn shard(
    family: &Family,
    shard: Shard,
    out: &Path,
    progress: Progress,
) -> Result<Vec<Row>, SweepError> {
    let folder = Folder::open(out)?;
    let runs = (0..family.runs()).skip(shard.share - 1).step_by(shard.of).collect();
    let stored = Stored { shard, family: family.clone(), rows: family.rows(runs, progress) };
    let text = toml::to_string(&stored).map_err(ReportError::from)?;
    folder.write(FILE, &text)?;
    Ok(stored.rows)
}

/// Joins the shares in these folders and writes the table and the chart of the sweep.
///
/// # Errors
/// [`MergeError`]; nothing is written unless every run of the sweep is in one share.
pub fn merge(folders: &[PathBuf], out: &Path) -> Result<Vec<Row>, MergeError> {
    let mut shares = gather::<Stored>(folders)?;
    if let Some((path, _)) = shares.iter().find(|(_, share)| !share.is_sound()) {
        let reason = "its runs are not those of its sweep".to_owned();
        return Err(MergeError::NoShare { path: path.clone(), reason });
    }
    let mut rows: Vec<Row> =
        shares.iter_mut().flat_map(|(_, share)| std::mem::take(&mut share.rows)).collect();
    rows.sort_by_key(|row| row.run);
    let family = &shares[0].1.family;
    if let Some(run) = (0..family.runs()).find(|&run| rows.get(run).is_none_or(|r| r.run != run)) {
        return Err(MergeError::Missing(format!("run {}", run + 1)));
    }
    show::write(family, &rows, &Folder::open(out)?)?;
    Ok(rows)
}
