//! Formulas: parsed from the neutral notation of [`socam_model::effects::Law::formula`], and written in the notation of a language.

/// A formula.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Formula {
    Number(f64),
    Name(String),
    Negative(Box<Self>),
    Binary(char, Box<Self>, Box<Self>),
    Call(String, Vec<Self>),
}

/// Notation of formulas in a language.
pub(crate) struct Dialect {
    /// Operator of powers.
    pub(crate) power: &'static str,
    /// The number pi.
    pub(crate) pi: &'static str,
}

/// Powers as `^`, pi as `pi`.
pub(crate) const CARET: Dialect = Dialect { power: "^", pi: "pi" };
/// Python with the names of `math`.
pub(crate) const PYTHON: Dialect = Dialect { power: "**", pi: "pi" };
/// Modelica.
pub(crate) const MODELICA: Dialect = Dialect { power: "^", pi: "Modelica.Constants.pi" };

/// Precedence of a sum, a product, a power and an atom.
const SUM: u8 = 1;
const PRODUCT: u8 = 2;
const POWER: u8 = 3;
const ATOM: u8 = 4;

impl Formula {
    /// `None` where the text is no formula.
    pub(crate) fn parse(text: &str) -> Option<Self> {
        let mut parser = Parser { rest: text };
        let formula = parser.sum()?;
        parser.skip_blanks();
        parser.rest.is_empty().then_some(formula)
    }

    /// The formula with names replaced, where `by` gives a formula for a name.
    pub(crate) fn replaced(&self, by: &dyn Fn(&str) -> Option<Self>) -> Self {
        let again = |inner: &Self| Box::new(inner.replaced(by));
        match self {
            Self::Number(_) => self.clone(),
            Self::Name(name) => by(name).unwrap_or_else(|| self.clone()),
            Self::Negative(inner) => Self::Negative(again(inner)),
            Self::Binary(operator, left, right) => Self::Binary(*operator, again(left), again(right)),
            Self::Call(function, arguments) => {
                Self::Call(function.clone(), arguments.iter().map(|own| own.replaced(by)).collect())
            }
        }
    }

    /// Whether a name occurs for which `is_one` holds.
    pub(crate) fn names(&self, is_one: &dyn Fn(&str) -> bool) -> bool {
        match self {
            Self::Number(_) => false,
            Self::Name(name) => is_one(name),
            Self::Negative(inner) => inner.names(is_one),
            Self::Binary(_, left, right) => left.names(is_one) || right.names(is_one),
            Self::Call(_, arguments) => arguments.iter().any(|own| own.names(is_one)),
        }
    }

    /// The formula in a language.
    pub(crate) fn written(&self, dialect: &Dialect) -> String {
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

struct Parser<'t> {
    rest: &'t str,
}

impl Parser<'_> {
    fn skip_blanks(&mut self) {
        self.rest = self.rest.trim_start();
    }

    fn take(&mut self, among: &[char]) -> Option<char> {
        self.skip_blanks();
        let first = self.rest.chars().next().filter(|first| among.contains(first))?;
        self.rest = &self.rest[first.len_utf8()..];
        Some(first)
    }

    fn sum(&mut self) -> Option<Formula> {
        let minus = self.take(&['-']).is_some();
        let first = self.product()?;
        let mut sum = if minus { Formula::Negative(Box::new(first)) } else { first };
        while let Some(operator) = self.take(&['+', '-']) {
            sum = Formula::Binary(operator, Box::new(sum), Box::new(self.product()?));
        }
        Some(sum)
    }

    fn product(&mut self) -> Option<Formula> {
        let mut product = self.power()?;
        while let Some(operator) = self.take(&['*', '/']) {
            product = Formula::Binary(operator, Box::new(product), Box::new(self.power()?));
        }
        Some(product)
    }

    fn power(&mut self) -> Option<Formula> {
        let base = self.atom()?;
        if self.take(&['^']).is_none() {
            return Some(base);
        }
        Some(Formula::Binary('^', Box::new(base), Box::new(self.atom()?)))
    }

    fn atom(&mut self) -> Option<Formula> {
        if self.take(&['(']).is_some() {
            let inner = self.sum()?;
            self.take(&[')'])?;
            return Some(inner);
        }
        self.skip_blanks();
        let is_digit = |c: char| c.is_ascii_digit() || c == '.';
        if self.rest.starts_with(is_digit) {
            return self.number();
        }
        let end = self.rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '_');
        let (name, rest) = self.rest.split_at(end.unwrap_or(self.rest.len()));
        if name.is_empty() {
            return None;
        }
        self.rest = rest;
        if self.take(&['(']).is_none() {
            return Some(Formula::Name(name.to_owned()));
        }
        let mut arguments = vec![self.sum()?];
        while self.take(&[',']).is_some() {
            arguments.push(self.sum()?);
        }
        self.take(&[')'])?;
        Some(Formula::Call(name.to_owned(), arguments))
    }

    fn number(&mut self) -> Option<Formula> {
        let mut end = 0;
        let mut before = ' ';
        for (index, c) in self.rest.char_indices() {
            let of_exponent = matches!(c, '+' | '-') && before == 'e';
            if !(c.is_ascii_digit() || matches!(c, '.' | 'e') || of_exponent) {
                break;
            }
            (before, end) = (c, index + 1);
        }
        let (number, rest) = self.rest.split_at(end);
        self.rest = rest;
        number.parse().ok().map(Formula::Number)
    }
}

#[cfg(test)]
mod tests;
