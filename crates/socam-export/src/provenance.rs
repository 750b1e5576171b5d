//! Origin of an exported model.

use sha2::{Digest, Sha256};

/// Origin of an exported model.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Provenance {
    /// Name of the model file.
    pub file: String,
    /// SHA-256 of the model file, in hexadecimal digits.
    pub sha256: String,
    /// Version of socam.
    pub version: &'static str,
}

impl Provenance {
    /// Origin of a model that comes from the file `file` with this text.
    #[must_use]
    pub fn new(file: &str, text: &str) -> Self {
        let digest = Sha256::digest(text.as_bytes());
        let sha256 = digest.iter().map(|byte| format!("{byte:02x}")).collect();
        Self { file: file.to_owned(), sha256, version: env!("CARGO_PKG_VERSION") }
    }
}
