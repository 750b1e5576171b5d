//! Everything that menus and keys do: one list, from which menus, shortcuts and the help are made.

use egui::{Key, KeyboardShortcut, Modifiers};

use crate::files::Purpose;
use crate::live::{self, signal::Settings};
use crate::{Dashboard, View};
use socam_chart::theme::{self, Look};

/// A command.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Command {
    NewSignal,
    Open,
    SaveSignal,
    SaveRecording,
    Simulate,
    ExportPng,
    ExportSvg,
    ExportCsv,
    CloseAll,
    Undo,
    Redo,
    Cut,
    Copy,
    Paste,
    Show(View),
    Theme,
    Larger,
    Smaller,
    NormalSize,
    Help,
}

const CTRL: Modifiers = Modifiers::COMMAND;
const CTRL_SHIFT: Modifiers = Modifiers::COMMAND.plus(Modifiers::SHIFT);

/// Views beyond the ninth have no key.
const VIEWS: [Key; 9] =
    [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5, Key::Num6, Key::Num7, Key::Num8, Key::Num9];

/// Commands besides the views with their texts and keys, in the order of the menus.
const COMMANDS: [(Command, &str, Modifiers, Key); 19] = [
    (Command::NewSignal, "New input signal", CTRL, Key::N),
    (Command::Open, "Open...", CTRL, Key::O),
    (Command::SaveSignal, "Save input signal...", CTRL, Key::S),
    (Command::SaveRecording, "Save recording as .csv or .m...", CTRL_SHIFT, Key::S),
    (Command::Simulate, "Simulate the shown recordings", CTRL_SHIFT, Key::M),
    (Command::ExportPng, "as PNG...", CTRL, Key::E),
    (Command::ExportSvg, "as SVG...", CTRL_SHIFT, Key::E),
    (Command::ExportCsv, "as CSV...", CTRL_SHIFT, Key::C),
    (Command::CloseAll, "Close all recordings", CTRL_SHIFT, Key::W),
    (Command::Undo, "Undo", CTRL, Key::Z),
    (Command::Redo, "Redo", CTRL, Key::Y),
    (Command::Cut, "Cut input signal", CTRL, Key::X),
    (Command::Copy, "Copy input signal", CTRL, Key::C),
    (Command::Paste, "Paste input signal", CTRL, Key::V),
    (Command::Theme, "Light or dark", CTRL_SHIFT, Key::L),
    (Command::Larger, "Larger", CTRL, Key::Plus),
    (Command::Smaller, "Smaller", CTRL, Key::Minus),
    (Command::NormalSize, "Normal size", CTRL, Key::Num0),
    (Command::Help, "What each control does", Modifiers::NONE, Key::F1),
];

impl Command {
    /// All commands of this platform.
    pub(crate) fn all() -> impl Iterator<Item = Self> {
        let views = View::reachable().map(Self::Show);
        COMMANDS.iter().map(|(command, ..)| *command).chain(views).filter(|command| command.is_reachable())
    }

    /// Whether this platform has it: a page in a browser has no bench.
    fn is_reachable(self) -> bool {
        let of_the_bench =
            [Self::NewSignal, Self::SaveSignal, Self::Undo, Self::Redo, Self::Cut, Self::Copy, Self::Paste];
        live::REACHABLE || !of_the_bench.contains(&self)
    }

    fn entry(self) -> Option<&'static (Self, &'static str, Modifiers, Key)> {
        COMMANDS.iter().find(|(command, ..)| *command == self)
    }

    /// Text of its item in a menu.
    pub(crate) fn text(self) -> &'static str {
        match self {
            Self::Show(view) => view.name(),
            _ => self.entry().map_or("", |(_, text, ..)| text),
        }
    }

    /// Text where it stands alone.
    pub(crate) fn words(self) -> String {
        match self {
            Self::Show(view) => format!("Show {}", view.name()),
            Self::ExportPng | Self::ExportSvg | Self::ExportCsv => {
                format!("Export what is seen {}", self.text())
            }
            _ => self.text().to_owned(),
        }
    }

    /// Its keys.
    pub(crate) fn keys(self) -> Option<KeyboardShortcut> {
        match self {
            Self::Show(view) => {
                let place = View::reachable().position(|own| own == view)?;
                VIEWS.get(place).map(|key| KeyboardShortcut::new(CTRL, *key))
            }
            _ => self.entry().map(|(_, _, modifiers, key)| KeyboardShortcut::new(*modifiers, *key)),
        }
    }

    /// Text fields handle these keys themselves.
    fn is_of_text(self) -> bool {
        matches!(self, Self::Undo | Self::Redo)
    }

    /// The window gets events for these, not keys.
    fn is_of_clipboard(self) -> bool {
        matches!(self, Self::Cut | Self::Copy | Self::Paste)
    }
}

impl Dashboard {
    /// Whether a command can be run now.
    pub(crate) fn can(&self, command: Command) -> bool {
        let is_any_shown = self.workspace.entries.iter().any(|entry| entry.shown);
        match command {
            Command::SaveRecording => is_any_shown,
            Command::Simulate => self.simulate.is_some() && is_any_shown,
            Command::CloseAll => !self.workspace.entries.is_empty(),
            Command::Undo => self.has_history() || self.views.live.signal.history()[0],
            Command::Redo => self.has_history() || self.views.live.signal.history()[1],
            _ => true,
        }
    }

    fn has_history(&self) -> bool {
        self.views.peek(self.layout.view).has_history()
    }

    /// Runs a command.
    pub(crate) fn run(&mut self, ctx: &egui::Context, command: Command) {
        match command {
            Command::NewSignal => {
                self.views.live.signal.change(Settings::default());
                self.layout.view = View::Live;
            }
            Command::Open => self.ask(ctx, Purpose::Open, ""),
            Command::SaveSignal => self.ask(ctx, Purpose::SaveSignal, "signal.toml"),
            Command::SaveRecording => self.ask_to_save_recording(ctx),
            Command::Simulate => self.simulate(ctx),
            Command::ExportPng => self.ask(ctx, Purpose::Export, "view.png"),
            Command::ExportSvg => self.ask(ctx, Purpose::Export, "view.svg"),
            Command::ExportCsv => self.ask(ctx, Purpose::Export, "view.csv"),
            Command::CloseAll => {
                self.workspace.entries.clear();
                self.views.time.fit();
            }
            // A view with a history of its own undoes its own changes; everywhere else the input signal is undone.
            Command::Undo if self.has_history() => self.views.get(self.layout.view).undo(&mut self.workspace),
            Command::Redo if self.has_history() => self.views.get(self.layout.view).redo(&mut self.workspace),
            Command::Undo => self.views.live.signal.undo(),
            Command::Redo => self.views.live.signal.redo(),
            // These change the live view, so it is shown.
            Command::Cut => {
                ctx.copy_text(self.views.live.signal.text());
                self.views.live.signal.change(Settings::default());
                self.layout.view = View::Live;
            }
            Command::Copy => {
                ctx.copy_text(self.views.live.signal.text());
                self.layout.view = View::Live;
            }
            Command::Paste => {
                ctx.send_viewport_cmd(egui::ViewportCommand::RequestPaste);
                self.layout.view = View::Live;
            }
            Command::Show(view) => self.layout.view = view,
            Command::Theme => {
                self.layout.look = if self.layout.look == Look::Light { Look::Dark } else { Look::Light };
                theme::apply(ctx, self.layout.look);
            }
            Command::Larger => self.zoom(ctx, self.layout.zoom * 1.1),
            Command::Smaller => self.zoom(ctx, self.layout.zoom / 1.1),
            Command::NormalSize => self.zoom(ctx, 1.0),
            Command::Help => self.help.is_open = true,
        }
    }

    fn ask_to_save_recording(&mut self, ctx: &egui::Context) {
        let first = self.workspace.entries.iter().find(|entry| entry.shown);
        let name = first.map_or("recording", |entry| crate::recording::short(&entry.recording.about.name));
        let name = std::path::Path::new(name).with_extension("csv").display().to_string();
        self.ask(ctx, Purpose::SaveRecording, &name);
    }

    fn zoom(&mut self, ctx: &egui::Context, zoom: f32) {
        self.layout.zoom = zoom.clamp(0.6, 2.5);
        ctx.set_zoom_factor(self.layout.zoom);
    }

    /// Runs the commands whose keys were pressed.
    pub(crate) fn shortcuts(&mut self, ctx: &egui::Context) {
        self.layout.zoom = ctx.zoom_factor();
        let is_typing = ctx.egui_wants_keyboard_input();
        let mut commands: Vec<Command> = Command::all()
            .filter(|command| !(command.is_of_clipboard() || is_typing && command.is_of_text()))
            .collect();
        // Ctrl+S also fits where Ctrl+Shift+S is pressed.
        commands.sort_by_key(|command| !command.keys().is_some_and(|keys| keys.modifiers.shift));
        for command in commands {
            let Some(keys) = command.keys() else { continue };
            if ctx.input_mut(|input| input.consume_shortcut(&keys)) && self.can(command) {
                self.run(ctx, command);
            }
        }
        if !is_typing && self.layout.view == View::Live {
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
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_command_has_keys_of_its_own() {
        let mut known: Vec<KeyboardShortcut> = Vec::new();
        for command in Command::all() {
            let keys = command.keys().unwrap_or_else(|| panic!("{command:?} has no keys"));
            assert!(!known.contains(&keys), "{command:?}");
            known.push(keys);
        }
    }
}
