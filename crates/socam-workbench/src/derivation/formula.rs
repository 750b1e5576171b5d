//! Channels that a formula computes: the language of laws and rules, over the channels of a recording.

use socam_model::formula::{Formula, Tape};
use socam_units::Product;

use crate::signal::Signal;

/// The name by which a formula calls a channel: letters, digits and underscores stay, all else is an underscore, so that
/// `motor_speed.integral` may be written with its dot or without.
#[must_use]
pub fn called(name: &str) -> String {
    name.chars().map(|letter| if letter.is_ascii_alphanumeric() { letter } else { '_' }).collect()
}

/// The names of the channels of a formula, each once, as [`called`] has them.
///
/// # Errors
/// When the text is no formula, or names no channel; one sentence.
pub(crate) fn names(text: &str) -> Result<Vec<String>, String> {
    let names: Vec<String> = parsed(text)?.all_names().into_iter().filter(|name| name != "pi").collect();
    if names.is_empty() { Err("the formula names no channel; click one above".into()) } else { Ok(names) }
}

/// The unit of a formula over channels.
///
/// # Errors
/// When the text is no formula, names what is no channel, or joins units that do not go together; one sentence.
pub(crate) fn unit(text: &str, sources: &[Signal]) -> Result<String, String> {
    bound(text, sources).map(|(_, unit)| unit)
}

/// A formula that takes the values of its [`names`], in that order.
///
/// # Errors
/// Those of [`unit()`].
pub(crate) fn tape(text: &str, sources: &[Signal]) -> Result<Tape, String> {
    bound(text, sources).map(|(tape, _)| tape)
}

fn bound(text: &str, sources: &[Signal]) -> Result<(Tape, String), String> {
    let mut inputs = Vec::new();
    for name in names(text)? {
        let Some(signal) = sources.iter().find(|signal| called(&signal.name) == name) else {
            return Err(format!("no channel that is shown is called {name}; the channels are listed above"));
        };
        inputs.push((name, signal.unit.as_str()));
    }
    let named = |name: &str| {
        let unit = inputs.iter().find(|(known, _)| known == name).map_or("1", |(_, unit)| unit);
        Product::of_symbol(unit).ok_or_else(|| format!("the unit {unit} of {name} is unknown"))
    };
    for (name, _) in &inputs {
        named(name)?;
    }
    // Angles have no dimension in the check of units: whether a result is in rad/s or 1/s is found apart from it.
    let found = of(&parsed(text)?, &named);
    let written = found.as_ref().map_or_else(|_| "1".into(), ToString::to_string);
    let checked: Vec<(String, &str)> =
        inputs.iter().map(|(name, unit)| (name.clone(), of_model_files(unit))).collect();
    let tape = Tape::over(&plain(text), &checked, of_model_files(&written));
    let unit = found?.to_string();
    tape.map(|tape| (tape, unit)).map_err(|problem| problem.to_string())
}

/// A unit with the names that formulas know: these have no watt and no joule.
fn of_model_files(unit: &str) -> &str {
    match unit {
        "W" => "N m/s",
        "J" => "N m",
        other => other,
    }
}

fn parsed(text: &str) -> Result<Formula, String> {
    if text.trim().is_empty() {
        return Err("write a formula, such as torque_out*output_speed".into());
    }
    Formula::parse(&plain(text)).map_err(|problem| match ["derivative(", "integral("].iter().find(|own| text.contains(**own)) {
        Some(own) => format!(
            "{own}) is no function of formulas: derive it as a channel of its own by that operation, and name that channel here"
        ),
        None => problem.to_string(),
    })
}

/// The text with underscores for the dots inside of names: every character keeps its place.
fn plain(text: &str) -> String {
    let mut in_name = None;
    let plain = |letter: char| {
        let goes_on = letter.is_ascii_alphanumeric() || letter == '_' || letter == '.';
        in_name = goes_on.then(|| in_name.unwrap_or_else(|| letter.is_ascii_alphabetic() || letter == '_'));
        if in_name == Some(true) && letter == '.' { '_' } else { letter }
    };
    text.chars().map(plain).collect()
}

/// The unit of a formula whose dimensions fit.
fn of(formula: &Formula, named: &dyn Fn(&str) -> Result<Product, String>) -> Result<Product, String> {
    let both = |left: &Formula, right: &Formula| Ok::<_, String>((of(left, named)?, of(right, named)?));
    // A number beside an angle is an angle.
    let joined = |(left, right)| if left == Product::ONE { right } else { left };
    match formula {
        Formula::Number(_) => Ok(Product::ONE),
        Formula::Name(name) if name == "pi" => Ok(Product::ONE),
        Formula::Name(name) => named(name),
        Formula::Negative(inner) => of(inner, named),
        Formula::Binary('*', left, right) => both(left, right).map(|(left, right)| left * right),
        Formula::Binary('/', left, right) => both(left, right).map(|(left, right)| left / right),
        Formula::Binary('^', base, exponent) => power(of(base, named)?, exponent),
        Formula::Binary(_, left, right) => both(left, right).map(joined),
        Formula::Call(function, arguments) => {
            let units = arguments.iter().map(|own| of(own, named)).collect::<Result<Vec<_>, _>>()?;
            match (function.as_str(), &units[..]) {
                ("abs", [own]) => Ok(*own),
                ("sqrt", [own]) => root(*own),
                ("min" | "max", [left, right]) => Ok(joined((*left, *right))),
                _ => Ok(Product::ONE),
            }
        }
    }
}

/// The unit of a power: that of half a power by a root.
fn power(base: Product, exponent: &Formula) -> Result<Product, String> {
    let (sign, number) = match exponent {
        Formula::Number(number) => (1.0, *number),
        Formula::Negative(inner) => match **inner {
            Formula::Number(number) => (-1.0, number),
            _ => return Ok(Product::ONE),
        },
        _ => return Ok(Product::ONE),
    };
    if base == Product::ONE {
        return Ok(base);
    }
    let is_whole = number.fract() == 0.0;
    let times = if is_whole { number } else { 2.0 * number };
    if times.fract() != 0.0 || times > 40.0 {
        return Err(format!(
            "a unit to the power of {number} has no whole exponents; use a power like 2 or 0.5"
        ));
    }
    let base = if is_whole { base } else { root(base)? };
    let whole = (0..times as u32).fold(Product::ONE, |product, _| product * base);
    Ok(if sign < 0.0 { Product::ONE / whole } else { whole })
}

/// The unit whose square is this one.
fn root(unit: Product) -> Result<Product, String> {
    let written = match unit.to_string().as_str() {
        "1" => return Ok(unit),
        other => other.to_owned(),
    };
    let half = |factors: &str| -> Option<String> {
        let each = factors.trim_matches(['(', ')']).split_whitespace().map(|factor| {
            let base = factor.trim_end_matches(|letter: char| letter.is_ascii_digit());
            let power: u8 = if base.is_empty() {
                return Some("1".to_owned());
            } else {
                factor[base.len()..].parse().ok()?
            };
            power.is_multiple_of(2).then(|| format!("{base}{}", power / 2))
        });
        each.collect::<Option<Vec<_>>>().map(|each| each.join(" "))
    };
    let (above, below) = written.split_once('/').unwrap_or((&written, ""));
    let found = half(above).zip(half(below)).and_then(|(above, below)| {
        Product::of_symbol(&if below.is_empty() { above } else { format!("{above}/({below})") })
    });
    found.ok_or_else(|| {
        format!("the square root of {written} has no unit; take that of a square, such as sqrt(a^2 + b^2)")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn channels() -> Vec<Signal> {
        let of = |(name, unit): (&str, &str)| Signal { name: name.into(), unit: unit.into() };
        [
            ("torque_in", "N m"),
            ("torque_out", "N m"),
            ("motor_speed", "rad/s"),
            ("output_speed", "rad/s"),
            ("motor_speed.integral", "rad"),
            ("output angle", "rad"),
        ]
        .map(of)
        .into()
    }

    #[test]
    fn a_formula_has_the_unit_that_its_channels_give_it() {
        for (text, expected) in [
            ("torque_out * output_speed / (torque_in * motor_speed)", "1"),
            ("torque_in*motor_speed", "W"),
            ("motor_speed - 10*output_speed", "rad/s"),
            ("motor_speed.integral - 10*output_angle", "rad"),
            ("0.5 + motor_speed.integral", "rad"),
            ("sqrt(torque_in^2 + torque_out^2)", "N m"),
            ("(torque_in*torque_out)^0.5", "N m"),
            ("sqrt(motor_speed^4)", "rad2/s2"),
            ("torque_in^-1", "1/(N m)"),
            ("torque_in/sin(output_angle)", "N m"),
            ("abs(torque_in)/max(motor_speed, 0)", "N m s/rad"),
            ("2*pi*sign(torque_in)", "1"),
        ] {
            assert_eq!(unit(text, &channels()).as_deref(), Ok(expected), "{text}");
        }
    }

    #[test]
    fn what_is_wrong_is_one_sentence_with_its_place() {
        for (text, words) in [
            ("", "write a formula"),
            ("2*3", "names no channel"),
            ("torque_in + motor_speed", "character 11: + joins \"N m\" and \"rad/s\""),
            ("motor_speed.integral*torque_in + motor_speed", "character 32: +"),
            ("torque_in*(motor_speed", "the bracket of character 11 is open"),
            ("torque_inn", "no channel that is shown is called torque_inn"),
            ("sin(torque_in)", "sin needs a number without unit"),
            ("sqrt(torque_in)", "the square root of N m has no unit"),
            ("torque_in^0.3", "no whole exponents"),
            ("derivative(torque_in)", "derive it as a channel of its own"),
        ] {
            let sentence = unit(text, &channels()).unwrap_err();
            assert!(sentence.contains(words) && !sentence.contains('\n'), "{text}: {sentence}");
        }
    }
}
