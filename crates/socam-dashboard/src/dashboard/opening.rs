//! Opening and saving: files that were named, dropped or chosen, and the jobs that read and write them.

use std::path::{Path, PathBuf};

use super::Dashboard;
use crate::document::Document;
#[cfg(not(target_arch = "wasm32"))]
use crate::files::Dialog;
use crate::files::{Answer, Purpose};
use crate::job::{CANCELLED, Job};
#[cfg(not(target_arch = "wasm32"))]
use crate::native::{Ended, Native};
use crate::outside;
use crate::workspace::Content;

/// A document that was opened, or why it was not, and the file that it was opened from.
pub(crate) type Opened = Result<(Document, Option<String>), (String, Option<String>)>;

impl Dashboard {
    /// Simulates the model with the inputs of the shown recordings, and opens the results beside them.
    pub(crate) fn simulate(&mut self, ctx: &egui::Context) {
        let Some(simulate) = self.simulate else { return };
        for entry in
            self.workspace.entries.iter().filter(|entry| entry.shown && entry.recording.path.is_some())
        {
            let (model, run) = (self.workspace.model().clone(), entry.recording.about.name.clone());
            let title = format!("Simulating {}", crate::recording::short(&run));
            let work = move |_: &crate::job::Handle| {
                simulate(&model, &run)
                    .map(|run| (Document::Recording(run), None))
                    .map_err(|sentence| (sentence, None))
            };
            self.opening.push(Job::start(&title, ctx, work));
        }
    }

    /// Begins to open files that were dropped into the window or named before.
    #[cfg(not(target_arch = "wasm32"))]
    pub(super) fn begin_to_open(&mut self, ctx: &egui::Context) {
        let dropped = ctx.input(|input| input.raw.dropped_files.clone());
        self.waiting.extend(dropped.iter().map(|file| file.path().display().to_string()));
        for path in std::mem::take(&mut self.waiting) {
            if let Some(folder) = Path::new(&path).parent().filter(|folder| folder.is_dir()) {
                self.layout.folder = folder.into();
            }
            let title = format!("Opening {path}");
            let open = move |handle: &crate::job::Handle| match crate::document::open(&path, handle) {
                Ok(document) => Ok((document, Some(path))),
                Err(sentence) => Err((sentence, Some(path))),
            };
            self.opening.push(Job::start(&title, ctx, open));
        }
    }

    /// Shows the documents that have been opened since the last pass.
    pub(super) fn take_opened(&mut self) {
        // In the order in which files were named: the first one gets the first colour.
        while let Some(result) = self.opening.first().and_then(Job::poll) {
            self.opening.remove(0);
            match result.unwrap_or_else(|sentence| Err((sentence, None))) {
                Ok((document, path)) => {
                    path.into_iter().for_each(|path| self.layout.remember(&path));
                    self.show(document);
                }
                Err((sentence, _)) if sentence == CANCELLED => {}
                #[cfg(not(target_arch = "wasm32"))]
                Err((text, to_map)) if crate::foreign::needs_mapping(&text) => {
                    self.notices.push(super::Notice { text, grave: true, to_map });
                }
                Err((sentence, _)) => self.warn(sentence),
            }
        }
    }

    /// Asks for a file. A page in a browser uses its own dialogs and offers saved files for download.
    #[cfg(target_arch = "wasm32")]
    pub(crate) fn ask(&mut self, ctx: &egui::Context, purpose: Purpose, name: &str) {
        match purpose {
            Purpose::Open => self.wishes_files = true,
            _ => self.answered(ctx, purpose, vec![name.into()]),
        }
    }

    /// Asks for a file by a dialog of the desktop, or by one of its own.
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) fn ask(&mut self, ctx: &egui::Context, purpose: Purpose, name: &str) {
        let folder = self.layout.folder.canonicalize().unwrap_or_else(|_| self.layout.folder.clone());
        if self.is_native {
            self.native = Some(Native::open(ctx, purpose, &folder, name));
        } else {
            self.dialog = Some(Dialog::new(purpose, &folder, name));
        }
    }

    /// Waits for a dialog of the desktop; where there is none, and from then on, the window draws its own.
    #[cfg(not(target_arch = "wasm32"))]
    pub(super) fn native_dialog(&mut self, ctx: &egui::Context) {
        let Some(ended) = self.native.as_ref().and_then(Native::poll) else { return };
        let Some(Native { purpose, name, .. }) = self.native.take() else { return };
        match ended {
            Ended::Files(files) => {
                if let Some(folder) = files.first().and_then(|file| file.parent()) {
                    self.layout.folder = folder.into();
                }
                self.answered(ctx, purpose, files);
            }
            Ended::Cancelled => {}
            Ended::Unseen => self.choose_here(ctx, purpose, &name),
        }
    }

    /// Asks by the window's own dialog from now on.
    #[cfg(not(target_arch = "wasm32"))]
    pub(super) fn choose_here(&mut self, ctx: &egui::Context, purpose: Purpose, name: &str) {
        self.is_native = false;
        self.native = None;
        self.ask(ctx, purpose, name);
    }

    pub(super) fn dialogs(&mut self, ctx: &egui::Context) {
        #[cfg(not(target_arch = "wasm32"))]
        self.native_dialog(ctx);
        let Some(dialog) = &mut self.dialog else { return };
        let Some(answer) = dialog.ui(ctx) else { return };
        let purpose = dialog.purpose;
        self.layout.folder = dialog.folder().into();
        self.dialog = None;
        if let Answer::Files(files) = answer {
            self.answered(ctx, purpose, files);
        }
    }

    /// Uses the files that were chosen in a dialog.
    pub(crate) fn answered(&mut self, ctx: &egui::Context, purpose: Purpose, files: Vec<PathBuf>) {
        match purpose {
            Purpose::Open => self.open(files.iter().map(|path| path.display().to_string())),
            Purpose::Export => self.exporting = files.into_iter().next(),
            Purpose::SaveSignal => {
                let text = self.views.live.signal.text();
                files.iter().for_each(|path| self.put(path, Ok(text.clone().into_bytes())));
            }
            Purpose::SaveRecording => files.iter().for_each(|path| self.save_recording(ctx, path)),
            Purpose::SaveModel
            | Purpose::SaveJson
            | Purpose::SaveReport
            | Purpose::SavePlots
            | Purpose::SavePicture => {
                if let Some((path, content)) = files.first().zip(self.content.take()) {
                    self.save_content(path, content);
                }
            }
        }
    }

    fn save_content(&mut self, path: &Path, content: Content) {
        match content {
            Content::Bytes(bytes) => self.put(path, Ok(bytes)),
            #[cfg(not(target_arch = "wasm32"))]
            Content::Report(report) => match report.write(path) {
                Ok(()) => self.say(format!("{} is written: open its index.html", path.display())),
                Err(sentence) => self.warn(sentence),
            },
        }
    }

    /// Writes the first recording that is shown; on a thread, since it may be long.
    fn save_recording(&mut self, ctx: &egui::Context, path: &Path) {
        let Some(recording) =
            self.workspace.entries.iter().find(|entry| entry.shown).map(|entry| &entry.recording)
        else {
            return self.warn("no recording is shown; open one first");
        };
        let (recording, path) = (recording.clone(), path.to_owned());
        let title = format!("Saving {}", path.display());
        self.saving.push(Job::start(&title, ctx, move |handle| {
            outside::save(&recording, &path, handle).map(|bytes| (path, bytes))
        }));
    }

    /// Reports the files that have been saved since the last pass.
    pub(super) fn take_saved(&mut self) {
        while let Some(result) = self.saving.first().and_then(Job::poll) {
            self.saving.remove(0);
            match result.and_then(|result| result) {
                Ok((path, None)) => self.say(format!("{} is written", path.display())),
                Ok((path, bytes)) => self.put(&path, Ok(bytes.unwrap_or_default())),
                Err(sentence) if sentence == CANCELLED => {}
                Err(sentence) => self.warn(sentence),
            }
        }
    }
}
