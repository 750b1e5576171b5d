//! Lists the recordings of a fleet: those in a folder, or those named in a list.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use serde::Deserialize;

use crate::error::{FleetError, Result};
use crate::labels;
use crate::source::{Content, Source};

/// Extensions of files that are listed as recordings. The format is determined by the content; a file with one of these extensions
/// that is not a recording gets a row that says so.
const EXTENSIONS: [&str; 18] = [
    "mcap", "csv", "m", "mat", "h5", "hdf5", "mf4", "tdms", "parquet", "arrow", "feather", "tsv", "lvm",
    "wpilog", "ulg", "asc", "blf", "db3",
];

/// A line of a list.
#[derive(Deserialize)]
struct Line {
    file: String,
    machine: Option<String>,
    date: Option<String>,
}

/// The recordings of a folder, or of a list: a CSV file with the columns `file`, `machine` and `date`, of which only the first must be there.
/// Paths of a list are relative to its folder. Sorted by name; `except` is left out.
///
/// # Errors
/// When the folder or the list cannot be read.
pub fn sources(place: &Path, except: &[&Path]) -> Result<Vec<Source>> {
    let mut found = if place.is_dir() {
        let mut paths = Vec::new();
        walk(place, &mut paths)?;
        paths.into_iter().map(|path| in_folder(place, path)).collect()
    } else {
        listed(place)?
    };
    let hidden: Vec<PathBuf> = except.iter().filter_map(|path| path.canonicalize().ok()).collect();
    found.retain(|source: &Source| match &source.content {
        Content::Path(path) => !path.canonicalize().is_ok_and(|path| hidden.contains(&path)),
        Content::Bytes(_) => true,
    });
    found.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(found)
}

/// Every `of`-th recording, starting with `number` (1 to `of`). The shards of one list are disjoint and together contain all
/// recordings.
#[must_use]
pub fn shard(all: Vec<Source>, number: usize, of: usize) -> Vec<Source> {
    all.into_iter().skip(number.saturating_sub(1)).step_by(of.max(1)).collect()
}

fn walk(folder: &Path, found: &mut Vec<PathBuf>) -> Result<()> {
    let entries = folder.read_dir().map_err(|e| FleetError::io(folder, "read", e))?;
    for entry in entries {
        let entry = entry.map_err(|e| FleetError::io(folder, "read", e))?;
        let path = entry.path();
        if entry.file_name().to_string_lossy().starts_with('.') {
            continue;
        }
        // Links to folders are not followed: they may lead back.
        let kind = entry.file_type().map_err(|e| FleetError::io(&path, "read", e))?;
        if kind.is_dir() {
            walk(&path, found)?;
        } else if is_recording(&path) {
            found.push(path);
        }
    }
    Ok(())
}

/// Whether a file of this name is a recording of a folder, by its extension.
#[must_use]
pub fn is_recording(path: &Path) -> bool {
    let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
    extension.is_some_and(|extension| EXTENSIONS.contains(&extension.as_str()))
}

fn in_folder(folder: &Path, path: PathBuf) -> Source {
    let within = path.strip_prefix(folder).unwrap_or(&path);
    let parts: Vec<_> = within.components().map(|part| part.as_os_str().to_string_lossy()).collect();
    Source { name: parts.join("/"), ..Source::path(path.clone()) }
}

fn listed(list: &Path) -> Result<Vec<Source>> {
    let file = File::open(list).map_err(|e| FleetError::io(list, "open", e))?;
    entries(list, file)
}

/// Recordings named in the list whose text `reader` returns. Paths are relative to the folder of `list`; names are as written in
/// the list.
///
/// # Errors
/// When the text is not a list of recordings.
pub fn entries(list: &Path, reader: impl Read) -> Result<Vec<Source>> {
    let problem = |problem: String| FleetError::List { path: list.into(), problem };
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).flexible(true).from_reader(reader);
    let headers = reader.headers().map_err(|e| problem(e.to_string()))?;
    if !headers.iter().any(|name| name == "file") {
        return Err(problem(
            "expected a folder, or a CSV list whose first line is `file,machine,date`, or only `file`".into(),
        ));
    }
    let folder = list.parent().unwrap_or(Path::new(""));
    let mut found = Vec::new();
    for (number, line) in reader.deserialize().enumerate() {
        let line: Line = line.map_err(|e| problem(e.to_string()))?;
        let text = line.date.filter(|text| !text.is_empty());
        let date = text.map(|text| {
            let wrong = || problem(format!("line {}: `{text}` is no date; write 2026-03-01", number + 2));
            labels::date(&text).ok_or_else(wrong)
        });
        found.push(Source {
            content: Content::Path(folder.join(&line.file)),
            name: line.file,
            machine: line.machine.filter(|machine| !machine.is_empty()),
            date: date.transpose()?,
        });
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_and_lists_name_recordings_and_shards_share_them() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| {
            let path = folder.path().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(&path, text).unwrap();
            path
        };
        for name in ["SN2/a.csv", "SN1/b.MCAP", "SN1/.hidden.csv", "notes.txt"] {
            write(name, "");
        }
        let out = write("fleet.parquet", "");
        let names = |all: &[Source]| all.iter().map(|one| one.name.clone()).collect::<Vec<_>>();
        let all = sources(folder.path(), &[&out]).unwrap();
        assert_eq!(names(&all), ["SN1/b.MCAP", "SN2/a.csv"]);
        let mut shards = [shard(all.clone(), 1, 2), shard(all.clone(), 2, 2)].concat();
        shards.sort_by(|a, b| a.name.cmp(&b.name));
        assert_eq!(shards, all);

        let list = write("list.csv", "file, machine, date\nSN2/a.csv, 7, 1970-01-02\nSN1/b.MCAP\n");
        let all = sources(&list, &[]).unwrap();
        assert_eq!((all[0].machine.clone(), all[1].machine.as_deref()), (None, Some("7")));
        assert_eq!(all[1].date, Some(86_400_000));
        let list = write("bad.csv", "file,machine,date\nSN2/a.csv,7,soon\n");
        assert!(sources(&list, &[]).unwrap_err().to_string().contains("line 2: `soon` is no date"));
        let list = write("other.csv", "t_s,x_rad\n0,1\n");
        assert!(sources(&list, &[]).unwrap_err().to_string().contains("expected a folder"));
    }
}
