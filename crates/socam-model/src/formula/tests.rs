//! Values and derivatives of formulas, their units, and texts that are none.

use proptest::prelude::*;

use super::*;

fn tape(text: &str) -> Tape {
    Tape::new(&parse(text).unwrap(), &["speed", "load"], &["a", "b", "c"], None).unwrap()
}

fn value(tape: &Tape, inputs: [f64; 2], parameters: [f64; 3]) -> (f64, [f64; 5]) {
    let (mut by_input, mut by_parameter) = ([0.0; 2], [0.0; 3]);
    let value = tape.evaluate((&inputs, &mut by_input), (&parameters, &mut by_parameter));
    let [x, y] = by_input;
    let [a, b, c] = by_parameter;
    (value, [x, y, a, b, c])
}

#[test]
fn derivatives_are_differences() {
    for text in [
        "-a*tanh(speed/b) - c*load",
        "a*exp(-abs(speed/b)^c)*sin(2*pi*load)",
        "sqrt(a^2 + speed^2)/b - (speed*load)^3*c",
        "max(a*speed, b*load) + min(c, atan(speed))*cos(load)",
        "log(a + speed^2)^2 - -b*speed^-2 + 1e-1*2.5E1*c",
        "a*speed/(1 + (speed/b)^2) - speed*(speed*(speed*c))",
    ] {
        let tape = tape(text);
        for (inputs, parameters) in [([0.7, -0.4], [0.3, 0.9, 1.7]), ([-1.3, 0.6], [1.1, 0.2, 0.8])] {
            let (_, derivatives) = value(&tape, inputs, parameters);
            for (index, derivative) in derivatives.into_iter().enumerate() {
                let moved = |step: f64| {
                    let (mut inputs, mut parameters) = (inputs, parameters);
                    *inputs.iter_mut().chain(&mut parameters).nth(index).unwrap() += step;
                    value(&tape, inputs, parameters).0
                };
                let difference = (moved(1e-6) - moved(-1e-6)) / 2e-6;
                assert!(
                    (derivative - difference).abs() < 1e-7 * (1.0 + difference.abs()),
                    "{text}, {index}: {derivative}, {difference}"
                );
            }
        }
    }
}

#[test]
fn a_formula_has_the_value_that_arithmetic_gives() {
    let at = |text: &str| value(&tape(text), [2.0, 3.0], [5.0, 7.0, 11.0]).0;
    assert_eq!(at("-speed^2"), -4.0);
    assert_eq!(at("a - b - c"), -13.0);
    assert_eq!(at("a/b/c"), 5.0 / 7.0 / 11.0);
    assert_eq!(at("2*-speed"), -4.0);
    assert_eq!(at("speed^-1"), 0.5);
    assert_eq!(at("+min(a, b) + max(speed, load)*abs(-1.5e1)"), 50.0);
    // No derivative is infinite where the operation has no influence.
    assert_eq!(value(&tape("a*sqrt(abs(speed))"), [0.0; 2], [0.0; 3]).1, [0.0; 5]);
}

#[test]
fn structure_is_found() {
    let brake = tape("-a*tanh(speed/b) - c*load");
    assert_eq!((brake.amplitudes(3), brake.divisors().collect::<Vec<_>>()), (vec![0, 2], vec![1]));
    assert!((brake.transition(&[0.0; 2], &[0.3, 0.05, 0.1]) - 0.05).abs() < 1e-15);
    assert!(brake.vanishes(|own| own != 1) && !brake.vanishes(|own| own == 0));
    assert_eq!(tape("a*(b + c*speed)").amplitudes(3), [0]);
    assert_eq!(tape("speed^a").amplitudes(3), [] as [usize; 0]);
    assert_eq!(tape("a*speed^2").transition(&[0.0; 2], &[1.0; 3]), 0.0);
    // The width in front of a smooth function of the input does not count.
    assert_eq!(tape("tanh(a + load/b)").transition(&[0.0; 2], &[1.0; 3]), 0.0);
}

/// The unit or the problem of a formula of a bearing.
fn unit(text: &str) -> String {
    let named = |name: &str| {
        powers_of(match name {
            "speed" => "rad/s",
            "a" => "N m",
            "b" => "N m s/rad",
            "w" => "rpm",
            "t" => "K",
            _ => return None,
        })
    };
    let usual = ["1", "N m", "rad/s", "N m s/rad"];
    match check(text, &parse(text).unwrap(), &usual, &named) {
        Ok(unit) => unit_of(unit.powers(), &usual),
        Err(problem) => problem.to_string(),
    }
}

#[test]
fn units_are_propagated() {
    for (text, expected) in [
        ("-a*tanh(speed/w)", "N m"),
        ("b*speed + max(0, -a)", "N m"),
        ("a^2/sqrt(b*a*speed)", "N m"),
        ("speed^0.5*speed^0.5", "rad/s"),
        (
            "speed^(1/2)",
            "character 6: a power whose exponent is no plain number needs a number without unit, and this is in \"rad/s\"; divide it by a parameter in that unit",
        ),
        ("a + speed", "character 3: + joins \"N m\" and \"rad/s\"; both must have one unit"),
        (
            "tanh(speed)",
            "character 1: tanh needs a number without unit, and this is in \"rad/s\"; divide it by a parameter in that unit",
        ),
        (
            "2*speed^b",
            "character 8: the exponent of ^ needs a number without unit, and this is in \"N m s/rad\"; divide it by a parameter in that unit",
        ),
        ("speed^50", "character 6: the exponent 50 is beyond 20, the largest that is read"),
        ("(speed/w)^(a/a)", "1"),
        ("min(a, 1)", "character 1: min joins \"N m\" and \"1\"; both must have one unit"),
        ("t*a", "kg m^2 s^-2 K"),
        ("sped", "character 1: sped is unknown here"),
    ] {
        assert_eq!(unit(text), expected, "{text}");
    }
}

#[test]
fn texts_that_are_no_formula_are_explained() {
    for (text, expected) in [
        ("", "character 1: the formula ends where a number, a name or \"(\" is expected"),
        ("a +", "character 4: the formula ends where a number, a name or \"(\" is expected"),
        ("a b", "character 3: an operator is missing; write one of + - * / ^ here, as in 2*speed"),
        ("2speed", "character 2: an operator is missing; write one of + - * / ^ here, as in 2*speed"),
        ("a**2", "character 3: a power is written with ^, as in speed^2"),
        ("a^b^c", "character 4: a power of a power needs brackets, as in (a^2)^3"),
        ("a)", "character 2: there is no open bracket; remove \")\""),
        (
            "tan(a)",
            "character 1: there is no function tan; functions are abs, sign, sqrt, exp, log, sin, cos, tanh, atan, min, max",
        ),
        ("min(a)", "character 1: min has 2 arguments, not 1"),
        ("sin(a, b)", "character 1: sin has 1 argument, not 2"),
        ("(a b)", "character 4: an operator or the \")\" to the bracket of character 1 is expected here"),
        ("1..2*a", "character 1: \"1..2\" is no number that can be read; write one like 1.5e-3"),
        ("1e999", "character 1: \"1e999\" is no number that can be read; write one like 1.5e-3"),
        (
            "a > 0",
            "character 3: \">\" is no operator here; operators are + - * / ^, and corners are written with min, max and abs",
        ),
        ("ä*a", "character 1: a number, a name or \"(\" is expected, and not \"ä\""),
    ] {
        assert_eq!(parse(text).unwrap_err().to_string(), expected, "{text}");
    }
    let deep = format!("{}a{}", "(".repeat(10_000), ")".repeat(10_000));
    assert!(parse(&deep).unwrap_err().to_string().contains("nested more than 40 deep"));
    assert!(parse(&"-".repeat(10_000)).is_err());
    assert!(parse(&vec!["a"; 5000].join("+")).unwrap_err().to_string().contains("more than 2000"));
}

proptest! {
    #[test]
    fn any_text_ends_in_a_value_or_a_sentence(text in "[-+*/^(),. aespbndtlw0-9]{0,60}|\\PC{0,40}") {
        match parse(&text) {
            Err(problem) => prop_assert!(!problem.problem.is_empty() && problem.character <= text.chars().count() + 1),
            Ok(steps) => {
                let _ = check(&text, &steps, &["1"], &|_| Some([0.5; 5]));
                if let Some(tape) = Tape::new(&steps, &["s", "d"], &["a", "b", "p"], None) {
                    let _ = value(&tape, [0.0, -1e300], [0.0, 1e300, f64::MIN_POSITIVE]);
                    let _ = (tape.amplitudes(3), tape.transition(&[0.0; 2], &[0.0; 3]));
                }
                prop_assert!(Formula::parse(&text).is_ok());
            }
        }
    }
}

/// The value of a formula of a curve.
fn number(formula: &Formula, named: &dyn Fn(&str) -> f64) -> f64 {
    let of = |inner: &Formula| number(inner, named);
    match formula {
        Formula::Number(number) => *number,
        Formula::Name(name) => named(name),
        Formula::Negative(inner) => -of(inner),
        Formula::Binary('+', left, right) => of(left) + of(right),
        Formula::Binary('-', left, right) => of(left) - of(right),
        Formula::Binary(_, left, right) => of(left) * of(right),
        Formula::Call(name, own) if name == "min" => of(&own[0]).min(of(&own[1])),
        Formula::Call(_, own) => of(&own[0]).max(of(&own[1])),
    }
}

#[test]
fn a_curve_is_smooth_passes_its_points_and_equals_its_formula() {
    let (inputs, parameters) = (["speed", "load"], ["a", "b", "c"]);
    let curves = [
        Curve { input: 0, at: vec![-1.0, 0.5, 2.0], values: Values::Parameters(vec![0, 1, 2]) },
        Curve {
            input: 0,
            at: vec![-1.0, -0.2, 0.3, 1.0],
            values: Values::Numbers(vec![0.5, -2.0, 1e-3, 4.0]),
        },
        Curve { input: 0, at: vec![-1.0, 1.0], values: Values::Parameters(vec![2, 0]) },
    ];
    for curve in curves {
        let written = Formula::parse(&curve.formula("speed", &parameters)).unwrap();
        let text = "-curve*load";
        let own = Tape::new(&parse(text).unwrap(), &inputs, &parameters, Some(curve.clone())).unwrap();
        let p = [0.3, -0.8, 1.4];
        for x in [-3.0, -1.0, -0.6, -0.2, 0.1, 0.5, 0.9, 1.0, 1.7, 2.0, 5.0] {
            let (found, derivatives) = value(&own, [x, -1.0], p);
            let at = |p: [f64; 3]| {
                number(&written, &|name| match parameters.iter().position(|own| *own == name) {
                    Some(index) => p[index],
                    None => x,
                })
            };
            assert!((found - at(p)).abs() < 1e-12 * (1.0 + found.abs()), "{x}: {found}, {}", at(p));
            for index in 0..3 {
                let mut moved = p;
                moved[index] += 1.0;
                let difference = at(moved) - at(p);
                assert!(
                    (derivatives[2 + index] - difference).abs() < 1e-9,
                    "{x}: {derivatives:?}, {difference}"
                );
            }
            // Its slope is continuous.
            for side in [-1e-7, 1e-7] {
                let difference = (value(&own, [x + side, -1.0], p).0 - found) / side;
                assert!((derivatives[0] - difference).abs() < 1e-5, "{x}: {}, {difference}", derivatives[0]);
            }
        }
        assert_eq!(own.amplitudes(3).len(), if curve.depends_on(|_| true) { curve.at.len() } else { 0 });
    }
    // A parabola is followed in the middle, and a line everywhere.
    let line = Curve { input: 0, at: vec![0.0, 1.0, 5.0], values: Values::Numbers(vec![1.0, 3.0, 11.0]) };
    for x in [-2.0, 0.3, 3.0, 9.0] {
        let (value, slope) = line.evaluate(x, &[]);
        assert!((value - 1.0 - 2.0 * x).abs() < 1e-12 && (slope - 2.0).abs() < 1e-12);
    }
}
