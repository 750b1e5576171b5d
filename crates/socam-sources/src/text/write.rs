//! A description as text, with what is not known.

use std::fmt::Write as _;

use socam_units::plain_name;

use super::form::{Form, separator_name};
use super::signal::{Role, Signal};
use crate::description::SCHEMA;

/// Number of ticks after which clocks of microcontrollers usually begin anew.
const WRAP: u64 = 1 << 32;

pub(super) fn description(form: &Form, signals: &[Signal]) -> String {
    let mut text = format!(
        "# What this device sends. Replace every \"?\"; delete channels that are not wanted.\nschema = {}\n\n[lines]\n",
        quoted(SCHEMA)
    );
    lines(&mut text, form);
    for signal in signals {
        match &signal.role {
            Role::Clock { unit, is_measured, is_whole } => {
                let why = match (unit, is_measured) {
                    (Some(_), true) => "   # it runs as fast as this computer's clock in this unit",
                    (None, _) => "   # not stated: s, ms, us or ns",
                    _ => "",
                };
                let unit = unit.unwrap_or("?");
                let _ =
                    write!(text, "\n[clock]\nsignal = {}\nunit = \"{unit}\"{why}\n", quoted(&signal.name));
                if *is_whole && matches!(unit, "ms" | "us") {
                    let _ = writeln!(
                        text,
                        "wrap = {WRAP}   # a counter of 32 bits; delete it if the counter is longer"
                    );
                }
            }
            Role::Number => {
                let _ = write!(
                    text,
                    "\n# It numbers the rows, so that lost ones are counted. If it begins anew: wrap = 256, for 0 to 255.\n[number]\nsignal = {}\n",
                    quoted(&signal.name)
                );
            }
            Role::Channel { .. } | Role::Aside => {}
        }
    }
    let mut names: Vec<String> = Vec::new();
    for signal in signals {
        if let Role::Channel { unit, guess } = &signal.role {
            let name = channel_name(signal, &names);
            let _ = write!(text, "\n[channels.{}]\nsignal = {}\n", quoted(&name), quoted(&signal.name));
            names.push(name);
            channel(&mut text, unit.as_deref(), *guess, signal);
        }
    }
    text
}

fn lines(text: &mut String, form: &Form) {
    match form {
        Form::Csv { separator, decimal_comma, names } => {
            let names: Vec<String> = names.iter().map(|name| quoted(name)).collect();
            let _ = write!(
                text,
                "form = \"csv\"\nseparator = \"{}\"\ndecimal = \"{}\"\nnames = [{}]\n",
                separator_name(*separator),
                if *decimal_comma { "," } else { "." },
                names.join(", ")
            );
        }
        Form::Pairs => text.push_str("form = \"pairs\"\n"),
        Form::Json => text.push_str("form = \"json\"\n"),
        Form::Topics => text.push_str("form = \"foxglove\"\n"),
        // Nothing is guessed of bytes, so that none is written.
        Form::Frames(_) => {}
    }
}

/// A name of letters, digits, underscores and hyphens that none has yet.
fn channel_name(signal: &Signal, taken: &[String]) -> String {
    let plain = plain_name(&signal.column.name);
    let plain = if plain.is_empty() { "signal".to_owned() } else { plain };
    let numbered = (2..).map(|number| format!("{plain}_{number}"));
    std::iter::once(plain.clone()).chain(numbered).find(|name| !taken.contains(name)).unwrap_or_default()
}

fn channel(text: &mut String, unit: Option<&str>, guess: Option<&str>, signal: &Signal) {
    match unit {
        Some(unit) if socam_units::is_counts(unit) => {
            text.push_str("unit = \"counts\"\ncounts_per_turn = \"?\"   # or counts_per_m\n");
        }
        Some(unit) => {
            let _ = writeln!(text, "unit = {}", quoted(unit));
        }
        None => {
            let perhaps = guess.map_or(String::new(), |guess| format!(", perhaps \"{guess}\""));
            let _ = writeln!(text, "unit = \"?\"   # not stated by the device{perhaps}");
        }
    }
    let low = signal.values.iter().map(|(value, _)| *value).fold(f64::INFINITY, f64::min);
    let high = signal.values.iter().map(|(value, _)| *value).fold(f64::NEG_INFINITY, f64::max);
    let _ = writeln!(text, "# it was from {low} to {high}");
}

/// A string of TOML.
fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}
