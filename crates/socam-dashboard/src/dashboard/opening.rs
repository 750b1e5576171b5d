//! Opening and saving: files that were named, dropped or chosen, and the jobs that read and write them.

use std::path::{Path, PathBuf};

use super::Dashboard;
use crate::document::Document;
use crate::files::{Answer, Purpose};
use crate::job::{CANCELLED, Job};
use crate::outside;

impl Dashboard {
    /// Simulates the model with the inputs of the shown recordings, and opens the results beside them.
    pub(crate) fn simulate(&mut self, ctx: &egui::Context) {
        let Some(simulate) = self.simulate else { return };
        for entry in
            self.workspace.entries.iter().filter(|entry| entry.shown && entry.recording.path.is_some())
        {
            let (model, run) = (self.workspace.model().clone(), entry.recording.about.name.clone());
            let title = format!("Simulating {}", crate::recording::short(&run));
            let work = move |_: &crate::job::Handle| simulate(&model, &run).map(Document::Recording);
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
            self.opening.push(Job::start(&title, ctx, move |handle| crate::document::open(&path, handle)));
        }
    }

    /// Shows the documents that have been opened since the last pass.
    pub(super) fn take_opened(&mut self) {
        // In the order in which files were named: the first one gets the first colour.
        while let Some(result) = self.opening.first().and_then(Job::poll) {
            self.opening.remove(0);
            match result.and_then(|result| result) {
                Ok(document) => self.show(document),
                Err(sentence) if sentence == CANCELLED => {}
                Err(sentence) => self.warn(sentence),
            }
        }
    }

    pub(super) fn dialogs(&mut self, ctx: &egui::Context) {
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
            Purpose::SaveBytes => {
                let bytes = std::mem::take(&mut self.to_save);
                files.iter().for_each(|path| self.put(path, Ok(bytes.clone())));
            }
            Purpose::SaveRecording => files.iter().for_each(|path| self.save_recording(ctx, path)),
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
