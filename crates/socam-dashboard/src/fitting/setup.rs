//! The set-up of the next identification or diagnosis.

use egui::{CollapsingHeader, ComboBox, RichText, Ui};
use socam_model::{BUILTIN, Model};

use super::parameters::Changes;
use super::roles::{Role, Roles};
use crate::recording::{Recording, short};
use crate::review::Entry;
use socam_chart::theme;

/// Which recordings are fitted and which are held out, and which parameters are fixed. Both views show the same set-up.
#[derive(Debug, Clone, Default)]
pub struct Setup {
    roles: Roles,
    changes: Changes,
}

/// What is fitted.
#[derive(Debug, Clone)]
pub(crate) struct Chosen {
    /// The model with start values and fixed parameters.
    pub(crate) model: Model,
    /// Recordings that are fitted.
    pub(crate) training: Vec<Recording>,
    /// Recordings that are only predicted.
    pub(crate) held_out: Vec<Recording>,
}

impl Setup {
    /// Sets what a recording is used for.
    pub fn use_as(&mut self, name: &str, role: Role) {
        self.roles.set(name, role);
    }

    /// Sets a parameter's start value, SI, and whether it is fixed there.
    pub fn set_parameter(&mut self, name: &str, value: f64, is_fixed: bool) {
        self.changes.set(name, value, is_fixed);
    }

    /// Draws the set-up. Returns another model if one was chosen.
    pub(crate) fn ui(
        &mut self,
        ui: &mut Ui,
        entries: &[Entry],
        models: (&Model, &[Model], u64),
    ) -> Option<Model> {
        let (model, known, revision) = models;
        self.changes.belong_to(revision);
        let wanted = choice(ui, model, known);
        if entries.is_empty() {
            ui.label(
                RichText::new("No recording is open: press Ctrl+O, or drop files here.")
                    .color(theme::weak(ui)),
            );
        } else {
            self.roles.ui(ui, entries);
        }
        let header = CollapsingHeader::new(self.changes.summary(model)).id_salt("start values");
        header.show(ui, |ui| self.changes.ui(ui, model));
        wanted
    }

    /// What is fitted.
    ///
    /// # Errors
    /// Why nothing can be started; one sentence.
    pub(crate) fn chosen(&self, entries: &[Entry], model: &Model) -> Result<Chosen, String> {
        let of = |role: Role| -> Vec<Recording> {
            let own = entries.iter().filter(|entry| self.roles.of(entry) == role);
            own.map(|entry| entry.recording.clone()).collect()
        };
        let chosen = Chosen {
            model: self.changes.applied(model),
            training: of(Role::Fit),
            held_out: of(Role::HoldOut),
        };
        match chosen.problem(entries.is_empty()) {
            Some(problem) => Err(problem),
            None => Ok(chosen),
        }
    }
}

impl Chosen {
    fn problem(&self, is_empty: bool) -> Option<String> {
        if is_empty {
            return Some("No recording is open: press Ctrl+O.".into());
        }
        if self.training.is_empty() {
            return Some("No recording is fitted: choose `fit` for at least one.".into());
        }
        let used: Vec<&Recording> = self.training.iter().chain(&self.held_out).collect();
        for (index, recording) in used.iter().enumerate() {
            let name = &recording.about.name;
            if used[..index].iter().any(|other| other.about.name == *name) {
                return Some(format!(
                    "{} is open twice; its samples would count double: close one.",
                    short(name)
                ));
            }
            if let Some(problem) = self.lacking(recording) {
                return Some(problem);
            }
        }
        self.parameters()
    }

    /// Says which channel of the model a recording lacks.
    fn lacking(&self, recording: &Recording) -> Option<String> {
        let has = |column: &str| {
            let mut channels = recording.about.channels.iter();
            channels.any(|own| own.name == column || own.column_name() == column)
        };
        let channels = self.model.inputs().chain(self.model.outputs());
        let read = channels.filter(|channel| !channel.quantity.is_clock());
        let missing: Vec<&str> =
            read.map(|channel| channel.column.as_str()).filter(|column| !has(column)).collect();
        (!missing.is_empty()).then(|| {
            format!(
                "{} lacks {}, which the model {} reads: choose another model or another recording.",
                short(&recording.about.name),
                missing.join(", "),
                self.model.name
            )
        })
    }

    fn parameters(&self) -> Option<String> {
        let parameters = &self.model.parameters;
        if parameters.iter().all(|parameter| parameter.fixed) {
            return Some("Every parameter is fixed: free at least one.".into());
        }
        let outside = |p: &&socam_model::Parameter| !p.fixed && !(p.bounds.0..=p.bounds.1).contains(&p.value);
        if let Some(parameter) = parameters.iter().find(outside) {
            return Some(format!("{} starts outside its bounds: change its start value.", parameter.name));
        }
        self.model.equations(&self.model.values()).err().map(|error| format!("{error}."))
    }
}

/// The model that is used, and others to choose: the embedded ones, and those that were open in this window.
fn choice(ui: &mut Ui, model: &Model, known: &[Model]) -> Option<Model> {
    let mut wanted = None;
    ui.horizontal(|ui| {
        let label = ui.label("Model");
        let shown = ComboBox::from_id_salt("model").width(230.0).selected_text(title(model));
        let shown = shown.show_ui(ui, |ui| {
            for (name, text) in BUILTIN {
                if ui.selectable_label(model.text == *text, format!("{name}, built in")).clicked() {
                    wanted = Model::builtin(name);
                }
            }
            for other in known.iter().filter(|other| !is_built_in(other)) {
                if ui.selectable_label(model.text == other.text, title(other)).clicked() {
                    wanted = Some(other.clone());
                }
            }
        });
        shown.response.labelled_by(label.id).on_hover_text("A model file is opened with Ctrl+O");
    });
    wanted
}

fn is_built_in(model: &Model) -> bool {
    BUILTIN.iter().any(|(_, text)| model.text == *text)
}

fn title(model: &Model) -> String {
    let kind = if is_built_in(model) { "built in" } else { "from a file or a fit" };
    format!("{}, {kind}", model.name)
}
