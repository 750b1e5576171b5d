//! Opening and saving: the jobs that read and write files, and what becomes of their results.

use std::path::{Path, PathBuf};

use egui::Context;
use socam_workbench::Content;
use socam_workbench::about::short;
use socam_workbench::document::Document;
use socam_workbench::job::{CANCELLED, Handle, Job};
use socam_workbench::purpose::Purpose;

use super::Dashboard;
use crate::platform::{self, Found};
use crate::progress::wake;

/// An opened document or an error, and the file from which it was opened.
pub(crate) type Opened = Result<(Found, Option<String>), (String, Option<String>)>;

/// Result of saving: the path, and the bytes unless they are written already.
pub(super) type Saved = Result<(PathBuf, Option<Vec<u8>>), String>;

impl Dashboard {
    /// Simulates the model with the inputs of the shown recordings, and opens the results beside them.
    pub(crate) fn simulate(&mut self, ctx: &Context) {
        let Some(simulate) = self.workspace.simulate else { return };
        for entry in
            self.workspace.entries.iter().filter(|entry| entry.shown && entry.recording.path().is_some())
        {
            let (model, own) = (self.workspace.model().clone(), entry.recording.clone());
            let title = format!("Simulating {}", short(&own.about.name));
            let work = move |_: &Handle| {
                simulate(&model, &own)
                    .map(|run| (Document::Recording(run).into(), None))
                    .map_err(|sentence| (sentence, None))
            };
            self.opening.push(Job::start(&title, &wake(ctx), work));
        }
    }

    /// Shows the documents that have been opened since the last pass.
    pub(super) fn take_opened(&mut self) {
        // Files are taken in the order in which they were named: the first one gets the first colour.
        while let Some(result) = self.opening.first().and_then(Job::poll) {
            self.opening.remove(0);
            match result.unwrap_or_else(|sentence| Err((sentence, None))) {
                Ok((found, path)) => {
                    path.iter().for_each(|path| self.layout.remember(path));
                    self.show_found(found, path.as_deref());
                }
                Err((sentence, _)) if sentence == CANCELLED => {}
                Err((text, _)) => self.warn(text),
            }
        }
    }

    /// Uses the files that were chosen in a dialog.
    pub(crate) fn answered(&mut self, ctx: &Context, purpose: Purpose, files: Vec<PathBuf>) {
        match purpose {
            Purpose::Open => self.open(files.iter().map(|path| path.display().to_string())),
            Purpose::Export => self.exporting = files.into_iter().next(),
            Purpose::SaveSignal => {
                let text = self.workspace.present_signal().text();
                files.iter().for_each(|path| self.put(path, Ok(text.clone().into_bytes())));
            }
            Purpose::SaveRecording => files.iter().for_each(|path| self.save_recording(ctx, path)),
            Purpose::SaveSession => files.iter().for_each(|path| self.save_session(path)),
            Purpose::SaveModel
            | Purpose::SaveJson
            | Purpose::SaveReport
            | Purpose::SavePlots
            | Purpose::SavePicture
            | Purpose::SaveAnimation => {
                if let Some((path, content)) = files.first().zip(self.content.take()) {
                    self.save_content(path, content);
                    self.note_saved(purpose, path);
                }
            }
        }
    }

    fn save_content(&mut self, path: &Path, content: Content) {
        match content {
            Content::Bytes(bytes) => self.put(path, Ok(bytes)),
            Content::Report(write) => match write(path) {
                Ok(()) => self.say(format!("{} is written: open its index.html", path.display())),
                Err(sentence) => self.warn(sentence),
            },
        }
    }

    /// Writes the first recording that is shown; on a thread, since it may be long.
    fn save_recording(&mut self, ctx: &Context, path: &Path) {
        let Some(recording) =
            self.workspace.entries.iter().find(|entry| entry.shown).map(|entry| &entry.recording)
        else {
            return self.warn("no recording is shown; open one first");
        };
        let (recording, path) = (recording.clone(), path.to_owned());
        let title = format!("Saving {}", path.display());
        self.saving.push(Job::start(&title, &wake(ctx), move |handle| {
            platform::save(&recording, &path, handle).map(|bytes| (path, bytes))
        }));
    }

    /// Writes all samples in sight of the view over time; on a thread, since they may be many.
    pub(super) fn export_samples(&mut self, ctx: &Context, path: PathBuf) {
        match self.views.time.in_sight(&self.workspace.entries) {
            Ok(table) => {
                let title = format!("Writing {}", path.display());
                self.saving.push(Job::start(&title, &wake(ctx), move |handle| {
                    table.text(handle).map(|text| (path, Some(text.into_bytes())))
                }));
            }
            Err(sentence) => self.warn(sentence),
        }
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
