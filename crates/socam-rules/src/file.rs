//! The file of rules.

use std::path::Path;

use socam_model::formula::Formula;
use socam_recording::{Fields, SettingsError, read_settings};

use crate::error::RulesError;

/// Schema of the file.
pub const SCHEMA: &str = "socam.rules/1";

/// A rule: a formula over the channels of a recording that must stay below or above a value, except for a duration.
#[derive(Debug, Clone, PartialEq)]
pub struct Rule {
    /// Its name, the key of its table.
    pub name: String,
    /// The formula. A channel is named as in the recording, with `_` for what is no letter or digit.
    pub formula: String,
    /// Unit of the limits.
    pub unit: String,
    /// Value that the formula must stay below, in `unit`.
    pub below: Option<f64>,
    /// Value that the formula must stay above, in `unit`.
    pub above: Option<f64>,
    /// Time for which it may be otherwise without breaking the rule, s.
    pub for_s: f64,
    /// Line of the formula in the file.
    pub(crate) line: usize,
}

/// The rules of a file.
///
/// ```
/// use socam_rules::Rules;
///
/// let rules = Rules::parse("[rules.overload]\nformula = \"abs(motor_torque)\"\nunit = \"N m\"\nbelow = 20\nfor_s = 0.5")?;
/// assert_eq!((rules.all[0].name.as_str(), rules.all[0].below), ("overload", Some(20.0)));
/// let problem = Rules::parse("[rules.overload]\nformula = \"abs(motor_torque\"\nunit = \"N m\"\nbelow = 20").unwrap_err();
/// assert!(problem.to_string().starts_with("line 2: the formula of overload, character "));
/// # Ok::<(), socam_rules::RulesError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Rules {
    /// All rules, in the order of the file; at least one.
    pub all: Vec<Rule>,
}

impl Rules {
    /// Reads a file of rules.
    ///
    /// # Errors
    /// [`RulesError::File`], with the file and the line.
    pub fn open(path: &Path) -> Result<Self, RulesError> {
        let text = read_settings(path)?;
        Self::parse(&text).map_err(|error| match error {
            RulesError::File(problem) => problem.in_file(path).into(),
            other => other,
        })
    }

    /// Reads the text of a file of rules.
    ///
    /// # Errors
    /// [`RulesError::File`], with the line.
    pub fn parse(text: &str) -> Result<Self, RulesError> {
        let mut fields = Fields::parse(text)?;
        fields.schema(SCHEMA);
        let all = fields.named_tables("rules", rule);
        fields.finish()?;
        if all.is_empty() {
            let message =
                "there is no rule; expected a table [rules.NAME] with formula, unit, and below or above";
            return Err(SettingsError::new(message).into());
        }
        Ok(Self { all })
    }
}

fn rule(name: &str, fields: &mut Fields<'_>) -> Rule {
    let any = f64::MIN..=f64::MAX;
    let rule = Rule {
        name: name.to_owned(),
        formula: fields.text("formula"),
        unit: fields.text("unit"),
        below: fields.maybe_number("below", any.clone()),
        above: fields.maybe_number("above", any),
        for_s: fields.maybe_number("for_s", 0.0..=f64::MAX).unwrap_or(0.0),
        line: fields.line("formula"),
    };
    if rule.below.is_none() && rule.above.is_none() {
        fields.complain(format!("the rule {name} has no limit; write below, above or both"));
    }
    if rule.below.zip(rule.above).is_some_and(|(below, above)| above >= below) {
        fields
            .complain_about("above", format!("the rule {name} cannot be kept: above is not less than below"));
    }
    if !rule.formula.is_empty()
        && let Err(problem) = Formula::parse(&rule.formula)
    {
        fields.complain_about("formula", format!("the formula of {name}, {problem}"));
    }
    if !rule.unit.is_empty() && socam_units::parse(&rule.unit).is_none() {
        let message = format!("the unit of {name} is \"{}\"; expected one such as N m, rpm, A, 1", rule.unit);
        fields.complain_about("unit", message);
    }
    rule
}
