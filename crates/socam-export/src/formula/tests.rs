//! Compares every law's formula with the law, and checks the notation of formulas.

use socam_model::effects::{CATALOGUE, Effect, REFINED};

use super::{CARET, Formula, PYTHON};

fn value(formula: &Formula, named: &dyn Fn(&str) -> f64) -> f64 {
    let of = |inner: &Formula| value(inner, named);
    match formula {
        Formula::Number(number) => *number,
        Formula::Name(name) if name == "pi" => std::f64::consts::PI,
        Formula::Name(name) => named(name),
        Formula::Negative(inner) => -of(inner),
        Formula::Binary(operator, left, right) => match operator {
            '+' => of(left) + of(right),
            '-' => of(left) - of(right),
            '*' => of(left) * of(right),
            '/' => of(left) / of(right),
            _ => of(left).powf(of(right)),
        },
        Formula::Call(function, arguments) => {
            let first = of(&arguments[0]);
            match function.as_str() {
                "abs" => first.abs(),
                "sign" => first.signum(),
                "sqrt" => first.sqrt(),
                "exp" => first.exp(),
                "sin" => first.sin(),
                "tanh" => first.tanh(),
                "min" => first.min(of(&arguments[1])),
                "max" => first.max(of(&arguments[1])),
                other => panic!("{other} is no function of the notation"),
            }
        }
    }
}

/// Numbers that look random, within 0.1 .. 1.1, or of either sign.
fn draws(count: usize, turn: usize, signed: bool) -> Vec<f64> {
    let draw = |index: usize| {
        let share = ((index * 7919 + turn * 104_729 + 13) as f64 * 0.618_033_988_749).fract();
        let sign = if signed && (index * 31 + turn * 17).is_multiple_of(3) { -1.0 } else { 1.0 };
        sign * (0.1 + share)
    };
    (0..count).map(draw).collect()
}

fn agrees(effect: &Effect) {
    for (index, law) in effect.laws().iter().enumerate() {
        let formula = Formula::parse(law.formula)
            .unwrap_or_else(|problem| panic!("law {index} of {}: {problem}: {}", effect.id, law.formula));
        let borrowed = effect.borrows.map_or(&[][..], |borrowed| borrowed.symbols());
        let names: Vec<&str> =
            effect.parameters.iter().map(|own| own.name).chain(borrowed.iter().copied()).collect();
        let inputs: Vec<&str> = law.law_inputs.iter().map(|input| input.symbol()).collect();
        for turn in 0..40 {
            let (parameters, seen) = (draws(names.len(), turn, false), draws(inputs.len(), turn + 5, true));
            let named = |name: &str| {
                let input = inputs.iter().position(|own| *own == name).map(|at| seen[at]);
                let parameter = || names.iter().position(|own| *own == name).map(|at| parameters[at]);
                input.or_else(parameter).unwrap_or_else(|| panic!("{}: what is {name}?", effect.id))
            };
            let expected = law.evaluate(&seen, &parameters).torque;
            for again in [formula.clone(), Formula::parse(&formula.written(&CARET)).expect("its own text")] {
                let found = value(&again, &named);
                let error = (found - expected).abs();
                assert!(
                    error < 1e-9 * (1.0 + expected.abs()),
                    "{} law {index}: {found}, {expected}",
                    effect.id
                );
            }
        }
    }
}

#[test]
fn every_law_has_a_formula_that_equals_it() {
    CATALOGUE.iter().chain(REFINED).for_each(|effect| agrees(effect));
}

#[test]
fn brackets_stay_where_they_are_needed() {
    for text in ["a - (b - c)", "a/(b*c)", "(a + b)^2", "-(a + b)*c", "min(a, -b)", "(a/b)^2", "a*(-b)"] {
        let formula = Formula::parse(text).unwrap_or_else(|problem| panic!("{text}: {problem}"));
        assert_eq!(formula.written(&CARET), text);
    }
    assert_eq!(Formula::parse("2 * x ^ 3").unwrap().written(&PYTHON), "2*x**3");
    for wrong in ["", "a +", "(a", "a b", "f(", "1..2", "a, b"] {
        assert!(Formula::parse(wrong).is_err(), "{wrong}");
    }
}
