//! Sessions: what the window shows is saved as a file, and is there again when that is opened.

use std::path::Path;

use socam_model::Model;
use socam_workbench::about::short;
use socam_workbench::purpose::Purpose;
use socam_workbench::save;
use socam_workbench::session::{Named, SCHEMA, Session, is_there, relative, relative_run};

use crate::dashboard::Dashboard;

impl Dashboard {
    fn identification(&self) -> Option<String> {
        self.views.identify.page.shown.as_ref().map(|shown| format!("{shown:?}"))
    }

    fn shown_diagnosis(&self) -> Option<String> {
        self.views.diagnosis.page.shown.as_ref().map(|shown| format!("{:?}", shown.diagnosis))
    }

    /// Notes that a file holds the identification that is shown.
    pub(super) fn identification_is_in(&mut self, path: &str) {
        self.own.results.identification = self.identification().map(|text| (path.to_owned(), text));
    }

    /// Notes that a file or folder holds the diagnosis that is shown.
    pub(super) fn diagnosis_is_in(&mut self, path: &str) {
        self.own.results.diagnosis = self.shown_diagnosis().map(|text| (path.to_owned(), text));
    }

    /// Notes the file of a result that was saved.
    pub(crate) fn note_saved(&mut self, purpose: Purpose, path: &Path) {
        let path = path.display().to_string();
        match purpose {
            Purpose::SaveJson if is_there(&path) => self.identification_is_in(&path),
            Purpose::SaveReport if is_there(&path) => self.diagnosis_is_in(&path),
            _ => {}
        }
    }

    /// Saves what the window shows, and says what is in no file and thus not in the session.
    pub(crate) fn save_session(&mut self, path: &Path) {
        let folder = path.parent().unwrap_or(Path::new(""));
        let mut left_out: Vec<String> = Vec::new();
        let mut recordings = Vec::new();
        for entry in &self.workspace.entries {
            let name = &entry.recording.about.name;
            if entry.recording.path().is_none() {
                left_out.push(short(name).to_owned());
                continue;
            }
            recordings.push(Named {
                run: relative_run(name, folder),
                shown: entry.shown,
                shift_s: entry.shift_s,
                notes: entry.notes.clone(),
            });
        }
        let mut results = Vec::new();
        let known = &self.own.results;
        let shown = [
            ("the identification", self.identification(), &known.identification),
            ("the diagnosis", self.shown_diagnosis(), &known.diagnosis),
        ];
        for (what, shown, kept) in shown {
            match (shown, kept) {
                (Some(shown), Some((path, text))) if shown == *text => results.push(relative(path, folder)),
                (Some(_), _) => left_out.push(what.to_owned()),
                (None, _) => {}
            }
        }
        let session = Session {
            schema: SCHEMA.into(),
            view: self.layout.view,
            recordings,
            results,
            range_s: self.views.time.x,
            cursors_s: self.views.time.cursors,
            fit_range_s: self.workspace.setup.range_s,
            layout: self.views.time.arrangement(),
            model: Some(self.workspace.model().text.clone()),
        };
        match save::write_new(path, session.text().as_bytes()) {
            Ok(()) if left_out.is_empty() => self.say(format!("{} is written", path.display())),
            Ok(()) => self.say(format!(
                "{} is written without what is in no file: {}; save it first to have it in a session",
                path.display(),
                left_out.join(", ")
            )),
            Err(sentence) => self.warn(sentence),
        }
    }

    /// Replaces what the window shows by a session; its files are opened with the next pass.
    pub(crate) fn show_session(&mut self, session: Session) {
        let missing = session.missing();
        if !missing.is_empty() {
            let count = socam_plot::words::counted(missing.len(), "file that is", "files that are");
            self.warn(format!(
                "the session names {count} not there: {}; all else is open",
                missing.join(", ")
            ));
        }
        match session.model.as_deref().map(Model::parse) {
            Some(Ok(model)) if model.text != self.workspace.model().text => self.workspace.set_model(model),
            Some(Err(error)) => self.warn(format!("the model of the session is not used: {error}")),
            _ => {}
        }
        self.workspace.entries.clear();
        self.views.time.fit();
        self.views.time.arrange(&session.layout);
        (self.views.time.x, self.views.time.cursors) = (session.range_s, session.cursors_s);
        self.workspace.setup.range_s = session.fit_range_s;
        let paths = session.recordings.iter().map(|own| &own.run).chain(&session.results);
        let found: Vec<String> = paths.filter(|path| is_there(path)).cloned().collect();
        self.open(found);
        self.own.session = Some(session);
    }

    /// Shows the recordings of a session as they were, once all of them are open.
    pub(super) fn end_session(&mut self) {
        let Some(session) = self.own.session.take() else { return };
        for named in &session.recordings {
            let is_it = |own: &&mut socam_workbench::entry::Entry| own.recording.about.name == named.run;
            if let Some(entry) = self.workspace.entries.iter_mut().find(is_it) {
                (entry.shown, entry.shift_s) = (named.shown, named.shift_s);
                entry.notes.clone_from(&named.notes);
            }
        }
        self.layout.view = session.view;
    }
}
