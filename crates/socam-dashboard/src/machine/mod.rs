//! The machine: the drawing of the model, what each element has, a new model from words, and the motion of a recording.

mod columns;
mod describe;
mod details;
mod film;
mod help;
mod motions;
mod player;
mod scene;
mod time_line;

use egui::{Button, RichText, ScrollArea, Sense, Ui, vec2};
use socam_chart::chart::Seen;
use socam_chart::theme;
use socam_model::Model;
use socam_model::drawing::PlaceMark;
use socam_workbench::model_history::ModelHistory;
use socam_workbench::new_model::NewModel;
use socam_workbench::purpose::Purpose;
use socam_workbench::recording::Recording;
use socam_workbench::{Content, Request, Workspace};

use crate::bench::{Kept, Stand};
use crate::layout;
use crate::model_choice;
use crate::view::{Help, ViewPanel};
use columns::Wire;
use details::Change;
pub use player::{Colouring, Player};
use scene::Scene;

/// State of the view.
#[derive(Debug, Default)]
pub struct MachineView {
    /// The name of the element that is looked at.
    pub selected: Option<String>,
    /// What is played, and how.
    pub player: Player,
    form: Option<NewModel>,
    /// The form that was left, whose words are kept.
    left: Option<NewModel>,
    /// Whether the form has just been opened.
    takes_focus: bool,
    editor: details::Editor,
    history: ModelHistory,
    motions: motions::Motions,
    film: film::Film,
    drawing: Kept,
}

impl ViewPanel for MachineView {
    fn ui(&mut self, ui: &mut Ui, workspace: &mut Workspace, _: &mut Vec<Seen>) {
        self.history.belong_to(workspace.revision());
        let recording = self.player.choose(&workspace.entries);
        let width = layout::panel(ui, "machine", 336.0);
        let panel = egui::Panel::left("machine").default_size(width).size_range(250.0..=640.0);
        let panel = panel.show(ui, |ui| {
            ScrollArea::vertical()
                .auto_shrink(false)
                .show(ui, |ui| self.side(ui, workspace, recording.as_ref()));
        });
        layout::keep_panel(ui, "machine", panel.response.rect.width());
        match &self.form {
            Some(form) => {
                let model = form.model().0.cloned();
                egui::CentralPanel::default().show(ui, |ui| {
                    if let Some(model) = model {
                        self.picture(ui, workspace, &model, None);
                    }
                });
            }
            None => self.play(ui, workspace, recording.as_ref()),
        }
    }

    fn poll(&mut self, _: &egui::Context, workspace: &mut Workspace) {
        self.motions.poll();
        if let Some(answer) = self.film.poll() {
            workspace.request(match answer {
                Ok(bytes) => {
                    Request::SaveAs(Purpose::SaveAnimation, "machine.png".into(), Content::Bytes(bytes))
                }
                Err(sentence) => Request::Warn(sentence),
            });
        }
    }

    fn is_busy(&self) -> bool {
        self.motions.is_busy() || self.film.is_busy()
    }

    fn has_history(&self) -> bool {
        true
    }

    fn undo(&mut self, workspace: &mut Workspace) {
        if let Some(model) = self.history.undo(workspace.model().clone(), workspace.revision() + 1) {
            workspace.edit_model(model);
        }
    }

    fn redo(&mut self, workspace: &mut Workspace) {
        if let Some(model) = self.history.redo(workspace.model().clone(), workspace.revision() + 1) {
            workspace.edit_model(model);
        }
    }

    fn help() -> Help {
        help::HELP
    }
}

impl MachineView {
    /// Begins an animation, if a recording is played.
    pub(crate) fn film(&mut self) {
        self.film.begin();
    }

    /// Opens the form of a new model with the words that it was left with.
    pub(crate) fn describe_again(&mut self) {
        let form = self.left.take().or_else(|| self.form.take()).unwrap_or_default();
        self.describe(form);
    }

    /// Opens the form of a new model.
    pub fn describe(&mut self, form: NewModel) {
        self.form = Some(form);
        self.takes_focus = true;
    }

    /// Whether a recording is played, so that an animation of it can be drawn.
    pub(crate) fn can_film(&self) -> bool {
        self.form.is_none() && self.motions.known().is_some() && !self.film.is_busy()
    }

    /// The left side: the form of a new model, or the model and one of its elements.
    fn side(&mut self, ui: &mut Ui, workspace: &mut Workspace, recording: Option<&Recording>) {
        ui.add_space(4.0);
        if let Some(form) = &mut self.form {
            if describe::ui(ui, form, workspace, std::mem::take(&mut self.takes_focus)) {
                self.left = self.form.take();
            }
            return;
        }
        self.doors(ui, workspace);
        ui.separator();
        let columns = columns::names(recording);
        if let Some(recording) = recording {
            columns::list(ui, workspace.model(), recording, &columns);
        }
        let now = (self.motions.known(), self.player.time_s);
        let change = self.editor.ui(ui, workspace.model(), &mut self.selected, now, &columns);
        if let Some(change) = change {
            self.change(workspace, &change);
        }
    }

    /// Changes the model of the window, or says why it cannot be changed so.
    fn change(&mut self, workspace: &mut Workspace, change: &Change) {
        let before = workspace.model().clone();
        let changed = match change {
            Change::Parameter(name, si, fixed) => before.with_parameter(name, *si, *fixed),
            Change::Column(wire) => before.with_column(&wire.channel, &wire.column),
        };
        match changed {
            Ok(model) => {
                workspace.edit_model(model);
                self.history.changed(before, workspace.revision());
                self.editor.problem = None;
            }
            Err(error) => self.editor.problem = Some(format!("{error}.")),
        }
    }

    /// The ways to a model: one that is known, one of a file, a new one.
    fn doors(&mut self, ui: &mut Ui, workspace: &mut Workspace) {
        if workspace.revision() == 0 {
            let text = "No model of your machine is open yet: this is a built-in one.";
            ui.label(RichText::new(text).color(theme::weak(ui)));
        }
        if let Some(model) = model_choice::ui(ui, workspace) {
            workspace.request(Request::Model(Box::new(model)));
        }
        ui.horizontal_wrapped(|ui| {
            if ui.button("Open model...").on_hover_text("A model file (.toml), also by Ctrl+O").clicked() {
                workspace.request(Request::Ask);
            }
            if ui.button("New model...").on_hover_text("Describe the machine in a line of words").clicked() {
                self.describe_again();
            }
            if ui.button("Save model file...").clicked() {
                let content = Content::Bytes(workspace.model().text.clone().into_bytes());
                let name = format!("{}.toml", workspace.model().name);
                workspace.request(Request::SaveAs(Purpose::SaveModel, name, content));
            }
        });
        let [undo, redo] = self.history.can();
        if undo || redo {
            ui.horizontal(|ui| {
                if ui.add_enabled(undo, Button::new("Undo the change")).clicked() {
                    self.undo(workspace);
                }
                if ui.add_enabled(redo, Button::new("Redo the change")).clicked() {
                    self.redo(workspace);
                }
            });
        }
    }

    /// The drawing of the model, which moves as a recording does, above the time line.
    fn play(&mut self, ui: &mut Ui, workspace: &mut Workspace, recording: Option<&Recording>) {
        let model = workspace.model().clone();
        if let Some(recording) = recording {
            self.motions.update(ui.ctx(), workspace, recording);
        }
        egui::Panel::bottom("playing").show(ui, |ui| {
            ui.add_space(4.0);
            self.time_line(ui, workspace, recording);
            ui.add_space(4.0);
        });
        let picture = egui::CentralPanel::default();
        let wired = picture.show(ui, |ui| self.picture(ui, workspace, &model, recording)).inner;
        if let Some(wire) = wired {
            self.change(workspace, &Change::Column(wire));
        }
    }

    fn time_line(&mut self, ui: &mut Ui, workspace: &mut Workspace, recording: Option<&Recording>) {
        let Some(recording) = recording else {
            ui.horizontal_wrapped(|ui| {
                crate::together::level(ui);
                ui.label("A recording that is open and shown moves the machine.");
                if ui.button("Open...").on_hover_text("Recordings, models, results (Ctrl+O)").clicked() {
                    workspace.request(Request::Ask);
                }
            });
            return;
        };
        if self.film.is_busy() {
            self.film.progress(ui);
            return;
        }
        if self.player.ui(ui, &workspace.entries, recording, &mut self.motions) {
            self.film.begin();
        }
    }

    /// The drawing, with a click on an element. Returns a column that was dropped onto a channel.
    fn picture(
        &mut self,
        ui: &mut Ui,
        workspace: &Workspace,
        model: &Model,
        recording: Option<&Recording>,
    ) -> Option<Wire> {
        let motion = recording.and_then(|_| self.motions.known());
        let diagnosis = workspace.rail.diagnosis.as_ref().filter(|own| own.model == model.name);
        let marks: Vec<(&str, PlaceMark)> =
            diagnosis.map(|diagnosis| socam_findings::headline::marks(diagnosis)).unwrap_or_default();
        let room = ui.available_size();
        let drawing = self.drawing.get(model, &marks, f64::from(room.x));
        let whole = vec2(drawing.size[0] as f32, drawing.size[1] as f32);
        let scale = (room.x / whole.x).min((room.y - scene::HEAD) / whole.y).clamp(SMALLEST, LARGEST);
        let size = scale * whole + vec2(0.0, scene::HEAD);
        let scene = Scene {
            model,
            drawing: &drawing,
            motion,
            time_s: self.player.time_s,
            angle_scale: motion.map_or(1.0, |motion| self.player.angle_scale(motion)),
            colouring: self.player.colouring,
        };
        let mut wired = None;
        ScrollArea::both().id_salt("machine").auto_shrink(false).show(ui, |ui| {
            let (area, _) = ui.allocate_exact_size(size.max(room.floor()), Sense::hover());
            let above = (0.4 * (area.height() - size.y)).max(0.0);
            let corner = area.min + vec2(0.5 * (area.width() - size.x), above + scene::HEAD);
            let stand = Stand { corner, scale };
            for (index, place) in drawing.places.iter().enumerate() {
                let said = scene.said(place, &marks);
                if scene::point_at(
                    ui,
                    index,
                    stand.area(place.from, place.to),
                    &said,
                    self.selected.as_deref() == Some(&place.name),
                ) {
                    self.selected = Some(place.name.clone());
                }
            }
            for own in drawing.places.iter().filter(|place| scene::is_sensor(place)) {
                let area = stand.area(own.from, own.to);
                wired = columns::drop_at(ui, model, &own.name, area).or(wired.take());
            }
            let shapes = scene.shapes(ui, stand);
            ui.painter().extend(shapes);
            let part =
                egui::Rect::from_min_size(corner - vec2(0.0, scene::HEAD), size).intersect(ui.clip_rect());
            if motion.is_some() {
                self.film.go_on(ui, &self.player, &scene, stand, part);
            } else {
                self.film.give_up();
            }
        });
        wired
    }
}

/// Least and greatest magnification of a drawing; one that is still too wide is scrolled.
const SMALLEST: f32 = 0.8;
const LARGEST: f32 = 1.7;
