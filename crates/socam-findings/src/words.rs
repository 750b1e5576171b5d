//! Names of effects and places in sentences, and the digits of numbers.

use socam_model::effects;
pub use socam_plot::words::{
    chance, estimate, interval, level, minus, number, percent, quantity, rough, unit,
};

use crate::document::UNEXPLAINED;

/// Name of an effect within a sentence; for an id that the catalogue lacks, the id with spaces.
///
/// ```
/// use socam_findings::words::{capital, effect};
///
/// assert_eq!((effect("mesh_loss").as_str(), effect("of_a_later_version").as_str()), ("mesh loss", "of a later version"));
/// assert_eq!(capital(&effect("mesh_loss")), "Mesh loss");
/// ```
#[must_use]
pub fn effect(id: &str) -> String {
    match effects::find(id) {
        _ if id == UNEXPLAINED => "unexplained misfit".to_owned(),
        Some(effect) => effect.name.to_owned(),
        None => id.replace('_', " "),
    }
}

/// Name of an effect's parameter within a sentence, by its unit: along a line, the catalogue's torque is a force.
///
/// ```
/// use socam_findings::words::parameter;
///
/// assert_eq!(parameter("static_torque", "N m"), "static torque");
/// assert_eq!(parameter("static_torque", "N"), "static force");
/// ```
#[must_use]
pub fn parameter(name: &str, unit: &str) -> String {
    let name = name.replace('_', " ");
    if unit == "N" { name.replace("torque", "force") } else { name }
}

/// The words with a capital first letter.
#[must_use]
pub fn capital(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// A list in words, with `last` before the last item: "a, b and c".
#[must_use]
pub fn list(items: &[String], last: &str) -> String {
    match items {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., end] => format!("{} {last} {end}", first.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_lists() {
        assert_eq!(capital(&effect("coulomb_friction")), "Coulomb friction");
        assert_eq!(capital(""), "");
        assert_eq!(capital("µ effect"), "Μ effect");
        assert_eq!(list(&["a".into(), "b".into(), "c".into()], "or"), "a, b or c");
    }
}
