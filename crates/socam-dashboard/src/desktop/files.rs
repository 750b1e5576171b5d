//! A dialog for choosing files to open or to save. The dashboard draws it itself, so that it does not need a desktop's dialog.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::time::UNIX_EPOCH;

use egui::{Button, Modal, RichText, Role, TextEdit, Ui, WidgetInfo};

use socam_chart::table::{self, Key, Table};
use socam_chart::theme;
use socam_workbench::purpose::{Purpose, can_open};

/// A dialog that is open.
#[derive(Debug)]
pub(super) struct Dialog {
    /// Purpose.
    pub(super) purpose: Purpose,
    /// The last folder that could be listed.
    folder: PathBuf,
    /// Name as typed.
    typed: String,
    name: String,
    /// Parts of names that are shown.
    search: String,
    chosen: BTreeSet<PathBuf>,
    entries: Vec<Row>,
    /// Why the typed folder is not shown.
    problem: Option<String>,
    /// Whether it has not been drawn yet.
    is_new: bool,
}

/// A file or a folder.
#[derive(Debug, Clone)]
struct Row {
    path: PathBuf,
    is_folder: bool,
    bytes: u64,
    /// When it was changed, s since 1970.
    changed_s: Option<i64>,
}

impl Row {
    fn name(&self) -> String {
        let name = self.path.file_name().unwrap_or_default().to_string_lossy();
        if self.is_folder { format!("{name}/") } else { name.into_owned() }
    }
}

const COLUMNS: [table::Column; 3] =
    [table::text("name", 300.0), table::number("size", 80.0), table::number("changed", 130.0)];

/// Result of a dialog.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Answer {
    /// The chosen files.
    Files(Vec<PathBuf>),
    /// Cancelled.
    Cancelled,
}

impl Dialog {
    /// A dialog in a folder; `name` is proposed for a file to be saved.
    #[must_use]
    pub(super) fn new(purpose: Purpose, folder: &Path, name: &str) -> Self {
        let mut dialog = Self {
            purpose,
            folder: folder.into(),
            typed: String::new(),
            name: name.into(),
            search: String::new(),
            chosen: BTreeSet::new(),
            entries: Vec::new(),
            problem: None,
            is_new: true,
        };
        dialog.go(folder.into());
        dialog
    }

    /// The folder that is shown.
    #[must_use]
    pub(super) fn folder(&self) -> &Path {
        &self.folder
    }

    /// Shows a folder. The path of a file shows the folder that it is in, with the file chosen; what is neither changes nothing.
    fn go(&mut self, path: PathBuf) {
        let file = path.is_file().then(|| path.clone());
        let folder = match &file {
            Some(file) => file.parent().unwrap_or(Path::new(".")).to_owned(),
            None => path,
        };
        match list(&folder) {
            Ok(entries) => {
                self.typed = folder.display().to_string();
                (self.folder, self.entries, self.problem) = (folder, entries, None);
                self.chosen = file.iter().cloned().collect();
                if let Some(name) = file.as_deref().and_then(Path::file_name) {
                    self.name = name.to_string_lossy().into_owned();
                }
            }
            Err(sentence) => self.problem = Some(sentence),
        }
    }

    /// Draws it; `Some` when it ended.
    pub(super) fn ui(&mut self, ctx: &egui::Context) -> Option<Answer> {
        let mut answer = None;
        let mut is_entered = false;
        let modal = Modal::new(egui::Id::unique("files")).show(ctx, |ui| {
            ui.set_width(560.0_f32.min(ui.ctx().content_rect().width() - 40.0));
            let opens = self.purpose == Purpose::Open;
            ui.heading(self.purpose.title());
            self.place(ui);
            self.contents(ui);
            if !opens {
                ui.horizontal(|ui| {
                    let label = ui.label("Name");
                    let field = ui.add(TextEdit::singleline(&mut self.name).desired_width(400.0));
                    let field = field.labelled_by(label.id);
                    if self.is_new {
                        field.request_focus();
                    }
                    is_entered |= field.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
                });
            }
            ui.separator();
            ui.horizontal(|ui| {
                let ready = if opens { !self.chosen.is_empty() } else { !self.name.trim().is_empty() };
                let (word, file) = if opens {
                    ("Open selected", None)
                } else {
                    ("Save", Some(self.folder.join(self.name.trim())))
                };
                if ui.add_enabled(ready, Button::new(word)).clicked() || (is_entered && ready) {
                    answer = Some(Answer::Files(
                        file.map_or_else(|| self.chosen.iter().cloned().collect(), |file| vec![file]),
                    ));
                }
                if ui.button("Cancel").clicked() {
                    answer = Some(Answer::Cancelled);
                }
                if opens {
                    let text = format!("{} selected; a double click opens at once", self.chosen.len());
                    ui.label(RichText::new(text).small().color(theme::weak(ui)));
                }
            });
            if let Some(file) =
                self.chosen.iter().next().filter(|_| std::mem::take(&mut self.opened_at_once(ui)))
            {
                answer = Some(Answer::Files(vec![file.clone()]));
            }
        });
        self.is_new = false;
        // A click beside the dialog does not give up what is chosen in it.
        if modal.should_close() && !modal.backdrop_response.clicked() {
            answer.get_or_insert(Answer::Cancelled);
        }
        answer
    }

    fn opened_at_once(&self, ui: &Ui) -> bool {
        ui.data_mut(|data| data.remove_temp::<bool>(egui::Id::unique("opened at once"))).unwrap_or(false)
    }

    fn place(&mut self, ui: &mut Ui) {
        ui.horizontal(|ui| {
            if ui.button("Up").on_hover_text("The folder above").clicked()
                && let Some(above) = self.folder.parent()
            {
                self.go(above.into());
            }
            let typed =
                ui.add(TextEdit::singleline(&mut self.typed).desired_width(ui.available_width() - 8.0));
            typed.widget_info(|| WidgetInfo::labeled(Role::TextInput, true, "Folder"));
            if typed.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter)) {
                self.go(PathBuf::from(self.typed.trim()));
            }
        });
    }

    fn contents(&mut self, ui: &mut Ui) {
        if let Some(sentence) = &self.problem {
            ui.add(egui::Label::new(RichText::new(sentence).color(theme::alarm(ui))).wrap());
        }
        let hint = RichText::new("Search in this folder").color(theme::weak(ui));
        let field = TextEdit::singleline(&mut self.search).hint_text(hint).desired_width(f32::INFINITY);
        let field = ui.add(field);
        field.widget_info(|| WidgetInfo::labeled(Role::TextInput, true, "Search in this folder"));
        if self.is_new && self.purpose == Purpose::Open {
            field.request_focus();
        }
        let words = self.search.to_lowercase();
        let is_found =
            |row: &&Row| words.split_whitespace().all(|word| row.name().to_lowercase().contains(word));
        let rows: Vec<Row> = self.entries.iter().filter(is_found).cloned().collect();
        let mut pressed = None;
        // What was searched for until one was left is opened by Enter.
        if let [only] = &rows[..]
            && field.lost_focus()
            && ui.input(|input| input.key_pressed(egui::Key::Enter))
        {
            pressed = Some((only.clone(), true));
        }
        ui.allocate_ui(egui::vec2(ui.available_width(), HEIGHT), |ui| {
            ui.set_min_height(HEIGHT);
            if rows.is_empty() {
                ui.label(RichText::new("no folder and no file of ours is here").color(theme::weak(ui)));
                return;
            }
            let mut files = Table::new("files", &COLUMNS);
            files.most_height = HEIGHT - 30.0;
            let key = |row: &Row, column: usize| match column {
                0 => Key::from(row.name().to_lowercase().as_str()),
                1 => Key::Number(if row.is_folder { -1.0 } else { row.bytes as f64 }),
                _ => row.changed_s.map(|seconds| seconds as f64).into(),
            };
            files.show(ui, &rows, key, |ui, row, column| match column {
                0 => {
                    let label = ui.selectable_label(self.chosen.contains(&row.path), row.name());
                    if label.clicked() || label.double_clicked() {
                        pressed = Some((row.clone(), label.double_clicked()));
                    }
                }
                1 if row.is_folder => {}
                1 => drop(ui.label(RichText::new(size(row.bytes)).color(theme::weak(ui)))),
                _ => drop(ui.label(RichText::new(date(row.changed_s)).color(theme::weak(ui)))),
            });
        });
        match pressed {
            Some((row, _)) if row.is_folder => self.go(row.path),
            Some((row, is_double)) => self.press(ui, row.path, is_double),
            None => {}
        }
    }

    fn press(&mut self, ui: &Ui, path: PathBuf, is_double: bool) {
        self.name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if is_double {
            let opens = self.purpose == Purpose::Open;
            self.chosen = [path].into();
            ui.data_mut(|data| data.insert_temp(egui::Id::unique("opened at once"), opens));
        } else if !self.chosen.remove(&path) {
            self.chosen.insert(path);
        }
    }
}

/// Height of the list, points.
const HEIGHT: f32 = 300.0;

/// `12 kB`
fn size(bytes: u64) -> String {
    const UNITS: [&str; 4] = ["B", "kB", "MB", "GB"];
    let (mut value, mut unit) = (bytes as f64, 0);
    while value >= 999.5 && unit + 1 < UNITS.len() {
        (value, unit) = (value / 1000.0, unit + 1);
    }
    if unit == 0 || value >= 9.95 {
        format!("{value:.0} {}", UNITS[unit])
    } else {
        format!("{value:.1} {}", UNITS[unit])
    }
}

/// `2026-11-28 22:40`, in the time zone of this computer.
fn date(changed_s: Option<i64>) -> String {
    let time = changed_s.and_then(|seconds| jiff::Timestamp::from_second(seconds).ok());
    time.map_or_else(String::new, |time| {
        time.to_zoned(jiff::tz::TimeZone::system()).strftime("%Y-%m-%d %H:%M").to_string()
    })
}

/// Folders, then files that can be opened.
fn list(folder: &Path) -> Result<Vec<Row>, String> {
    let read = std::fs::read_dir(folder);
    let read =
        read.map_err(|error| format!("cannot list {}: {error}; type another folder", folder.display()))?;
    let mut entries: Vec<Row> = read
        .filter_map(|entry| {
            let path = entry.ok()?.path();
            let hidden = path.file_name()?.to_string_lossy().starts_with('.');
            let about = std::fs::metadata(&path).ok()?;
            let ours = path.extension().is_some_and(can_open);
            let since = about.modified().ok().and_then(|time| time.duration_since(UNIX_EPOCH).ok());
            let changed_s = since.map(|time| time.as_secs() as i64);
            let row = Row { is_folder: about.is_dir(), bytes: about.len(), changed_s, path };
            (!hidden && (row.is_folder || ours)).then_some(row)
        })
        .collect();
    entries.sort_by(|a, b| b.is_folder.cmp(&a.is_folder).then_with(|| a.path.cmp(&b.path)));
    Ok(entries)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_typed_file_is_chosen_and_what_is_not_there_changes_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("run.csv");
        std::fs::write(&file, "t_s,a_V\n0,1\n").unwrap();
        let mut dialog = Dialog::new(Purpose::Open, folder.path(), "");
        dialog.go(file.clone());
        assert_eq!((dialog.folder(), dialog.chosen.contains(&file)), (folder.path(), true));
        dialog.go(folder.path().join("nowhere"));
        assert_eq!(dialog.folder(), folder.path());
        assert!(dialog.problem.as_ref().is_some_and(|text| text.contains("type another folder")));
        assert_eq!(dialog.entries.len(), 1);
    }

    #[test]
    fn sizes_have_two_digits() {
        assert_eq!(
            [512, 1234, 56_789, 999_700, 3_400_000_000].map(size),
            ["512 B", "1.2 kB", "57 kB", "1.0 MB", "3.4 GB"]
        );
    }
}
