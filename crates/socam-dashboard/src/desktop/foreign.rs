//! Recordings of any format, also of other programs, as the command line reads them. A mapping is used where a file does not state
//! the meaning of its numbers.

use std::path::{Path, PathBuf};

use socam_import::{ImportError, Mapping};
use socam_recording::{Dataset, Selection};

/// Opens `RUN` or `RUN@FROM..TO`.
///
/// # Errors
/// When it cannot be read, or needs a mapping; one sentence.
pub(super) fn read(run: &str) -> Result<Dataset, String> {
    open(&Selection::parse(run).map_err(|error| error.to_string())?)
}

/// Opens a recording. A file that does not state its units or times is read with the mapping beside it, `FILE.map.toml`.
///
/// # Errors
/// When it cannot be read, or needs a mapping; one sentence.
fn open(selection: &Selection) -> Result<Dataset, String> {
    match socam_import::open_selection(selection) {
        Ok(data) => Ok(data),
        Err(ImportError::Unstated { path, problem }) => {
            let place = mapping_of(&path);
            if !place.is_file() {
                return Err(format!(
                    "{} {problem}; {NEEDS_MAPPING}, which is read from {}",
                    path.display(),
                    place.display()
                ));
            }
            let mapping = Mapping::open(&place).map_err(|error| error.to_string())?;
            let imported = socam_import::import(selection, &mapping).map_err(|error| error.to_string())?;
            Ok(imported.data)
        }
        Err(error) => Err(error.to_string()),
    }
}

/// The words by which the window knows that a mapping helps.
const NEEDS_MAPPING: &str = "it needs a mapping";

/// Whether a mapping would help to open a file that could not be opened for this reason.
pub(super) fn needs_mapping(sentence: &str) -> bool {
    sentence.contains(NEEDS_MAPPING)
}

/// Path of the mapping of a file.
fn mapping_of(file: &Path) -> PathBuf {
    let mut name = file.as_os_str().to_owned();
    name.push(".map.toml");
    name.into()
}

/// Writes a mapping to complete beside a file. Returns what to do next.
///
/// # Errors
/// When the file cannot be read or the mapping cannot be written; one sentence.
pub(super) fn propose_mapping(run: &str) -> Result<String, String> {
    let selection = Selection::parse(run).map_err(|error| error.to_string())?;
    let proposal = socam_import::propose(&selection.path, None).map_err(|error| error.to_string())?;
    let place = mapping_of(&selection.path);
    socam_workbench::save::write_new(&place, proposal.text.as_bytes())?;
    Ok(format!(
        "{} is written: complete it in a text editor ({}), and open {run} again",
        place.display(),
        proposal.unknown.join("; ")
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file without units and times is refused; with the mapping beside it, it opens.
    #[test]
    fn a_file_that_does_not_state_its_units_is_read_with_the_mapping_beside_it() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("log.txt");
        let rows: String = (0..50).map(|row| format!("{};{}\n", f64::from(row) * 0.01, row % 7)).collect();
        std::fs::write(&file, format!("zeit;drehzahl\n{rows}")).unwrap();
        let run = file.display().to_string();
        let refused = open(&Selection::parse(&run).unwrap()).unwrap_err();
        assert!(needs_mapping(&refused) && refused.contains("log.txt.map.toml"), "{refused}");
        let said = propose_mapping(&run).unwrap();
        assert!(said.contains("log.txt.map.toml is written"), "{said}");
        let place = folder.path().join("log.txt.map.toml");
        let text = std::fs::read_to_string(&place).unwrap();
        println!("{text}");
        assert!(propose_mapping(&run).unwrap_err().contains("exists already"));
    }
}
