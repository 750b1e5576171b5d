//! The window in a browser: a page passes files to it, and offers the files that it writes for download.

use std::path::Path;

use egui::{Context, Ui};
use socam_recording::Dataset;
use socam_workbench::document::{self, Document};
use socam_workbench::job::{Handle, Job};
use socam_workbench::purpose::Purpose;
use socam_workbench::recording::Recording;
use socam_workbench::session::Session;

use crate::dashboard::Dashboard;
use crate::progress::wake;

/// Reads a file that was given to the page.
fn read(name: &str) -> Result<Dataset, String> {
    Dataset::open(name).map_err(|error| error.to_string())
}

impl Dashboard {
    /// Opens a file that was given to the page.
    pub fn take_file(&mut self, ctx: &Context, name: &str, bytes: Vec<u8>) {
        let is_text = name.ends_with(".json") || name.ends_with(".toml");
        let title = format!("Opening {name}");
        let own = name.to_owned();
        let open = move |handle: &Handle| {
            if is_text {
                let text = String::from_utf8(bytes).map_err(|_| (format!("{own} is no text"), None))?;
                let document = document::parse(&own, &text);
                return document.map(|document| (document, None)).map_err(|sentence| (sentence, None));
            }
            socam_recording::hand_over(&own, bytes);
            let run = Recording::open(&own, read, handle).map_err(|sentence| (sentence, None))?;
            Ok((Document::Recording(run), None))
        };
        self.opening.push(Job::start(&title, &wake(ctx), open));
    }

    /// Files for download since the last call.
    pub fn take_leaving(&mut self) -> Vec<(String, Vec<u8>)> {
        std::mem::take(&mut self.own.leaving)
    }

    /// Whether the page should ask for files to open; resets the request.
    pub fn take_wish_for_files(&mut self) -> bool {
        std::mem::take(&mut self.own.wishes_files)
    }

    /// Asks for a file by the page's dialog; what is saved is offered for download under its usual name.
    pub(crate) fn ask(&mut self, ctx: &Context, purpose: Purpose, name: &str) {
        match purpose {
            Purpose::Open => self.own.wishes_files = true,
            _ => self.answered(ctx, purpose, vec![name.into()]),
        }
    }

    /// Offers a file for download.
    pub(crate) fn put(&mut self, path: &Path, bytes: Result<Vec<u8>, String>) {
        match bytes {
            Ok(bytes) => self.own.leaving.push((path.display().to_string(), bytes)),
            Err(sentence) => self.warn(sentence),
        }
    }

    pub(crate) fn show_found(&mut self, document: Document, _: Option<&str>) {
        self.show(document);
    }

    /// A page cannot open paths: it is given files.
    pub(crate) fn open(&mut self, _: impl IntoIterator<Item = String>) {}

    /// Nothing waits for files.
    pub(crate) fn will_begin(&self) -> bool {
        false
    }

    pub(crate) fn begin_to_open(&mut self, _: &Context) {}

    pub(crate) fn begin(&mut self, _: &Context) {}

    /// A page has no dialogs of its own.
    pub(crate) fn dialogs(&mut self, _: &Context) {}

    pub(crate) fn is_choosing(&self) -> bool {
        false
    }

    pub(crate) fn is_asking(&self) -> bool {
        false
    }

    pub(crate) fn asking(&mut self, _: &mut Ui) {}

    /// A page reads no file whose columns lack units.
    pub(crate) fn ask_for_columns(&mut self, _: &str) {}

    /// A page does not know the paths of its files.
    pub(crate) fn note_saved(&mut self, _: Purpose, _: &Path) {}

    /// A page offers no session, since it cannot open files by their paths.
    pub(crate) fn save_session(&mut self, _: &Path) {}

    /// A page shows the layout of a session and names its recordings.
    pub(crate) fn show_session(&mut self, session: Session) {
        self.views.time.arrange(&session.layout);
        let runs: Vec<&str> = session.recordings.iter().map(|own| own.run.as_str()).collect();
        self.say(format!(
            "the plots are those of the session; a page cannot open its recordings by their paths, drop them here: {}",
            runs.join(", ")
        ));
    }
}
