//! Names of recordings as they are written: a span behind an `@`, files that a `+` joins, and wildcards where the shell has not expanded them.

use std::path::PathBuf;

use glob::MatchOptions;

use crate::error::{RecordingError, Result};
use crate::files::exists;

/// As shells do: a wildcard matches neither a separator nor the dot of a hidden file.
const AS_SHELLS: MatchOptions =
    MatchOptions { case_sensitive: true, require_literal_separator: true, require_literal_leading_dot: true };

/// Whether a name has wildcards.
pub(crate) fn is_pattern(name: &str) -> bool {
    name.contains(['*', '?', '['])
}

/// The files that a pattern names, in natural order: 2 before 10.
///
/// # Errors
/// When there is none, or it is no pattern; one sentence.
pub(crate) fn files(pattern: &str) -> Result<Vec<PathBuf>> {
    let failed = |problem: String| RecordingError::Pattern { text: pattern.into(), problem };
    let paths = glob::glob_with(pattern, AS_SHELLS)
        .map_err(|error| failed(format!("is no file, and no wildcard either ({error})")))?;
    // A folder that cannot be read holds nothing that could be opened.
    let mut files: Vec<PathBuf> = paths.flatten().filter(|path| path.is_file()).collect();
    alphanumeric_sort::sort_path_slice(&mut files);
    if files.is_empty() {
        return Err(failed("matches no file; check the folder and the pattern".into()));
    }
    Ok(files)
}

/// Names of recordings with the wildcards expanded: `runs/*.csv@2..8` becomes the part of each file. What is joined by `+`, and a file whose
/// own name has the characters, stays.
///
/// ```
/// # let folder = tempfile::tempdir().unwrap();
/// for name in ["run_10.csv", "run_9.csv"] {
///     std::fs::write(folder.path().join(name), "t_s,speed_rad_s\n0,1.5\n").unwrap();
/// }
/// let names = socam_recording::expand(&[format!("{}/run_*.csv@0..1", folder.path().display())])?;
/// assert!(names.len() == 2 && names[0].ends_with("run_9.csv@0..1") && names[1].ends_with("run_10.csv@0..1"));
/// # Ok::<(), socam_recording::RecordingError>(())
/// ```
///
/// # Errors
/// When a wildcard matches no file; one sentence.
pub fn expand(names: &[String]) -> Result<Vec<String>> {
    let mut all = Vec::new();
    for name in names {
        let (run, span) = split(name);
        if !is_pattern(run) || exists(run) || joined(run).is_some() {
            all.push(name.clone());
            continue;
        }
        let span = span.map_or(String::new(), |span| format!("@{span}"));
        all.extend(files(run)?.iter().map(|path| format!("{}{span}", path.display())));
    }
    Ok(all)
}

/// The text before the `@` of a span, and the span, `FROM..TO`.
pub(crate) fn split(text: &str) -> (&str, Option<&str>) {
    match text.rsplit_once('@') {
        Some((files, span)) if span.contains("..") && !exists(text) => (files, Some(span)),
        _ => (text, None),
    }
}

/// The names that a `+` joins; `None` where there is one file, whose name may have the character.
pub(crate) fn joined(text: &str) -> Option<Vec<&str>> {
    let names_files = |name: &str| exists(name) || (is_pattern(name) && files(name).is_ok());
    if !text.contains('+') || names_files(text) {
        return None;
    }
    if let Some(one) = text.strip_suffix('+').filter(|one| names_files(one)) {
        return Some(vec![one]);
    }
    let names: Vec<&str> = text.split('+').filter(|name| !name.is_empty()).collect();
    names.iter().any(|name| names_files(name)).then_some(names)
}

/// The one file that a wildcard matches.
pub(crate) fn only(pattern: &str) -> Result<PathBuf> {
    match files(pattern)?.as_slice() {
        [one] => Ok(one.clone()),
        several => Err(RecordingError::Pattern {
            text: pattern.into(),
            problem: format!(
                "matches {} files where one recording is needed; name one of them, or write `{pattern}+` where they follow one another",
                several.len()
            ),
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_of_that_name_wins_and_nothing_is_said() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name).display().to_string();
        std::fs::create_dir(folder.path().join("a_folder.csv")).unwrap();
        for name in ["a_2.csv", "a_11.csv", "a_1.csv", "b[1].csv", "b1.csv", ".a_3.csv"] {
            std::fs::write(at(name), "").unwrap();
        }
        assert_eq!(expand(&[at("a_*.csv")]).unwrap(), ["a_1.csv", "a_2.csv", "a_11.csv"].map(at));
        assert_eq!(expand(&[at("b[1].csv@2..")]).unwrap(), [at("b[1].csv@2..")]);
        assert_eq!(
            expand(&[at("a_[1-2].csv"), at("b?.csv")]).unwrap(),
            ["a_1.csv", "a_2.csv", "b1.csv"].map(at)
        );
        assert_eq!(expand(&[at("absent.csv"), at("a_*.csv+")]).unwrap(), [at("absent.csv"), at("a_*.csv+")]);
        let none = expand(&[at("c_*.csv")]).unwrap_err().to_string();
        assert!(none.contains("c_*.csv` matches no file"), "{none}");
    }
}
