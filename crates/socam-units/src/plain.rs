//! Plain names.

/// A name of small letters, digits and underscores.
///
/// ```
/// assert_eq!(socam_units::plain_name("Motor Speed"), "motor_speed");
/// ```
#[must_use]
pub fn plain_name(name: &str) -> String {
    let mut plain = String::new();
    for c in name.chars() {
        match c {
            'a'..='z' | '0'..='9' => plain.push(c),
            'A'..='Z' => plain.push(c.to_ascii_lowercase()),
            '\u{e4}' | '\u{c4}' => plain.push_str("ae"),
            '\u{f6}' | '\u{d6}' => plain.push_str("oe"),
            '\u{fc}' | '\u{dc}' => plain.push_str("ue"),
            '\u{df}' => plain.push_str("ss"),
            _ if !plain.ends_with('_') => plain.push('_'),
            _ => {}
        }
    }
    let plain = plain.trim_matches('_');
    if plain.is_empty() { "signal".into() } else { plain.to_owned() }
}
