//! Recordings of any format, also of other programs, as the command line reads them. A mapping is used where a file does not state
//! the meaning of its numbers.

use std::path::{Path, PathBuf};

use socam_import::{Columns, ImportError, Mapping};
use socam_recording::{Dataset, Selection};

/// Opens `RUN` or `RUN@FROM..TO`.
///
/// # Errors
/// When it cannot be read, or needs a mapping; one sentence.
pub(super) fn read(run: &str) -> Result<Dataset, String> {
    open(&Selection::parse(run).map_err(|error| error.to_string())?)
}

/// Opens a recording. A file that does not state its units or times is read with the mapping beside it, `FILE.map.toml`, and without one as
/// plain numbers.
///
/// # Errors
/// When it cannot be read; one sentence.
fn open(selection: &Selection) -> Result<Dataset, String> {
    match socam_import::open_selection(selection) {
        Ok(data) => Ok(data),
        Err(ImportError::Unstated { path, .. }) => {
            let place = mapping_of(&path);
            let imported = if place.is_file() {
                Mapping::open(&place).and_then(|mapping| socam_import::import(selection, &mapping))
            } else {
                Columns::of(&path).and_then(|columns| columns.import(selection))
            };
            Ok(imported.map_err(|error| error.to_string())?.data)
        }
        Err(error) => Err(error.to_string()),
    }
}

/// Path of the mapping of a file.
pub(super) fn mapping_of(file: &Path) -> PathBuf {
    let mut name = file.as_os_str().to_owned();
    name.push(".map.toml");
    name.into()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file without units and times is drawn as plain numbers; with the mapping beside it, it has them.
    #[test]
    fn a_file_that_does_not_state_its_units_is_read_with_the_mapping_beside_it() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("log.txt");
        let rows: String = (0..50).map(|row| format!("{};{}\n", f64::from(row) * 0.01, row % 7)).collect();
        std::fs::write(&file, format!("zeit;drehzahl\n{rows}")).unwrap();
        let run = file.display().to_string();
        let plain = read(&run).unwrap();
        assert_eq!((plain.rows(), plain.channels()[0].column_name().as_str()), (50, "drehzahl_1"));
        assert!(plain.warnings()[0].to_string().starts_with(socam_import::PLAIN_NUMBERS));
        let mut columns = Columns::of(&file).unwrap();
        columns.columns[0].unit = "rpm".into();
        std::fs::write(folder.path().join("log.txt.map.toml"), columns.text()).unwrap();
        let mapped = read(&run).unwrap();
        assert_eq!(mapped.channels()[0].column_name(), "drehzahl_rad_s");
        assert!(mapped.warnings().is_empty(), "{:?}", mapped.warnings());
    }
}
