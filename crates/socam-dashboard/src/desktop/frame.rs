//! The window on a desktop: files are opened by their paths and written to the disk, and dialogs ask for them.

use std::path::Path;

use egui::{Context, Ui};
use socam_workbench::View;
use socam_workbench::document::{self, Document};
use socam_workbench::entry::Entry;
use socam_workbench::job::{Handle, Job};
use socam_workbench::purpose::Purpose;
use socam_workbench::save;
use socam_workbench::setup::Role;

use super::columns::{Answer, Pane};
use super::files::{self, Dialog};
use super::fleet::Opened;
use super::foreign;
use super::native::{Ended, Native};
use super::own::Found;
use crate::dashboard::Dashboard;
use crate::progress::wake;

/// Opens a path: a document, or the table of a fleet.
fn found(path: &str, handle: &Handle) -> Result<Found, String> {
    if socam_fleet::Table::is_one(Path::new(path)) {
        return Opened::read(Path::new(path), handle).map(Found::from);
    }
    document::open(path, foreign::read, handle).map(Found::from)
}

impl Dashboard {
    /// Uses the desktop's file dialogs; without a desktop the window draws its own.
    pub fn use_native_dialogs(&mut self) {
        self.own.is_native = true;
    }

    /// Opens files with the next pass.
    pub fn open(&mut self, paths: impl IntoIterator<Item = String>) {
        self.own.waiting.extend(paths);
    }

    /// Diagnoses the recordings once all of them are open; those named in `held_out` are used for validation only.
    pub fn diagnose(&mut self, held_out: Vec<String>) {
        self.own.diagnose = Some(held_out);
    }

    /// Watches the running bench, or else the first recording, once all files are open; other recordings are healthy.
    pub fn watch(&mut self) {
        self.own.watches = true;
    }

    /// Shows this view once all files are open, whatever view their kind would choose.
    pub fn show_first(&mut self, view: View) {
        self.own.first_view = Some(view);
    }

    /// Shows a fleet.
    pub fn show_fleet(&mut self, opened: Opened) {
        self.views.fleet.show(opened);
        self.layout.view = View::Fleet;
    }

    /// Whether files wait to be opened, or something begins once they are.
    pub(crate) fn will_begin(&self) -> bool {
        let begins = self.own.diagnose.is_some() || self.own.watches;
        !self.own.waiting.is_empty() || (begins && !self.workspace.entries.is_empty())
    }

    /// Begins what waits for all files to be open.
    pub(crate) fn begin(&mut self, ctx: &Context) {
        if !self.opening.is_empty() || !self.own.waiting.is_empty() {
            return;
        }
        self.end_session();
        if !self.workspace.entries.is_empty()
            && let Some(held_out) = self.own.diagnose.take()
        {
            for name in held_out {
                self.workspace.setup.use_as(&name, Role::HoldOut);
            }
            self.views.diagnosis.begin(ctx, &self.workspace);
            self.layout.view = View::Diagnosis;
        }
        if std::mem::take(&mut self.own.watches) {
            self.views.watch.begin_when_possible();
            self.layout.view = View::Watch;
        }
        if let Some(view) = self.own.first_view.take() {
            self.layout.view = view;
        }
    }

    /// Shows what was opened, from a file.
    pub(crate) fn show_found(&mut self, found: Found, path: Option<&str>) {
        match found {
            Found::Document(document) => {
                let (is_fit, is_diagnosis) = (
                    matches!(*document, Document::Identification(_)),
                    matches!(*document, Document::Diagnosis(..)),
                );
                self.show(*document);
                match path {
                    Some(path) if is_fit => self.identification_is_in(path),
                    Some(path) if is_diagnosis => self.diagnosis_is_in(path),
                    _ => {}
                }
            }
            Found::Fleet(opened) => self.show_fleet(*opened),
        }
    }

    /// Asks for the names and units of the columns of a recording's file.
    pub(crate) fn ask_for_columns(&mut self, run: &str) {
        let entries = &self.workspace.entries;
        let recording = entries.iter().map(|entry| &entry.recording).find(|own| own.about.name == run);
        match recording.and_then(|own| own.path()).map(|path| Pane::of(path, run)) {
            Some(Ok(pane)) => self.own.columns = Some(pane),
            Some(Err(sentence)) => self.warn(sentence),
            None => {}
        }
    }

    /// Draws the window of columns. When its mapping is written, the recordings of the file are opened again.
    fn columns(&mut self, ctx: &Context) {
        let Some(pane) = &mut self.own.columns else { return };
        let Some(answer) = pane.ui(ctx) else { return };
        let path = pane.path();
        self.own.columns = None;
        if let Answer::Written = answer {
            let is_it = |entry: &Entry| entry.recording.path() == Some(path.as_path());
            let runs: Vec<String> = self
                .workspace
                .entries
                .iter()
                .filter(|entry| is_it(entry))
                .map(|entry| entry.recording.about.name.clone())
                .collect();
            self.workspace.entries.retain(|entry| !is_it(entry));
            self.open(runs);
        }
    }

    /// Writes a file and reports it.
    pub(crate) fn put(&mut self, path: &Path, bytes: Result<Vec<u8>, String>) {
        match bytes.and_then(|bytes| save::write_new(path, &bytes)) {
            Ok(()) => self.say(format!("{} is written", path.display())),
            Err(sentence) => self.warn(sentence),
        }
    }

    /// Whether a dialog of the window's own is open.
    pub(crate) fn is_choosing(&self) -> bool {
        self.own.dialog.is_some() || self.own.columns.is_some()
    }

    /// Whether a dialog of the desktop is open.
    pub(crate) fn is_asking(&self) -> bool {
        self.own.native.is_some()
    }

    /// Begins to open files that were dropped into the window or named before.
    pub(crate) fn begin_to_open(&mut self, ctx: &Context) {
        let dropped = ctx.input(|input| input.raw.dropped_files.clone());
        self.own.waiting.extend(dropped.iter().map(|file| file.path().display().to_string()));
        for path in std::mem::take(&mut self.own.waiting) {
            if let Some(folder) = Path::new(&path).parent().filter(|folder| folder.is_dir()) {
                self.layout.folder = folder.into();
            }
            let title = format!("Opening {path}");
            let open = move |handle: &Handle| match found(&path, handle) {
                Ok(found) => Ok((found, Some(path))),
                Err(sentence) => Err((sentence, Some(path))),
            };
            self.opening.push(Job::start(&title, &wake(ctx), open));
        }
    }

    /// Asks for a file by a dialog of the desktop, or by one of its own.
    pub(crate) fn ask(&mut self, ctx: &Context, purpose: Purpose, name: &str) {
        let folder = self.layout.folder.canonicalize().unwrap_or_else(|_| self.layout.folder.clone());
        if self.own.is_native {
            self.own.native = Some(Native::open(ctx, purpose, &folder, name));
        } else {
            self.own.dialog = Some(Dialog::new(purpose, &folder, name));
        }
    }

    /// Waits for a dialog of the desktop; where there is none, and from then on, the window draws its own.
    pub(crate) fn native_dialog(&mut self, ctx: &Context) {
        let Some(ended) = self.own.native.as_ref().and_then(Native::poll) else { return };
        let Some(Native { purpose, name, .. }) = self.own.native.take() else { return };
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
    pub(crate) fn choose_here(&mut self, ctx: &Context, purpose: Purpose, name: &str) {
        self.own.is_native = false;
        self.own.native = None;
        self.ask(ctx, purpose, name);
    }

    pub(crate) fn dialogs(&mut self, ctx: &Context) {
        self.native_dialog(ctx);
        self.columns(ctx);
        let Some(dialog) = &mut self.own.dialog else { return };
        let Some(answer) = dialog.ui(ctx) else { return };
        let purpose = dialog.purpose;
        self.layout.folder = dialog.folder().into();
        self.own.dialog = None;
        if let files::Answer::Files(files) = answer {
            self.answered(ctx, purpose, files);
        }
    }

    /// Says that a dialog of the desktop is open, which another window may cover.
    pub(crate) fn asking(&mut self, ui: &mut Ui) {
        let Some(native) = &self.own.native else { return };
        let (purpose, name) = (native.purpose, native.name.clone());
        ui.horizontal(|ui| {
            if ui.button("Choose here").clicked() {
                self.choose_here(ui.ctx(), purpose, &name);
            }
            ui.label(format!("A window of the desktop asks for a file: {}", purpose.title()));
        });
    }
}
