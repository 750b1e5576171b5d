//! Actions of the commands.

use egui::Context;
use socam_chart::theme::{self, Look};
use socam_workbench::View;
use socam_workbench::about::short;
use socam_workbench::purpose::Purpose;

use super::Dashboard;
use crate::commands::Command;

impl Dashboard {
    /// Whether a command can be run now.
    pub(crate) fn can(&self, command: Command) -> bool {
        let is_any_shown = self.workspace.entries.iter().any(|entry| entry.shown);
        match command {
            Command::SaveRecording => is_any_shown,
            Command::Simulate => self.workspace.simulate.is_some() && is_any_shown,
            Command::ExportAnimation => self.layout.view == View::Machine && self.views.machine.can_film(),
            Command::Start => self.views.peek(self.layout.view).can_start(),
            Command::SaveReport => self.views.peek(self.layout.view).has_report(),
            Command::OwnWindow => !self.is_apart(self.layout.view),
            Command::CloseAll => !self.workspace.entries.is_empty(),
            Command::Undo => self.has_history() || self.workspace.present_signal().history()[0],
            Command::Redo => self.has_history() || self.workspace.present_signal().history()[1],
            _ => true,
        }
    }

    fn has_history(&self) -> bool {
        self.views.peek(self.layout.view).has_history()
    }

    /// Runs a command.
    pub(crate) fn run(&mut self, ctx: &Context, command: Command) {
        match command {
            Command::NewSignal => {
                self.workspace.present_signal_mut().renew();
                self.layout.view = View::Live;
            }
            Command::NewModel => {
                self.views.machine.describe_again();
                self.layout.view = View::Machine;
            }
            Command::Open => self.ask(ctx, Purpose::Open, ""),
            Command::SaveSignal => self.ask(ctx, Purpose::SaveSignal, "signal.toml"),
            Command::SaveRecording => self.ask_to_save_recording(ctx),
            Command::SaveSession => self.ask(ctx, Purpose::SaveSession, "bench.session.json"),
            Command::SaveReport => self.views.peek(self.layout.view).save_report(&mut self.workspace),
            Command::Simulate => self.simulate(ctx),
            Command::Start => self.views.get(self.layout.view).start(ctx, &mut self.workspace),
            Command::ExportPng => self.ask(ctx, Purpose::Export, "view.png"),
            Command::ExportSvg => self.ask(ctx, Purpose::Export, "view.svg"),
            Command::ExportCsv => self.ask(ctx, Purpose::Export, "view.csv"),
            Command::ExportAnimation => self.views.machine.film(),
            Command::CloseAll => {
                self.workspace.entries.clear();
                self.views.time.fit();
            }
            // A view with a history of its own undoes its own changes; everywhere else the input signal is undone.
            Command::Undo if self.has_history() => self.views.get(self.layout.view).undo(&mut self.workspace),
            Command::Redo if self.has_history() => self.views.get(self.layout.view).redo(&mut self.workspace),
            Command::Undo => self.workspace.present_signal_mut().undo(),
            Command::Redo => self.workspace.present_signal_mut().redo(),
            // These commands change the live view, so it is shown.
            Command::Cut => {
                ctx.copy_text(self.workspace.present_signal().text());
                self.workspace.present_signal_mut().renew();
                self.layout.view = View::Live;
            }
            Command::Copy => {
                ctx.copy_text(self.workspace.present_signal().text());
                self.layout.view = View::Live;
            }
            Command::Paste => {
                ctx.send_viewport_cmd(egui::ViewportCommand::RequestPaste);
                self.layout.view = View::Live;
            }
            Command::Show(view) => self.layout.view = view,
            Command::OwnWindow => self.set_apart(),
            Command::Theme => {
                self.layout.look = if self.layout.look == Look::Light { Look::Dark } else { Look::Light };
                self.layout.look_is_chosen = true;
                theme::apply(ctx, self.layout.look);
            }
            Command::Larger => self.zoom(ctx, self.layout.zoom * 1.1),
            Command::Smaller => self.zoom(ctx, self.layout.zoom / 1.1),
            Command::NormalSize => self.zoom(ctx, 1.0),
            Command::Help => self.help.is_open = !self.help.is_open,
        }
    }

    fn ask_to_save_recording(&mut self, ctx: &Context) {
        let first = self.workspace.entries.iter().find(|entry| entry.shown);
        let name = first.map_or("recording", |entry| short(&entry.recording.about.name));
        let name = std::path::Path::new(name).with_extension("csv").display().to_string();
        self.ask(ctx, Purpose::SaveRecording, &name);
    }

    fn zoom(&mut self, ctx: &Context, zoom: f32) {
        self.layout.zoom = zoom.clamp(0.6, 2.5);
        ctx.set_zoom_factor(self.layout.zoom);
    }

    /// Runs the commands whose keys were pressed.
    pub(crate) fn shortcuts(&mut self, ctx: &Context) {
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

    fn clipboard(&mut self, ctx: &Context) {
        for event in ctx.input(|input| input.events.clone()) {
            match event {
                egui::Event::Copy => ctx.copy_text(self.workspace.present_signal().text()),
                egui::Event::Cut => {
                    ctx.copy_text(self.workspace.present_signal().text());
                    self.workspace.present_signal_mut().renew();
                }
                egui::Event::Paste(text) => {
                    if let Err(sentence) = self.workspace.present_signal_mut().paste(&text) {
                        self.warn(sentence);
                    }
                }
                _ => {}
            }
        }
    }
}
