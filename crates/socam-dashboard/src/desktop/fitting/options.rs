//! A form of a task's options, drawn from their one description ([`socam_job::options::describe`]).

use egui::{CollapsingHeader, ComboBox, DragValue, TextEdit, Ui};
use serde_json::Value;
use socam_job::options::{Described, ValueType, describe, from_words};
use socam_job::{JobError, Settings};

use crate::together::level;

/// A task whose options a view offers.
pub(crate) trait Offered: Settings {
    /// How they are shown.
    const LAYOUT: Layout;
}

/// How a view shows the options of its task.
#[derive(Debug)]
pub(crate) struct Layout {
    /// Options that are always seen, in this order; the others fold under "More options".
    pub(crate) first: &'static [First],
    /// Options that the set-up offers, or that the window has no use for. Those of files are left out too.
    pub(crate) left_out: &'static [&'static str],
    /// Whether options under a heading of their own are offered.
    pub(crate) is_headed: bool,
}

/// An option that is always seen.
#[derive(Debug)]
pub(crate) struct First {
    /// Its keyword.
    pub(crate) name: &'static str,
    /// Its label.
    pub(crate) label: &'static str,
    /// Whether its number is a share that is shown in percent.
    pub(crate) is_percent: bool,
    /// Those of its choices that the window offers, with their meanings; all of them where none is named.
    pub(crate) choices: &'static [(&'static str, &'static str)],
}

impl First {
    /// An option that is shown as it is typed, with all of its choices.
    pub(crate) const fn new(name: &'static str, label: &'static str) -> Self {
        Self { name, label, is_percent: false, choices: &[] }
    }
}

/// The options of a task as texts that its command would take, and the settings that they make.
#[derive(Debug)]
pub(crate) struct Form<T> {
    first: Vec<Row>,
    more: Vec<Row>,
    settings: Result<T, String>,
}

/// An option and its value.
#[derive(Debug)]
struct Row {
    option: Described,
    label: String,
    is_percent: bool,
    /// Meanings of its choices.
    meanings: &'static [(&'static str, &'static str)],
    /// The value as it is typed on the command line, a line for each one of a list; empty for the default.
    text: String,
}

/// All options have their defaults.
impl<T: Offered> Default for Form<T> {
    fn default() -> Self {
        Self::new(&T::LAYOUT)
    }
}

impl<T: Settings> Form<T> {
    fn new(layout: &Layout) -> Self {
        let (all, problem) = match describe::<T>() {
            Ok(all) => (all, None),
            Err(error) => (Vec::new(), Some(error.in_keywords())),
        };
        let known = |name: &str| all.iter().find(|option| option.name == name).cloned();
        let first = |own: &First| {
            let mut option = known(own.name)?;
            let is_offered = |choice: &String| own.choices.iter().any(|(word, _)| word == choice);
            option.choices.retain(|choice| own.choices.is_empty() || is_offered(choice));
            let (label, is_percent) = (own.label.to_owned(), own.is_percent);
            Some(Row { option, label, is_percent, meanings: own.choices, text: String::new() })
        };
        let is_more = |option: &&Described| {
            let is_first = layout.first.iter().any(|own| own.name == option.name);
            let is_left_out = layout.left_out.contains(&option.name.as_str());
            !is_first
                && !is_left_out
                && option.kind != ValueType::Path
                && (layout.is_headed || option.heading.is_none())
        };
        let more = |option: &Described| Row {
            label: words_of(&option.name),
            option: option.clone(),
            is_percent: false,
            meanings: &[],
            text: String::new(),
        };
        let mut form = Self {
            first: layout.first.iter().filter_map(first).collect(),
            more: all.iter().filter(is_more).map(more).collect(),
            settings: Err(problem.unwrap_or_default()),
        };
        form.read();
        form
    }

    /// The settings.
    ///
    /// # Errors
    /// Which value cannot be meant; one sentence.
    pub(crate) fn settings(&self) -> Result<&T, String> {
        self.settings.as_ref().map_err(Clone::clone)
    }

    /// Draws the options.
    pub(crate) fn ui(&mut self, ui: &mut Ui) {
        let mut is_changed = false;
        for row in &mut self.first {
            is_changed |= row.ui::<T>(ui, true);
        }
        if !self.more.is_empty() {
            let set = self.more.iter().filter(|row| !row.words().is_empty()).count();
            let title = if set == 0 { "More options".into() } else { format!("More options: {set} set") };
            CollapsingHeader::new(title).id_salt(("more options", T::COMMAND)).show(ui, |ui| {
                for row in &mut self.more {
                    is_changed |= row.ui::<T>(ui, false);
                }
            });
        }
        if is_changed {
            self.read();
        }
    }

    fn read(&mut self) {
        let words: Vec<String> = self.first.iter().chain(&self.more).flat_map(Row::words).collect();
        self.settings = from_words(&words).map_err(|error| self.sentence(&error));
    }

    /// The sentence of a wrong value, with the label that the form has.
    fn sentence(&self, error: &JobError) -> String {
        let JobError::Value { keyword, problem, .. } = error else { return error.in_keywords() };
        let row = self.first.iter().chain(&self.more).find(|row| row.option.name == *keyword);
        format!("{}{problem}", row.map_or(keyword, |row| &row.label))
    }
}

impl Row {
    /// The option as words of the command line; none at its default.
    fn words(&self) -> Vec<String> {
        let flag = &self.option.flag;
        let with = |text: &str| format!("{flag}={text}");
        match self.text.trim() {
            "" => Vec::new(),
            _ if self.option.kind == ValueType::Switch => vec![flag.clone()],
            text if self.option.is_list => {
                text.lines().map(str::trim).filter(|line| !line.is_empty()).map(with).collect()
            }
            text => vec![with(text)],
        }
    }

    /// Draws the option; whether it was changed. Choices that are always seen stand side by side.
    fn ui<T: Settings>(&mut self, ui: &mut Ui, is_first: bool) -> bool {
        let has_default = !self.option.default.is_null();
        let drawn = ui.horizontal(|ui| match self.option.kind {
            ValueType::Switch => self.switch(ui),
            ValueType::Choice if is_first => self.side_by_side(ui),
            kind => {
                level(ui);
                let label = ui.label(&self.label).on_hover_text(&self.option.help);
                match kind {
                    ValueType::Choice => self.choice(ui, label.id),
                    ValueType::Whole | ValueType::Number if has_default => self.number::<T>(ui, label.id),
                    _ => self.line(ui, label.id),
                }
            }
        });
        drawn.inner
    }

    fn switch(&mut self, ui: &mut Ui) -> bool {
        let usual = self.option.default.as_bool().unwrap_or_default();
        let mut is_on = usual == self.text.is_empty();
        let tick = ui.checkbox(&mut is_on, &self.label).on_hover_text(&self.option.help);
        if tick.changed() {
            self.text = if is_on == usual { String::new() } else { is_on.to_string() };
        }
        tick.changed()
    }

    fn side_by_side(&mut self, ui: &mut Ui) -> bool {
        let (shown, choices) = (self.shown(), self.option.choices.clone());
        choices.iter().fold(false, |is_changed, choice| {
            let meaning = self.meanings.iter().find(|(word, _)| word == choice);
            let meaning = meaning.map_or(self.option.help.as_str(), |(_, meaning)| meaning);
            let label = ui.selectable_label(shown == *choice, words_of(choice)).on_hover_text(meaning);
            is_changed | (label.clicked() && self.choose(choice))
        })
    }

    fn choice(&mut self, ui: &mut Ui, label: egui::Id) -> bool {
        let (shown, choices) = (self.shown(), self.option.choices.clone());
        let list = ComboBox::from_id_salt(&self.option.name).selected_text(words_of(&shown));
        let list = list.show_ui(ui, |ui| {
            choices.iter().fold(false, |is_changed, choice| {
                let is_chosen = ui.selectable_label(shown == *choice, words_of(choice)).clicked();
                is_changed | (is_chosen && self.choose(choice))
            })
        });
        list.response.labelled_by(label);
        list.inner.unwrap_or_default()
    }

    fn choose(&mut self, choice: &str) -> bool {
        self.text = if text_of(&self.option.default) == choice { String::new() } else { choice.to_owned() };
        true
    }

    /// A number stays within the range that the task takes.
    fn number<T: Settings>(&mut self, ui: &mut Ui, label: egui::Id) -> bool {
        let shown = self.shown();
        // A number that is typed in percent is shown so, too.
        let (shown, end) = shown.strip_suffix('%').map_or((shown.as_str(), ""), |number| (number, "%"));
        let factor = if self.is_percent { 100.0 } else { 1.0 };
        let mut value = factor * shown.parse::<f64>().unwrap_or_default();
        let is_whole = self.option.kind == ValueType::Whole;
        let speed = (0.01 * value.abs()).max(1e-6);
        let field = DragValue::new(&mut value).update_while_editing(false);
        let field = if is_whole {
            field.speed(0.1).max_decimals(0)
        } else {
            field.speed(speed).custom_formatter(|value, _| rounded(value, 5))
        };
        let field = if self.is_percent || end == "%" { field.suffix(" %") } else { field };
        if !ui.add(field).labelled_by(label).changed() {
            return false;
        }
        let text = if is_whole { format!("{value:.0}") } else { rounded(value / factor, 10) + end };
        let is_taken = from_words::<T>(&[format!("{}={text}", self.option.flag)]).is_ok();
        if is_taken {
            self.text = if text_of(&self.option.default) == text { String::new() } else { text };
        }
        is_taken
    }

    fn line(&mut self, ui: &mut Ui, label: egui::Id) -> bool {
        let hint = match text_of(&self.option.default) {
            usual if usual.is_empty() => default_in(&self.option.help)
                .map_or_else(|| self.option.value_name.to_lowercase(), str::to_owned),
            usual => usual,
        };
        let field = if self.option.is_list {
            TextEdit::multiline(&mut self.text).desired_rows(1).hint_text(format!("{hint}, one a line"))
        } else {
            TextEdit::singleline(&mut self.text).hint_text(hint)
        };
        ui.add(field.desired_width(190.0)).labelled_by(label).changed()
    }

    /// The value, also where it is the default.
    fn shown(&self) -> String {
        match self.text.trim() {
            "" => text_of(&self.option.default),
            text => text.to_owned(),
        }
    }
}

/// A default as it would be typed.
fn text_of(value: &Value) -> String {
    match value {
        Value::Null | Value::Array(_) => String::new(),
        Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}

/// The word `10s` of a help that ends with `[default: 10s]`.
fn default_in(help: &str) -> Option<&str> {
    let (_, default) = help.rsplit_once("[default: ")?;
    default.strip_suffix(']').filter(|default| !default.contains(' '))
}

/// `false_alarm_rate` as `False alarm rate`, `period_s` as `Period`
fn words_of(name: &str) -> String {
    let words = name.strip_suffix("_s").unwrap_or(name).replace(['_', '-'], " ");
    let mut letters = words.chars();
    letters.next().map(|first| first.to_uppercase().chain(letters).collect()).unwrap_or_default()
}

/// A number of so many significant digits, without zeros at its end: 0.011 and not 0.011000000000000001.
fn rounded(value: f64, digits: usize) -> String {
    let decimals = digits - 1;
    format!("{value:.decimals$e}").parse::<f64>().unwrap_or(value).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use socam_job::Diagnose;

    const LAYOUT: Layout = Layout {
        first: &[First::new("most", "Most effects")],
        left_out: &["model", "fixed", "start_values", "repeatability"],
        is_headed: false,
    };

    fn set(form: &mut Form<Diagnose>, name: &str, text: &str) {
        let row = form.first.iter_mut().chain(&mut form.more).find(|row| row.option.name == name);
        row.unwrap().text = text.into();
        form.read();
    }

    #[test]
    fn values_are_texts_of_the_command_line() {
        let mut form = Form::<Diagnose>::new(&LAYOUT);
        assert_eq!(form.settings().unwrap(), &socam_job::options::defaults::<Diagnose>().unwrap());
        set(&mut form, "most", "5");
        set(&mut form, "start", "equilibrium");
        set(&mut form, "between", "hold\n\nmotor_torque=linear\n");
        let settings = form.settings().unwrap();
        assert_eq!((settings.most, settings.start), (5, socam_job::Start::Equilibrium));
        assert_eq!(settings.model.between, ["hold", "motor_torque=linear"]);
    }

    #[test]
    fn a_wrong_value_is_named_by_its_label() {
        let mut form = Form::<Diagnose>::new(&LAYOUT);
        set(&mut form, "most", "7");
        let said = form.settings().unwrap_err();
        assert!(said.starts_with("Most effects: 7 is not in"), "{said}");
        set(&mut form, "most", "");
        set(&mut form, "false_alarm_rate", "2");
        assert_eq!(form.settings().unwrap_err(), "False alarm rate 2: expected a number between 0 and 1");
    }

    #[test]
    fn numbers_have_no_digits_of_rounding() {
        assert_eq!(rounded(1.1 / 100.0, 10), "0.011");
        assert_eq!(rounded(100.0 * 0.01, 5), "1");
        assert_eq!(words_of("output-error"), "Output error");
        assert_eq!(default_in("Length of a block [default: 500ms]"), Some("500ms"));
    }
}
