//! Header comment of every exported file: its origin, its parameters with their intervals, and the parts of the model that it
//! leaves out.

use crate::{LeftOut, Provenance, Target, description::Description, names::line};

/// The lines of a file's header, without the marks of comments.
pub(crate) fn lines(d: &Description<'_>, target: Target, left_out: &[LeftOut]) -> Vec<String> {
    let mut lines = vec![d.model.name.clone()];
    if !d.model.description.is_empty() {
        lines.push(d.model.description.clone());
    }
    let Provenance { file, sha256, version } = d.provenance;
    lines.push(format!("Exported to {} by socam {version} from {file} (sha-256 {sha256}).", target.name()));
    let (angle, torque, inertia) = if d.is_rotation() { ("rad", "N m", "kg m2") } else { ("m", "N", "kg") };
    lines.push(format!("All values are SI: {angle}, {torque}, {inertia}, s."));
    lines.push(String::new());
    lines.push("Parameters (95 % intervals from the model file):".into());
    lines.extend((0..d.parameters.len()).map(|index| format!("  {}", parameter(d, index))));
    lines.push(String::new());
    if left_out.is_empty() {
        lines.push("This file holds the whole model.".into());
    } else {
        lines.push("Not held by this file, or only in part:".into());
        lines.extend(left_out.iter().map(|own| format!("  {own}")));
    }
    lines.iter().map(|text| line(text).trim_end().to_owned()).collect()
}

/// A parameter in one line: value, unit, interval, source.
pub(crate) fn parameter(d: &Description<'_>, index: usize) -> String {
    let own = &d.parameters[index];
    let mut text = format!("{} = {:?} {}", own.name, own.value, own.unit);
    if let Some([low, high]) = own.ci95 {
        text.push_str(&format!(", 95 % interval {low:?} to {high:?}"));
    }
    if own.fixed {
        text.push_str(", fixed");
    }
    if !own.source.is_empty() {
        text.push_str(&format!(" ({})", own.source));
    }
    line(&text)
}

/// The header as comments that begin with `mark`.
pub(crate) fn commented(lines: &[String], mark: &str) -> String {
    lines.iter().map(|line| format!("{mark} {line}").trim_end().to_owned() + "\n").collect()
}
