//! The command that does the same as the window.

use egui::{Label, RichText, Ui};
use socam_chart::theme;
use socam_job::options::{command_line, quoted};
use socam_job::{ModelSettings, Settings};
use socam_model::{BUILTIN, Model};
use socam_workbench::recording::Recording;

/// The name of a model for a command, and what a command by this name lacks.
pub(crate) fn named(model: &Model) -> (String, Vec<String>) {
    if let Some((name, _)) = BUILTIN.iter().find(|(_, text)| *text == model.text) {
        return ((*name).to_owned(), Vec::new());
    }
    let file = format!("{}.toml", model.name);
    let note = format!("{} stands for the file of the model, which is not built in.", quoted(&file));
    (file, vec![note])
}

/// Names the model in the settings of a command, with the changes by which `changed` came from `model`. Returns what the command lacks.
pub(crate) fn name_model(settings: &mut ModelSettings, model: &Model, changed: &Model) -> Vec<String> {
    let (name, mut notes) = named(model);
    settings.model = name;
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

/// The command on recordings, and on others behind their flag; `None` where one has no file.
pub(crate) fn of<'r, T: Settings>(
    settings: &T,
    recordings: impl IntoIterator<Item = &'r Recording>,
    (flag, others): (&str, &[Recording]),
) -> Option<String> {
    let name = |own: &Recording| own.path().map(|_| own.about.name.clone());
    let recordings: Vec<String> = recordings.into_iter().map(name).collect::<Option<_>>()?;
    let others: Vec<String> = others.iter().map(name).collect::<Option<_>>()?;
    command_line(settings, &[("", &recordings), (flag, &others)]).ok()
}

/// Draws a command, and what it lacks. Of several commands the first one is shown, and all are copied.
pub(crate) fn ui(ui: &mut Ui, command: &str, notes: &[String]) {
    ui.horizontal_wrapped(|ui| {
        ui.label(RichText::new("Same as:").small().color(theme::weak(ui)));
        if ui.small_button("Copy").on_hover_text("Copy the command").clicked() {
            ui.ctx().copy_text(command.to_owned());
        }
        let first = command.lines().next().unwrap_or_default();
        ui.add(Label::new(RichText::new(first).monospace().size(12.0)).wrap());
    });
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
