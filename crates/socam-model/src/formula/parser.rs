//! The grammar of formulas: a text becomes steps in postfix order.

use super::{FUNCTIONS, FormulaProblem, Step, What};

/// Deepest nesting of brackets, powers and signs; it bounds the recursion of this parser and of every walk over a tree.
const DEEPEST: usize = 40;
/// Most steps. Sums of many terms nest a tree as deep as they are long.
const MOST_STEPS: usize = 2000;

/// Parses a text.
pub(crate) fn parse(text: &str) -> Result<Vec<Step>, FormulaProblem> {
    let mut parser = Parser { text, at: 0, depth: 0, steps: Vec::new() };
    parser.sum()?;
    match parser.peek() {
        None => Ok(parser.steps),
        Some(')') => Err(parser.problem("there is no open bracket; remove \")\"")),
        Some('^') => Err(parser.problem("a power of a power needs brackets, as in (a^2)^3")),
        Some(sign @ ('=' | '<' | '>' | '!' | '&' | '|' | '?' | ':' | '%')) => Err(parser.problem(format!(
            "\"{sign}\" is no operator here; operators are + - * / ^, and corners are written with min, max and abs"
        ))),
        Some(_) => Err(parser.problem("an operator is missing; write one of + - * / ^ here, as in 2*speed")),
    }
}

struct Parser<'t> {
    text: &'t str,
    at: usize,
    depth: usize,
    steps: Vec<Step>,
}

impl Parser<'_> {
    fn problem(&self, problem: impl Into<String>) -> FormulaProblem {
        FormulaProblem::at(self.text, self.at, problem)
    }

    /// The next character that is no blank; the position moves to it.
    fn peek(&mut self) -> Option<char> {
        let rest = &self.text[self.at..];
        self.at += rest.len() - rest.trim_start().len();
        self.text[self.at..].chars().next()
    }

    /// Takes the next character if it is among these; gives its position too.
    fn take(&mut self, among: &[char]) -> Option<(char, usize)> {
        let first = self.peek().filter(|first| among.contains(first))?;
        let at = self.at;
        self.at += first.len_utf8();
        Some((first, at))
    }

    fn push(&mut self, what: What, at: usize) -> Result<(), FormulaProblem> {
        if self.steps.len() == MOST_STEPS {
            return Err(self.problem(format!("it has more than {MOST_STEPS} numbers, names and operators")));
        }
        self.steps.push(Step { what, at });
        Ok(())
    }

    fn deeper(&mut self) -> Result<(), FormulaProblem> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(self.problem(format!("brackets are nested more than {DEEPEST} deep")));
        }
        Ok(())
    }

    fn sum(&mut self) -> Result<(), FormulaProblem> {
        self.deeper()?;
        let minus = self.take(&['-', '+']);
        self.product()?;
        if let Some(('-', at)) = minus {
            self.push(What::Negative, at)?;
        }
        while let Some((operator, at)) = self.take(&['+', '-']) {
            self.product()?;
            self.push(What::Binary(operator), at)?;
        }
        self.depth -= 1;
        Ok(())
    }

    fn product(&mut self) -> Result<(), FormulaProblem> {
        self.factor()?;
        while let Some((operator, at)) = self.take(&['*', '/']) {
            if self.peek() == Some('*') {
                return Err(self.problem("a power is written with ^, as in speed^2"));
            }
            self.factor()?;
            self.push(What::Binary(operator), at)?;
        }
        Ok(())
    }

    /// A power, or the negative of one, as in `a*-b`.
    fn factor(&mut self) -> Result<(), FormulaProblem> {
        if let Some((_, at)) = self.take(&['-']) {
            self.deeper()?;
            self.factor()?;
            self.depth -= 1;
            return self.push(What::Negative, at);
        }
        self.atom()?;
        if let Some((_, at)) = self.take(&['^']) {
            let minus = self.take(&['-']);
            self.atom()?;
            if let Some((_, at)) = minus {
                self.push(What::Negative, at)?;
            }
            self.push(What::Binary('^'), at)?;
        }
        Ok(())
    }

    fn atom(&mut self) -> Result<(), FormulaProblem> {
        let expected = "a number, a name or \"(\" is expected";
        let Some(first) = self.peek() else {
            return Err(self.problem(format!("the formula ends where {expected}")));
        };
        if let Some((_, at)) = self.take(&['(']) {
            self.sum()?;
            return self.close(at);
        }
        if first.is_ascii_digit() || first == '.' {
            return self.number();
        }
        let rest = &self.text[self.at..];
        let end = rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(rest.len());
        let (name, at) = (rest[..end].to_owned(), self.at);
        if name.is_empty() {
            return Err(self.problem(format!("{expected}, and not \"{}\"", first.escape_debug())));
        }
        self.at += end;
        match self.take(&['(']) {
            None => self.push(What::Name(name), at),
            Some((_, bracket)) => self.call(&name, at, bracket),
        }
    }

    fn call(&mut self, name: &str, at: usize, bracket: usize) -> Result<(), FormulaProblem> {
        let Some(function) = FUNCTIONS.iter().position(|(known, _)| *known == name) else {
            let known: Vec<&str> = FUNCTIONS.iter().map(|(known, _)| *known).collect();
            let problem = format!("there is no function {name}; functions are {}", known.join(", "));
            return Err(FormulaProblem::at(self.text, at, problem));
        };
        let mut found = 1;
        self.sum()?;
        while self.take(&[',']).is_some() {
            self.sum()?;
            found += 1;
        }
        self.close(bracket)?;
        let wanted = FUNCTIONS[function].1;
        if found != wanted {
            let problem =
                format!("{name} has {wanted} argument{}, not {found}", if wanted == 1 { "" } else { "s" });
            return Err(FormulaProblem::at(self.text, at, problem));
        }
        self.push(What::Call(function), at)
    }

    fn close(&mut self, open: usize) -> Result<(), FormulaProblem> {
        if self.take(&[')']).is_some() {
            return Ok(());
        }
        let open = FormulaProblem::at(self.text, open, "").character;
        match self.peek() {
            None => Err(self.problem(format!("the bracket of character {open} is open; write \")\""))),
            Some(_) => Err(self.problem(format!(
                "an operator or the \")\" to the bracket of character {open} is expected here"
            ))),
        }
    }

    fn number(&mut self) -> Result<(), FormulaProblem> {
        let rest = &self.text[self.at..];
        let (mut end, mut before) = (0, ' ');
        for (index, c) in rest.char_indices() {
            let of_exponent = matches!(c, '+' | '-') && matches!(before, 'e' | 'E');
            if !(c.is_ascii_digit() || matches!(c, '.' | 'e' | 'E') || of_exponent) {
                break;
            }
            (before, end) = (c, index + 1);
        }
        let written = &rest[..end];
        let Some(number) = written.parse().ok().filter(|number: &f64| number.is_finite()) else {
            return Err(
                self.problem(format!("\"{written}\" is no number that can be read; write one like 1.5e-3"))
            );
        };
        let at = self.at;
        self.at += end;
        self.push(What::Number(number), at)
    }
}
