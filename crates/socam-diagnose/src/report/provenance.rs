//! What a report was made from, and how: command, date, and the hash of each file.

use std::{fs::File, io, path::Path};

use sha2::{Digest, Sha256};

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
        let (mut file, mut hash) = (File::open(path)?, Sha256::new());
        let mut block = vec![0; 1 << 16];
        loop {
            match io::Read::read(&mut file, &mut block)? {
                0 => break,
                read => hash.update(&block[..read]),
            }
        }
        Ok(Self { name: name.to_owned(), sha256: hexadecimal(&hash.finalize()) })
    }

    /// The hash of a file's content.
    ///
    /// ```
    /// let hash = socam_diagnose::report::FileHash::of_content("empty", b"");
    /// assert!(hash.sha256.starts_with("e3b0c44298fc1c14"));
    /// ```
    #[must_use]
    pub fn of_content(name: &str, content: &[u8]) -> Self {
        Self { name: name.to_owned(), sha256: hexadecimal(&Sha256::digest(content)) }
    }
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
