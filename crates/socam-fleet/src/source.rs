//! A recording of a fleet: location of its bytes, machine and date.

use std::fs::File;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};
use socam_model::Model;
use tempfile::NamedTempFile;

use crate::options::FleetOptions;

/// Version that is part of each id.
pub(crate) const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Location of the bytes of a recording.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Content {
    /// The bytes are in a file.
    Path(PathBuf),
    /// The bytes are in memory.
    Bytes(Vec<u8>),
}

/// A recording of a fleet.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Source {
    /// Name of the recording in the table: a path within the fleet, with `/`.
    pub name: String,
    /// Bytes of the recording.
    pub content: Content,
    /// Serial number of the machine, if a list says it; else the log's, else the first folder of `name`.
    pub machine: Option<String>,
    /// Date, ms since 1970 (UTC), if a list says it; else the log's, else a date `YYYY-MM-DD` in `name`.
    pub date: Option<i64>,
}

impl Source {
    /// A file, named by the last part of its path.
    #[must_use]
    pub fn path(path: impl Into<PathBuf>) -> Self {
        let path = path.into();
        let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        Self { name, content: Content::Path(path), machine: None, date: None }
    }

    /// Bytes in memory. The extension of `name` says nothing that the bytes do not say.
    #[must_use]
    pub fn bytes(name: impl Into<String>, bytes: Vec<u8>) -> Self {
        Self { name: name.into(), content: Content::Bytes(bytes), machine: None, date: None }
    }

    /// Id of the row that this recording gets: the hash of its bytes, the model, the options, the seed and the version.
    ///
    /// # Errors
    /// When the file cannot be read.
    pub fn id(&self, model: &Model, options: &FleetOptions, seed: u64) -> io::Result<String> {
        let mut hash = Sha256::new();
        match &self.content {
            Content::Path(path) => hash_file(path, &mut hash)?,
            Content::Bytes(bytes) => hash.update(bytes),
        }
        let content = hash.finalize();
        Ok(combined(&[&content, model.text.as_bytes(), options.text().as_bytes(), &seed.to_le_bytes()]))
    }

    /// Id of a recording whose bytes cannot be read: computed from its name instead.
    pub(crate) fn id_of_name(&self, model: &Model, options: &FleetOptions, seed: u64) -> String {
        let name = format!("unreadable {}", self.name);
        combined(&[name.as_bytes(), model.text.as_bytes(), options.text().as_bytes(), &seed.to_le_bytes()])
    }

    /// Calls `work` with a path at which the bytes can be read.
    pub(crate) fn with_path<T>(&self, work: impl FnOnce(&Path) -> T) -> io::Result<T> {
        match &self.content {
            Content::Path(path) => Ok(work(path)),
            Content::Bytes(bytes) => {
                let mut file = NamedTempFile::new()?;
                file.write_all(bytes)?;
                file.flush()?;
                Ok(work(file.path()))
            }
        }
    }
}

fn hash_file(path: &Path, hash: &mut Sha256) -> io::Result<()> {
    // A pipe would never end, and what it gave would be gone.
    if !path.metadata()?.is_file() {
        return Err(io::Error::other("it is not a file"));
    }
    let mut file = File::open(path)?;
    let mut buffer = vec![0; 1 << 18];
    loop {
        match file.read(&mut buffer)? {
            0 => return Ok(()),
            count => hash.update(&buffer[..count]),
        }
    }
}

/// Hash of several texts and of the version, each with its length before it.
fn combined(parts: &[&[u8]]) -> String {
    let mut hash = Sha256::new();
    for part in parts.iter().copied().chain([VERSION.as_bytes()]) {
        hash.update((part.len() as u64).to_le_bytes());
        hash.update(part);
    }
    hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_id_changes_with_all_that_a_row_depends_on_and_with_nothing_else() {
        let model = Model::builtin("two-mass").unwrap();
        let options = FleetOptions::default();
        let source = Source::bytes("a.csv", b"t_s,x_rad\n".to_vec());
        let id = source.id(&model, &options, 1).unwrap();
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), b"t_s,x_rad\n").unwrap();
        assert_eq!(Source::path(file.path()).id(&model, &options, 1).unwrap(), id);
        let other_bytes = Source::bytes("a.csv", b"t_s,x_rad \n".to_vec());
        let other_model = Model::builtin("emps").unwrap();
        let other_options = FleetOptions { most_effects: 2, ..options.clone() };
        for other in [
            other_bytes.id(&model, &options, 1).unwrap(),
            source.id(&other_model, &options, 1).unwrap(),
            source.id(&model, &other_options, 1).unwrap(),
            source.id(&model, &options, 2).unwrap(),
        ] {
            assert_ne!(other, id);
        }
    }
}
