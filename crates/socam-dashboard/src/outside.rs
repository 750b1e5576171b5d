//! Files that leave the window: to the disk; in a browser, to the page, which offers them for download.

use std::path::{Path, PathBuf};

use crate::Dashboard;
#[cfg(not(target_arch = "wasm32"))]
use crate::job::CANCELLED;
use crate::job::Handle;
use crate::recording::Recording;
use crate::save;

/// Writes a file atomically; an existing file is never replaced.
///
/// # Errors
/// When there is such a file already, or it cannot be written; one sentence.
#[cfg(not(target_arch = "wasm32"))]
pub(crate) fn write_new(path: &Path, bytes: &[u8]) -> Result<(), String> {
    use std::io::Write;

    if path.exists() {
        return Err(format!("{} exists already; choose another name", path.display()));
    }
    let write = || -> socam_recording::Result<std::io::Result<()>> {
        let mut file = socam_recording::OutputFile::create(path)?;
        if let Err(error) = file.write_all(bytes) {
            return Ok(Err(error));
        }
        file.commit().map(Ok)
    };
    match write() {
        Ok(Ok(())) => Ok(()),
        Ok(Err(error)) => Err(format!("cannot write {}: {error}", path.display())),
        Err(error) => Err(error.to_string()),
    }
}

/// Result of saving a recording: its path and, in a browser, its bytes.
pub(crate) type Saved = Result<(PathBuf, Option<Vec<u8>>), String>;

/// Writes a recording, by its name as `.csv` or `.m`.
///
/// # Errors
/// When there is such a file already, it cannot be written, or it was cancelled; nothing is left then.
#[cfg(not(target_arch = "wasm32"))]
pub(crate) fn save(recording: &Recording, path: &Path, handle: &Handle) -> Result<Option<Vec<u8>>, String> {
    if path.exists() {
        return Err(format!("{} exists already; choose another name", path.display()));
    }
    let mut file = socam_recording::OutputFile::create(path).map_err(|error| error.to_string())?;
    let written = save::write(recording, path, &mut Cancellable { out: &mut file, handle });
    if handle.is_cancelled() {
        return Err(CANCELLED.into());
    }
    written?;
    file.commit().map_err(|error| error.to_string())?;
    Ok(None)
}

/// Writes a recording for the page.
#[cfg(target_arch = "wasm32")]
pub(crate) fn save(recording: &Recording, path: &Path, _: &Handle) -> Result<Option<Vec<u8>>, String> {
    let mut bytes = Vec::new();
    save::write(recording, path, &mut bytes)?;
    Ok(Some(bytes))
}

/// A writer that fails once the job is cancelled.
#[cfg(not(target_arch = "wasm32"))]
struct Cancellable<'a, W> {
    out: W,
    handle: &'a Handle,
}

#[cfg(not(target_arch = "wasm32"))]
impl<W: std::io::Write> std::io::Write for Cancellable<'_, W> {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        if self.handle.is_cancelled() {
            return Err(std::io::Error::other(CANCELLED));
        }
        self.out.write(bytes)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.out.flush()
    }
}

impl Dashboard {
    /// Writes a file and reports it.
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) fn put(&mut self, path: &Path, bytes: Result<Vec<u8>, String>) {
        match bytes.and_then(|bytes| write_new(path, &bytes)) {
            Ok(()) => self.say(format!("{} is written", path.display())),
            Err(sentence) => self.warn(sentence),
        }
    }

    /// Offers a file for download.
    #[cfg(target_arch = "wasm32")]
    pub(crate) fn put(&mut self, path: &Path, bytes: Result<Vec<u8>, String>) {
        match bytes {
            Ok(bytes) => self.leaving.push((path.display().to_string(), bytes)),
            Err(sentence) => self.warn(sentence),
        }
    }

    /// Opens a file that was given to the page.
    #[cfg(target_arch = "wasm32")]
    pub fn take_file(&mut self, ctx: &egui::Context, name: &str, bytes: Vec<u8>) {
        let is_text = name.ends_with(".json") || name.ends_with(".toml");
        let title = format!("Opening {name}");
        let own = name.to_owned();
        let open = move |handle: &Handle| {
            if is_text {
                let text = String::from_utf8(bytes).map_err(|_| (format!("{own} is no text"), None))?;
                let document = crate::document::parse(&own, &text);
                return document.map(|document| (document, None)).map_err(|sentence| (sentence, None));
            }
            socam_recording::hand_over(&own, bytes);
            let run = Recording::open(&own, handle).map_err(|sentence| (sentence, None))?;
            Ok((crate::document::Document::Recording(run), None))
        };
        self.opening.push(crate::job::Job::start(&title, ctx, open));
    }

    /// Files for download since the last call.
    #[cfg(target_arch = "wasm32")]
    pub fn take_leaving(&mut self) -> Vec<(String, Vec<u8>)> {
        std::mem::take(&mut self.leaving)
    }

    /// Whether the page should ask for files to open; resets the request.
    #[cfg(target_arch = "wasm32")]
    pub fn take_wish_for_files(&mut self) -> bool {
        std::mem::take(&mut self.wishes_files)
    }
}
