//! SHA-256 of files: whether two of them have the same content, without decoding a sample.

use std::io::{self, Read};
use std::path::Path;

use sha2::{Digest, Sha256};

use crate::error::{RecordingError, Result};

/// Bytes that are read at once.
const BLOCK: usize = 1 << 16;

/// SHA-256 of a file's content in hexadecimal digits, read in blocks.
///
/// # Errors
/// When the file cannot be read.
pub fn sha256_of_file(path: &Path) -> io::Result<String> {
    let (mut file, _) = crate::files::open(path)?;
    let (mut hash, mut block) = (Sha256::new(), vec![0; BLOCK]);
    loop {
        match file.read(&mut block)? {
            0 => return Ok(hexadecimal(&hash.finalize())),
            read => hash.update(&block[..read]),
        }
    }
}

/// SHA-256 of bytes in hexadecimal digits.
///
/// ```
/// assert!(socam_recording::sha256(b"").starts_with("e3b0c44298fc1c14"));
/// ```
#[must_use]
pub fn sha256(content: &[u8]) -> String {
    hexadecimal(&Sha256::digest(content))
}

/// Whether two files have the same content: the same length and the same SHA-256.
pub(crate) fn is_same_content(one: &Path, other: &Path) -> Result<bool> {
    let read = |path: &Path, error| RecordingError::io(path, "read", error);
    let length = |path: &Path| crate::files::open(path).map(|(_, bytes)| bytes).map_err(|e| read(path, e));
    let hash = |path: &Path| sha256_of_file(path).map_err(|e| read(path, e));
    Ok(length(one)? == length(other)? && hash(one)? == hash(other)?)
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
