//! The form of a new model: words, the sentence under the field that is wrong, and the words that are understood.

use egui::{Button, CollapsingHeader, Label, Response, RichText, Role, TextEdit, Ui, WidgetInfo};
use socam_chart::theme;
use socam_workbench::new_model::{Field, GRAMMAR, NewModel};
use socam_workbench::origin::Origin;
use socam_workbench::purpose::Purpose;
use socam_workbench::recording::short;
use socam_workbench::{Content, Request, Workspace};

use super::columns;

/// Draws the form, whose parts take the keyboard's focus when it `is_new`; true when it is left.
pub(super) fn ui(ui: &mut Ui, form: &mut NewModel, workspace: &mut Workspace, is_new: bool) -> bool {
    ui.heading("New model");
    let text = "From the motor to the load, with | between the parts; drives and measurements one a line. Drawn as you type.";
    ui.add(Label::new(RichText::new(text).color(theme::weak(ui))).wrap());
    ui.add_space(4.0);
    field(ui, "Name of the model", &mut form.words.name, 1);
    let parts = field(ui, "Parts", &mut form.words.chain, 3);
    if is_new {
        parts.request_focus();
    }
    under(ui, form, Field::Chain);
    field(ui, "Drives", &mut form.words.drives, 2);
    under(ui, form, Field::Drives);
    field(ui, "Measured", &mut form.words.measures, 2);
    under(ui, form, Field::Measures);
    form.update();
    if let (Some(_), Some(_)) = form.model() {
        let text = "The drawing shows the last text that was understood.";
        ui.add(Label::new(RichText::new(text).small().color(theme::weak(ui))).wrap());
    }
    columns(ui, form, workspace);
    let is_left = buttons(ui, form, workspace);
    ui.add_space(4.0);
    CollapsingHeader::new("Words that are understood").default_open(true).show(ui, grammar);
    is_left
}

/// A field below its name. Text of several lines has one entry a line, but for the parts.
fn field(ui: &mut Ui, name: &str, text: &mut String, rows: usize) -> Response {
    ui.strong(name);
    let edit =
        if rows == 1 { TextEdit::singleline(text) } else { TextEdit::multiline(text).desired_rows(rows) };
    let field = ui.add(edit.desired_width(f32::INFINITY));
    field.widget_info(|| WidgetInfo::labeled(Role::TextInput, true, name));
    field
}

/// What is wrong with a field.
fn under(ui: &mut Ui, form: &NewModel, field: Field) {
    if let Some(problem) = form.model().1.filter(|problem| problem.field == field) {
        ui.add(
            Label::new(RichText::new(socam_chart::numbers::plain(&problem.sentence)).color(theme::alarm(ui)))
                .wrap(),
        );
    }
}

/// The columns that a drive or a measurement can name behind a colon, and those that the model reads and the recording lacks.
fn columns(ui: &mut Ui, form: &NewModel, workspace: &Workspace) {
    let Some((_, recording)) = workspace.shown().next() else { return };
    let (names, run) = (columns::names(Some(recording)), short(&recording.about.name));
    let text = format!("Columns of {run}: {}", names.join(", "));
    ui.add(Label::new(RichText::new(text).small().color(theme::weak(ui))).wrap());
    let (Some(model), None) = form.model() else { return };
    let lacking: Vec<&str> = columns::lacking(model, &names).map(|own| own.column.as_str()).collect();
    if !lacking.is_empty() {
        let text = format!(
            "{run} has no {}: write the column of it that is meant behind a colon, as in speed@load:COLUMN",
            lacking.join(", no ")
        );
        ui.add(Label::new(RichText::new(text).color(theme::alarm(ui))).wrap());
    }
}

fn buttons(ui: &mut Ui, form: &NewModel, workspace: &mut Workspace) -> bool {
    let mut is_left = false;
    let (model, problem) = form.model();
    let model = model.filter(|_| problem.is_none());
    ui.horizontal_wrapped(|ui| {
        let text = RichText::new("Use").strong();
        if ui
            .add_enabled(model.is_some(), Button::new(text))
            .on_hover_text("It becomes the model of all views")
            .clicked()
            && let Some(model) = model
        {
            workspace.origins.note(model, Origin::Words);
            workspace.request(Request::Model(Box::new(model.clone())));
            is_left = true;
        }
        if ui.add_enabled(model.is_some(), Button::new("Save...")).clicked()
            && let Some(model) = model
        {
            let content = Content::Bytes(model.text.clone().into_bytes());
            workspace.request(Request::SaveAs(Purpose::SaveModel, format!("{}.toml", model.name), content));
        }
        if ui
            .add_enabled(model.is_some(), Button::new("Copy the command"))
            .on_hover_text(form.command())
            .clicked()
        {
            ui.ctx().copy_text(form.command());
        }
        is_left |= ui.button("Back").clicked();
    });
    is_left
}

/// The words of the builder: examples with what they mean.
fn grammar(ui: &mut Ui) {
    for line in GRAMMAR.replace('`', "").lines() {
        match line.strip_prefix("  ").map(|line| line.split_once("  ").unwrap_or((line, ""))) {
            Some((example, meaning)) => {
                ui.add(Label::new(RichText::new(example).monospace().size(12.0)).wrap());
                if !meaning.trim().is_empty() {
                    let text = RichText::new(meaning.trim()).small().color(theme::weak(ui));
                    ui.add(Label::new(text).wrap());
                }
            }
            None => drop(ui.add(Label::new(RichText::new(line).color(theme::weak(ui))).wrap())),
        }
    }
}
