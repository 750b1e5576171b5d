//! The menus File, Edit, View, Input Signal and Help, and exports of what is seen.

use std::path::Path;

use egui::{Button, LayerId, Role, Ui, WidgetInfo};

use socam_chart::{export, raster, svg};
use socam_workbench::View;
use socam_workbench::input_signal::{Settings, SignalShape};

use super::Dashboard;
use crate::commands::Command;
use crate::platform::{HAS_BENCH, Views};

/// An item; the shortcut is not part of its accessible name.
fn item(ui: &mut Ui, enabled: bool, text: &str, keys: Option<egui::KeyboardShortcut>) -> bool {
    let mut button = Button::new(text);
    if let Some(keys) = keys {
        button = button.shortcut_text(ui.ctx().format_shortcut(&keys));
    }
    let response = ui.add_enabled(enabled, button);
    response.widget_info(|| WidgetInfo::labeled(Role::Button, enabled, text));
    response.clicked()
}

impl Dashboard {
    pub(crate) fn menus(&mut self, ui: &mut Ui) {
        ui.menu_button("File", |ui| self.file_menu(ui));
        if HAS_BENCH {
            ui.menu_button("Edit", |ui| {
                self.items(ui, &[Command::Undo, Command::Redo]);
                ui.separator();
                self.items(ui, &[Command::Cut, Command::Copy, Command::Paste]);
            });
        }
        ui.menu_button("View", |ui| {
            let views: Vec<Command> = Views::NAMES.iter().copied().map(Command::Show).collect();
            self.items(ui, &views);
            ui.separator();
            self.items(ui, &[Command::OwnWindow]);
            ui.separator();
            self.items(ui, &[Command::Theme, Command::Larger, Command::Smaller, Command::NormalSize]);
        });
        if HAS_BENCH {
            ui.menu_button("Input Signal", |ui| self.signal_menu(ui));
        }
        ui.menu_button("Help", |ui| self.items(ui, &[Command::Help]));
    }

    /// Items of commands, those of this platform.
    fn items(&mut self, ui: &mut Ui, commands: &[Command]) {
        let known: Vec<Command> = Command::all().filter(|command| commands.contains(command)).collect();
        for command in commands.iter().filter(|command| known.contains(command)) {
            if item(ui, self.can(*command), command.text(), command.keys()) {
                self.run(ui.ctx(), *command);
            }
        }
    }

    fn file_menu(&mut self, ui: &mut Ui) {
        self.items(ui, &[Command::NewSignal, Command::NewModel, Command::Open]);
        if !self.layout.recent.is_empty() {
            ui.menu_button("Open recent", |ui| self.recent_menu(ui));
        }
        self.items(
            ui,
            &[Command::SaveSignal, Command::SaveRecording, Command::SaveSession, Command::SaveReport],
        );
        if self.workspace.simulate.is_some() {
            self.items(ui, &[Command::Simulate]);
        }
        self.items(ui, &[Command::Start]);
        ui.separator();
        ui.menu_button("Export what is seen", |ui| {
            self.items(
                ui,
                &[Command::ExportPng, Command::ExportSvg, Command::ExportCsv, Command::ExportAnimation],
            );
        });
        self.items(ui, &[Command::CloseAll]);
    }

    /// Files that were opened last; those that are gone are grey.
    fn recent_menu(&mut self, ui: &mut Ui) {
        let mut wanted = None;
        for run in &self.layout.recent {
            let is_there = Path::new(run).exists()
                || socam_recording::Selection::parse(run)
                    .is_ok_and(|selection| selection.files().all(|path| path.exists()));
            let button = ui.add_enabled(is_there, Button::new(socam_workbench::recording::short(run)));
            let button =
                button.on_hover_text(run).on_disabled_hover_text(format!("{run} is not there any more"));
            if button.clicked() {
                wanted = Some(run.clone());
            }
        }
        self.open(wanted);
        ui.separator();
        if ui.button("Forget them").clicked() {
            self.layout.recent.clear();
        }
    }

    fn signal_menu(&mut self, ui: &mut Ui) {
        if self.workspace.bench.offer().is_some() {
            for name in socam_workbench::drive_run::FORMS {
                if item(ui, true, name, None) {
                    self.take_form(name);
                }
            }
            return;
        }
        for (kind, name) in [(SignalShape::Sine, "sine"), (SignalShape::Constant, "constant")] {
            if item(ui, true, name, None) {
                self.workspace.signal.change(Settings { kind, ..self.workspace.signal.settings.clone() });
                self.layout.view = View::Live;
            }
        }
        for name in socam_recording::ProfileFile::built_in_names().filter(|name| *name != "sine") {
            if item(ui, true, name, None) {
                self.take_form(name);
            }
        }
    }

    fn take_form(&mut self, name: &str) {
        if let Err(sentence) = self.workspace.take_form(name) {
            self.warn(sentence);
        }
        self.layout.view = View::Live;
    }

    /// Writes the picture of this pass, or its data, if an export was requested.
    pub(crate) fn export(&mut self, ctx: &egui::Context) {
        let Some(path) = self.exporting.take() else { return };
        if self.layout.view == View::Time && extension_of(&path) == "csv" {
            return self.export_samples(ctx, path);
        }
        let bytes = content(self, ctx, &path);
        self.put(&path, bytes);
    }
}

fn extension_of(path: &Path) -> String {
    path.extension().unwrap_or_default().to_string_lossy().to_lowercase()
}

/// Contents of the export file, by its extension. Menus and dialogs are in layers of their own and are left out.
fn content(dashboard: &Dashboard, ctx: &egui::Context, path: &Path) -> Result<Vec<u8>, String> {
    let part = ctx.content_rect();
    let ground = ctx.global_style().visuals.panel_fill;
    let shapes = || {
        ctx.graphics(|layers| {
            layers.get(LayerId::background()).map(|list| list.all_entries().cloned().collect::<Vec<_>>())
        })
        .unwrap_or_default()
    };
    match extension_of(path).as_str() {
        "csv" => Ok(export::csv(&dashboard.seen).into_bytes()),
        "svg" => svg::svg(&dashboard.seen, ctx.global_style().visuals.dark_mode).map(String::into_bytes),
        "png" => raster::png(&raster::of_shapes(ctx, shapes(), part, ground)),
        _ => Err(format!("{}: what is seen is exported as .png, .svg or .csv", path.display())),
    }
}
