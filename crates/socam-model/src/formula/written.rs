//! Formulas in the notation of a language.

use super::Formula;

/// Notation of formulas in a language.
pub struct Dialect {
    /// Operator of powers.
    pub power: &'static str,
    /// The number pi.
    pub pi: &'static str,
}

/// Precedence of a sum, a product, a power and an atom.
const SUM: u8 = 1;
const PRODUCT: u8 = 2;
const POWER: u8 = 3;
const ATOM: u8 = 4;

impl Formula {
    /// The formula in a language.
    pub fn written(&self, dialect: &Dialect) -> String {
        let binary = |operator: char, left: &Self, right: &Self| {
            let (written, own, least_right) = match operator {
                '+' => (" + ", SUM, SUM),
                '-' => (" - ", SUM, PRODUCT),
                '*' => ("*", PRODUCT, PRODUCT),
                '/' => ("/", PRODUCT, POWER),
                _ => (dialect.power, POWER, ATOM),
            };
            let least_left = if own == POWER { ATOM } else { own };
            let [left, right] = [(left, least_left), (right, least_right)].map(|(side, least)| {
                let text = side.written(dialect);
                if side.precedence() < least { format!("({text})") } else { text }
            });
            format!("{left}{written}{right}")
        };
        match self {
            Self::Number(number) if number.fract() == 0.0 && number.abs() < 1e9 => format!("{number}"),
            Self::Number(number) => format!("{number:?}"),
            Self::Name(name) if name == "pi" => dialect.pi.to_owned(),
            Self::Name(name) => name.clone(),
            Self::Negative(inner) if inner.precedence() < PRODUCT => format!("-({})", inner.written(dialect)),
            Self::Negative(inner) => format!("-{}", inner.written(dialect)),
            Self::Binary(operator, left, right) => binary(*operator, left, right),
            Self::Call(function, arguments) => {
                let each: Vec<String> = arguments.iter().map(|own| own.written(dialect)).collect();
                format!("{function}({})", each.join(", "))
            }
        }
    }

    fn precedence(&self) -> u8 {
        match self {
            Self::Number(number) if *number < 0.0 => SUM,
            Self::Number(_) | Self::Name(_) | Self::Call(..) => ATOM,
            Self::Negative(_) | Self::Binary('+' | '-', ..) => SUM,
            Self::Binary('*' | '/', ..) => PRODUCT,
            Self::Binary(..) => POWER,
        }
    }
}
