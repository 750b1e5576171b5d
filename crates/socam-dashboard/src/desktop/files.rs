//! A dialog for choosing files to open or to save. The dashboard draws it itself, so that it does not need a desktop's dialog.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use egui::{Button, Key, Modal, RichText, Role, ScrollArea, TextEdit, Ui, WidgetInfo};

use socam_chart::theme;
use socam_workbench::purpose::{Purpose, can_open};

/// A dialog that is open.
#[derive(Debug)]
pub(super) struct Dialog {
    /// Purpose.
    pub(super) purpose: Purpose,
    folder: PathBuf,
    /// Name as typed.
    typed: String,
    name: String,
    chosen: BTreeSet<PathBuf>,
    entries: Result<Vec<(PathBuf, bool)>, String>,
}

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
            chosen: BTreeSet::new(),
            entries: Ok(Vec::new()),
        };
        dialog.go(folder.into());
        dialog
    }

    /// The folder that is shown.
    #[must_use]
    pub(super) fn folder(&self) -> &Path {
        &self.folder
    }

    fn go(&mut self, folder: PathBuf) {
        self.typed = folder.display().to_string();
        self.chosen.clear();
        self.entries = list(&folder);
        self.folder = folder;
    }

    /// Draws it; `Some` when it ended.
    pub(super) fn ui(&mut self, ctx: &egui::Context) -> Option<Answer> {
        let mut answer = None;
        let modal = Modal::new(egui::Id::unique("files")).show(ctx, |ui| {
            ui.set_width(560.0);
            let opens = self.purpose == Purpose::Open;
            ui.heading(self.purpose.title());
            self.place(ui);
            self.contents(ui);
            if !opens {
                ui.horizontal(|ui| {
                    let label = ui.label("Name");
                    ui.add(TextEdit::singleline(&mut self.name).desired_width(400.0)).labelled_by(label.id);
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
                if ui.add_enabled(ready, Button::new(word)).clicked() {
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
        if modal.should_close() {
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
            let typed = ui.add(TextEdit::singleline(&mut self.typed).desired_width(480.0));
            typed.widget_info(|| WidgetInfo::labeled(Role::TextInput, true, "Folder"));
            if typed.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter)) {
                self.go(PathBuf::from(self.typed.trim()));
            }
        });
    }

    fn contents(&mut self, ui: &mut Ui) {
        let entries = match &self.entries {
            Ok(entries) => entries.clone(),
            Err(sentence) => {
                ui.label(RichText::new(sentence).color(theme::alarm(ui)));
                return;
            }
        };
        let mut go = None;
        ScrollArea::vertical().max_height(300.0).min_scrolled_height(300.0).auto_shrink(false).show(
            ui,
            |ui| {
                if entries.is_empty() {
                    ui.label(RichText::new("no folder and no file of ours is here").color(theme::weak(ui)));
                }
                for (path, is_folder) in &entries {
                    let name = path.file_name().unwrap_or_default().to_string_lossy();
                    let text = if *is_folder { format!("{name}/") } else { name.into_owned() };
                    let row = ui.selectable_label(self.chosen.contains(path), text);
                    if row.double_clicked() && !is_folder {
                        self.chosen = [path.clone()].into();
                        ui.data_mut(|data| {
                            data.insert_temp(
                                egui::Id::unique("opened at once"),
                                self.purpose == Purpose::Open,
                            )
                        });
                    } else if row.clicked() && *is_folder {
                        go = Some(path.clone());
                    } else if row.clicked() {
                        self.name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
                        if !self.chosen.remove(path) {
                            self.chosen.insert(path.clone());
                        }
                    }
                }
            },
        );
        if let Some(folder) = go {
            self.go(folder);
        }
    }
}

/// Folders, then files that can be opened.
fn list(folder: &Path) -> Result<Vec<(PathBuf, bool)>, String> {
    let read = std::fs::read_dir(folder);
    let read =
        read.map_err(|error| format!("cannot list {}: {error}; type another folder", folder.display()))?;
    let mut entries: Vec<(PathBuf, bool)> = read
        .filter_map(|entry| {
            let path = entry.ok()?.path();
            let hidden = path.file_name()?.to_string_lossy().starts_with('.');
            let is_folder = path.is_dir();
            let ours = path.extension().is_some_and(can_open);
            (!hidden && (is_folder || ours)).then_some((path, is_folder))
        })
        .collect();
    entries.sort_by(|a, b| b.1.cmp(&a.1).then_with(|| a.0.cmp(&b.0)));
    Ok(entries)
}
