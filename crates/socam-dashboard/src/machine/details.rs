//! What an element has: parameters to change, intervals, channels, and what it does at this moment.

use egui::{DragValue, Label, RichText, Role, Ui, WidgetInfo};
use socam_chart::numbers::{interval, number, trimmed};
use socam_chart::theme;
use socam_model::drawing::{Drawing, Place, Style};
use socam_model::{Model, Motion as Kind};
use socam_workbench::element::{ElementDetails, channel_words, in_file_unit, in_si};
use socam_workbench::motion::Motion;

use super::columns::{self, Wire};

/// The value that is being typed or dragged.
#[derive(Debug, Default)]
pub(super) struct Editor {
    /// Name of the parameter and its value in the unit of the file.
    pending: Option<(String, f64)>,
    /// Why the last change could not be made; one sentence.
    pub(super) problem: Option<String>,
    /// Intervals of the model's file, SI, its elements, and the text of the file.
    intervals: Vec<Option<[f64; 2]>>,
    places: Vec<Place>,
    of: String,
}

/// A change of the model.
pub(super) enum Change {
    /// A parameter's name, its new value, SI, and whether it is fixed.
    Parameter(String, f64, bool),
    /// Another column of a channel.
    Column(Wire),
}

impl Editor {
    /// Draws the element that is selected, or all parameters. Returns a change that was asked for.
    pub(super) fn ui(
        &mut self,
        ui: &mut Ui,
        model: &Model,
        selected: &mut Option<String>,
        (motion, time_s): (Option<&Motion>, f64),
        columns: &[String],
    ) -> Option<Change> {
        if self.of != model.text {
            // Reading the file anew in each pass would take longer than drawing it.
            (self.intervals, self.of) = (model.intervals(), model.text.clone());
            self.places = Drawing::of(model, &[], Style::default()).places;
        }
        let intervals = self.intervals.clone();
        let place = selected.as_ref().and_then(|name| self.places.iter().find(|place| place.name == *name));
        let place = place.cloned();
        let mut change = None;
        if let Some(problem) = &self.problem {
            ui.add(Label::new(RichText::new(problem).color(theme::alarm(ui))).wrap());
        }
        let Some(place) = place else {
            *selected = None;
            ui.strong(format!("All parameters of {}", model.name));
            ui.add(Label::new(RichText::new(&model.description).color(theme::weak(ui))).wrap());
            ui.label(RichText::new("A click on an element shows its own.").color(theme::weak(ui)));
            ui.add_space(4.0);
            for (index, ci95) in intervals.iter().enumerate() {
                change = self.parameter(ui, model, index, "", *ci95).or(change);
            }
            return change;
        };
        let details = ElementDetails::of(model, &place.name);
        ui.heading(&place.name);
        let kind = place.hint.strip_prefix(&format!("{}: ", place.name)).unwrap_or(&place.hint);
        ui.label(RichText::new(kind).color(theme::weak(ui)));
        if let Some(motion) = motion {
            now(ui, model, &place.name, motion, time_s);
        }
        ui.add_space(4.0);
        for own in &details.parameters {
            change = self.parameter(ui, model, own.index, &own.what, intervals[own.index]).or(change);
        }
        if details.parameters.is_empty() && details.channels.is_empty() {
            ui.label("It has no parameters, and no channel sits here.");
        }
        for effect in &details.effects {
            ui.label(format!("Effect: {effect}"));
        }
        for channel in details.channels.iter().map(|index| &model.channels[*index]) {
            ui.add_space(2.0);
            ui.strong(&channel.name);
            ui.add(Label::new(RichText::new(channel_words(channel)).color(theme::weak(ui))).wrap());
            change = columns::choice(ui, channel, columns).map(Change::Column).or(change);
        }
        ui.add_space(8.0);
        if ui.button("All parameters").clicked() {
            *selected = None;
        }
        change
    }

    /// Draws a parameter; returns a change of it.
    fn parameter(
        &mut self,
        ui: &mut Ui,
        model: &Model,
        index: usize,
        what: &str,
        ci95: Option<[f64; 2]>,
    ) -> Option<Change> {
        let parameter = &model.parameters[index];
        let name = &parameter.name;
        let mut change = None;
        ui.horizontal_wrapped(|ui| {
            ui.strong(name);
            if !what.is_empty() && what != name {
                ui.label(RichText::new(what).color(theme::weak(ui)));
            }
            if !parameter.source.is_empty() {
                ui.label(RichText::new(&parameter.source).small().color(theme::weak(ui)));
            }
        });
        ui.horizontal(|ui| {
            let known = in_file_unit(parameter, parameter.value);
            let pending = self.pending.as_ref().filter(|(own, _)| own == name).map(|(_, value)| *value);
            let mut value = pending.unwrap_or(known);
            let speed = (0.01 * value.abs()).max(1e-9);
            let field = DragValue::new(&mut value).speed(speed).custom_formatter(|value, _| trimmed(value));
            let field = ui.add(field.update_while_editing(false));
            let said = format!("Value of {name}");
            field.widget_info(|| WidgetInfo::labeled(Role::SpinButton, true, &said));
            if field.changed() && value.is_finite() {
                self.pending = Some((name.clone(), value));
            }
            // A drag changes the model once, at its end.
            if self.pending.as_ref().is_some_and(|(own, _)| own == name)
                && !field.dragged()
                && !field.has_focus()
            {
                let value = self.pending.take().map_or(known, |(_, value)| value);
                if value != known {
                    change = Some(Change::Parameter(name.clone(), in_si(parameter, value), parameter.fixed));
                }
            }
            ui.label(socam_plot::words::unit(&parameter.file_unit));
            let mut fixed = parameter.fixed;
            let tick = ui.checkbox(&mut fixed, "fixed");
            let said = format!("Fixed: {name}");
            tick.widget_info(|| WidgetInfo::selected(Role::CheckBox, true, fixed, &said));
            if tick.changed() {
                change = Some(Change::Parameter(name.clone(), parameter.value, fixed));
            }
        });
        if let Some(ends) = ci95 {
            let own = |value: f64| Some(in_file_unit(parameter, value));
            let text = format!("95 % interval {}", interval(own(parameter.value), ends.map(own)));
            ui.label(RichText::new(text).small().color(theme::weak(ui)));
        }
        ui.add_space(3.0);
        change
    }
}

/// What an element does at this moment.
fn now(ui: &mut Ui, model: &Model, name: &str, motion: &Motion, time_s: f64) {
    let (angle, torque) = match model.motion {
        Kind::Rotation => ("rad", "N m"),
        Kind::Translation => ("m", "N"),
    };
    let mut lines = Vec::new();
    if let Some(node) =
        model.nodes.iter().position(|node| node.name == name).and_then(|index| motion.nodes.get(index))
    {
        if let Some((measured, travel)) = node.measured.as_ref().and_then(|own| Some((own, own.at(time_s)?)))
        {
            let beyond = if measured.is_here { "" } else { ", beyond a spring" };
            lines.push(format!(
                "measured {} {angle} since the start, by {}{beyond}",
                number(travel),
                measured.channel
            ));
        }
        if let Some(travel) = node.predicted.as_ref().and_then(|own| own.at(time_s)) {
            lines.push(format!("predicted {} {angle} since the start", number(travel)));
        }
    }
    if let Some(spring) = motion.springs.iter().find(|spring| spring.name == name) {
        if let Some(value) = spring.torque.at(time_s) {
            let what = if model.motion == Kind::Rotation { "torque" } else { "force" };
            lines.push(format!("{what} predicted {} {torque}", number(value)));
        }
        if let Some(value) = spring.power.as_ref().and_then(|own| own.at(time_s)) {
            lines.push(format!("power predicted {} W", number(value)));
        }
    }
    for misfit in motion.misfits.iter().filter(|misfit| misfit.at == name || misfit.channel == name) {
        if let Some(share) = misfit.share.at(time_s) {
            lines.push(format!(
                "misfit of {} {:.1} % of its root mean square",
                misfit.channel,
                100.0 * share
            ));
        }
    }
    if !lines.is_empty() {
        ui.label(RichText::new(format!("At {time_s:.3} s:")).small().color(theme::weak(ui)));
        lines.iter().for_each(|line| drop(ui.add(Label::new(line).wrap())));
    }
}
