//! The menus File, Edit, View, Input Signal and Help, and their keyboard shortcuts.

use std::path::Path;

use egui::{Button, Key, KeyboardShortcut, LayerId, Modifiers, Role, Ui, WidgetInfo};

use crate::draw::{export, raster, svg};
#[cfg(not(target_arch = "wasm32"))]
use crate::files::Dialog;
use crate::files::Purpose;
use crate::live::{
    self,
    signal::{Kind, Settings},
};
use crate::theme::{self, Look};
use crate::{Dashboard, View};

const fn with_ctrl(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::COMMAND, key)
}

const OPEN: KeyboardShortcut = with_ctrl(Key::O);
const SAVE: KeyboardShortcut = with_ctrl(Key::S);
const EXPORT: KeyboardShortcut = with_ctrl(Key::E);
const UNDO: KeyboardShortcut = with_ctrl(Key::Z);
const REDO: KeyboardShortcut = with_ctrl(Key::Y);
const HELP: KeyboardShortcut = KeyboardShortcut::new(Modifiers::NONE, Key::F1);
/// Views beyond the ninth have no key.
const VIEWS: [Key; 9] =
    [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5, Key::Num6, Key::Num7, Key::Num8, Key::Num9];

fn item(ui: &mut Ui, text: &str, keys: Option<KeyboardShortcut>) -> bool {
    enabled_item(ui, true, text, keys)
}

fn enabled_item(ui: &mut Ui, enabled: bool, text: &str, keys: Option<KeyboardShortcut>) -> bool {
    let mut button = Button::new(text);
    if let Some(keys) = keys {
        button = button.shortcut_text(ui.ctx().format_shortcut(&keys));
    }
    let response = ui.add_enabled(enabled, button);
    // The shortcut is not part of the accessible name.
    response.widget_info(|| WidgetInfo::labeled(Role::Button, enabled, text));
    response.clicked()
}

impl Dashboard {
    pub(crate) fn menus(&mut self, ui: &mut Ui) {
        ui.menu_button("File", |ui| self.file_menu(ui));
        if live::REACHABLE {
            ui.menu_button("Edit", |ui| self.edit_menu(ui));
        }
        ui.menu_button("View", |ui| self.view_menu(ui));
        if live::REACHABLE {
            ui.menu_button("Input Signal", |ui| self.signal_menu(ui));
        }
        ui.menu_button("Help", |ui| {
            if item(ui, "What each control does", Some(HELP)) {
                self.help = true;
            }
        });
    }

    fn file_menu(&mut self, ui: &mut Ui) {
        if live::REACHABLE && item(ui, "New input signal", None) {
            self.views.live.signal.change(Settings::default());
            self.layout.view = View::Live;
        }
        if item(ui, "Open...", Some(OPEN)) {
            self.ask(ui.ctx(), Purpose::Open, "");
        }
        if live::REACHABLE && item(ui, "Save input signal...", Some(SAVE)) {
            self.ask(ui.ctx(), Purpose::SaveSignal, "signal.toml");
        }
        let any = self.workspace.entries.iter().any(|entry| entry.shown);
        if enabled_item(ui, any, "Save recording as .csv or .m...", None) {
            let first = self.workspace.entries.iter().find(|entry| entry.shown);
            let name =
                first.map_or("recording", |entry| crate::recording::short(&entry.recording.about.name));
            let name = Path::new(name).with_extension("csv").display().to_string();
            self.ask(ui.ctx(), Purpose::SaveRecording, &name);
        }
        if self.simulate.is_some() && enabled_item(ui, any, "Simulate the shown recordings", None) {
            self.simulate(ui.ctx());
        }
        ui.separator();
        ui.menu_button("Export what is seen", |ui| {
            for (text, name, keys) in [
                ("as PNG...", "view.png", Some(EXPORT)),
                ("as SVG...", "view.svg", None),
                ("as CSV...", "view.csv", None),
            ] {
                if item(ui, text, keys) {
                    self.ask(ui.ctx(), Purpose::Export, name);
                }
            }
        });
        if enabled_item(ui, !self.workspace.entries.is_empty(), "Close all recordings", None) {
            self.workspace.entries.clear();
            self.views.time.fit();
        }
    }

    fn edit_menu(&mut self, ui: &mut Ui) {
        let [undo, redo] = self.views.live.signal.history();
        if enabled_item(ui, undo, "Undo", Some(UNDO)) {
            self.views.live.signal.undo();
        }
        if enabled_item(ui, redo, "Redo", Some(REDO)) {
            self.views.live.signal.redo();
        }
        ui.separator();
        // These change the live view, so it is shown.
        if item(ui, "Cut input signal", Some(with_ctrl(Key::X))) {
            ui.ctx().copy_text(self.views.live.signal.text());
            self.views.live.signal.change(Settings::default());
            self.layout.view = View::Live;
        }
        if item(ui, "Copy input signal", Some(with_ctrl(Key::C))) {
            ui.ctx().copy_text(self.views.live.signal.text());
            self.layout.view = View::Live;
        }
        if item(ui, "Paste input signal", Some(with_ctrl(Key::V))) {
            ui.ctx().send_viewport_cmd(egui::ViewportCommand::RequestPaste);
            self.layout.view = View::Live;
        }
    }

    fn view_menu(&mut self, ui: &mut Ui) {
        for (place, view) in View::reachable().enumerate() {
            if item(ui, view.name(), VIEWS.get(place).copied().map(with_ctrl)) {
                self.layout.view = view;
            }
        }
        ui.separator();
        for (look, name) in [(Look::Light, "Light"), (Look::Dark, "Dark")] {
            if ui.selectable_label(self.layout.look == look, name).clicked() {
                self.layout.look = look;
                theme::apply(ui.ctx(), look);
            }
        }
        ui.separator();
        for (text, factor) in [("Larger", 1.1), ("Smaller", 1.0 / 1.1)] {
            if item(ui, text, None) {
                self.zoom(ui.ctx(), self.layout.zoom * factor);
            }
        }
        if item(ui, "Normal size", None) {
            self.zoom(ui.ctx(), 1.0);
        }
    }

    fn signal_menu(&mut self, ui: &mut Ui) {
        for (kind, name) in [(Kind::Sine, "Sine"), (Kind::Constant, "Constant")] {
            if item(ui, name, None) {
                self.views.live.signal.change(Settings { kind, ..self.views.live.signal.settings.clone() });
                self.layout.view = View::Live;
            }
        }
        for name in socam_recording::ProfileFile::built_in_names().filter(|name| *name != "sine") {
            if item(ui, name, None) {
                if let Err(sentence) = self.views.live.signal.take_built_in(name) {
                    self.warn(sentence);
                }
                self.layout.view = View::Live;
            }
        }
    }

    fn zoom(&mut self, ctx: &egui::Context, zoom: f32) {
        self.layout.zoom = zoom.clamp(0.6, 2.5);
        ctx.set_zoom_factor(self.layout.zoom);
    }

    /// A page in a browser uses its own dialogs and offers saved files for download.
    #[cfg(target_arch = "wasm32")]
    pub(crate) fn ask(&mut self, ctx: &egui::Context, purpose: Purpose, name: &str) {
        match purpose {
            Purpose::Open => self.wishes_files = true,
            _ => self.answered(ctx, purpose, vec![name.into()]),
        }
    }

    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) fn ask(&mut self, _: &egui::Context, purpose: Purpose, name: &str) {
        let folder = self.layout.folder.canonicalize().unwrap_or_else(|_| self.layout.folder.clone());
        self.dialog = Some(Dialog::new(purpose, &folder, name));
    }

    pub(crate) fn shortcuts(&mut self, ctx: &egui::Context) {
        self.layout.zoom = ctx.zoom_factor();
        let pressed = |keys: KeyboardShortcut| ctx.input_mut(|input| input.consume_shortcut(&keys));
        if pressed(OPEN) {
            self.ask(ctx, Purpose::Open, "");
        }
        if live::REACHABLE && pressed(SAVE) {
            self.ask(ctx, Purpose::SaveSignal, "signal.toml");
        }
        if pressed(EXPORT) {
            self.ask(ctx, Purpose::Export, "view.png");
        }
        if pressed(HELP) {
            self.help = true;
        }
        for (view, key) in View::reachable().zip(VIEWS) {
            if pressed(with_ctrl(key)) {
                self.layout.view = view;
            }
        }
        // Text fields handle undo and paste themselves.
        if ctx.egui_wants_keyboard_input() {
            return;
        }
        // A view with a history of its own undoes its own changes; everywhere else the input signal is undone.
        let view = self.views.get(self.layout.view);
        if pressed(UNDO) && !view.undo(&mut self.workspace) {
            self.views.live.signal.undo();
        }
        let view = self.views.get(self.layout.view);
        if pressed(REDO) && !view.redo(&mut self.workspace) {
            self.views.live.signal.redo();
        }
        if self.layout.view == View::Live {
            self.clipboard(ctx);
        }
    }

    fn clipboard(&mut self, ctx: &egui::Context) {
        for event in ctx.input(|input| input.events.clone()) {
            match event {
                egui::Event::Copy => ctx.copy_text(self.views.live.signal.text()),
                egui::Event::Cut => {
                    ctx.copy_text(self.views.live.signal.text());
                    self.views.live.signal.change(Settings::default());
                }
                egui::Event::Paste(text) => {
                    if let Err(sentence) = self.views.live.signal.paste(&text) {
                        self.warn(sentence);
                    }
                }
                _ => {}
            }
        }
    }

    /// Writes the picture of this pass, or its data, if an export was requested.
    pub(crate) fn export(&mut self, ctx: &egui::Context) {
        let Some(path) = self.exporting.take() else { return };
        let bytes = content(self, ctx, &path);
        self.put(&path, bytes);
    }
}

/// Contents of the export file, by its extension. Menus and dialogs are in layers of their own and are left out.
fn content(dashboard: &Dashboard, ctx: &egui::Context, path: &Path) -> Result<Vec<u8>, String> {
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let part = ctx.content_rect();
    let ground = ctx.global_style().visuals.panel_fill;
    let shapes = || {
        ctx.graphics(|layers| {
            layers.get(LayerId::background()).map(|list| list.all_entries().cloned().collect::<Vec<_>>())
        })
        .unwrap_or_default()
    };
    match extension.as_str() {
        "csv" => Ok(export::csv(&dashboard.workspace.seen).into_bytes()),
        "svg" => {
            svg::svg(&dashboard.workspace.seen, ctx.global_style().visuals.dark_mode).map(String::into_bytes)
        }
        "png" => raster::png(&raster::of_shapes(ctx, shapes(), part, ground)),
        _ => Err(format!("{}: what is seen is exported as .png, .svg or .csv", path.display())),
    }
}
