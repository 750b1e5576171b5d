//! Recordings of a fleet as files: where they are, and the way from a row to its recording.

use std::path::{Path, PathBuf};

use egui::{Frame, Key, Margin, RichText, Role, TextEdit, Ui, WidgetInfo};

use super::opened::Opened;
use socam_chart::theme;
use socam_workbench::View;
use socam_workbench::{Request, Workspace};

/// Search for the folder of the recordings.
#[derive(Debug, Default)]
pub(super) struct Folder {
    /// Folder in which the last recording was found, or that the user chose.
    known: Option<PathBuf>,
    typed: String,
    /// Recordings that were not found.
    lost: Vec<String>,
    /// Whether it was said which model the fleet has.
    has_said_model: bool,
}

impl Folder {
    /// Opens recordings, and makes the fleet's model the one they are compared with. Asks for the folder of those that are not found.
    pub(super) fn open(&mut self, opened: &Opened, names: &[String], workspace: &mut Workspace) {
        self.lost.clear();
        let mut found = Vec::new();
        for name in names {
            match self.find(&opened.path, name) {
                Some(path) => found.push(path),
                None => self.lost.push(name.clone()),
            }
        }
        if found.is_empty() {
            return;
        }
        self.use_model(opened, workspace);
        let is_open = |path: &PathBuf| {
            workspace.entries.iter().any(|entry| entry.recording.path() == Some(path.as_path()))
        };
        found.retain(|path| !is_open(path));
        if found.is_empty() {
            workspace.request(Request::Show(View::Time));
        }
        found.iter().for_each(|path| workspace.request(Request::Open(path.display().to_string())));
    }

    fn use_model(&mut self, opened: &Opened, workspace: &mut Workspace) {
        if opened.about.is_of(workspace.model()) {
            return;
        }
        match &opened.model {
            Some(model) => workspace.request(Request::Model(Box::new(model.clone()))),
            None if !std::mem::replace(&mut self.has_said_model, true) => {
                workspace.request(Request::Say(unknown_model(opened)));
            }
            None => {}
        }
    }

    /// A recording in the folder that is known, beside the table, or in a folder beside the table.
    fn find(&mut self, table: &Path, name: &str) -> Option<PathBuf> {
        let beside = table.parent().unwrap_or(Path::new(""));
        let first = self.known.iter().cloned().chain([beside.to_owned()]);
        let found = first.into_iter().find(|root| root.join(name).is_file()).or_else(|| {
            let here = if beside == Path::new("") { Path::new(".") } else { beside };
            let inside = std::fs::read_dir(here).ok()?.filter_map(|entry| Some(entry.ok()?.path()));
            let mut roots: Vec<PathBuf> = inside.filter(|root| root.join(name).is_file()).collect();
            roots.sort();
            roots.into_iter().next()
        })?;
        let path = found.join(name);
        self.known = Some(found);
        Some(path)
    }

    /// Asks where the recordings are that were not found. Returns those to try again.
    pub(super) fn ask(&mut self, ui: &mut Ui, table: &str) -> Option<Vec<String>> {
        let first = self.lost.first()?;
        let others = match self.lost.len() - 1 {
            0 => String::new(),
            count => format!(" and {}", socam_fleet::words::counted(count as u64, "other", "others")),
        };
        let text = match &self.known {
            Some(known) => format!("{first}{others}: not in {} and not beside {table}", known.display()),
            None => format!("{first}{others}: not beside {table} and not in a folder there"),
        };
        let mut looks = false;
        let frame = Frame::new().fill(theme::alarm_ground(ui)).corner_radius(4).inner_margin(Margin::same(6));
        frame.show(ui, |ui| {
            ui.add(egui::Label::new(RichText::new(text)).wrap());
            ui.horizontal(|ui| {
                let label = ui.label("Folder of the recordings");
                let width = (ui.available_width() - 100.0).clamp(80.0, 420.0);
                let field = ui.add(TextEdit::singleline(&mut self.typed).desired_width(width));
                field.widget_info(|| WidgetInfo::labeled(Role::TextInput, true, "Folder of the recordings"));
                let field = field.labelled_by(label.id);
                looks = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
                looks |= ui.button("Look there").clicked();
            });
        });
        if !looks || self.typed.trim().is_empty() {
            return None;
        }
        self.known = Some(PathBuf::from(self.typed.trim()));
        Some(std::mem::take(&mut self.lost))
    }
}

/// Text on what to do if the fleet's model is not built in.
pub(super) fn unknown_model(opened: &Opened) -> String {
    format!(
        "the model {} of this fleet is not built in: open its file to compare recordings with it",
        opened.about.model
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn recordings_are_found_beside_the_table_in_its_folders_and_where_the_user_says() {
        let place = tempfile::tempdir().unwrap();
        let put = |name: &str| {
            let path = place.path().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(&path, "").unwrap();
            path
        };
        let table = put("results/fleet.parquet");
        let (beside, inside, away) =
            (put("results/SN1/a.csv"), put("results/machines/SN2/b.csv"), put("disk/SN3/c.csv"));
        let mut folder = Folder::default();
        assert_eq!(folder.find(&table, "SN1/a.csv"), Some(beside));
        assert_eq!(folder.find(&table, "SN2/b.csv"), Some(inside.clone()));
        assert_eq!(folder.find(&table, "SN3/c.csv"), None);
        folder.known = Some(place.path().join("disk"));
        assert_eq!(folder.find(&table, "SN3/c.csv"), Some(away));
        assert_eq!(folder.find(&table, "SN2/b.csv"), Some(inside));
    }
}
