//! The command that does the same as the window.

use egui::{Label, RichText, Ui};
use socam_chart::theme;
use socam_job::options::{command_line, quoted};
use socam_job::{ModelSettings, Settings};
use socam_model::{BUILTIN, Model};
use socam_workbench::recording::Recording;
use socam_workbench::setup::Chosen;

/// Names the model in the settings of a command, with the changes by which `changed` came from `model`. Returns what the command lacks.
pub(crate) fn name_model(settings: &mut ModelSettings, model: &Model, changed: &Model) -> Vec<String> {
    let mut notes = Vec::new();
    settings.model = match BUILTIN.iter().find(|(_, text)| *text == model.text) {
        Some((name, _)) => (*name).to_owned(),
        None => {
            let file = format!("{}.toml", model.name);
            notes.push(format!("{} stands for the file of the model, which is not built in.", quoted(&file)));
            file
        }
    };
    for (before, now) in model.parameters.iter().zip(&changed.parameters) {
        let name = &now.name;
        let value = (before.value != now.value).then(|| format!("{name}={}", now.value));
        match (before.fixed, now.fixed, value) {
            (false, true, value) => settings.fixed.push(value.unwrap_or_else(|| name.clone())),
            (true, true, Some(value)) => settings.fixed.push(value),
            (was_fixed, false, value) => {
                settings.start_values.extend(value);
                if was_fixed {
                    notes.push(format!("{name} is fixed in the model's file, and no option frees it."));
                }
            }
            (true, true, None) => {}
        }
    }
    notes
}

/// The command on the chosen recordings; `None` where one has no file. `held_out` is the flag of those that are held out.
pub(crate) fn of<T: Settings>(settings: &T, chosen: &Chosen, held_out: &str) -> Option<String> {
    let names = |recordings: &[Recording]| -> Option<Vec<String>> {
        recordings.iter().map(|own| own.path().map(|_| own.about.name.clone())).collect()
    };
    let (fitted, predicted) = (names(&chosen.training)?, names(&chosen.held_out)?);
    command_line(settings, &[("", &fitted), (held_out, &predicted)]).ok()
}

/// Draws a command, and what it lacks.
pub(crate) fn ui(ui: &mut Ui, command: &str, notes: &[String]) {
    ui.horizontal(|ui| {
        ui.label(RichText::new("Same as:").small().color(theme::weak(ui)));
        if ui.small_button("Copy").on_hover_text("Copy the command").clicked() {
            ui.ctx().copy_text(command.to_owned());
        }
    });
    ui.add(Label::new(RichText::new(command).monospace().small()).wrap());
    for note in notes {
        ui.label(RichText::new(note).small().color(theme::weak(ui)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use socam_job::{Diagnose, options};

    #[test]
    fn a_model_is_named_with_its_changes() {
        let model = Model::builtin("two-mass").unwrap();
        let mut changed = model.clone();
        (changed.parameters[0].value, changed.parameters[0].fixed) = (0.5, !model.parameters[0].fixed);
        let mut settings: Diagnose = options::defaults().unwrap();
        let notes = name_model(&mut settings.model, &model, &changed);
        assert_eq!((notes.len(), settings.model.model.as_str()), (0, "two-mass"));
        assert_eq!(settings.model.fixed, [format!("{}=0.5", model.parameters[0].name)]);
        let same = settings.model.load().unwrap();
        assert_eq!(same.parameters[0].value, 0.5);
        assert!(same.parameters[0].fixed);
        let notes = name_model(&mut settings.model, &changed, &model);
        assert!(notes[0].contains("no option frees it"), "{notes:?}");
    }
}
