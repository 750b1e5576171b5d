//! What a report was made from, and how: command, date, and the hash of each file.

use std::{io, path::Path};

/// Command, date and files of a report. A page says nothing of what is empty.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Provenance {
    /// The command as it was typed.
    pub command: String,
    /// Date and time with its zone.
    pub date: String,
    /// The files that were read.
    pub files: Vec<FileHash>,
}

/// A file and its hash.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FileHash {
    /// Its name as it was given.
    pub name: String,
    /// Its SHA-256 in hexadecimal digits.
    pub sha256: String,
}

impl FileHash {
    /// The hash of a file, read in blocks.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn of_file(name: &str, path: &Path) -> io::Result<Self> {
        Ok(Self { name: name.to_owned(), sha256: socam_recording::sha256_of_file(path)? })
    }

    /// The hash of a file's content.
    ///
    /// ```
    /// let hash = socam_report::FileHash::of_content("empty", b"");
    /// assert!(hash.sha256.starts_with("e3b0c44298fc1c14"));
    /// ```
    #[must_use]
    pub fn of_content(name: &str, content: &[u8]) -> Self {
        Self { name: name.to_owned(), sha256: socam_recording::sha256(content) }
    }
}
