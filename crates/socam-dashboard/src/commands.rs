//! List of all commands, from which menus, shortcuts and the help are made.

use egui::{Key, KeyboardShortcut, Modifiers};

use socam_workbench::View;

use crate::platform::{HAS_BENCH, Views};

/// A command.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Command {
    NewSignal,
    NewModel,
    Open,
    SaveSignal,
    SaveRecording,
    SaveSession,
    SaveReport,
    Simulate,
    Start,
    ExportPng,
    ExportSvg,
    ExportCsv,
    ExportAnimation,
    CloseAll,
    Undo,
    Redo,
    Cut,
    Copy,
    Paste,
    Show(View),
    OwnWindow,
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
const COMMANDS: [(Command, &str, Modifiers, Key); 25] = [
    (Command::NewSignal, "New input signal", CTRL, Key::N),
    (Command::NewModel, "New model...", CTRL_SHIFT, Key::N),
    (Command::Open, "Open...", CTRL, Key::O),
    (Command::SaveSignal, "Save input signal...", CTRL, Key::S),
    (Command::SaveRecording, "Save recording as .csv or .m...", CTRL_SHIFT, Key::S),
    (Command::SaveSession, "Save session...", CTRL_SHIFT, Key::P),
    (Command::SaveReport, "Save report...", CTRL, Key::P),
    (Command::Simulate, "Simulate the shown recordings", CTRL_SHIFT, Key::M),
    (Command::Start, "Identify or diagnose, as shown", CTRL, Key::Enter),
    (Command::ExportPng, "as PNG...", CTRL, Key::E),
    (Command::ExportSvg, "as SVG...", CTRL_SHIFT, Key::E),
    (Command::ExportCsv, "as CSV...", CTRL_SHIFT, Key::C),
    (Command::ExportAnimation, "as animation...", CTRL_SHIFT, Key::G),
    (Command::CloseAll, "Close all recordings", CTRL_SHIFT, Key::W),
    (Command::Undo, "Undo", CTRL, Key::Z),
    (Command::Redo, "Redo", CTRL, Key::Y),
    (Command::Cut, "Cut input signal", CTRL, Key::X),
    (Command::Copy, "Copy input signal", CTRL, Key::C),
    (Command::Paste, "Paste input signal", CTRL, Key::V),
    (Command::OwnWindow, "This view in a window of its own", CTRL_SHIFT, Key::O),
    (Command::Theme, "Light or dark", CTRL_SHIFT, Key::L),
    (Command::Larger, "Larger", CTRL, Key::Plus),
    (Command::Smaller, "Smaller", CTRL, Key::Minus),
    (Command::NormalSize, "Normal size", CTRL, Key::Num0),
    (Command::Help, "What each control does", Modifiers::NONE, Key::F1),
];

impl Command {
    /// All commands of this platform.
    pub(crate) fn all() -> impl Iterator<Item = Self> {
        let views = Views::NAMES.iter().copied().map(Self::Show);
        COMMANDS.iter().map(|(command, ..)| *command).chain(views).filter(|command| command.is_reachable())
    }

    /// Whether this platform has it: a page in a browser has no bench and no files.
    fn is_reachable(self) -> bool {
        let of_the_desktop = [
            Self::NewSignal,
            Self::SaveSignal,
            Self::SaveSession,
            Self::SaveReport,
            Self::Start,
            Self::Undo,
            Self::Redo,
            Self::Cut,
            Self::Copy,
            Self::Paste,
            Self::OwnWindow,
        ];
        HAS_BENCH || !of_the_desktop.contains(&self)
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
            Self::ExportPng | Self::ExportSvg | Self::ExportCsv | Self::ExportAnimation => {
                format!("Export what is seen {}", self.text())
            }
            _ => self.text().to_owned(),
        }
    }

    /// Keyboard shortcut of the command.
    pub(crate) fn keys(self) -> Option<KeyboardShortcut> {
        match self {
            Self::Show(view) => {
                let place = Views::NAMES.iter().position(|own| *own == view)?;
                VIEWS.get(place).map(|key| KeyboardShortcut::new(CTRL, *key))
            }
            _ => self.entry().map(|(_, _, modifiers, key)| KeyboardShortcut::new(*modifiers, *key)),
        }
    }

    /// Text fields handle these keys themselves.
    pub(crate) fn is_of_text(self) -> bool {
        matches!(self, Self::Undo | Self::Redo)
    }

    /// The window gets events for these, not keys.
    pub(crate) fn is_of_clipboard(self) -> bool {
        matches!(self, Self::Cut | Self::Copy | Self::Paste)
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
