//! A model file as it is written, part by part.

use std::fmt::{Display, Write as _};

use socam_model::effects::Effect;

/// Digits of a value.
const DIGITS: usize = 9;

/// A number of a model file, in the unit of its source.
pub(crate) struct Parameter<'a> {
    pub(crate) key: &'a str,
    pub(crate) value: f64,
    pub(crate) unit: &'a str,
    pub(crate) bounds: Option<(f64, f64)>,
    pub(crate) fixed: bool,
    pub(crate) source: &'a str,
}

/// The text of a model file.
pub(crate) struct ModelText {
    text: String,
}

impl ModelText {
    /// A file that begins with its name, what it is about and what it leaves out; its parameters follow.
    pub(crate) fn new(name: &str, about: &str, turns: bool, left_out: &[String]) -> Self {
        let mut file = Self { text: String::from("schema = \"socam.model/1\"\n") };
        file.line(format_args!("name = {}", quoted(name)));
        file.line(format_args!("description = {}", quoted(about)));
        file.line(format_args!("motion = \"{}\"", if turns { "rotation" } else { "translation" }));
        for left_out in left_out {
            file.comment(&format!("Left out: {left_out}"));
        }
        file.line("\n[parameters]");
        file
    }

    pub(crate) fn line(&mut self, line: impl Display) {
        let _ = writeln!(self.text, "{line}");
    }

    pub(crate) fn comment(&mut self, comment: &str) {
        self.line(format_args!("# {}", comment.replace(['\n', '\r'], " ")));
    }

    pub(crate) fn parameter(&mut self, parameter: &Parameter<'_>) {
        let Parameter { key, value, unit, bounds, fixed, source } = parameter;
        let bounds = bounds.map_or(String::new(), |(low, high)| {
            format!(", bounds = [{}, {}]", rounded(low, 2), rounded(high, 2))
        });
        let fixed = if *fixed { ", fixed = true" } else { "" };
        self.line(format_args!(
            "{key} = {{ value = {}, unit = \"{unit}\"{bounds}{fixed}, source = {} }}",
            rounded(*value, DIGITS),
            quoted(source)
        ));
    }

    /// A table with keys whose values are strings.
    pub(crate) fn table(&mut self, header: &str, keys: &[(&str, &str)]) {
        self.line(format_args!("\n{header}"));
        for (key, value) in keys {
            self.line(format_args!("{key} = {}", quoted(value)));
        }
    }

    /// An effect, with its parameters by names of the file's.
    pub(crate) fn effect(&mut self, effect: &Effect, at: &str, parameters: &[(&str, &str)]) {
        self.table("[[effects]]", &[("effect", effect.id), ("at", at)]);
        let parameters: Vec<String> =
            parameters.iter().map(|(own, name)| format!("{own} = {}", quoted(name))).collect();
        self.line(format_args!("parameters = {{ {} }}", parameters.join(", ")));
    }

    pub(crate) fn channel(&mut self, name: &str, role: &str, quantity: &str, at: &str) {
        self.table(&format!("[channels.{name}]"), &[("role", role), ("quantity", quantity), ("at", at)]);
    }

    pub(crate) fn finish(self) -> String {
        self.text
    }
}

/// A number with so many digits.
pub(crate) fn rounded(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits - 1).parse().unwrap_or(value)
}

/// A name of letters, digits and underscores.
pub(crate) fn plain(name: &str) -> String {
    let plain: String = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    let plain = plain.trim_matches('_').to_owned();
    match plain.as_str() {
        "" | "ground" => "joint".to_owned(),
        _ => plain,
    }
}

/// A string of TOML.
fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}
