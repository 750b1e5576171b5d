//! The units of a formula: each operation checks the dimensions of its operands.

use super::{FUNCTIONS, FormulaProblem, Step, What};

/// Exponents of kg, m, s, A and K. Roots make halves of them.
pub(crate) type Powers = [f64; 5];

/// Largest magnitude of an exponent that is a number.
const LARGEST_EXPONENT: f64 = 20.0;
/// Difference of exponents that is rounding: thirds are not exact.
const ROUNDING: f64 = 1e-9;
const NONE: Powers = [0.0; 5];

/// The unit of a value while it is checked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Unit {
    /// The number 0, which has every unit.
    Any,
    Of(Powers),
}

impl Unit {
    pub(crate) fn powers(self) -> Powers {
        match self {
            Self::Any => NONE,
            Self::Of(powers) => powers,
        }
    }

    pub(crate) fn is(self, powers: Powers) -> bool {
        self == Self::Any || are_equal(self.powers(), powers)
    }
}

fn are_equal(a: Powers, b: Powers) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() < ROUNDING)
}

/// The exponents of a unit in words; `None` for an unknown one.
pub(crate) fn powers_of(unit: &str) -> Option<Powers> {
    Some(socam_units::parse(unit)?.dimension.map(f64::from))
}

/// A unit in words with these exponents: the first of the `usual` ones that has them, or a product of kg, m, s, A and K.
pub(crate) fn unit_of(powers: Powers, usual: &[&'static str]) -> String {
    let mut known = usual.iter().filter(|unit| powers_of(unit).is_some_and(|own| are_equal(own, powers)));
    if let Some(unit) = known.next() {
        return (*unit).to_owned();
    }
    let each = ["kg", "m", "s", "A", "K"].iter().zip(powers).filter(|(_, power)| power.abs() > ROUNDING);
    let each =
        each.map(|(name, power)| if power == 1.0 { (*name).to_owned() } else { format!("{name}^{power}") });
    each.collect::<Vec<_>>().join(" ")
}

/// The unit of a formula, where `named` gives the unit of each of its names.
///
/// # Errors
/// [`FormulaProblem`] at the operation whose operands do not fit, and at a name without a unit.
pub(crate) fn check(
    text: &str,
    steps: &[Step],
    usual: &[&'static str],
    named: &dyn Fn(&str) -> Option<Powers>,
) -> Result<Unit, FormulaProblem> {
    let written = |unit: Unit| unit_of(unit.powers(), usual);
    let mut stack: Vec<(Unit, Option<f64>)> = Vec::new();
    for step in steps {
        let fail = |problem: String| Err(FormulaProblem::at(text, step.at, problem));
        let mut pop = || stack.pop().unwrap_or((Unit::Any, None));
        let pure = |unit: Unit, what: &str| {
            if unit.is(NONE) {
                return Ok(());
            }
            fail(format!(
                "{what} needs a number without unit, and this is in \"{}\"; divide it by a parameter in that unit",
                written(unit)
            ))
        };
        let same = |left: Unit, right: Unit, what: &str| match (left, right) {
            (Unit::Any, other) | (other, Unit::Any) => Ok(other),
            (Unit::Of(a), Unit::Of(b)) if are_equal(a, b) => Ok(left),
            _ => fail(format!(
                "{what} joins \"{}\" and \"{}\"; both must have one unit",
                written(left),
                written(right)
            ))
            .map(|()| left),
        };
        let found = match &step.what {
            What::Number(0.0) => (Unit::Any, Some(0.0)),
            What::Number(number) => (Unit::Of(NONE), Some(*number)),
            What::Name(name) if name == "pi" => (Unit::Of(NONE), None),
            What::Name(name) => match named(name) {
                Some(powers) => (Unit::Of(powers), None),
                None => return fail(format!("{name} is unknown here")).map(|()| Unit::Any),
            },
            What::Negative => {
                let (unit, number) = pop();
                (unit, number.map(|number| -number))
            }
            What::Binary(operator) => {
                let (right, left) = (pop(), pop());
                let unit = match operator {
                    '+' | '-' => same(left.0, right.0, &operator.to_string())?,
                    '*' | '/' => {
                        let sign = if *operator == '*' { 1.0 } else { -1.0 };
                        let (a, b) = (left.0.powers(), right.0.powers());
                        let product = std::array::from_fn(|index| a[index] + sign * b[index]);
                        if left.0 == Unit::Any { Unit::Any } else { Unit::Of(product) }
                    }
                    _ => power(left.0, right, &pure, &fail)?,
                };
                (unit, None)
            }
            What::Call(function) => {
                let (name, count) = FUNCTIONS[*function];
                let (unit, _) = pop();
                let unit = match name {
                    _ if count == 2 => same(pop().0, unit, name)?,
                    "abs" => unit,
                    "sign" => Unit::Of(NONE),
                    "sqrt" => Unit::Of(unit.powers().map(|power| 0.5 * power)),
                    _ => {
                        pure(unit, name)?;
                        Unit::Of(NONE)
                    }
                };
                (unit, None)
            }
        };
        stack.push(found);
    }
    Ok(stack.pop().map_or(Unit::Any, |(unit, _)| unit))
}

/// The unit of a power.
fn power(
    base: Unit,
    (exponent, number): (Unit, Option<f64>),
    pure: &dyn Fn(Unit, &str) -> Result<(), FormulaProblem>,
    fail: &dyn Fn(String) -> Result<(), FormulaProblem>,
) -> Result<Unit, FormulaProblem> {
    pure(exponent, "the exponent of ^")?;
    match number {
        Some(number) if number.abs() > LARGEST_EXPONENT => {
            fail(format!("the exponent {number} is beyond {LARGEST_EXPONENT}, the largest that is read"))?;
        }
        Some(number) => return Ok(Unit::Of(base.powers().map(|power| number * power))),
        None => pure(base, "a power whose exponent is no plain number")?,
    }
    Ok(Unit::Of(NONE))
}
